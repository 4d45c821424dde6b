"""Joint angles over time: the last seconds while capturing, a whole take in review."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QRectF, Qt, Signal
from PySide6.QtGui import QBrush, QColor, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QWidget

from studio.ui.style_sheet import mixed
from studio.ui.theme import Theme
from studio.ui.views.plots.canvas import Curve, EndLabel, PlotCanvas, Tick
from studio.ui.views.plots.polyline import COLUMN, Samples, polyline, thinned

SECONDS = 10.0  # s shown while capturing
AIR = 0.06  # of the range above and below the lines
LEAST_SPAN = 20.0  # degrees; noise shall not fill the plot
STEPS = (1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0, 360.0)  # degrees between the lines of the grid
TIME_STEPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600)  # s
LINE_EVERY = 36  # px between horizontal lines, at least
NUMBER_EVERY = 72  # px between times, at least, at 100 % text
HATCH = 10  # px between the strokes over a gap
GAP_OF_NOTE = 3.0  # px; a shorter gap is seen as a break of the line
LONG = 20_000  # samples; a longer curve is thinned once
THINNED = 32  # samples in one column of a thinned curve
DASHES = [6.0, 4.0]  # px; right

Side = Literal["left", "right", ""]


class AngleCurve(NamedTuple):
    """One angle over time."""

    name: str
    """For people."""
    side: Side
    time: NDArray[np.float64]
    """(n,), s."""
    degrees: NDArray[np.float64]
    """(n,), NaN where it was not measured."""


@dataclass(frozen=True, slots=True)
class _Gap:
    from_s: float
    to_s: float
    side: Side


class _Line(NamedTuple):
    """A curve made ready to be drawn again and again."""

    whole: Samples
    thin: Samples
    column_s: float
    """s, of a column of ``thin``; infinite when thinning does not pay."""


class AnglePlot(PlotCanvas):
    """Named curves, left solid and right dashed, gaps hatched, a cursor that can be dragged."""

    time_picked = Signal(float)
    """s; the plot was clicked or dragged there."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self._curves: Sequence[AngleCurve] = ()
        self._lines: list[_Line] = []
        self._items: list[Curve] = []
        self._gaps: list[_Gap] = []
        self._range = (0.0, SECONDS)
        self._origin = 0.0
        self._is_live = False
        self._heights = (0.0, 0.0)
        self._cursor = math.nan
        self._dragging = False
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.set_title(self.tr("Joint angles, °"))
        self.setAccessibleName(self.tr("Joint angles over time"))
        self.restyle()

    def show_live(self, curves: Sequence[AngleCurve], now: float) -> None:
        """Show the last ten seconds; ``now`` is the right end, on the clock of the curves."""
        self._is_live, self._origin, self._range = True, now, (now - SECONDS, now)
        self._take(curves)

    def show_curves(self, curves: Sequence[AngleCurve]) -> None:
        """Show a whole take, or what ``set_range`` chose of it; times are take times."""
        self._is_live, self._origin = False, 0.0
        self._heights = (0.0, 0.0)
        ends = [curve.time[[0, -1]] for curve in curves if len(curve.time)]
        if ends:
            self._range = (float(np.min(ends)), max(float(np.max(ends)), float(np.min(ends)) + 0.01))
        self._take(curves)

    def set_range(self, from_s: float, to_s: float) -> None:
        """Show this part of the take, s."""
        if to_s <= from_s:
            raise ValueError(f"{from_s} to {to_s} s is not a range")
        self._range = (from_s, to_s)
        self.redraw()

    @property
    def shown_range(self) -> tuple[float, float]:
        """The part of the take that is shown, s."""
        return self._range

    def set_cursor(self, time: float | None) -> None:
        """Stand a line at a time, s; None for none."""
        self._cursor = math.nan if time is None else time
        self.setAccessibleDescription(self.text())
        self.viewport().update()

    def text(self) -> str:
        """Return the values at the cursor, or the newest, as words."""
        said = []
        for curve in self._curves:
            value = _value_at(curve, self._cursor)
            words = self.tr("not measured") if math.isnan(value) else self.tr("{n:.0f} degrees").format(n=value)
            said.append(f"{curve.name}: {words}")
        return ", ".join(said) or self.tr("no angle chosen")

    def redraw(self) -> None:
        """Draw what was shown last."""
        if not self.is_seen():
            return
        parts = [self._visible(line) for line in self._lines]
        self._fit(parts)
        last: list[EndLabel] = []
        for curve, item, part in zip(self._curves, self._items, parts, strict=True):
            line = polyline(part.time, part.values[:, None], part.breaks, self._column_s())
            item.draw(line.time - self._origin, line.values[:, 0], line.joined)
            if len(line.time):
                mark = {"left": "● ", "right": "■ ", "": ""}[curve.side]
                last.append(EndLabel(mark + curve.name, float(line.values[-1, 0]), self._colour(curve)))
        self.set_labels(last, self.tr("No angle was measured here") if self._curves else self.tr("No angle chosen"))
        self.viewport().update()

    def restyle(self) -> None:
        """Take over colours and text size."""
        for row, (curve, item) in enumerate(zip(self._curves, self._items, strict=True)):
            item.setPen(self._pen(curve, row))
        super().restyle()

    def draw_marks(self, painter: QPainter) -> None:
        """Paint the gaps and the cursor."""
        area = self.area()
        patterns = {"left": Qt.BrushStyle.FDiagPattern, "right": Qt.BrushStyle.BDiagPattern}
        painter.setPen(Qt.PenStyle.NoPen)
        low, high = self._range
        for gap in self._gaps:
            left = self.x_of(max(gap.from_s, low) - self._origin)
            right = self.x_of(min(gap.to_s, high) - self._origin)
            if right - left < GAP_OF_NOTE:
                continue
            colour = QColor(self._side_colour(gap.side))
            colour.setAlphaF(0.35)
            painter.setBrush(QBrush(colour, patterns.get(gap.side, Qt.BrushStyle.DiagCrossPattern)))
            painter.drawRect(QRectF(left, area.top(), right - left, area.height()))
        if low <= self._cursor <= high:
            x = self.x_of(self._cursor - self._origin)
            painter.setPen(QPen(QColor(self._theme.tokens.accent), 2))
            painter.drawLine(QLineF(x, area.top(), x, area.bottom()))

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Pick the time under the pointer."""
        self._dragging = event.button() == Qt.MouseButton.LeftButton
        if self._dragging:
            self._pick(event)
        event.accept()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Pick on while dragging."""
        if self._dragging:
            self._pick(event)
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Let go."""
        self._dragging = False
        event.accept()

    def _take(self, curves: Sequence[AngleCurve]) -> None:
        known = [(curve.name, curve.side) for curve in self._curves]
        self._curves = tuple(curves)
        self._lines = [_line(curve) for curve in curves]
        self._gaps = [gap for curve in curves for gap in _gaps(curve)]
        if known != [(curve.name, curve.side) for curve in curves]:
            for item in self._items:
                self.view.removeItem(item)
            self._items = [Curve() for _ in curves]
            for row, (curve, item) in enumerate(zip(self._curves, self._items, strict=True)):
                item.setPen(self._pen(curve, row))
                self.view.addItem(item, ignoreBounds=True)
        if not self._is_live:
            self.setAccessibleDescription(self.text())
        self.redraw()

    def _column_s(self) -> float:
        """Return what a column of the chosen range spans; the axis follows later."""
        low, high = self._range
        return (high - low) * COLUMN / max(self.area().width(), 1.0)

    def _visible(self, line: _Line) -> Samples:
        """Return what lies in the range, thinned where that still gives more than the screen has."""
        low, high = self._range
        enough = self._column_s() >= 2 * line.column_s
        return (line.thin if enough else line.whole).between(low, high)

    def _fit(self, parts: Sequence[Samples]) -> None:
        """Set the axes: times as chosen, angles so that all of them fit."""
        known = [part.values[np.isfinite(part.values)] for part in parts]
        known = [part for part in known if len(part)]
        low = min((float(part.min()) for part in known), default=0.0)
        high = max((float(part.max()) for part in known), default=0.0)
        air = max(AIR * (high - low), (LEAST_SPAN - (high - low)) / 2)
        step = _step(STEPS, (high - low + 2 * air) * LINE_EVERY / max(self.area().height(), 1.0))
        # Whole steps: the axis stays while the lines move, and is seldom painted anew.
        heights = (math.floor((low - air) / step) * step, math.ceil((high + air) / step) * step)
        low, high = self._heights
        fits = low <= heights[0] and heights[1] <= high and high - low <= heights[1] - heights[0] + 2 * step
        if self._is_live and fits:
            heights = self._heights
        self._heights = heights
        ticks = [Tick(at, f"{at:.0f}") for at in np.arange(heights[0], heights[1] + step / 2, step).tolist()]
        low_s, high_s = (end - self._origin for end in self._range)
        self.set_axes((low_s, high_s), self._time_ticks(low_s, high_s), heights, ticks)

    def _time_ticks(self, low: float, high: float) -> list[Tick]:
        if self._is_live:
            ago = self.tr("{n:.0f} s ago")
            times = (SECONDS, SECONDS / 2)
            return [*(Tick(-time, ago.format(n=time)) for time in times), Tick(0.0, self.tr("now"))]
        room = NUMBER_EVERY * max(self._theme.text_scale, 1.0)
        step = _step(TIME_STEPS, (high - low) * room / max(self.area().width(), 1.0))
        first = math.ceil(low / step)
        return [Tick(row * step, clock(row * step, step)) for row in range(first, math.floor(high / step) + 1)]

    def _pen(self, curve: AngleCurve, row: int) -> QPen:
        pen = QPen(QColor(self._colour(curve)), 0)
        if curve.side == "right":
            pen.setDashPattern(DASHES)
        return pen

    def _colour(self, curve: AngleCurve) -> str:
        """Return the colour of the side; a second angle of one side is a shade nearer to text."""
        before = [other.name for other in self._curves if other.side == curve.side]
        shade = 0.35 * min(before.index(curve.name), 2) if curve.name in before else 0.0
        colour = self._side_colour(curve.side)
        return mixed(colour, self._theme.tokens.text if curve.side else self._theme.tokens.muted, shade)

    def _side_colour(self, side: Side) -> str:
        tokens = self._theme.tokens
        return {"left": tokens.left, "right": tokens.right, "": tokens.text}[side]

    def _pick(self, event: QMouseEvent) -> None:
        area, (low, high) = self.area(), self._range
        share = (event.position().x() - area.left()) / max(area.width(), 1.0)
        self.time_picked.emit(low + min(max(share, 0.0), 1.0) * (high - low))


def clock(seconds: float, step: float) -> str:
    """Return a time of the axis as minutes and seconds, as exact as the step between two."""
    decimals = 0 if step >= 1 else 1 if step >= 0.1 else 2
    units = round(abs(seconds) * 10**decimals)
    minutes, rest = divmod(units, 60 * 10**decimals)
    sign = "-" if seconds < 0 and units else ""
    width = 2 if decimals == 0 else 3 + decimals
    return f"{sign}{minutes}:{rest / 10**decimals:0{width}.{decimals}f}"


def _line(curve: AngleCurve) -> _Line:
    whole = Samples(curve.time, curve.degrees, np.zeros(len(curve.time), np.bool_))
    if len(curve.time) < LONG:
        return _Line(whole, whole, math.inf)
    column_s = THINNED * float(curve.time[-1] - curve.time[0]) / len(curve.time)
    return _Line(whole, thinned(whole, column_s), column_s)


def _gaps(curve: AngleCurve) -> list[_Gap]:
    missing = np.concatenate([[False], np.isnan(curve.degrees), [False]]).astype(np.int8)
    edges = np.flatnonzero(np.diff(missing))
    before = np.maximum(edges[::2] - 1, 0)
    after = np.minimum(edges[1::2], len(curve.time) - 1)
    return [
        _Gap(float(curve.time[first]), float(curve.time[last]), curve.side)
        for first, last in zip(before, after, strict=True)
    ]


def _step(steps: Sequence[float], least: float) -> float:
    return next((step for step in steps if step >= least), steps[-1])


def _value_at(curve: AngleCurve, time: float) -> float:
    if len(curve.time) == 0:
        return math.nan
    if math.isnan(time):
        return float(curve.degrees[-1])
    return float(curve.degrees[int(np.clip(np.searchsorted(curve.time, time), 0, len(curve.time) - 1))])
