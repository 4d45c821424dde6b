"""The floor: a grid that fades to the horizon, the path that was walked, and the shadow below the body."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPoint, QPointF, QRect, QRectF, QSize, QSizeF, Qt
from PySide6.QtGui import QBrush, QColor, QLinearGradient, QPainter, QPen, QPixmap, QTransform

from studio.core import rotation
from studio.core.body import Segment, Skeleton
from studio.ui.theme import Theme
from studio.ui.views.stage.camera import NEAR, Camera
from studio.ui.views.stage.shading import Shading, mixed, placed

Array = NDArray[np.float64]

REACH = 1.2  # of the camera's distance; how far the grid goes
FADES = ((0.0, 0), (0.45, 0), (0.6, 85), (0.8, 180), (1.0, 235))
"""Nearness (the target's depth by that of the line) and how much of 255 is seen."""
FLAT = math.radians(80.0)  # rad; seen more steeply, the floor has no far end
LOW = (Segment.LeftHand, Segment.RightHand, Segment.LeftLeg, Segment.RightLeg, Segment.Head)
FAINTEST = 0.02  # of the shadow's darkness; less is not seen
FLATTEST = 0.05  # of its width; the least height of a shadow on the picture
AIR = 0.1  # of the picture; so far beyond its edge lines are still drawn
SHADOW_HEIGHT = 0.35  # m; what is higher throws no contact shadow


class FloorPainter:
    """Pens and brushes of one palette, and the floor as it was seen last."""

    def __init__(self, theme: Theme) -> None:
        tokens = theme.tokens
        ground = QColor(tokens.window)
        self._ground = _ground(theme)
        self._line = mixed(ground, QColor(tokens.text), 0.24 if theme.is_dark else 0.22)
        self._path = QColor(tokens.accent)
        self._fading_line, self._fading_path = _fading(self._line), _fading(self._path)

        self._seen: tuple[Camera, QSize, float] | None = None
        self._kept: QPixmap | None = None

    def paint(self, painter: QPainter, camera: Camera, room: QSize) -> None:
        """Paint ground and grid; while the camera stands, as a picture that was kept."""
        ratio = painter.device().devicePixelRatio()
        seen = (camera, room, ratio)
        if seen != self._seen:
            self._seen, self._kept = seen, None
            self._paint_anew(painter, camera, room)
            return
        if self._kept is None:
            self._kept = QPixmap((QSizeF(room) * ratio).toSize())
            self._kept.setDevicePixelRatio(ratio)
            inner = QPainter(self._kept)
            inner.setRenderHints(painter.renderHints())
            self._paint_anew(inner, camera, room)
            inner.end()
        painter.drawPixmap(0, 0, self._kept)

    def _paint_anew(self, painter: QPainter, camera: Camera, room: QSize) -> None:
        painter.fillRect(QRect(QPoint(), room), placed(self._ground, QTransform.fromScale(1.0, room.height())))
        self._paint_grid(painter, camera)

    def _paint_grid(self, painter: QPainter, camera: Camera) -> None:
        """Paint lines a metre apart, or more when the eye is far."""
        ends = camera.seen(_grid(camera))
        kept = _clipped(ends)
        points = camera.on_picture(kept)
        across = points[..., 0]
        points = points[(across.max(axis=1) > 0.0) & (across.min(axis=1) < camera.size[0])].reshape(-1, 4)
        painter.setPen(self._pen(camera, self._fading_line, self._line, 1.0))
        painter.drawLines([QLineF(*row) for row in points.tolist()])

    def paint_path(self, painter: QPainter, camera: Camera, path: Array) -> None:
        """Paint where the hips were above the floor, (n, 2), m, world; a NaN row parts two ways."""
        near = np.hypot(*(path - camera.target[:2]).T) < REACH * camera.distance
        points = camera.project(np.column_stack([np.where(near[:, None], path, np.nan), np.zeros(len(path))]))
        painter.setPen(self._pen(camera, self._fading_path, self._path, 2.0))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        for run in _runs(_in_sight(points, camera)):
            painter.drawPolyline([QPointF(x, y) for x, y in run.tolist()])

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
        with np.errstate(invalid="ignore"):
            spots, width, dark = _shadows(skeleton, world_from_segment, joints)
            seen = camera.seen(spots)
        above = abs(float(camera.eye[2]))
        blot = shading.shadow
        for (x, y), depth, half_width, amount in zip(
            camera.on_picture(seen).tolist(), seen[:, 2].tolist(), width, dark, strict=True
        ):
            if amount > FAINTEST and math.isfinite(x + y):
                # a circle on the floor is an ellipse that is as flat as the camera is low
                wide = half_width * camera.focal / depth
                high = wide * max(above / depth, FLATTEST)
                painter.setOpacity(amount)
                painter.drawPixmap(QRectF(x - wide, y - high, 2 * wide, 2 * high), blot, QRectF(blot.rect()))
        painter.setOpacity(1.0)

    def _pen(self, camera: Camera, fading: QBrush, plain: QColor, hairlines: float) -> QPen:
        width = hairlines * camera.hairline
        if camera.elevation > FLAT:
            return QPen(plain, width)
        top = camera.horizon
        at_target = camera.project(np.array([camera.target[0], camera.target[1], 0.0]))[1]
        if not math.isfinite(at_target) or at_target - top < 1.0:
            return QPen(plain, width)
        return QPen(placed(fading, QTransform(1.0, 0.0, 0.0, float(at_target) - top, 0.0, top)), width)


def _ground(theme: Theme) -> QBrush:
    """Return the ground behind the figure, from y = 0 to 1: lighter where the floor is near, so that shadows show."""
    window, raised = QColor(theme.tokens.window), QColor(theme.tokens.raised)
    gradient = QLinearGradient(0.0, 0.0, 0.0, 1.0)
    for place, share in ((0.0, 0.1), (0.28, 0.0), (0.85, 1.0), (1.0, 0.8)):
        gradient.setColorAt(place, mixed(window, raised, share))
    return QBrush(gradient)


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


def _in_sight(points: Array, camera: Camera) -> Array:
    """Return ``points`` (n, 2), px, with NaN for those between which no line comes near the picture."""
    size = np.array(camera.size)
    air = AIR * size.max()
    with np.errstate(invalid="ignore"):
        low, high = np.minimum(points[:-1], points[1:]), np.maximum(points[:-1], points[1:])
        crossing = ((high >= -air) & (low <= size + np.array([air, camera.top + air]))).all(axis=1)
    kept = np.append(crossing, False) | np.append(False, crossing)
    return np.where(kept[:, None], points, np.nan)


def _runs(points: Array) -> Sequence[Array]:
    known = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(known.astype(np.int8))) + 1
    return [run for run in np.split(points, cuts) if len(run) > 1 and np.isfinite(run).all()]


def _shadows(skeleton: Skeleton, world_from_segment: Array, joints: Array) -> tuple[Array, list[float], list[float]]:
    """Return where shadows are, (n, 3), m, world, half their widths in m, and how dark they are, 0…1."""
    left, right = (
        joints[foot] + rotation.rotate(world_from_segment[foot], skeleton.foot_points())
        for foot in (Segment.LeftFoot, Segment.RightFoot)
    )
    points = np.array([joints[Segment.Hips], *_along(left), *_along(right), *joints[list(LOW)]])
    width = [0.42] + [0.10] * 6 + [0.15] * len(LOW)
    return points * (1.0, 1.0, 0.0), width, [0.6, *(_near(height) for height in points[1:, 2].tolist())]


def _along(sole: Array) -> Array:
    """Return three places from heel to ball, (3, 3), m, world."""
    return np.asarray(sole[:1] + np.array([[0.12], [0.55], [1.0]]) * (sole[1:] - sole[:1]))


def _near(height: float) -> float:
    """Return how dark the shadow of something at a height in m is, 0…1."""
    return min(max(1.0 - height / SHADOW_HEIGHT, 0.0), 1.0) ** 2 if math.isfinite(height) else 0.0
