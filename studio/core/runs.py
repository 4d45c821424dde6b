"""From a stream with holes to uninterrupted runs of frames that a filter can step through.

Attitude filters are fed the rotation between consecutive wire quaternions (contracts §4): coning-safe,
and a lost packet costs nothing, because the tag integrated across it. Missing frames up to 1 s are
stepped with that rotation shared out evenly; a longer gap or a restarted sensor begins a new run.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.sample import Correction, SensorInfo, Stream

LONGEST_BRIDGE = 1.0  # s; contracts §5


@dataclass(frozen=True)
class Run:
    """Frames without a break: one row for each frame, received or bridged."""

    time: NDArray[np.float64]
    """(n,), s of take time."""
    increments: NDArray[np.float64]
    """(n, 3), rad, sensor axes: rotation from the frame before; row 0 is zero."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s²; NaN throughout when the sensor sends none."""
    orientation: NDArray[np.float64]
    """(n, 4), as the device sent it, bridged; NaN throughout when it sends none."""
    lost: NDArray[np.bool_]
    """(n,), True for frames that never arrived."""
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
    longest = LONGEST_BRIDGE / stream.info.frame_s
    breaks = np.flatnonzero((np.diff(frames) > longest) | (np.diff(epochs) != 0)) + 1
    return [_run(stream, part, wanted) for part in np.split(rows, breaks) if len(part) > 1]


def uses_wire_quaternions(info: SensorInfo) -> bool:
    """Return whether the sensor integrates by itself, so that its quaternions are the truth about turning."""
    return info.orientation == "integrated"


def has_turning(info: SensorInfo) -> bool:
    """Return whether the gyroscope can be followed at all."""
    return info.has_rate or uses_wire_quaternions(info)


def _usable(stream: Stream) -> NDArray[np.intp]:
    """Return the rows that say how the sensor turned (or, without a gyroscope, how it stood)."""
    if has_turning(stream.info) and not uses_wire_quaternions(stream.info):
        return np.flatnonzero(np.isfinite(stream.rate).all(axis=1))
    return np.flatnonzero(np.isfinite(stream.orientation).all(axis=1))


def _run(stream: Stream, rows: NDArray[np.intp], wanted: Correction | None) -> Run:
    frames = stream.frame[rows] - stream.frame[rows[0]]
    grid = np.arange(frames[-1] + 1)
    time = np.interp(grid, frames, stream.time[rows])
    lost = np.ones(len(grid), bool)
    lost[frames] = False
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
        frame_s = float(time[-1] - time[0]) / len(grid[1:])
        increments = np.zeros((len(grid), 3))
        increments[1:] = 0.5 * (rate[:-1] + rate[1:]) * frame_s
        applied = None
    else:
        increments, applied = np.zeros((len(grid), 3)), None
    if wanted is not None:
        increments[1:] = recorrect(increments[1:], frame_s, applied, wanted)
    return Run(
        time, increments, _bridge_vectors(stream, rows, frames, grid), orientation, lost, int(stream.epoch[rows[0]])
    )


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
    if not np.isfinite(orientation).all():
        return np.full((int(frames[-1]) + 1, 4), np.nan)
    steps = np.diff(frames)
    before = np.repeat(np.arange(len(steps)), steps)
    fraction = (np.arange(frames[-1]) - frames[before]) / steps[before]
    vectors = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(orientation[:-1]), orientation[1:]))
    bridged = rotation.multiply(orientation[before], rotation.from_rotation_vector(vectors[before] * fraction[:, None]))
    return np.concatenate([bridged, orientation[-1:]])


def _bridge_vectors(
    stream: Stream, rows: NDArray[np.intp], frames: NDArray[np.int64], grid: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the accelerometer on every frame, linear across frames that carry none."""
    force = stream.acceleration[rows]
    known = np.isfinite(force).all(axis=1)
    if not known.any():
        return np.full((len(grid), 3), np.nan)
    return np.stack([np.interp(grid, frames[known], force[known, axis]) for axis in range(3)], axis=1)
