"""Time columns: put in order, damaged stamps left out, lost samples counted."""

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.importers.clock import count_frames, median_interval, put_in_order

REGULAR: NDArray[np.float64] = np.arange(100) * np.float64(0.01)


def test_a_regular_clock_is_left_alone():
    order = put_in_order(REGULAR)

    assert np.array_equal(order.keep, np.arange(100))
    assert (order.dropped, order.reordered) == (0, 0)


def test_rows_that_came_late_are_sorted_in():
    order = put_in_order(REGULAR[[0, 2, 1, 3, 4, 9, 5, 6, 7, 8]])

    assert np.array_equal(order.keep, [0, 2, 1, 3, 4, 6, 7, 8, 9, 5])
    assert (order.dropped, order.reordered) == (0, 5)


def test_the_same_time_twice_and_no_time_are_dropped():
    order = put_in_order(np.array([0, 0.01, 0.01, np.nan, 0.02]))

    assert np.array_equal(order.keep, [0, 1, 4])
    assert order.dropped == 2


@pytest.mark.parametrize(
    ("row", "wrong"),
    [(row, wrong) for row in (1, 50, 98) for wrong in (-1e9, -50.0, 50.0, 1e9)]
    # at the ends there is one neighbour: 50 s before all others, or after them, may be true
    + [(0, -1e9), (0, 50.0), (0, 1e9), (99, -1e9), (99, -50.0), (99, 1e9)],
)
def test_a_stamp_that_its_neighbours_contradict_costs_its_own_row(row, wrong):
    damaged = REGULAR.copy()
    damaged[row] += wrong
    order = put_in_order(damaged)

    assert np.array_equal(order.keep, np.delete(np.arange(100), row))
    assert order.dropped == 1


def test_a_long_gap_is_a_gap():
    order = put_in_order(np.concatenate([REGULAR, REGULAR + 60.0]))

    assert len(order.keep) == 200


def test_of_a_clock_that_started_anew_the_longer_stretch_is_kept():
    order = put_in_order(np.concatenate([REGULAR[:30] + 500, REGULAR, REGULAR[:20] + 9000]))

    assert np.array_equal(order.keep, np.arange(30, 130))
    assert order.dropped == 50


def test_nothing_is_left_of_no_time():
    assert len(put_in_order(np.array([])).keep) == 0
    assert len(put_in_order(np.array([np.nan, np.nan])).keep) == 0


def test_missing_samples_are_missing_numbers():
    kept = np.delete(np.arange(100), [3, 40, 41, 42])

    frames, frame_s = count_frames(REGULAR[kept], 0.01)

    assert np.array_equal(frames, kept)
    assert frame_s == pytest.approx(0.01)


def test_whole_milliseconds_of_60_hz_count_right_over_an_hour():
    """The median of such intervals is 17 ms, 2 % too long: counted with it, a 3 s gap would lose 4 frames."""
    true = np.delete(np.arange(216_000, dtype=np.float64), np.arange(1000, 1180))
    stamps = np.rint(true * 1000.0 / 60) / 1000.0
    frames, frame_s = count_frames(stamps, median_interval(stamps))

    assert np.array_equal(frames, true)
    assert frame_s == pytest.approx(1 / 60, rel=1e-4)


def test_two_samples_have_an_interval():
    assert median_interval(np.array([0.0, 0.5])) == 0.5
    assert median_interval(np.array([0.0, 1.0, 101.0])) == 1.0
