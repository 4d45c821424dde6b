"""What fifteen plots cost while they slide: share of one core, beside pyqtgraph's own plot items."""

import time

import numpy as np
import pyqtgraph as pg
import pytest
from PySide6.QtGui import QPixmap
from PySide6.QtWidgets import QGridLayout, QWidget

from studio.capture.live_buffer import Window
from studio.ui.theme import Theme
from studio.ui.views.plots.angle_plot import AngleCurve, AnglePlot
from studio.ui.views.plots.signal_plot import SECONDS, SignalPlot

pytestmark = pytest.mark.benchmark

PLOTS = 15
COLUMNS = 3
SIZE = (1280, 900)  # px: fifteen plots have room for some 330 columns each
PICTURES = 25  # a second
MEASURED = 50  # pictures


def window(now, rate):
    times = np.arange(now - SECONDS, now, 1 / rate)
    turning = np.stack([3 * np.sin(6 * times), np.cos(5 * times), np.sin(7 * times)], axis=1)
    count = len(times)
    lost = np.zeros(count, np.int64)
    lost[::50] = 1
    level = np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    return Window(times, level, turning, 9.81 * turning, lost, np.zeros(count, np.bool_), np.zeros(count, np.int64))


def arranged(qtbot, plots):
    page = QWidget()
    qtbot.addWidget(page)
    grid = QGridLayout(page)
    for row, plot in enumerate(plots):
        grid.addWidget(plot, row // COLUMNS, row % COLUMNS)
    page.resize(*SIZE)
    page.show()
    qtbot.waitExposed(page)
    return page


def cost(page, show):
    """Return the processor time of one picture, s: handing over, and painting all into memory."""
    canvas = QPixmap(page.size())
    times = []
    for picture in range(MEASURED + 5):
        before = time.process_time()
        show(100.0 + picture / PICTURES)
        page.render(canvas)
        times.append(time.process_time() - before)
    return float(np.mean(times[5:]))


def plain(qtbot):
    """Return a page of pyqtgraph's PlotDataItems as its examples make them, and what shows a moment."""
    widgets = [pg.PlotWidget() for _ in range(PLOTS)]
    items = [[widget.plot(pen=colour) for colour in "rgb"] for widget in widgets]

    def show(now, rate):
        shown = window(now, rate)
        for row in items:
            for axis, item in enumerate(row):
                item.setData(shown.time - now, np.degrees(shown.rate[:, axis]))

    return arranged(qtbot, widgets), show


@pytest.mark.parametrize("rate", [25, 50, 100])
def test_fifteen_plots_stay_within_the_budget(qtbot, rate):
    """The budget is 40 % of a core with 250 samples in each curve."""
    plots = [SignalPlot(Theme()) for _ in range(PLOTS)]
    page = arranged(qtbot, plots)

    def show(now):
        shown = window(now, rate)
        for plot in plots:
            plot.show_window(shown, now)

    ours = cost(page, show)
    page.hide()
    theirs_page, show_plain = plain(qtbot)
    theirs = cost(theirs_page, lambda now: show_plain(now, rate))

    print(
        f"\n{PLOTS} plots x 3 curves x {int(SECONDS * rate)} samples: {ours * 1e3:.1f} ms a picture, "
        f"{ours * PICTURES:.0%} of a core at {PICTURES} Hz; PlotDataItem {theirs * 1e3:.1f} ms, "
        f"{theirs / ours:.1f} times as much"
    )
    assert ours < theirs


def test_a_whole_take_is_drawn_at_once(qtbot):
    times = np.arange(0, 1800, 0.01)
    curves = [
        AngleCurve("left knee flexion", "left", times, 30 + 30 * np.sin(6 * times)),
        AngleCurve("right knee flexion", "right", times, 30 - 30 * np.sin(6 * times)),
    ]
    plot = AnglePlot(Theme())
    page = arranged(qtbot, [plot])
    plot.show_curves(curves)

    drawn = cost(page, lambda now: plot.set_range(0.0, 1800.0 - now / 100))

    print(f"\n2 angles over 30 min at 100 Hz (360,000 values): {drawn * 1e3:.1f} ms for a new range")
    assert plot.shown_range[1] < 1800.0
