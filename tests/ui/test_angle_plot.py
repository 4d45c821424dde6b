"""Joint angles over time: sides, gaps, ranges, and the cursor that is picked by hand."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt

from studio.ui.theme import Theme
from studio.ui.views.plots.angle_plot import AngleCurve, AnglePlot, clock
from studio.ui.views.plots.canvas import Curve

TIME = np.arange(0, 60, 0.02)


def knees():
    return [
        AngleCurve("left knee flexion", "left", TIME, 30 + 30 * np.sin(TIME)),
        AngleCurve("right knee flexion", "right", TIME, 30 - 30 * np.sin(TIME)),
    ]


@pytest.fixture
def plot(qtbot):
    plot = AnglePlot(Theme())
    qtbot.addWidget(plot)
    plot.resize(800, 240)
    plot.show()
    qtbot.waitExposed(plot)
    return plot


def items(plot):
    return [item for item in reversed(plot.scene().items()) if isinstance(item, Curve)]


def test_left_is_solid_and_right_is_dashed(plot):
    plot.show_curves(knees())

    assert [item.pen.style() for item in items(plot)] == [Qt.PenStyle.SolidLine, Qt.PenStyle.CustomDashLine]


def test_a_whole_take_is_shown_and_no_peak_is_lost(plot):
    peaked = knees()[0].degrees.copy()
    peaked[1234] = 111.0

    plot.show_curves([AngleCurve("left knee flexion", "left", TIME, peaked)])

    _, y = items(plot)[0].drawn[:2]
    assert plot.shown_range == pytest.approx((0.0, 59.98))
    assert y.max() == 111.0
    assert plot.view.viewRange()[1][1] >= 111.0


def test_no_peak_and_no_gap_of_an_hour_is_lost(plot):
    time = np.arange(0, 3600, 0.01)
    peaked = 30 + 30 * np.sin(time)
    peaked[123456], peaked[200000:210000] = 111.0, np.nan

    plot.show_curves([AngleCurve("left knee flexion", "left", time, peaked)])
    x, y = items(plot)[0].drawn[:2]
    assert len(x) <= plot.width()
    assert y.max() == 111.0
    assert not ((x > 2000.5) & (x < 2099.5)).any()

    plot.set_range(1234.0, 1235.0)
    x, y = items(plot)[0].drawn[:2]
    assert len(x) > 99
    assert x[y.argmax()] == pytest.approx(1234.56)


def test_a_part_can_be_shown(plot):
    plot.show_curves(knees())

    plot.set_range(10.0, 12.0)

    x, _ = items(plot)[0].drawn[:2]
    assert plot.view.viewRange()[0] == pytest.approx([10.0, 12.0])
    assert (x.min(), x.max()) == pytest.approx((10.0, 12.0), abs=0.021)


def test_a_range_must_have_a_length(plot):
    with pytest.raises(ValueError, match="is not a range"):
        plot.set_range(3.0, 3.0)


def test_the_last_ten_seconds_slide(plot):
    plot.show_live(knees(), 30.0)

    x, _ = items(plot)[0].drawn[:2]
    assert plot.shown_range == (20.0, 30.0)
    assert plot.view.viewRange()[0] == pytest.approx([-10.0, 0.0])
    assert (x.min(), x.max()) == pytest.approx((-10.0, 0.0), abs=0.021)


def test_what_was_not_measured_is_hatched(plot):
    plot.show_curves(knees())
    whole = plot.grab().toImage()
    holed = [knees()[0]._replace(degrees=np.where((TIME > 20) & (TIME < 30), np.nan, knees()[0].degrees)), knees()[1]]
    plot.show_curves(holed)
    hatched = plot.grab().toImage()

    def changed(since, until):
        y = round(plot.area().top()) + 2
        xs = range(round(plot.x_of(since)), round(plot.x_of(until)))
        return sum(hatched.pixelColor(x, y) != whole.pixelColor(x, y) for x in xs)

    assert changed(21.0, 29.0) > 5
    assert changed(40.0, 50.0) == 0


def test_the_axis_of_a_still_limb_is_not_filled_by_noise(plot):
    plot.show_curves([AngleCurve("pelvis tilt", "", TIME, 5 + 0.01 * np.sin(TIME))])

    low, high = plot.view.viewRange()[1]
    assert high - low >= 20.0


def test_a_click_and_a_drag_pick_times(plot, qtbot):
    plot.show_curves(knees())
    plot.set_range(0.0, 50.0)
    picked: list[float] = []
    plot.time_picked.connect(picked.append)
    y = round(plot.area().center().y())
    canvas = plot.viewport()

    qtbot.mousePress(canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(plot.x_of(10.0)), y))
    qtbot.mouseMove(canvas, QPoint(round(plot.x_of(25.0)), y))
    qtbot.mouseMove(canvas, QPoint(plot.width() + 50, y))
    qtbot.mouseRelease(canvas, Qt.MouseButton.LeftButton, pos=QPoint(round(plot.x_of(25.0)), y))
    qtbot.mouseMove(canvas, QPoint(round(plot.x_of(5.0)), y))

    assert picked == pytest.approx([10.0, 25.0, 50.0], abs=0.1)


def test_the_right_button_picks_nothing(plot, qtbot):
    plot.show_curves(knees())
    with qtbot.assertNotEmitted(plot.time_picked):
        qtbot.mouseClick(plot.viewport(), Qt.MouseButton.RightButton, pos=QPoint(300, 100))


def test_the_values_at_the_cursor_are_said_in_words(plot):
    left, right = knees()
    plot.show_curves([left, right._replace(degrees=np.full(len(TIME), np.nan))])

    plot.set_cursor(np.pi / 2)

    assert plot.text() == "left knee flexion: 60 degrees, right knee flexion: not measured"
    assert plot.accessibleDescription() == plot.text()
    assert plot.accessibleName() == "Joint angles over time"


def test_without_angles_it_says_so(plot):
    plot.show_curves([])

    assert plot.text() == "no angle chosen"
    assert items(plot) == []


@pytest.mark.parametrize(
    ("seconds", "step", "words"),
    [
        (0, 10, "0:00"),
        (75, 5, "1:15"),
        (3600, 600, "60:00"),
        (7.5, 0.5, "0:07.5"),
        (0.25, 0.05, "0:00.25"),
        (-2, 1, "-0:02"),
    ],
)
def test_times_are_minutes_and_seconds(seconds, step, words):
    assert clock(seconds, step) == words
