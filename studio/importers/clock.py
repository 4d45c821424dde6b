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


def count_frames(time: NDArray[np.float64]) -> tuple[NDArray[np.int64], float]:
    """Return each row's number of nominal frames since the first, and the nominal frame in s.

    The nominal frame is the mean of the intervals that lie within half of their median, so that stamps
    rounded to whole milliseconds give it too. A lost sample is a missing number.

    Parameters
    ----------
    time : (n,), s
        Strictly increasing, at least two.
    """
    step = np.diff(time)
    median = float(np.median(step))
    frame_s = float(step[np.abs(step - median) < 0.5 * median].mean())
    frames = np.maximum(np.rint(step / frame_s), 1.0).astype(np.int64)
    return np.concatenate([np.zeros(1, np.int64), np.cumsum(frames)]), frame_s
