"""What is drawn of many samples: nothing that stands out is lost, and gaps stay gaps."""

import numpy as np
import pytest

from studio.ui.views.plots.canvas import spread
from studio.ui.views.plots.polyline import polyline


def no_breaks(time):
    return np.zeros(len(time), np.bool_)


def test_few_samples_are_drawn_as_they_are():
    time = np.arange(0, 1, 0.02)
    values = np.stack([np.sin(time), np.cos(time)], axis=1)

    line = polyline(time, values, no_breaks(time), 0.01)

    assert line.time.tolist() == time.tolist()
    assert line.values.tolist() == values.tolist()
    assert line.joined[:-1].all()


def test_a_single_peak_among_many_samples_is_kept():
    time = np.arange(0, 100, 0.001)
    values = np.zeros((len(time), 1))
    values[54321], values[12345] = 7.0, -3.0

    line = polyline(time, values, no_breaks(time), 0.5)

    assert len(line.time) <= 2 * (100 / 0.5 + 1)
    assert line.values.max() == 7.0
    assert line.values.min() == -3.0
    assert abs(line.time[line.values[:, 0].argmax()] - 54.321) <= 0.5


def test_columns_do_not_move_with_the_window():
    time = np.arange(0, 100, 0.01)
    values = np.random.default_rng(1).normal(size=(len(time), 1))

    one = polyline(time[1000:3000], values[1000:3000], no_breaks(time[1000:3000]), 0.1)
    later = polyline(time[1007:3007], values[1007:3007], no_breaks(time[1007:3007]), 0.1)

    inside = (later.time > 11) & (later.time < 29)
    assert set(later.values[inside, 0]) <= set(one.values[:, 0])


@pytest.mark.parametrize("column_s", [0.001, 0.1])
def test_the_line_is_broken_where_samples_are_missing(column_s):
    time = np.concatenate([np.arange(0, 1, 0.01), np.arange(1.5, 2, 0.01)])
    breaks = no_breaks(time)
    breaks[100] = True

    line = polyline(time, np.ones((len(time), 1)), breaks, column_s)

    (last,) = np.flatnonzero(~line.joined[:-1])
    assert line.time[last] == pytest.approx(0.99)
    assert line.time[last + 1] == pytest.approx(1.5)


def test_values_that_were_not_measured_break_the_line():
    time = np.arange(10.0)
    values = np.ones((10, 1))
    values[[0, 4, 5, 9]] = np.nan

    line = polyline(time, values, no_breaks(time), 0.001)

    assert line.time.tolist() == [1, 2, 3, 6, 7, 8]
    assert line.joined.tolist() == [True, True, False, True, True, False]


def test_nothing_measured_is_no_line():
    time = np.arange(3.0)

    assert len(polyline(time, np.full((3, 2), np.nan), no_breaks(time), 0.1).time) == 0


def test_labels_of_lines_that_end_together_do_not_cover_each_other():
    placed = spread([50.0, 52.0, 48.0, 99.0], apart=10.0, low=0.0, high=100.0)

    assert np.diff(np.sort(placed)).min() >= 10.0
    assert np.argsort(placed).tolist() == [2, 0, 1, 3]
    assert max(placed) <= 100.0
