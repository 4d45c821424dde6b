"""What a take may claim. It may come from a stranger; solving, drawing and listing rely on these bounds.

A claim about the whole take that cannot be true is a reason to refuse it; one sample or mark is left out and counted.
"""

import math
from collections.abc import Iterable
from datetime import datetime
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.core.runs import LONGEST_BRIDGE
from studio.core.sample import LARGEST_RATE, SensorInfo, Stream, is_plausible_correction
from studio.core.take import Mark, Setup

LONGEST_TAKE: Final = 7 * 86400.0  # s; a week
SHORTEST_FRAME: Final = 1e-4  # s; 10 kHz, above any gyroscope
LONGEST_FRAME: Final = 60.0  # s
FRAME: Final = 0.02  # s; what the wire protocol calls a frame, for a sensor of which nobody knows
STEP_BACK: Final = 10.0  # s; a clock that is fitted anew moves by tenths of a second, to either side
MOST_FRAMES: Final = 4_320_000  # 12 h at 100 Hz; solved, 3.5 GB
FRAMES_PER_SAMPLE: Final = 10  # beyond that: nine of ten samples lost
LARGEST_COUNT: Final = 1 << 52  # of frames; exact as float64
MOST_RESTARTS: Final = 1 << 30
STATURES: Final = (0.3, 2.8)  # m; as in resources/map.schema.json
LARGEST_FORCE: Final = 1e5  # m/s²; 10,000 g
LARGEST_NUMBER: Final = 1e12  # seconds since 1970 fit, microseconds do not
LARGEST_FACT: Final = 1e9  # in a setup; all are SI or counts
LONGEST_LIST: Final = 1000  # in a setup
LONGEST_TEXT: Final = 1024  # characters, in a setup
LONGEST_LABEL: Final = 256  # characters of a name or a marker
LONGEST_NOTES: Final = 100_000  # characters

Rows = NDArray[np.void]


def is_plausible_time(time: float) -> bool:
    """Return whether a time (s of take time) can lie in or near a take."""
    return abs(time) <= LONGEST_TAKE


def is_plausible_mark(mark: Mark) -> bool:
    """Return whether a mark lies in or near a take; only its end may be unknown."""
    return is_plausible_time(mark.time) and (math.isnan(mark.end) or is_plausible_time(mark.end))


def sensor_fault(info: SensorInfo) -> str:
    """Return the name of the field that cannot be true and without which a sensor is of no use; empty when none."""
    known = info.frame_s == 0.0 or SHORTEST_FRAME <= info.frame_s <= LONGEST_FRAME
    return "" if known else "frame_s"


def setup_fault(setup: Setup) -> str:
    """Return the name of the field of a setup that cannot be true; empty when all can."""
    if not _is_moderate(msgspec.to_builtins(setup)):
        return "setup"
    if not STATURES[0] <= setup.stature <= STATURES[1]:
        return "stature"
    if not 1 <= setup.performer <= LONGEST_LIST:
        return "performer"
    if not all(is_plausible_correction(calibration.correction) for calibration in setup.calibrations):
        return "gain"
    if not all(abs(math.hypot(*attitude) - 1.0) < 0.01 for attitude in _attitudes(setup)):
        return "carried"
    return ""


def plausible_utc(text: str) -> str:
    """Return an ISO 8601 time as it is, anything else as empty."""
    try:
        datetime.fromisoformat(text)
    except ValueError:
        return ""
    return text


def believe(rows: Rows, zero: float) -> tuple[Rows, int]:
    """Return the rows that a sensor can have sent, and of how many the row or a reading was not believed.

    Parameters
    ----------
    rows : of one sensor, in the order of arrival; fields of ``SAMPLE_DTYPE``
        Readings that no sensor has become unknown, in place.
    zero : s, take time 0 on the clock of ``time``

    A sample whose time or count cannot be is left out: no later step could place it.
    """
    with np.errstate(invalid="ignore", over="ignore"):
        time = rows["time"] - zero
        placed = np.abs(time) <= LONGEST_TAKE
        placed &= (rows["frame"] >= -LARGEST_COUNT) & (rows["frame"] <= LARGEST_COUNT)
        placed &= (rows["epoch"] >= 0) & (rows["epoch"] <= MOST_RESTARTS)
        placed &= ~_is_ahead(time, placed)
        placed &= time >= np.maximum.accumulate(np.where(placed, time, -LONGEST_TAKE)) - STEP_BACK
        length = np.sqrt((rows["orientation"] ** 2).sum(axis=1))
        wrong = (length < 0.5) | (length > 2.0)
        rows["orientation"][wrong] = np.nan
        for name, largest in (("rate", LARGEST_RATE), ("acceleration", LARGEST_FORCE)):
            beyond = (np.abs(rows[name]) > largest).any(axis=1)
            rows[name][beyond] = np.nan
            wrong |= beyond
        for name in ("battery", "temperature", "rssi"):
            beyond = np.abs(rows[name]) > LARGEST_NUMBER
            rows[name][beyond] = np.nan
            wrong |= beyond
        for name in ("device_time", "received"):
            beyond = ~(np.abs(rows[name]) <= LARGEST_NUMBER)
            rows[name][beyond] = rows["time"][beyond]  # as of a recording that does not tell
            wrong |= beyond
    unbelieved = int((wrong | ~placed).sum())
    return (rows if placed.all() else rows[placed]), unbelieved


def _is_ahead(time: NDArray[np.float64], placed: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which rows (n,) lie far ahead of the one before and of the one after; s, of those that are ``placed``."""
    ahead = np.zeros(len(time), bool)
    kept = time[placed]
    if len(kept) > 2:
        steps = np.diff(kept)
        # The first is judged by the two that follow; of the last nobody can tell whether the rest was cut off.
        of_the_last = np.concatenate(([kept[0] - kept[2]], steps))
        of_the_next = np.concatenate((-steps, [-np.inf]))
        ahead[placed] = np.minimum(of_the_last, of_the_next) > STEP_BACK
    return ahead


def nominal_frame(info: SensorInfo, time: NDArray[np.float64]) -> float:
    """Return the frame of a sensor (s): as told, else the usual step of its samples' times, else the protocol's."""
    if info.frame_s > 0:
        return info.frame_s
    step = float(np.median(np.diff(time))) if len(time) > 1 else 0.0
    return step if SHORTEST_FRAME <= step <= LONGEST_FRAME else FRAME


def frames_fault(streams: Iterable[Stream]) -> str:
    """Return what would have a take solved to far more frames than it has samples; empty when nothing would."""
    samples, longest, shortest = 0, 0.0, LONGEST_FRAME
    for stream in streams:
        if not len(stream):
            continue
        samples += len(stream)
        longest, shortest = max(longest, float(stream.time.max())), min(shortest, stream.info.frame_s)
        order = np.lexsort((stream.frame, stream.epoch))
        steps = np.diff(stream.frame[order])
        steps = steps[(steps > 0) & (steps <= LONGEST_BRIDGE / stream.info.frame_s)]
        if steps.sum() > MOST_FRAMES + FRAMES_PER_SAMPLE * len(stream):
            return "frame"
    return "time" if longest / shortest > MOST_FRAMES + FRAMES_PER_SAMPLE * samples else ""


def _is_moderate(value: Any) -> bool:
    if isinstance(value, dict):
        return len(value) <= LONGEST_LIST and all(_is_moderate(key) and _is_moderate(v) for key, v in value.items())
    if isinstance(value, (list, tuple)):
        return len(value) <= LONGEST_LIST and all(map(_is_moderate, value))
    if isinstance(value, str):
        return len(value) <= LONGEST_TEXT
    return not isinstance(value, (int, float)) or math.isnan(value) or abs(value) <= LARGEST_FACT


def _attitudes(setup: Setup) -> list[tuple[float, ...]]:
    if setup.carried is None:
        return []
    limbs = setup.carried.alignment.limbs.values()
    return [*(limb.sensor_from_segment for limb in limbs), *setup.carried.wearer_from_sensor.values()]
