"""Time columns of foreign recordings: put in order, and counted in frames."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

LATE = 1.0  # s; a stamp further than this before its predecessor is no late packet: the clock started anew, or lies
PAUSE = 3600.0  # s; what comes after a longer silence belongs to another recording, or its stamp is damaged


class Order(NamedTuple):
    """Which rows to keep so that time only grows."""

    keep: NDArray[np.intp]
    """(n,), rows in the order of time."""
    dropped: int
    """Rows without a time, twice the same time, a stamp its neighbours contradict, or of another stretch."""
    reordered: int
    """Rows that came after later ones."""


def put_in_order(time: NDArray[np.float64]) -> Order:
    """Sort rows that came late and leave out those whose time cannot be believed.

    A stamp that differs from both neighbours by more than ``LATE``, while they agree, is damaged. Where the
    clock jumps back by more than ``LATE`` or ahead by more than ``PAUSE`` a new stretch begins; the one with
    most rows is kept.

    Parameters
    ----------
    time : (n,), s
        In the order of the file.
    """
    rows = np.flatnonzero(np.isfinite(time))
    stamps = time[rows]
    if len(rows) > 2:
        middle = np.median([stamps[:-2], stamps[1:-1], stamps[2:]], axis=0)
        believed = np.ones(len(rows), np.bool_)
        believed[1:-1] = np.abs(stamps[1:-1] - middle) <= LATE
        rows, stamps = rows[believed], stamps[believed]
    step = np.diff(stamps)
    edges = [0, *(np.flatnonzero((step < -LATE) | (step > PAUSE)) + 1), len(rows)]
    longest = int(np.argmax(np.diff(edges)))
    rows = rows[edges[longest] : edges[longest + 1]]
    stamps = time[rows]
    late = int((stamps < np.maximum.accumulate(stamps)).sum())
    rows = rows[np.argsort(stamps, kind="stable")]
    new = np.ones(len(rows), np.bool_)
    new[1:] = np.diff(time[rows]) > 0
    return Order(rows[new], len(time) - int(new.sum()), late)


def median_interval(time: NDArray[np.float64]) -> float:
    """Return the median of the intervals, s; of two middle ones the lower, so that it is one that exists."""
    return float(np.sort(np.diff(time))[(len(time) - 2) // 2])


def count_frames(time: NDArray[np.float64], nominal: float) -> tuple[NDArray[np.int64], float]:
    """Return each row's number of frames since the first, and the length of a frame in s.

    A frame is the mean of the intervals that lie within half of the nominal one, so that stamps rounded to
    whole milliseconds give it too. A lost sample is a missing number.

    Parameters
    ----------
    time : (n,), s
        Strictly increasing, at least two.
    nominal : s
        From one sample to the next when none is lost.
    """
    step = np.diff(time)
    single = step[np.abs(step - nominal) < 0.5 * nominal]
    frame_s = float(single.mean()) if len(single) else nominal
    frames = np.maximum(np.rint(step / frame_s), 1.0).astype(np.int64)
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(frames)]), frame_s
