"""The floor: a grid that fades to the horizon, the path that was walked, and the shadow below the body."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QLinearGradient, QPainter, QPen, QPolygonF, QTransform

from studio.core import rotation
from studio.core.body import Segment, Skeleton
from studio.ui.theme import Theme
from studio.ui.views.stage.camera import NEAR, Camera
from studio.ui.views.stage.shading import Shading, mixed, placed

Array = NDArray[np.float64]

REACH = 2.8  # of the camera's distance; how far the grid goes
FADES = ((0.0, 0), (0.27, 0), (0.42, 70), (0.75, 190), (1.0, 235))
"""Nearness (the target's depth by that of the line) and how much of 255 is seen."""
FLAT = math.radians(80.0)  # rad; seen more steeply, the floor has no far end
SHADOW_HEIGHT = 0.35  # m; what is higher throws no contact shadow


class FloorPainter:
    """Pens and brushes of one palette."""

    def __init__(self, theme: Theme) -> None:
        tokens = theme.tokens
        ground = QColor(tokens.window)
        self._line = mixed(ground, QColor(tokens.text), 0.24 if theme.is_dark else 0.22)
        self._path = QColor(tokens.accent)
        self._fading_line, self._fading_path = _fading(self._line), _fading(self._path)

    def paint_grid(self, painter: QPainter, camera: Camera) -> None:
        """Paint lines a metre apart, or more when the eye is far."""
        ends = camera.seen(_grid(camera))
        kept = _clipped(ends)
        points = camera.on_picture(kept).reshape(-1, 4)
        painter.setPen(self._pen(camera, self._fading_line, self._line, 1.0))
        painter.drawLines([QLineF(*row) for row in points.tolist()])

    def paint_path(self, painter: QPainter, camera: Camera, path: Array) -> None:
        """Paint where the hips were above the floor, (n, 2), m, world; a NaN row parts two ways."""
        if len(path) < 2:
            return
        points = camera.project(np.column_stack([path, np.zeros(len(path))]))
        painter.setPen(self._pen(camera, self._fading_path, self._path, 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for run in _runs(points):
            painter.drawPolyline(QPolygonF([QPointF(x, y) for x, y in run.tolist()]))

    def paint_shadow(
        self,
        painter: QPainter,
        camera: Camera,
        shading: Shading,
        skeleton: Skeleton,
        world_from_segment: Array,
        joints: Array,
    ) -> None:
        """Paint soft shadows below the hips, the feet, and what else comes near the floor."""
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(shading.shadow)
        under = joints[Segment.Hips] * (1.0, 1.0, 0.0)
        self._blot(painter, camera, under, np.array([0.42, 0.0, 0.0]), 0.42, 0.55)
        for foot in (Segment.LeftFoot, Segment.RightFoot):
            sole = joints[foot] + rotation.rotate(world_from_segment[foot], skeleton.foot_points())
            long = (sole[1] - sole[0]) * (0.85, 0.85, 0.0)
            self._blot(painter, camera, sole.mean(axis=0) * (1.0, 1.0, 0.0), long, 0.085, _near(sole[:, 2].min()))
        for joint in (Segment.LeftHand, Segment.RightHand, Segment.LeftLeg, Segment.RightLeg, Segment.Head):
            x, y, z = joints[joint]
            self._blot(painter, camera, np.array([x, y, 0.0]), np.array([0.13, 0.0, 0.0]), 0.13, _near(z - 0.05))
        painter.setOpacity(1.0)

    def _blot(
        self, painter: QPainter, camera: Camera, middle: Array, long: Array, half_width: float, dark: float
    ) -> None:
        length = float(np.hypot(long[0], long[1]))
        if not (math.isfinite(length) and np.isfinite(middle).all()) or dark <= 0.0 or length < half_width / 4:
            return
        wide = np.array([-long[1], long[0], 0.0]) * (half_width / length)
        points = camera.project(np.stack([middle, middle + long, middle + wide]))
        if not np.isfinite(points).all():
            return
        (x, y), (lx, ly), (wx, wy) = points.tolist()
        painter.save()
        painter.setOpacity(dark)
        painter.setTransform(QTransform(lx - x, ly - y, wx - x, wy - y, x, y), True)
        painter.drawEllipse(QRectF(-1.0, -1.0, 2.0, 2.0))
        painter.restore()

    def _pen(self, camera: Camera, fading: QBrush, plain: QColor, width: float) -> QPen:
        if camera.elevation > FLAT:
            return QPen(plain, width)
        top = camera.horizon
        at_target = camera.project(np.array([camera.target[0], camera.target[1], 0.0]))[1]
        if not math.isfinite(at_target) or at_target - top < 1.0:
            return QPen(plain, width)
        pen = QPen(placed(fading, QTransform(1.0, 0.0, 0.0, float(at_target) - top, 0.0, top)), width)
        pen.setJoinStyle(Qt.PenJoinStyle.RoundJoin)
        return pen


def _fading(colour: QColor) -> QBrush:
    """Return a brush from the horizon at y = 0 to the target at y = 1: on the picture nearness runs evenly."""
    gradient = QLinearGradient(0.0, 0.0, 0.0, 1.0)
    for nearness, alpha in FADES:
        seen = QColor(colour)
        seen.setAlpha(alpha)
        gradient.setColorAt(nearness, seen)
    return QBrush(gradient)


def _grid(camera: Camera) -> Array:
    """Return the ends of the lines, (n, 2, 3), m, world."""
    reach = REACH * camera.distance
    step = 1.0 if camera.distance < 9.0 else 2.0 if camera.distance < 18.0 else 5.0
    lines = []
    for axis in (0, 1):
        middle = camera.target[axis]
        along = camera.target[1 - axis]
        places = np.arange(math.ceil((middle - reach) / step), math.floor((middle + reach) / step) + 1) * step
        ends = np.zeros((len(places), 2, 3))
        ends[:, :, axis] = places[:, None]
        ends[:, :, 1 - axis] = (along - reach, along + reach)
        lines.append(ends)
    return np.concatenate(lines)


def _clipped(ends: Array) -> Array:
    """Return lines (n, 2, 3) along right, up, depth without what lies nearer than NEAR."""
    depth = ends[..., 2]
    ends = ends[(depth > NEAR).any(axis=1)]
    depth = ends[..., 2]
    others = ends[:, ::-1]
    run = depth - others[..., 2]
    share = np.clip((1.01 * NEAR - others[..., 2]) / np.where(run == 0.0, 1.0, run), 0.0, 1.0)
    cut = others + share[..., None] * (ends - others)
    return np.where((depth > NEAR)[..., None], ends, cut)


def _runs(points: Array) -> Sequence[Array]:
    known = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(known.astype(np.int8))) + 1
    return [run for run in np.split(points, cuts) if len(run) > 1 and np.isfinite(run).all()]


def _near(height: float) -> float:
    """Return how dark the shadow of something at a height in m is, 0…1."""
    return float(np.clip(1.0 - height / SHADOW_HEIGHT, 0.0, 1.0) ** 2) if math.isfinite(height) else 0.0
