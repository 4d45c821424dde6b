"""Whether a table holds what its map says: units that people mix up are seen in the numbers.

An accelerometer reads 1 g when its wearer stands still. A gyroscope tells how fast gravity turns in the sensor's
axes, which the accelerometer shows too: a factor of 57.3 between them is a mix-up of degrees and radians.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core.frames import GRAVITY

Array = NDArray[np.float64]

ACCELERATION_UNITS: Mapping[str, float] = {"m/s2": 1.0, "g": GRAVITY, "mg (thousandths of g)": GRAVITY / 1000}
"""m/s² in one of each; people know the last one, a map does not."""

SECOND = 1.0  # s; shorter tables are not judged
APART = 3.0  # times; the units above are 9.8 and more apart, and nobody runs with three times gravity all the time
LAG = 0.5  # s; what moves is swung to and fro within it, and so gravity stays when averaged over it
FASTEST = math.radians(4000.0)  # rad/s; no wearable gyroscope reads more
MIXED_UP = 20.0  # times; real legs give 0.9 to 1.8, and with degrees for radians 48 to 104
TURNED_MUCH, TURNED_SEEN = 1.0, 0.1  # rad within LAG, root mean square: less tells nothing
USUAL = 0.999  # share of the readings; single ones may be damaged


def doubt_acceleration(acceleration: Array, frame_s: float, unit: str) -> str | None:
    """Return why the numbers are not in ``unit``, one clause; None where they may be.

    Parameters
    ----------
    acceleration : (n, 3), m/s², as the map reads it
    frame_s : float, s
    unit : str
        What the map says.
    """
    rest = _norm_in_calmest_second(acceleration, frame_s)
    if rest is None or GRAVITY / APART <= rest <= GRAVITY * APART:
        return None
    scale = ACCELERATION_UNITS[unit]
    fitting = [name for name, size in ACCELERATION_UNITS.items() if 1 / APART <= rest / scale * size / GRAVITY <= APART]
    seen = f"at rest it reads {rest / scale:.4g}, and gravity is {GRAVITY / scale:.4g} {unit}"
    if not fitting:
        return f"{seen}; leave it out if gravity was taken off"
    if fitting[0].startswith("mg"):
        return f"{seen}; it looks like mg: divide the columns by 1000 and say g"
    return f"{seen}; it looks like {fitting[0]}"


def doubt_rate(time: Array, rate: Array, acceleration: Array, frame_s: float, unit: str) -> str | None:
    """Return why the numbers are not in ``unit``, one clause; None where they may be.

    Parameters
    ----------
    time : (n,), s
    rate : (n, 3), rad/s, as the map reads it
    acceleration : (n, 3), m/s², in the same axes; NaN where unknown
    frame_s : float, s
    unit : str
        What the map says.
    """
    other = "deg/s" if unit == "rad/s" else "rad/s"
    usual = _usual(np.abs(rate[np.isfinite(rate).all(axis=1)]))
    shown = usual if unit == "rad/s" else math.degrees(usual)
    if usual > FASTEST:
        hint = f"it looks like {other}" if unit == "rad/s" else "no gyroscope turns so fast"
        return f"it turns by up to {shown:.4g} {unit}; {hint}"
    times = _times_too_fast(time, rate, acceleration, frame_s)
    if times is None or 1 / MIXED_UP <= times <= MIXED_UP or (times > 1) != (unit == "rad/s"):
        return None
    factor = f"{times:.0f} times faster" if times > 1 else f"{1 / max(times, 1e-3):.0f} times slower"
    return f"it turns by up to {shown:.4g} {unit}, {factor} than gravity does in its axes; it looks like {other}"


def _usual(readings: Array) -> float:
    return float(np.quantile(readings, USUAL)) if readings.size else 0.0


def _norm_in_calmest_second(acceleration: Array, frame_s: float) -> float | None:
    norms = np.linalg.norm(acceleration[np.isfinite(acceleration).all(axis=1)], axis=1)
    rows = max(round(SECOND / frame_s), 2)
    if len(norms) < rows:
        return None
    sums = np.concatenate([[0.0], np.cumsum(norms)])
    squares = np.concatenate([[0.0], np.cumsum(norms**2)])
    mean = (sums[rows:] - sums[:-rows]) / rows
    spread = (squares[rows:] - squares[:-rows]) / rows - mean**2
    return float(mean[int(np.argmin(spread))])


def _times_too_fast(time: Array, rate: Array, acceleration: Array, frame_s: float) -> float | None:
    """Return how many times faster the gyroscope turns than gravity does; None where that cannot be told."""
    known = np.flatnonzero(np.isfinite(rate).all(axis=1) & np.isfinite(acceleration).all(axis=1))
    rows = max(round(LAG / frame_s), 1)
    if len(known) < max(3 * rows, SECOND / frame_s):
        return None
    summed = np.concatenate([np.zeros((1, 3)), np.cumsum(acceleration[known], axis=0)])
    gravity = summed[rows:] - summed[:-rows]
    up = gravity / np.maximum(np.linalg.norm(gravity, axis=1, keepdims=True), 1e-9)
    middle = known[rows // 2 :][: len(up)]
    moment, turning = time[middle], np.cross(up, rate[middle])  # what rests in the world turns backwards
    turned = np.concatenate([np.zeros((1, 3)), np.cumsum(turning[:-1] * np.diff(moment)[:, None], axis=0)])
    without_gap = moment[rows:] - moment[:-rows] < 2 * LAG
    by_rate, by_gravity = (_size((way[rows:] - way[:-rows])[without_gap]) for way in (turned, up))
    if by_gravity > 0 and (by_rate > TURNED_MUCH or by_gravity > TURNED_SEEN):
        return by_rate / by_gravity
    return None


def _size(vectors: Array) -> float:
    """Return the root mean square length, 0 of none."""
    return math.sqrt(float((vectors**2).sum()) / max(len(vectors), 1))
