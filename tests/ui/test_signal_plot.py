"""The plot of one sensor: what it draws, what it marks, what it costs when nobody looks, and what it says in words."""

import math

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication

from studio.core import rotation
from studio.ui.models.signal_values import Signal, SignalValues, levelled, values_of
from studio.ui.theme import DARK, LIGHT, Theme, contrast
from studio.ui.views.plots.canvas import Curve
from studio.ui.views.plots.colours import ON_DARK, ON_LIGHT
from studio.ui.views.plots.signal_plot import SECONDS, SPANS, SignalPlot
from tests.ui.sensor_windows import window


@pytest.fixture
def plot(qtbot):
    plot = SignalPlot(Theme())
    qtbot.addWidget(plot)
    plot.resize(640, 240)
    plot.show()
    qtbot.waitExposed(plot)
    return plot


def items(plot):
    return [item for item in plot.scene().items() if isinstance(item, Curve)]


def curves(plot):
    return [curve.drawn[:2] for curve in items(plot)]


def drawn(plot):
    return sum(len(x) for x, _ in curves(plot) if x is not None)


def test_ten_seconds_up_to_now_are_drawn_in_degrees_per_second(plot):
    plot.show_window(window(100.0, seconds=20.0, rate=40.0), 100.0)

    x, y = max(curves(plot), key=lambda curve: np.ptp(curve[1]))
    assert -SECONDS <= x.min() < -SECONDS + 0.1
    assert x.max() == pytest.approx(0.0, abs=1e-6)
    assert np.abs(y).max() == pytest.approx(40.0, rel=0.01)


def test_what_a_silent_sensor_said_moves_out_to_the_left(plot):
    shown = window(100.0, rate=40.0)

    plot.show_window(shown, 104.0)
    assert max(x.max() for x, _ in curves(plot)) == pytest.approx(-4.0)

    plot.show_window(shown, 120.0)
    assert drawn(plot) == 0


def test_no_more_points_are_drawn_than_the_screen_has(plot):
    slow, fast = window(100.0, rate=40.0), window(100.0, seconds=11.0, rate=40.0)
    many = fast._replace(
        time=np.linspace(89, 100, 20000),
        orientation=np.tile(fast.orientation[:1], (20000, 1)),
        rate=np.random.default_rng(1).normal(size=(20000, 3)),
        acceleration=np.tile(fast.acceleration[:1], (20000, 1)),
        lost_before=np.zeros(20000, np.int64),
        clipped=np.zeros(20000, np.bool_),
    )

    plot.show_window(slow, 100.0)
    assert 3 * 500 <= drawn(plot) <= 3 * 501
    plot.show_window(many, 100.0)
    assert drawn(plot) <= 3 * (plot.area().width() + 4)


def test_lost_samples_break_the_line_and_are_ticked_below(plot):
    plot.show_window(window(100.0, rate=40.0), 100.0)
    whole = plot.grab().toImage()
    plot.show_window(window(100.0, rate=40.0, missing=range(250, 300)), 100.0)
    broken = plot.grab().toImage()

    below = round(plot.area().bottom()) + 5
    x = round(plot.x_of(-5.0 + 0.02))
    ticks = [at for at in range(x - 20, x + 21) if broken.pixelColor(at, below) != whole.pixelColor(at, below)]
    assert ticks
    assert ticks == [at for at in ticks if abs(at - x) <= 2]


def test_clipped_readings_are_marked_above(plot):
    plot.show_window(window(100.0, rate=40.0), 100.0)
    plain = plot.grab().toImage()
    plot.show_window(window(100.0, rate=40.0, clipped=[300]), 100.0)
    marked = plot.grab().toImage()

    x, top = round(plot.x_of(-5.0 + 0.02)), round(plot.area().top()) + 2
    assert marked.pixelColor(x, top) != plain.pixelColor(x, top)


def test_the_axis_grows_at_once_and_goes_back_when_there_is_room(plot):
    reached = []
    for rate in (5.0, 40.0, 24.0, 15.0):
        plot.show_window(window(100.0, rate=rate), 100.0)
        reached.append(plot.view.viewRange()[1][1] / 1.04)

    assert reached == pytest.approx([10.0, 50.0, 50.0, 25.0])


@pytest.mark.parametrize(("signal", "up"), [(Signal.FORCE, 9.81), (Signal.FORCE_G, 9.81 / 9.80665)])
def test_the_accelerometer_can_be_read_in_either_unit(plot, signal, up):
    plot.set_signal(signal)
    plot.show_window(window(100.0), 100.0)

    assert max(y.max() for _, y in curves(plot)) == pytest.approx(up)
    assert plot.view.viewRange()[1][1] == pytest.approx(1.04 * SPANS[signal][0])


def test_an_angle_that_passes_180_degrees_is_no_stroke_across_the_plot(plot):
    shown = window(100.0)
    yaw = np.degrees(np.arange(len(shown.time)) * 0.05)
    turned = shown._replace(orientation=rotation.about(2, np.radians(yaw)))
    plot.set_signal(Signal.ORIENTATION)

    plot.show_window(turned, 100.0)

    for curve in items(plot):
        y = curve.drawn.y
        joined = curve.drawn.joined
        steps = np.abs(np.diff(y))
        assert steps.max() < 10 or not joined[:-1][steps > 180].any()


def test_nothing_is_drawn_while_the_plot_is_hidden(plot):
    plot.show_window(window(100.0, rate=40.0), 100.0)
    plot.hide()
    before = curves(plot)[0][0]

    plot.show_window(window(105.0, rate=40.0), 105.0)
    assert curves(plot)[0][0] is before

    plot.show()
    assert curves(plot)[0][0] is not before


def test_another_sensor_begins_empty(plot):
    plot.show_window(window(100.0, rate=40.0), 100.0)

    plot.set_sensor("4  tag 04")

    assert drawn(plot) == 0
    assert plot.accessibleName() == "Gyroscope, °/s of 4  tag 04"


def test_a_screen_reader_hears_values_and_losses_once_a_second(plot):
    plot.show_window(window(100.0, missing=[300, 301], clipped=[400]), 100.0)
    said = plot.accessibleDescription()
    plot.show_window(window(100.2, missing=[300], clipped=[]), 100.2)

    assert said == "x 0.00 °/s, y 0.00 °/s, z 0.00 °/s. 2 samples lost and 1 clipped in the last 10 s."
    assert plot.accessibleDescription() == said


def test_values_are_copied_as_a_table_with_dots(plot, qtbot):
    plot.show_window(window(100.0, rate=40.0), 100.0)
    plot.setFocus()

    qtbot.keyClick(plot, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)

    lines = [line.split("\t") for line in QGuiApplication.clipboard().text().split("\n")]
    assert lines[0] == ["axis", "newest °/s", "mean °/s", "deviation °/s", "least °/s", "most °/s"]
    assert [line[0] for line in lines[1:]] == ["x", "y", "z"]
    # A sine's deviation is its height by the root of two.
    assert float(lines[1][3]) == pytest.approx(40 / math.sqrt(2), rel=0.02)
    assert float(lines[1][5]) == pytest.approx(40, abs=0.1)


def test_a_sensor_without_gyroscope_has_dashes(qtbot):
    values = SignalValues()
    shown = window(10.0)

    values.show_window(Signal.TURNING, shown._replace(rate=np.full_like(shown.rate, np.nan)))

    assert values.index(0, 1).data() == "–"


def test_the_mean_of_angles_around_180_degrees_is_not_zero():
    shown = window(10.0)
    yaw = 180.0 + np.where(np.arange(len(shown.time)) % 2, 1.0, -1.0)
    values = SignalValues()

    values.show_window(Signal.ORIENTATION, shown._replace(orientation=rotation.about(2, np.radians(yaw))))

    assert abs(abs(float(values.index(2, 2).data())) - 180.0) < 0.1
    assert float(values.index(2, 3).data()) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("tilt", [(0, 0, 0), (30, 0, 0), (0, -50, 0), (180, 0, 0), (100, 20, 0)])
def test_roll_and_pitch_are_those_of_the_tag_whatever_attitude_it_was_switched_on_in(tilt):
    """A tag counts from its own start; gravity tells how that start stood."""
    lying = window(10.0, turned=tilt)
    start = rotation.from_rotation_vector(np.radians([25.0, -70.0, 10.0]))
    counted = lying._replace(orientation=rotation.multiply(rotation.inverse(start), lying.orientation))

    seen = rotation.rotate(rotation.inverse(levelled(counted)), np.array([0.0, 0.0, 1.0]))

    truth = rotation.rotate(rotation.inverse(lying.orientation), np.array([0.0, 0.0, 1.0]))
    np.testing.assert_allclose(seen, truth, atol=1e-9)


def test_a_level_device_keeps_its_orientation():
    lying = window(10.0, turned=(20.0, 10.0, 70.0))

    np.testing.assert_allclose(np.abs((levelled(lying) * lying.orientation).sum(axis=1)), 1.0, atol=1e-12)
    assert values_of(Signal.ORIENTATION, lying).shape == (len(lying.time), 3)


@pytest.mark.parametrize(("colours", "tokens"), [(ON_DARK, DARK), (ON_LIGHT, LIGHT)])
def test_axes_are_seen_on_every_ground_and_are_not_the_colours_of_sides(colours, tokens):
    for colour in colours:
        assert min(contrast(colour, ground) for ground in (tokens.window, tokens.panel, tokens.raised)) >= 3.0
        assert colour not in (tokens.left, tokens.right)


def test_other_colours_and_larger_text_are_taken_over(qtbot):
    theme = Theme()
    theme.scheme = "dark"
    plot = SignalPlot(theme)
    qtbot.addWidget(plot)
    plot.resize(600, 300)
    plot.show()
    small = plot.area()

    theme.scheme, theme.text_scale = "light", 2.0
    plot.restyle()

    assert plot.area().left() > small.left()
    assert plot.grab().toImage().pixelColor(round(plot.area().right()) - 3, 1).name().upper() == LIGHT.panel
