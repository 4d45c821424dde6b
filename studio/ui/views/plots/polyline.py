"""From samples to the points a screen can show: least and most of every few pixels, broken at gaps."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

COLUMN = 2  # px; a line of two points for every two pixels looks like the samples themselves


class Polyline(NamedTuple):
    """Points of k lines that share their times."""

    time: NDArray[np.float64]
    """(m,), s."""
    values: NDArray[np.float64]
    """(m, k), finite."""
    joined: NDArray[np.bool_]
    """(m,), whether a point is joined to the next."""


def polyline(
    time: NDArray[np.float64], values: NDArray[np.float64], breaks: NDArray[np.bool_], column_s: float
) -> Polyline:
    """Return the points to draw.

    Parameters
    ----------
    time : (n,), s, rising
    values : (n, k)
        Rows with a NaN are left out, and the line is broken there.
    breaks : (n,)
        Whether the line is broken just before a sample.
    column_s : float, s
        What one column of pixels spans; columns stand at fixed times, so that a sliding window does not flicker.
    """
    known = np.isfinite(values).all(axis=1)
    if not known.all():
        holes = np.concatenate([[0], np.cumsum(~known)])[:-1][known]
        breaks = breaks[known] | (np.diff(holes, prepend=holes[:1]) > 0)
        time, values = time[known], values[known]
    if len(time) == 0:
        return Polyline(time, values, np.empty(0, np.bool_))
    column = np.floor(time / column_s).astype(np.int64)
    starts = np.flatnonzero((np.diff(column, prepend=column[0] - 1) != 0) | breaks)
    if len(time) <= 2 * len(starts):
        return Polyline(time, values, np.append(~breaks[1:], False))
    return _envelope(time, values, breaks, starts)


def _envelope(
    time: NDArray[np.float64], values: NDArray[np.float64], breaks: NDArray[np.bool_], starts: NDArray[np.intp]
) -> Polyline:
    last = np.append(starts[1:], len(time)) - 1
    low = np.minimum.reduceat(values, starts, axis=0)
    high = np.maximum.reduceat(values, starts, axis=0)
    rising = values[last] >= values[starts]
    points = np.empty((2 * len(starts), values.shape[1]))
    points[0::2] = np.where(rising, low, high)
    points[1::2] = np.where(rising, high, low)
    joined = np.ones(2 * len(starts), np.bool_)
    joined[1:-1:2] = ~breaks[starts[1:]]
    joined[-1] = False
    moments = np.empty(2 * len(starts))
    moments[0::2], moments[1::2] = time[starts], time[last]
    return Polyline(moments, points, joined)


class Samples(NamedTuple):
    """One line as it came, or as it was thinned once for all."""

    time: NDArray[np.float64]
    """(n,), s."""
    values: NDArray[np.float64]
    """(n,), NaN where there is none."""
    breaks: NDArray[np.bool_]
    """(n,), whether the line is broken just before."""

    def between(self, from_s: float, to_s: float) -> "Samples":
        """Return what lies in a range, with one more on each side."""
        first = max(int(np.searchsorted(self.time, from_s)) - 1, 0)
        last = int(np.searchsorted(self.time, to_s)) + 1
        return Samples(self.time[first:last], self.values[first:last], self.breaks[first:last])


def thinned(samples: Samples, column_s: float) -> Samples:
    """Return least and most of each column, so that a long line need not be read whole for every picture."""
    line = polyline(samples.time, samples.values[:, None], samples.breaks, column_s)
    return Samples(line.time, line.values[:, 0], np.concatenate([[False], ~line.joined[:-1]]))
