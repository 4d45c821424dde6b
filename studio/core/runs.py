"""From a stream with holes to uninterrupted runs of frames that a filter can step through.

Attitude filters are fed the rotation between consecutive wire quaternions (contracts §4): coning-safe,
and a lost packet costs nothing, because the tag integrated across it. Missing frames up to 1 s are
stepped with that rotation shared out evenly; a longer gap or a restarted sensor begins a new run. Where
the sensor's own quaternion tells how it turned meanwhile, runs are chained, so that a filter need not find
its tilt anew in the middle of a swing.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.sample import Correction, Flag, SensorInfo, Stream

Array = NDArray[np.float64]

LONGEST_BRIDGE = 1.0  # s; contracts §5


@dataclass(frozen=True)
class Run:
    """Frames without a break: one row for each frame, received or bridged."""

    time: NDArray[np.float64]
    """(n,), s of take time."""
    increments: NDArray[np.float64]
    """(n, 3), rad, sensor axes: rotation from the frame before; row 0 is zero."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s²; NaN in a chain's silences, and throughout when the sensor sends none."""
    orientation: NDArray[np.float64]
    """(n, 4), as the device sent it, bridged; NaN throughout when it sends none."""
    lost: NDArray[np.bool_]
    """(n,), True for frames that never arrived."""
    silent: NDArray[np.bool_]
    """(n,), True for frames of a chain that only lead a filter across a silence too long to be bridged."""
    epoch: int


def runs_of(stream: Stream, wanted: Correction | None) -> list[Run]:
    """Return the runs of a stream with the gyroscope corrected as ``wanted``.

    Parameters
    ----------
    wanted : Correction or None
        Offset and gain to be in force. None leaves what the sensor itself applied.
    """
    usable = _usable(stream)
    order = np.lexsort((stream.frame[usable], stream.epoch[usable]))
    rows = usable[order]
    frames, epochs = stream.frame[rows], stream.epoch[rows]
    fresh = np.concatenate([[True], (np.diff(frames) > 0) | (np.diff(epochs) > 0)]) if len(rows) else np.array([], bool)
    rows, frames, epochs = rows[fresh], frames[fresh], epochs[fresh]
    frame_s = stream.info.frame_s
    breaks = np.flatnonzero((np.diff(frames) > longest_bridge(frame_s) / frame_s) | (np.diff(epochs) != 0)) + 1
    return [_run(stream, part, wanted) for part in np.split(rows, breaks) if len(part) > 1]


def longest_bridge(frame_s: float) -> float:
    """Return for how long, s, a sensor may be silent and still count as measured meanwhile.

    The one rule for filters and figures, live and offline; half a frame is left to clocks that are not exact.
    """
    return LONGEST_BRIDGE + 0.5 * frame_s


def is_bridged(silent_for: float, frame_s: float) -> bool:
    """Return whether a sensor that was silent for so long, s, counts as measured meanwhile."""
    return silent_for <= longest_bridge(frame_s)


def steps_across(silent_for: float, frame_s: float) -> int:
    """Return in how many steps a filter is led across a silence, s: those of the longest bridge at most.

    In a longer stretch without acceleration a filter would only wait, and in one turned slowly enough see rest.
    """
    return max(1, round(min(silent_for, LONGEST_BRIDGE) / frame_s))


def chained(before: Run, after: Run, info: SensorInfo, wanted: Correction | None) -> Run:
    """Return two runs as one, led across the silence between them by the sensor's own quaternion."""
    # A clock that is fitted anew can put the first sample after a silence before the last one.
    silent_for = max(float(after.time[0] - before.time[-1]), info.frame_s)
    steps = steps_across(silent_for, info.frame_s)
    ends = before.orientation[-1], after.orientation[0]
    turned = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(ends[0]), ends[1]))
    if wanted is not None and uses_wire_quaternions(info):  # a filter on the device corrects by itself
        turned = recorrect(turned[None], silent_for, info.correction, wanted)[0]
    increments = after.increments.copy()
    increments[0] = turned / steps
    fraction = np.arange(1, steps) / steps

    def joined(first: Array, middle: Array, last: Array) -> Array:
        return np.concatenate([first, middle, last])

    return Run(
        time=joined(before.time, before.time[-1] + silent_for * fraction, after.time),
        increments=joined(before.increments, np.tile(increments[0], (steps - 1, 1)), increments),
        acceleration=joined(before.acceleration, np.full((steps - 1, 3), np.nan), after.acceleration),
        orientation=joined(
            before.orientation,
            rotation.slerp(np.tile(ends[0], (steps - 1, 1)), np.tile(ends[1], (steps - 1, 1)), fraction),
            after.orientation,
        ),
        lost=np.concatenate([before.lost, np.ones(steps - 1, bool), after.lost]),
        silent=np.concatenate([before.silent, np.ones(steps - 1, bool), after.silent]),
        epoch=after.epoch,
    )


def uses_wire_quaternions(info: SensorInfo) -> bool:
    """Return whether the sensor integrates by itself, so that its quaternions are the truth about turning."""
    return info.orientation == "integrated"


def has_turning(info: SensorInfo) -> bool:
    """Return whether the gyroscope can be followed at all."""
    return info.has_rate or uses_wire_quaternions(info)


def _usable(stream: Stream) -> NDArray[np.intp]:
    """Return the rows that say how the sensor turned (or, without a gyroscope, how it stood)."""
    by_rate = has_turning(stream.info) and not uses_wire_quaternions(stream.info)
    told = np.isfinite(stream.rate if by_rate else stream.orientation).all(axis=1)
    return np.flatnonzero(told & (stream.flags & Flag.IMU_ERROR == 0))


def _run(stream: Stream, rows: NDArray[np.intp], wanted: Correction | None) -> Run:
    frames = stream.frame[rows] - stream.frame[rows[0]]
    grid = np.arange(frames[-1] + 1)
    time = np.interp(grid, frames, stream.time[rows])
    lost = np.ones(len(grid), bool)
    lost[frames] = False
    lost[_told_otherwise(stream, rows)] = False
    orientation = _bridge_rotations(stream.orientation[rows], frames)
    frame_s = stream.info.frame_s
    if uses_wire_quaternions(stream.info):
        increments = np.zeros((len(grid), 3))
        increments[1:] = rotation.to_rotation_vector(
            rotation.multiply(rotation.inverse(orientation[:-1]), orientation[1:])
        )
        applied = stream.info.correction
    elif stream.info.has_rate:
        rate = np.stack([np.interp(grid, frames, stream.rate[rows, axis]) for axis in range(3)], axis=1)
        frame_s = max(float(time[-1] - time[0]) / len(grid[1:]), 0.5 * frame_s)  # of a clock that went back: the least
        increments = np.zeros((len(grid), 3))
        increments[1:] = 0.5 * (rate[:-1] + rate[1:]) * frame_s
        applied = None
    else:
        increments, applied = np.zeros((len(grid), 3)), None
    if wanted is not None:
        increments[1:] = recorrect(increments[1:], frame_s, applied, wanted)
    force = _bridge_vectors(stream, rows, frames, grid)
    return Run(time, increments, force, orientation, lost, np.zeros(len(grid), bool), int(stream.epoch[rows[0]]))


def _told_otherwise(stream: Stream, rows: NDArray[np.intp]) -> NDArray[np.int64]:
    """Return the frames of a run in which the sensor told of itself instead: filled, and nothing was lost."""
    first, last = stream.frame[rows[0]], stream.frame[rows[-1]]
    told = (stream.flags & Flag.FILLED != 0) & (stream.epoch == stream.epoch[rows[0]])
    told &= (stream.frame > first) & (stream.frame < last)
    return np.asarray(stream.frame[told] - first)


def recorrect(
    increments: NDArray[np.float64], frame_s: float, applied: Correction | None, wanted: Correction
) -> NDArray[np.float64]:
    """Return increments (n, 3) as they would be with another offset and gain than those applied by the tag."""
    rate = increments / frame_s
    if applied is not None:
        rate = rate @ np.linalg.inv(np.array(applied.gain)).T + np.array(applied.offset)
    return np.asarray((rate - np.array(wanted.offset)) @ np.array(wanted.gain).T * frame_s)


def _bridge_rotations(orientation: NDArray[np.float64], frames: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return one quaternion for each frame, (frames[-1] + 1, 4), slerped across missing ones."""
    known = np.isfinite(orientation).all(axis=1)
    if not known.any():
        return np.full((int(frames[-1]) + 1, 4), np.nan)
    before_first, after_last = int(frames[known][0]), int(frames[-1] - frames[known][-1])
    orientation, frames = orientation[known], frames[known] - frames[known][0]
    steps = np.diff(frames)
    before = np.repeat(np.arange(len(steps)), steps)
    fraction = (np.arange(frames[-1]) - frames[before]) / steps[before]
    vectors = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(orientation[:-1]), orientation[1:]))
    bridged = rotation.multiply(orientation[before], rotation.from_rotation_vector(vectors[before] * fraction[:, None]))
    ends = np.repeat(orientation[[0, -1]], [before_first, after_last + 1], axis=0)
    return np.concatenate([ends[:before_first], bridged, ends[before_first:]])


def _bridge_vectors(
    stream: Stream, rows: NDArray[np.intp], frames: NDArray[np.int64], grid: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the accelerometer on every frame, linear across frames that carry none."""
    force = stream.acceleration[rows]
    known = np.isfinite(force).all(axis=1)
    if not known.any():
        return np.full((len(grid), 3), np.nan)
    return np.stack([np.interp(grid, frames[known], force[known, axis]) for axis in range(3)], axis=1)
