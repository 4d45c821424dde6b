"""The body: parts painted from the farthest to the nearest; known ones shaded, unknown hatched, silent hollow."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QImage, QPainter, QPolygonF, QTransform
from shiboken6 import VoidPtr

from studio.ui.models.stage_pose import StagePose
from studio.ui.views.stage.body_parts import Body, Part
from studio.ui.views.stage.camera import Camera
from studio.ui.views.stage.outlines import EDGE, Outlines, grown, outlines
from studio.ui.views.stage.shading import Shading, placed

Array = NDArray[np.float64]

RIM = 1.25  # hairlines; the dark line that parts a limb from what is behind it
GHOST_RIM = 1.75  # hairlines


class FigurePainter:
    """Keeps two polygons for each part, so that a frame makes none."""

    def __init__(self, body: Body) -> None:
        self.body = body
        self._leads = np.array([part.lead for part in body.parts])
        self._edges, self._rims = Polygons(len(body.parts)), Polygons(len(body.parts))

    def project(self, camera: Camera, pose: StagePose) -> Outlines:
        """Return the body of ``pose`` on the picture."""
        return outlines(self.body, camera, pose.world_from_segment, pose.joints, self._leads)

    def paint(self, painter: QPainter, shading: Shading, pose: StagePose, seen: Outlines) -> None:
        """Paint the figure."""
        painter.setPen(Qt.PenStyle.NoPen)
        self._edges.fill(seen.edges)
        self._rims.fill(grown(seen.edges, RIM * seen.hairline))
        shades = np.column_stack([seen.light_across, seen.light_towards, seen.across, seen.shade_middle]).tolist()
        known = pose.measured.difference(pose.silent)
        for row in seen.order:
            part = self.body.parts[row]
            if part.needs:
                if known.issuperset(part.needs):
                    self._paint_shaded(painter, shading, part, shades[row], row)
            elif part.place in pose.silent:
                self._paint_hollow(painter, shading, row)
            elif part.place not in pose.measured:
                self._paint_hatched(painter, shading, seen, row)
            else:
                painter.setBrush(shading.rim)
                painter.drawPolygon(self._rims[row])
                self._paint_shaded(painter, shading, part, shades[row], row)

    def paint_ghost(self, painter: QPainter, shading: Shading, seen: Outlines) -> None:
        """Paint only the outline of the whole body, filled so thinly that what is behind is seen."""
        if not seen.order:
            return
        rows = list(seen.order)
        left, top = np.floor(seen.edges[rows].min(axis=(0, 1)) - 2 * GHOST_RIM * seen.hairline).tolist()
        right, bottom = np.ceil(seen.edges[rows].max(axis=(0, 1)) + 2 * GHOST_RIM * seen.hairline).tolist()
        box = QRectF(left, top, right - left, bottom - top) & QRectF(painter.window())
        if box.isEmpty():
            return
        ratio = painter.device().devicePixelRatio()
        layer = QImage((box.size() * ratio).toSize(), QImage.Format.Format_ARGB32_Premultiplied)
        layer.setDevicePixelRatio(ratio)
        layer.fill(Qt.GlobalColor.transparent)
        self._edges.fill(seen.edges)
        self._rims.fill(grown(seen.edges, GHOST_RIM * seen.hairline))
        inner = QPainter(layer)
        inner.setRenderHint(QPainter.RenderHint.Antialiasing)
        inner.translate(-box.topLeft())
        inner.setPen(Qt.PenStyle.NoPen)
        inner.setBrush(shading.ghost_edge)
        for row in rows:
            inner.drawPolygon(self._rims[row])
        # all insides replace what was painted: only the edge of the whole stays
        inner.setCompositionMode(QPainter.CompositionMode.CompositionMode_Source)
        inner.setBrush(shading.ghost_fill)
        for row in rows:
            inner.drawPolygon(self._edges[row])
        inner.end()
        painter.drawImage(box.topLeft(), layer)

    def _paint_shaded(self, painter: QPainter, shading: Shading, part: Part, shade: list[float], row: int) -> None:
        across, towards, ax, ay, x, y = shade
        brush = shading.brush(part.tone, across, towards)
        painter.setBrush(placed(brush, QTransform(ax, ay, -ay, ax, x, y)))
        painter.drawPolygon(self._edges[row])

    def _paint_hatched(self, painter: QPainter, shading: Shading, seen: Outlines, row: int) -> None:
        (ax, ay), (x, y) = seen.along[row].tolist(), seen.middles[row].tolist()
        # the lines lie at 45 degrees to the limb and move with it
        cos, sin = (ax - ay) * math.sqrt(0.5), (ax + ay) * math.sqrt(0.5)
        painter.setBrush(placed(shading.hatch, QTransform(cos, sin, -sin, cos, x, y)))
        painter.setPen(shading.hatch_pen)
        painter.drawPolygon(self._edges[row])
        painter.setPen(Qt.PenStyle.NoPen)

    def _paint_hollow(self, painter: QPainter, shading: Shading, row: int) -> None:
        painter.setBrush(shading.hollow_fill)
        painter.setPen(shading.hollow_pen)
        painter.drawPolygon(self._edges[row])
        painter.setPen(Qt.PenStyle.NoPen)


class Polygons:
    """Outlines for Qt in memory of their own, written as one array: 40 points cost as much as one."""

    def __init__(self, count: int) -> None:
        self._polygons = [QPolygonF([QPointF()] * EDGE) for _ in range(count)]
        self._points = [_points_of(polygon) for polygon in self._polygons]

    def __getitem__(self, row: int) -> QPolygonF:
        return self._polygons[row]

    def fill(self, edges: Array) -> None:
        """Take over ``edges`` (count, EDGE, 2), px."""
        for points, edge in zip(self._points, edges, strict=True):
            points[:] = edge


def _points_of(polygon: QPolygonF) -> Array:
    size = np.dtype(np.float64).itemsize * 2 * EDGE
    memory: Any = VoidPtr(polygon.data(), size, True)  # type: ignore[call-arg, arg-type]  # the stub knows less
    return np.frombuffer(memory, np.float64).reshape(EDGE, 2)
