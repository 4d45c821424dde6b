"""Letters at hands and feet, and the names of silent limbs beside the figure."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QPainter, QPen, QPixmap

from studio.core.body import Place
from studio.ui.models.stage_pose import StagePose
from studio.ui.theme import GAP, GRID, RADIUS, Theme
from studio.ui.views.stage.body_parts import Part
from studio.ui.views.stage.outlines import Outlines

Array = NDArray[np.float64]

LETTERED = ("hand", "toes")
OF_SMALL, OF_LARGE = 0.06, 0.028  # of the figure's height; a letter is between these, if it can one and a half captions
LEAST = 16.0  # px
SMALL_FIGURE = 160.0  # px; of a figure that is less high only the feet get letters
NARROW = 420  # px at 100 % text; narrower pictures list the names at the top instead of beside the limbs
WIDEST = 0.36  # of the picture; where there is no more room beside the figure, longer names are cut
LISTED = 0.25  # of the picture's height; more room is not taken by a list


class Letters(NamedTuple):
    """The letters of both sides in the language of the window."""

    left: str
    right: str


class More(NamedTuple):
    """Words for what finds no room, with ``{n}``."""

    others: str
    all: str


class _Label(NamedTuple):
    words: str
    limb: QPointF
    on_right: bool


class LabelsPainter:
    """Fonts and colours of one palette."""

    def __init__(self, theme: Theme) -> None:
        self._theme = theme
        self._font = theme.font("body")
        self._metrics = QFontMetricsF(self._font)
        self._badges: dict[tuple[bool, int, Letters, float], QPixmap] = {}

    def letters(
        self, parts: Sequence[Part], seen: Outlines, letters: Letters, ratio: float
    ) -> dict[int, tuple[QPointF, QPixmap]]:
        """Return where to put a round L at the left hand and foot, a square R at the right ones, by part."""
        rows = list(seen.order)
        height = float(np.ptp(seen.edges[rows][..., 1])) if rows else 0.0
        usual = min(max(height * OF_SMALL, LEAST), self._theme.pixels("caption") * 1.5)
        size = round(max(usual, height * OF_LARGE))
        placed = {}
        for row in rows:
            part = parts[row]
            if part.name not in LETTERED or (part.name == "hand" and height < SMALL_FIGURE):
                continue
            corner = self._beside(seen, row, size) - QPointF(size / 2, size / 2)
            placed[row] = (corner, self._badge(part.tone == "left", size, letters, ratio))
        return placed

    def _badge(self, is_left: bool, size: int, letters: Letters, ratio: float) -> QPixmap:
        """Return a letter on its ground; drawn once for each size."""
        key = (is_left, size, letters, ratio)
        if key not in self._badges:
            self._badges[key] = self._drawn(*key)
        return self._badges[key]

    def _drawn(self, is_left: bool, size: int, letters: Letters, ratio: float) -> QPixmap:
        tokens = self._theme.tokens
        badge = QPixmap(round(size * ratio), round(size * ratio))
        badge.setDevicePixelRatio(ratio)
        badge.fill(Qt.GlobalColor.transparent)
        box = QRectF(0.0, 0.0, size, size)
        painter = QPainter(badge)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.left if is_left else tokens.right))
        if is_left:
            painter.drawEllipse(box)
        else:
            painter.drawRoundedRect(box, 2.0, 2.0)
        font = self._theme.font("caption", bold=True)
        font.setPixelSize(round(size / 1.5))
        painter.setFont(font)
        painter.setPen(QColor(tokens.on_accent))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, letters.left if is_left else letters.right)
        painter.end()
        return badge

    def _beside(self, seen: Outlines, row: int, size: int) -> QPointF:
        """Return the middle of a letter just beyond the lower end of a part."""
        edge = seen.edges[row]
        along = seen.along[row]
        tip = edge[(edge @ along).argmax()]
        x, y = (seen.middles[row] + along * ((tip - seen.middles[row]) @ along + 0.75 * size)).tolist()
        return QPointF(x, y)

    def paint_silent(
        self, painter: QPainter, room: QRectF, parts: Sequence[Part], seen: Outlines, pose: StagePose, more: More
    ) -> None:
        """Paint the words for each silent place, with a line to its limb; ``more`` says how many found no room."""
        labels = self._labels(parts, seen, pose)
        painter.setFont(self._font)
        if room.width() < NARROW * self._theme.text_scale:
            self._paint_list(painter, room, [label.words for label in labels], more)
            return
        limbs = seen.edges[list(seen.order)]
        for on_right in (False, True):
            column = sorted((label for label in labels if label.on_right == on_right), key=_height)
            side = float(limbs[..., 0].max() if on_right else limbs[..., 0].min()) if column else 0.0
            self._paint_column(painter, room, column, side, more)

    def _labels(self, parts: Sequence[Part], seen: Outlines, pose: StagePose) -> list[_Label]:
        middle = float(np.median(seen.middles[list(seen.order), 0])) if seen.order else 0.0
        largest: dict[Place, int] = {}
        for row in seen.order:
            place = parts[row].place
            if place in pose.silent and not parts[row].needs:
                known = largest.get(place)
                if known is None or np.ptp(seen.edges[row], axis=0).max() > np.ptp(seen.edges[known], axis=0).max():
                    largest[place] = row
        return [
            _Label(pose.silent[place], QPointF(*seen.middles[row].tolist()), float(seen.middles[row, 0]) >= middle)
            for place, row in largest.items()
        ]

    def _paint_column(self, painter: QPainter, room: QRectF, labels: Sequence[_Label], side: float, more: More) -> None:
        if not labels:
            return
        height, gap = self._chip_height(), float(GRID)
        fits = max(int((room.height() + gap) // (height + gap)), 1)
        shown = labels if len(labels) <= fits else labels[: fits - 1]
        hidden = len(labels) - len(shown)
        tops = _spread([label.limb.y() - height / 2 for label in shown], height + gap, room.top(), room.bottom())
        for label, top in zip(shown, tops, strict=True):
            box = self._chip(label.words, room, side, label.on_right, top)
            edge = QPointF(box.left() if label.on_right else box.right(), box.center().y())
            painter.setPen(QPen(QColor(self._theme.tokens.warn), 1.25))
            painter.drawLine(label.limb, edge)
            painter.setBrush(QColor(self._theme.tokens.warn))
            painter.drawEllipse(label.limb, 2.5, 2.5)
            self._paint_chip(painter, box, label.words)
        if hidden:
            top = tops[-1] + height + gap if tops else room.top()
            words = more.others.format(n=hidden)
            self._paint_chip(painter, self._chip(words, room, side, labels[0].on_right, top), words)

    def _paint_list(self, painter: QPainter, room: QRectF, words: Sequence[str], more: More) -> None:
        height = self._chip_height()
        fits = max(int(room.height() * LISTED // (height + GRID)), 1)
        shown = list(words)
        if len(words) > fits:
            shown = [*words[: fits - 1], more.others.format(n=len(words) - fits + 1)]
            shown = shown if fits > 1 else [more.all.format(n=len(words))]
        for line, said in enumerate(shown):
            width = min(self._width(said), room.width())
            self._paint_chip(painter, QRectF(room.left(), room.top() + line * (height + GRID), width, height), said)

    def _chip(self, words: str, room: QRectF, side: float, on_right: bool, top: float) -> QRectF:
        beside = room.right() - side - 3 * GAP if on_right else side - 3 * GAP - room.left()
        width = min(self._width(words), max(beside, WIDEST * room.width()))
        left = side + 3 * GAP if on_right else side - 3 * GAP - width
        left = min(max(left, room.left()), room.right() - width)
        return QRectF(left, top, width, self._chip_height())

    def _width(self, words: str) -> float:
        return math.ceil(self._metrics.horizontalAdvance(words)) + 2.0 * GAP + self._mark() + GRID

    def _chip_height(self) -> float:
        return math.ceil(self._metrics.height()) + float(GAP)

    def _mark(self) -> float:
        return self._metrics.ascent() * 0.7

    def _paint_chip(self, painter: QPainter, box: QRectF, words: str) -> None:
        tokens = self._theme.tokens
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.raised))
        painter.drawRoundedRect(box, RADIUS, RADIUS)
        size = self._mark()
        mark = QRectF(box.left() + GAP, box.center().y() - size / 2, size, size)
        painter.setPen(QPen(QColor(tokens.warn), 1.75))
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawEllipse(mark.adjusted(1, 1, -1, -1))
        text = QRectF(mark.right() + GRID, box.top(), box.right() - GAP - mark.right() - GRID, box.height())
        painter.setPen(QColor(tokens.text))
        # one px more: elision rounds
        said = self._metrics.elidedText(words, Qt.TextElideMode.ElideRight, text.width() + 1.0)
        painter.drawText(text, Qt.AlignmentFlag.AlignVCenter | Qt.TextFlag.TextSingleLine, said)


def _height(label: _Label) -> float:
    return label.limb.y()


def _spread(wanted: Sequence[float], step: float, top: float, bottom: float) -> list[float]:
    """Return places near the wanted ones, ``step`` apart, between ``top`` and ``bottom`` as far as there is room."""
    places: list[float] = []
    for place in wanted:
        places.append(max(place, places[-1] + step if places else top))
    limit = bottom - step
    for row in reversed(range(len(places))):
        places[row] = max(min(places[row], limit), top)
        limit = places[row] - step
    return places
