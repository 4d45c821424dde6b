"""The last seconds of one sensor: gyroscope, accelerometer or orientation, with what was lost and clipped."""

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QLineF, QPointF, Qt
from PySide6.QtGui import QColor, QGuiApplication, QKeyEvent, QKeySequence, QPainter, QPen, QPolygonF
from PySide6.QtWidgets import QWidget

from studio.capture.live_buffer import Window
from studio.ui.models.signal_values import Signal, SignalValues, values_of
from studio.ui.theme import GRID, Theme
from studio.ui.views.plots.canvas import MARKS, Curve, EndLabel, PlotCanvas, Tick
from studio.ui.views.plots.colours import axis_colours
from studio.ui.views.plots.polyline import COLUMN, polyline

SECONDS = 10.0  # s
SAID_EVERY = 1.0  # s between two descriptions for a screen reader
SPANS = {
    Signal.TURNING: (10.0, 25.0, 50.0, 100.0, 250.0, 500.0, 1000.0, 2000.0),
    Signal.FORCE: (15.0, 30.0, 60.0, 160.0),
    Signal.FORCE_G: (1.5, 3.0, 6.0, 16.0),
    Signal.ORIENTATION: (180.0,),
}
"""Ranges of the vertical axis, each the same up and down; the last is what the chips can tell."""
ROOM = 0.8  # of a smaller range that must suffice before the axis goes back to it


class SignalPlot(PlotCanvas):
    """Ten seconds that slide."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self.values = SignalValues(self)
        """The same as a table; follows the plot while the plot is seen or ``keep_values`` is set."""
        self._signal = Signal.TURNING
        self._name = ""
        self._window: Window | None = None
        self._now = 0.0
        self._said = -np.inf
        self._span = 0.0
        self._lost: NDArray[np.float64] = np.empty(0)
        self._clipped: NDArray[np.float64] = np.empty(0)
        self._curves = [Curve() for _ in range(3)]
        for curve in reversed(self._curves):
            self.view.addItem(curve, ignoreBounds=True)
        self.set_signal(Signal.TURNING)
        self.restyle()

    @property
    def signal(self) -> Signal:
        """What is plotted."""
        return self._signal

    def set_signal(self, signal: Signal) -> None:
        """Plot something else of the sensor."""
        self._signal, self._span = signal, 0.0
        titles = {
            Signal.TURNING: self.tr("Gyroscope, °/s"),
            Signal.FORCE: self.tr("Accelerometer, m/s²"),
            Signal.FORCE_G: self.tr("Accelerometer, g"),
            Signal.ORIENTATION: self.tr("Orientation, °"),
        }
        self.set_title(titles[signal])
        self._fit(0.0)
        self._say_name()
        self.redraw()

    def set_sensor(self, name: str) -> None:
        """Say whose signal it is."""
        self._name = name
        self._window = None
        self._said = -np.inf
        self._say_name()
        self.redraw()

    def show_window(self, window: Window, now: float) -> None:
        """Show the newest samples; ``now`` (s, clock of ``Sample.time``) is the right end.

        Nothing is drawn while the plot is not seen.
        """
        newest = float(window.time[-1]) if len(window.time) else now
        self._window, self._now = window, max(now, newest)
        if self.is_seen():
            self._draw(window)

    def copy_values(self) -> None:
        """Put the table of values on the clipboard."""
        if self._window is not None:
            self.values.show_window(self._signal, self._window)
        QGuiApplication.clipboard().setText(self.values.text())

    def redraw(self) -> None:
        """Draw what was shown last."""
        if self._window is not None and self.is_seen():
            self._draw(self._window)
            return
        if self._window is None:
            self._clear()
        self.viewport().update()

    def restyle(self) -> None:
        """Take over colours and text size."""
        for curve, colour in zip(self._curves, axis_colours(self._theme), strict=True):
            curve.setPen(QPen(QColor(colour), 0))
        super().restyle()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Copy the values with the system's key for copying."""
        if event.matches(QKeySequence.StandardKey.Copy):
            self.copy_values()
            event.accept()
            return
        QWidget.keyPressEvent(self, event)

    def draw_marks(self, painter: QPainter) -> None:
        """Paint a tick below each gap and a wedge above each clipped reading."""
        area, tokens = self.area(), self._theme.tokens
        painter.setPen(QPen(QColor(tokens.bad), 2))
        bottom = area.bottom() + 2
        painter.drawLines([QLineF(x, bottom, x, bottom + MARKS - 2) for x in self._pixels(self._lost)])
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.warn))
        top = area.top()
        for x in self._pixels(self._clipped):
            painter.drawPolygon(
                QPolygonF([QPointF(x - GRID, top), QPointF(x + GRID, top), QPointF(x, top + 1.5 * GRID)])
            )

    def _draw(self, window: Window) -> None:
        window = _from(window, int(np.searchsorted(window.time, self._now - SECONDS)))
        values = values_of(self._signal, window)
        time, breaks = window.time - self._now, window.lost_before > 0
        self._lost = time[breaks]
        self._clipped = time[window.clipped]
        known = values[np.isfinite(values).all(axis=1)]
        if len(known) == 0:
            self._clear()
            return
        self._fit(float(np.abs(known).max()))
        for curve, (points, heights, joined) in zip(
            self._curves, self._lines(window.time, values, breaks), strict=True
        ):
            curve.draw(points - self._now, heights, joined)
        self._label(known[-1])
        self._say(window)
        self.viewport().update()

    def _lines(
        self, time: NDArray[np.float64], values: NDArray[np.float64], breaks: NDArray[np.bool_]
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]]:
        column_s = self.column_s(COLUMN)
        if self._signal is not Signal.ORIENTATION:
            line = polyline(time, values, breaks, column_s)
            return [(line.time, line.values[:, row], line.joined) for row in range(3)]
        # An angle that passes 180° leaps, each axis at another time.
        leaps = np.abs(np.diff(values, axis=0, prepend=values[:1])) > SPANS[Signal.ORIENTATION][0]
        lines = [polyline(time, values[:, [row]], breaks | leaps[:, row], column_s) for row in range(3)]
        return [(line.time, line.values[:, 0], line.joined) for line in lines]

    def _label(self, newest: NDArray[np.float64]) -> None:
        turned = self._signal is Signal.ORIENTATION
        names = (self.tr("roll"), self.tr("pitch"), self.tr("yaw")) if turned else ("x", "y", "z")
        parts = zip(names, newest.tolist(), axis_colours(self._theme), strict=True)
        self.set_labels([EndLabel(*part) for part in parts], "")

    def _clear(self) -> None:
        self._lost = self._clipped = np.empty(0)
        for curve in self._curves:
            curve.clear()
        self.set_labels((), self.tr("Nothing in the last {n:.0f} s").format(n=SECONDS))
        self.viewport().update()

    def _fit(self, largest: float) -> None:
        spans = SPANS[self._signal]
        span = next((span for span in spans if largest <= span), spans[-1])
        if span < self._span and largest > ROOM * span:
            span = self._span
        if span == self._span:
            return
        self._span = span
        words = [f"{value:g}" for value in (-span, 0.0, span)]
        half = span / 2
        y = [Tick(-span, words[0]), Tick(-half, ""), Tick(0.0, words[1]), Tick(half, ""), Tick(span, words[2])]
        x = [
            Tick(-SECONDS, self.tr("{n:.0f} s ago").format(n=SECONDS)),
            Tick(-SECONDS / 2, self.tr("{n:.0f} s ago").format(n=SECONDS / 2)),
            Tick(0.0, self.tr("now")),
        ]
        self.set_axes((-SECONDS, 0.0), x, (-1.04 * span, 1.04 * span), y)

    def _pixels(self, times: NDArray[np.float64]) -> list[float]:
        """Return the pixels of moments, one for each column."""
        if len(times) == 0:
            return []
        area = self.area()
        pixels = np.unique(np.round(area.right() + times * area.width() / SECONDS))
        return [float(x) for x in pixels]

    def _say_name(self) -> None:
        words = self._title if not self._name else self.tr("{signal} of {sensor}")
        self.setAccessibleName(words.format(signal=self._title, sensor=self._name))

    def _say(self, window: Window) -> None:
        if self._now - self._said < SAID_EVERY:
            return
        self._said = self._now
        self.values.show_window(self._signal, window)
        lost = int(window.lost_before.sum())
        said = self.tr("{values}. {lost} samples lost and {clipped} clipped in the last {n:.0f} s.")
        said = said.format(values=self.values.sentence(), lost=lost, clipped=int(window.clipped.sum()), n=SECONDS)
        self.setAccessibleDescription(said)
        self.setToolTip(said)


def _from(window: Window, first: int) -> Window:
    return Window(
        window.time[first:],
        window.orientation[first:],
        window.rate[first:],
        window.acceleration[first:],
        window.lost_before[first:],
        window.clipped[first:],
        window.flags[first:],
    )
