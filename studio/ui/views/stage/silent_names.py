"""The names of silent limbs beside the figure, with a line to each.

They stand at the height that the limb has in a body that stands upright: names that went with the limbs could not be
read.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen

from studio.core import rotation
from studio.core.body import Place, Segment
from studio.ui.models.stage_pose import StagePose
from studio.ui.theme import GAP, GRID, RADIUS, Theme
from studio.ui.views.stage.body_parts import Part
from studio.ui.views.stage.camera import Camera
from studio.ui.views.stage.outlines import Outlines

Array = NDArray[np.float64]

NARROW = 420  # px at 100 % text; narrower pictures list the names at the top instead of beside the limbs
ASIDE = 0.30  # of the stature, from the body's middle to the names
WIDEST = 0.30  # of the picture; where there is less room beside the figure, names lie over it
LISTED = 0.25  # of the picture's height; more is not taken by a list
TURNED = 0.25  # sine of the turn from which the sides of the names change: a step turns the hips by 0.1
LEFT, RIGHT = 0, 1  # columns of the picture

HEIGHTS: dict[str, float] = {
    "head": 0.93,
    "chest": 0.78,
    "upper_arm": 0.74,
    "forearm": 0.58,
    "pelvis": 0.54,
    "hand": 0.46,
    "thigh": 0.40,
    "shank": 0.20,
    "foot": 0.04,
}
"""Of the stature; of places on both sides."""


class More(NamedTuple):
    """Words for what finds no room, with ``{n}``."""

    others: str
    all: str


class _Name(NamedTuple):
    words: str
    limb: QPointF
    height: float
    column: int


class SilentNames:
    """Fonts and colours of one palette; remembers on which side the names of the left limbs stand."""

    def __init__(self, theme: Theme) -> None:
        self._theme = theme
        self._font = theme.font("body")
        self._metrics = QFontMetricsF(self._font)
        self._left_column = RIGHT

    def list_height(self, width: float, height: float, pose: StagePose) -> float:
        """Return the px that a list at the top takes, 0 where the names stand beside the limbs."""
        if not pose.silent or not self._is_narrow(width):
            return 0.0
        return min(len(pose.silent), self._lines_listed(height)) * (self._chip_height() + GRID)

    def paint(
        self,
        painter: QPainter,
        room: QRectF,
        camera: Camera,
        stature: float,
        parts: Sequence[Part],
        seen: Outlines,
        pose: StagePose,
        more: More,
    ) -> None:
        """Paint the words for each silent place; ``more`` says what found no room."""
        painter.setFont(self._font)
        if self._is_narrow(room.width()):
            self._paint_list(painter, room, list(pose.silent.values()), more)
            return
        self._choose_columns(camera, pose)
        names = self._names(parts, seen, pose)
        columns = [sorted((name for name in names if name.column == c), key=_downwards) for c in (LEFT, RIGHT)]
        lines = 2 if (self._chip_height(2) + GRID) * max(map(len, columns)) <= room.height() else 1
        for mine in columns:
            if mine:
                self._paint_column(painter, room, mine, _anchors(camera, stature, mine), lines, more)

    def _is_narrow(self, width: float) -> bool:
        return width < NARROW * self._theme.text_scale

    def _choose_columns(self, camera: Camera, pose: StagePose) -> None:
        right = rotation.rotate(pose.world_from_segment[Segment.Hips], (0.0, 0.0, 1.0))
        turn = float(right @ camera.axes[0])
        if abs(turn) > TURNED:
            self._left_column = LEFT if turn > 0 else RIGHT

    def _names(self, parts: Sequence[Part], seen: Outlines, pose: StagePose) -> list[_Name]:
        largest: dict[Place, int] = {}
        for row in seen.order:
            place = parts[row].place
            if place in pose.silent and not parts[row].needs and parts[row].lead < 0.03:
                known = largest.get(place)
                if known is None or _extent(seen, row) > _extent(seen, known):
                    largest[place] = row
        return [
            _Name(pose.silent[place], QPointF(*seen.middles[row].tolist()), _height(place), self._column(place))
            for place, row in largest.items()
        ]

    def _column(self, place: Place) -> int:
        if place.value.startswith("left_"):
            return self._left_column
        return 1 - self._left_column

    def _paint_column(
        self,
        painter: QPainter,
        room: QRectF,
        names: Sequence[_Name],
        anchors: Sequence[QPointF],
        lines: int,
        more: More,
    ) -> None:
        column, edge = names[0].column, anchors[0].x()
        least = self._chip_height() + GRID
        fits = max(int((room.height() + GRID) // least), 1)
        shown = list(names) if len(names) <= fits else list(names[: fits - 1])
        boxes = [self._chip(name.words, room, edge, column, lines) for name in shown]
        said = [name.words for name in shown]
        if len(shown) < len(names):
            said.append(more.others.format(n=len(names) - len(shown)))
            boxes.append(self._chip(said[-1], room, edge, column, 1))
        wanted = [*(anchor.y() for anchor in anchors[: len(shown)]), room.bottom()]
        tops = _spread(wanted[: len(boxes)], [box.height() for box in boxes], room.top(), room.bottom())
        for box, top in zip(boxes, tops, strict=True):
            box.moveTop(top)
        for name, box in zip(shown, boxes, strict=False):
            self._paint_line(
                painter, name.limb, QPointF(box.left() if column == RIGHT else box.right(), box.center().y())
            )
        for words, box in zip(said, boxes, strict=True):
            self._paint_chip(painter, box, words)

    def _paint_line(self, painter: QPainter, limb: QPointF, name: QPointF) -> None:
        warn = QColor(self._theme.tokens.warn)
        painter.setPen(QPen(warn, 1.25))
        painter.drawLine(limb, name)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(warn)
        painter.drawEllipse(limb, 3.0, 3.0)

    def _paint_list(self, painter: QPainter, room: QRectF, words: Sequence[str], more: More) -> None:
        height, fits = self._chip_height(), self._lines_listed(room.height())
        shown = list(words)
        if len(words) > fits:
            shown = [*words[: fits - 1], more.others.format(n=len(words) - fits + 1)]
            shown = shown if fits > 1 else [more.all.format(n=len(words))]
        for line, said in enumerate(shown):
            width = min(self._width(said), room.width())
            self._paint_chip(painter, QRectF(room.left(), room.top() + line * (height + GRID), width, height), said)

    def _lines_listed(self, height: float) -> int:
        return max(int(height * LISTED // (self._chip_height() + GRID)), 1)

    def _chip(self, words: str, room: QRectF, edge: float, column: int, lines: int) -> QRectF:
        beside = room.right() - edge if column == RIGHT else edge - room.left()
        full = self._width(words)
        width = min(full, max(beside, WIDEST * room.width()))
        left = min(max(edge if column == RIGHT else edge - width, room.left()), room.right() - width)
        return QRectF(left, 0.0, width, self._chip_height(lines if full > width else 1))

    def _width(self, words: str) -> float:
        return math.ceil(self._metrics.horizontalAdvance(words)) + 2.0 * GAP + self._mark() + GRID + 2.0

    def _chip_height(self, lines: int = 1) -> float:
        return math.ceil(lines * self._metrics.lineSpacing()) + float(GAP)

    def _mark(self) -> float:
        return self._metrics.ascent() * 0.7

    def _paint_chip(self, painter: QPainter, box: QRectF, words: str) -> None:
        tokens = self._theme.tokens
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.raised))
        painter.drawRoundedRect(box, RADIUS, RADIUS)
        size = self._mark()
        line = self._chip_height() / 2
        mark = QRectF(box.left() + GAP, box.top() + line - size / 2, size, size)
        painter.setPen(QPen(QColor(tokens.warn), 1.75))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(mark.adjusted(1, 1, -1, -1))
        text = QRectF(mark.right() + GRID, box.top(), box.right() - GAP - mark.right() - GRID, box.height())
        painter.setPen(QColor(tokens.text))
        flags = Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft
        lines = [words] if box.height() <= self._chip_height() else self._halved(words, text.width())
        text.adjust(0.0, GRID, 0.0, -GRID)
        text.setHeight(text.height() / len(lines))
        for said in lines:
            cut = self._metrics.elidedText(said, Qt.TextElideMode.ElideRight, text.width())
            painter.drawText(text, flags | Qt.TextFlag.TextSingleLine, cut)
            text.translate(0.0, text.height())

    def _halved(self, words: str, width: float) -> list[str]:
        """Return what fits into a line, and the rest."""
        parts = words.split(" ")
        fits = 1
        while fits < len(parts) and self._metrics.horizontalAdvance(" ".join(parts[: fits + 1])) <= width:
            fits += 1
        return [" ".join(parts[:fits]), " ".join(parts[fits:])]


def _downwards(name: _Name) -> float:
    return -name.height


def _height(place: Place) -> float:
    return HEIGHTS[place.value.removeprefix("left_").removeprefix("right_")]


def _extent(seen: Outlines, row: int) -> float:
    return float(np.ptp(seen.edges[row], axis=0).max())


def _anchors(camera: Camera, stature: float, names: Sequence[_Name]) -> list[QPointF]:
    """Return where the names begin: beside the middle of the picture, at their heights."""
    aside = ASIDE * stature * camera.axes[0] * (1.0 if names[0].column == RIGHT else -1.0)
    x, y, _ = camera.target
    points = [np.array([x, y, name.height * stature]) + aside for name in names]
    return [QPointF(*row) for row in np.nan_to_num(camera.project(np.array(points))).tolist()]


def _spread(wanted: Sequence[float], heights: Sequence[float], top: float, bottom: float) -> list[float]:
    """Return the upper ends of boxes near their wanted middles, in order, between ``top`` and ``bottom``."""
    tops: list[float] = []
    least = top
    for middle, height in zip(wanted, heights, strict=True):
        tops.append(max(middle - height / 2, least))
        least = tops[-1] + height + GRID
    limit = bottom
    for row in reversed(range(len(tops))):
        tops[row] = max(min(tops[row], limit - heights[row]), top)
        limit = tops[row] - GRID
    return tops
