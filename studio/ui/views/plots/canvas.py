"""The ground of all plots: light grid, no box, labels at the ends of the lines.

pyqtgraph has the view and its ranges. The axes are ours, because its axis items cost more than three curves, and are
kept as a picture as long as neither range nor size changes.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pyqtgraph as pg
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFocusEvent, QFontMetricsF, QPainter, QPainterPath, QPen, QResizeEvent, QShowEvent
from PySide6.QtWidgets import QFrame, QGraphicsView, QSizePolicy, QStyleOptionGraphicsItem, QWidget

from studio.ui.theme import FOCUS, GAP, GRID, Theme

MARKS = 8  # px; height of the strip below the lines in which marks stand
LEAST_WIDTH, LEAST_HEIGHT = 160, 96  # px at 100 % text


class Tick(NamedTuple):
    """A line of the grid."""

    at: float
    words: str
    """Empty: a line without a number."""


class EndLabel(NamedTuple):
    """What stands at the end of a line."""

    words: str
    at: float
    """Value of the line's end."""
    colour: str


class Drawn(NamedTuple):
    """The points of a curve in the units of its axes."""

    x: NDArray[np.float64]
    """(n,)."""
    y: NDArray[np.float64]
    """(n,)."""
    joined: NDArray[np.bool_]
    """(n,), whether a point is joined to the next."""


class Curve(pg.GraphicsObject):
    """A line, broken where points are not joined; as large as its view, so that nobody asks for least and most of it.

    pyqtgraph's own curve checks and converts for each picture what we know already: it costs twice as much.
    """

    def __init__(self) -> None:
        super().__init__()
        self.pen = QPen()
        self._path = QPainterPath()
        self.clear()

    def setPen(self, pen: QPen) -> None:  # noqa: N802 (as Qt's painter calls it)
        """Draw with this pen from now on."""
        self.pen = pen
        self.update()

    def draw(self, x: NDArray[np.float64], y: NDArray[np.float64], joined: NDArray[np.bool_]) -> None:
        """Draw these points, ``joined`` to the next or not."""
        self.drawn = Drawn(x, y, joined)
        self._path = pg.arrayToQPath(x, y, "all" if joined[:-1].all() else joined, finiteCheck=False)
        self.update()

    def clear(self) -> None:
        """Draw nothing."""
        nothing = np.empty(0)
        self.draw(nothing, nothing, np.empty(0, np.bool_))

    def boundingRect(self) -> QRectF:  # noqa: N802 (Qt's name)
        """Return what the view shows."""
        view = self.getViewBox()
        return QRectF() if view is None else QRectF(view.viewRect())

    def paint(self, painter: QPainter, option: QStyleOptionGraphicsItem, widget: QWidget | None = None) -> None:
        """Paint the line."""
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(self.pen)
        painter.drawPath(self._path)


class PlotCanvas(pg.GraphicsView):
    """Curves in a frame of reference; a subclass says which."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._title = ""
        self._nothing = ""
        self._x_ticks: Sequence[Tick] = ()
        self._y_ticks: Sequence[Tick] = ()
        self._labels: Sequence[EndLabel] = ()
        self._widest_label = ""
        self._area = QRectF(0, 0, 8, 8)
        self.view = pg.ViewBox(enableMouse=False, enableMenu=False)
        self.view.disableAutoRange()
        self.scene().addItem(self.view)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setCacheMode(QGraphicsView.CacheModeFlag.CacheBackground)
        self.setViewportUpdateMode(QGraphicsView.ViewportUpdateMode.FullViewportUpdate)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.updateGeometry()
        self._lay_out()
        self.redraw()

    def redraw(self) -> None:
        """Draw anew what was shown last; called when something else than the data changed."""

    def is_seen(self) -> bool:
        """Return whether any of the plot is on the screen."""
        return self.isVisible() and not self.viewport().visibleRegion().isEmpty()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return room to read it."""
        return self.minimumSizeHint() * 2

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return room for axes and some line."""
        scale = max(self._theme.text_scale, 1.0)
        return QSize(round(LEAST_WIDTH * scale), round(LEAST_HEIGHT * scale))

    def area(self) -> QRectF:
        """Return where the lines are, px."""
        return self._area

    def x_of(self, at: float) -> float:
        """Return the pixel of a value on the horizontal axis."""
        area, (low, high) = self.area(), self.view.viewRange()[0]
        return float(area.left() + area.width() * (at - low) / (high - low))

    def y_of(self, at: float) -> float:
        """Return the pixel of a value on the vertical axis."""
        area, (low, high) = self.area(), self.view.viewRange()[1]
        return float(area.bottom() - area.height() * (at - low) / (high - low))

    def column_s(self, column: float) -> float:
        """Return what ``column`` pixels span on the horizontal axis."""
        low, high = self.view.viewRange()[0]
        return float((high - low) * column / max(self.area().width(), 1.0))

    def set_axes(
        self, x: tuple[float, float], x_ticks: Sequence[Tick], y: tuple[float, float], y_ticks: Sequence[Tick]
    ) -> None:
        """Set the ranges and the lines of the grid."""
        ranges = [list(x), list(y)]
        if ranges == self.view.viewRange() and (x_ticks, y_ticks) == (self._x_ticks, self._y_ticks):
            return
        self._x_ticks, self._y_ticks = x_ticks, y_ticks
        self.view.setRange(xRange=x, yRange=y, padding=0)
        self._lay_out()

    def set_title(self, words: str) -> None:
        """Say what is plotted and in which unit."""
        self._title = words
        self.resetCachedContent()

    def set_labels(self, labels: Sequence[EndLabel], nothing: str) -> None:
        """Set what stands at the ends of the lines, or ``nothing`` when there are none."""
        self._labels, self._nothing = labels, nothing
        widest = max((label.words for label in labels), key=len, default=self._widest_label)
        if widest != self._widest_label:
            self._widest_label = widest
            self._lay_out()

    def resizeEvent(self, event: QResizeEvent | None) -> None:  # noqa: N802 (Qt's name)
        """Lay out."""
        super().resizeEvent(event)
        if event is None:  # pyqtgraph calls it while it is being built
            return
        self._lay_out()
        self.redraw()

    def close(self) -> bool:
        """Close as every widget: pyqtgraph 0.14 takes its viewport away, which ends the program (PySide6 6.10)."""
        return QGraphicsView.close(self)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 (Qt's name)
        """Draw what came in while nobody looked."""
        super().showEvent(event)
        self.redraw()

    def focusInEvent(self, event: QFocusEvent) -> None:  # noqa: N802 (Qt's name)
        """Show the ring."""
        super().focusInEvent(event)
        self.viewport().update()

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802 (Qt's name)
        """Hide the ring."""
        super().focusOutEvent(event)
        self.viewport().update()

    def drawBackground(self, painter: QPainter, rect: QRectF) -> None:  # noqa: N802 (Qt's name)
        """Paint ground, grid, numbers and title; kept by Qt as a picture."""
        tokens = self._theme.tokens
        painter.fillRect(rect, QColor(tokens.panel))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, False)
        area = self.area()
        painter.setFont(self._theme.font("caption"))
        numbers, line = QPen(QColor(tokens.muted)), QPen(QColor(tokens.line), 1)
        height = painter.fontMetrics().height()
        for tick in self._y_ticks:
            y = math.floor(self.y_of(tick.at))
            painter.setPen(line)
            painter.drawLine(QPointF(area.left(), y), QPointF(area.right(), y))
            painter.setPen(numbers)
            room = QRectF(0, y - height / 2, area.left() - GAP, height)
            painter.drawText(room, Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter, tick.words)
        for tick in self._x_ticks:
            x = math.floor(self.x_of(tick.at))
            painter.setPen(line)
            painter.drawLine(QPointF(x, area.top()), QPointF(x, area.bottom()))
            painter.setPen(numbers)
            wide = painter.fontMetrics().horizontalAdvance(tick.words)
            left = min(max(x - wide / 2, 0.0), self.width() - wide - 1.0)
            room = QRectF(left, area.bottom() + MARKS, wide + 1, height)
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter, tick.words)
        painter.setPen(numbers)
        words = painter.fontMetrics().elidedText(self._title, Qt.TextElideMode.ElideRight, self.width() - 2 * GAP)
        painter.drawText(QRectF(GAP, GRID, self.width() - GAP, height), Qt.AlignmentFlag.AlignVCenter, words)

    def drawForeground(self, painter: QPainter, rect: QRectF) -> None:  # noqa: N802 (Qt's name)
        """Paint marks, labels and the focus ring."""
        painter.setFont(self._theme.font("caption"))
        self.draw_marks(painter)
        self._draw_labels(painter)
        if not self._labels and self._nothing:
            painter.setPen(QColor(self._theme.tokens.muted))
            flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
            painter.drawText(self.area(), flags, self._nothing)
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.tokens.accent), FOCUS))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(0, 0, self.width(), self.height()).adjusted(1, 1, -1, -1))

    def draw_marks(self, painter: QPainter) -> None:
        """Paint what a subclass marks on the lines."""

    def _draw_labels(self, painter: QPainter) -> None:
        height = painter.fontMetrics().height()
        area = self.area()
        placed = spread([self.y_of(label.at) for label in self._labels], height * 0.85, area.top(), area.bottom())
        for label, y in zip(self._labels, placed, strict=True):
            painter.setPen(QColor(label.colour))
            room = QRectF(area.right() + GRID, y - height / 2, self.width() - area.right() - GRID, height)
            painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, label.words)

    def _lay_out(self) -> None:
        """Leave room for numbers, title and labels around the lines."""
        metrics = QFontMetricsF(self._theme.font("caption"))
        numbers = max((metrics.horizontalAdvance(tick.words) for tick in self._y_ticks), default=0.0)
        left = max(numbers, metrics.horizontalAdvance("-2000")) + 2 * GAP
        right = metrics.horizontalAdvance(self._widest_label) + GAP + GRID
        top = metrics.height() * (1.6 if self._title else 0.6) + GRID
        bottom = metrics.height() + MARKS + GRID
        size = self.viewport().size()
        width, height = max(size.width() - left - right, 8.0), max(size.height() - top - bottom, 8.0)
        self._area = QRectF(math.floor(left), math.floor(top), math.floor(width), math.floor(height))
        self.view.setGeometry(self._area)
        self.resetCachedContent()
        self.viewport().update()


def spread(wanted: Sequence[float], apart: float, low: float, high: float) -> list[float]:
    """Return places near those wanted, in the same order, ``apart`` from each other and within low…high."""
    order = sorted(range(len(wanted)), key=wanted.__getitem__)
    placed = [min(max(value, low), high) for value in wanted]
    for before, after in pairwise(order):
        placed[after] = max(placed[after], placed[before] + apart)
    limit = high
    for row in reversed(order):
        placed[row] = min(placed[row], limit)
        limit = placed[row] - apart
    return placed
