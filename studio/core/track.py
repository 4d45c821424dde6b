"""The attitude of one sensor through a take, each stretch of known heading apart."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import rest, rotation
from studio.core.attitude import open_estimator
from studio.core.frames import GRAVITY
from studio.core.runs import Run, chained, has_turning, runs_of, uses_wire_quaternions
from studio.core.sample import NO_CORRECTION, Flag, SensorId, SensorInfo, Stream
from studio.core.take import Calibration, Take

RAW_OFFSET_SIGMA = math.radians(20.0) / math.sqrt(3.0)  # rad/s; MPU-6050 data sheet: ±20 °/s, uniform
FRESH_OFFSET_SIGMA = math.radians(0.03)  # rad/s; measured at rest since power-on (0.001), warming up a little since
STORED_OFFSET_SIGMA = math.radians(0.05)  # rad/s; a stored offset after some minutes of warming up
DEVICE_OFFSET_SIGMA = math.radians(1.0)  # rad/s; a device with a filter of its own tracks its offset
GRAVITY_RANGE = 0.2  # of g; a person who holds still, and an accelerometer off by 1 % to 3 %
TURNING = math.radians(10.0)  # rad/s; 0.2° a frame tilts gravity by more than an accelerometer's noise
FEWEST_TURNING = 25  # frames; 0.5 s at 50 Hz
MOST_REPEATED = 0.95  # of the frames in which the sensor turned
LARGEST_CARRY = math.radians(2.0)  # what an offset may have turned a tag's own quaternion by during a gap


@dataclass(frozen=True)
class SensorTrack:
    """Attitude on the sensor's own frames."""

    info: SensorInfo
    estimator: str
    """Name in ``attitude.ESTIMATORS``; a source without gyroscope is always ``device``."""
    time: NDArray[np.float64]
    """(n,), s of take time."""
    attitude: NDArray[np.float64]
    """(n, 4), world_from_sensor, z up; the heading of each ``group`` is its own."""
    device: NDArray[np.float64]
    """(n, 4), what the device said, NaN when nothing."""
    speed: NDArray[np.float64]
    """(n,), rad/s, how fast the sensor turned."""
    lost: NDArray[np.bool_]
    """(n,), frames that never arrived and are bridged."""
    run: NDArray[np.int32]
    """(n,), counts uninterrupted runs."""
    group: NDArray[np.int32]
    """(n,), counts stretches within which the heading is one."""
    offset: NDArray[np.float64]
    """(3,), rad/s, subtracted after the sensor's own correction."""
    offset_sigma: float
    """rad/s, standard uncertainty of the offset, largest axis."""
    levelled: NDArray[np.bool_]
    """(n,), whether the frame tells of gravity; a hold without any such frame does not know what is up."""

    def rows(self, from_s: float, to_s: float) -> NDArray[np.intp]:
        """Return the frames between two times."""
        return np.flatnonzero((self.time >= from_s) & (self.time <= to_s))


def tells_gravity(acceleration: NDArray[np.float64], speed: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return in which frames (n,) an accelerometer felt about one g; in none when it gave one value while turning.

    Parameters
    ----------
    acceleration : (n, 3), m/s², sensor axes; NaN where nothing is known
    speed : (n,), rad/s
    """
    size = np.linalg.norm(acceleration, axis=1)
    felt = np.abs(size - GRAVITY) <= GRAVITY_RANGE * GRAVITY  # False for NaN
    turning = speed[1:] > TURNING
    repeated = (acceleration[1:] == acceleration[:-1]).all(axis=1)[turning]
    # One at a fourth of the gyroscope's rate repeats three of four.
    is_frozen = len(repeated) >= FEWEST_TURNING and repeated.mean() > MOST_REPEATED
    return np.asarray(felt & (not is_frozen))


def attitude_at(track: SensorTrack, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the attitude (n, 4) at any times (n,) s; before, after and between runs the nearest frame holds."""
    if len(track.time) == 1:
        return np.repeat(track.attitude, len(time), axis=0)
    after = np.clip(np.searchsorted(track.time, time), 1, len(track.time) - 1)
    before = after - 1
    span = track.time[after] - track.time[before]
    fraction = np.clip((time - track.time[before]) / np.where(span > 0, span, 1.0), 0.0, 1.0)
    fraction = np.where(track.run[before] == track.run[after], fraction, np.round(fraction))
    return rotation.slerp(track.attitude[before], track.attitude[after], fraction)


def tracks_of(take: Take, attitude: str, calibrations: Mapping[SensorId, Calibration]) -> dict[SensorId, SensorTrack]:
    """Return every sensor's track, looking ahead where that helps (method ``offline``).

    Parameters
    ----------
    attitude : str
        Key of ``attitude.ESTIMATORS``; sources that cannot serve it use what they can, and say so.
    calibrations : mapping
        Offset and gain to be in force, for the sensors that have one.
    """
    return {
        stream.info.sensor: _track(stream, attitude, calibrations.get(stream.info.sensor)) for stream in take.streams
    }


def estimator_for(info: SensorInfo, wanted: str) -> str:
    """Return the estimator that serves a sensor when ``wanted`` was asked for."""
    if not has_turning(info):
        return "device"
    if wanted == "device" or not info.has_acceleration:
        # Without an accelerometer a device that levels itself is to be believed, and any other only turns.
        return "device" if info.orientation == "world" else "gyro"
    return wanted


def prior_offset_sigma(info: SensorInfo, flags: int, calibration: Calibration | None) -> float:
    """Return how well the offset is known before this take is looked at, rad/s."""
    if calibration is not None and math.isfinite(max(calibration.offset_sigma)):
        return max(calibration.offset_sigma)
    if flags & Flag.OFFSET_OK:
        return FRESH_OFFSET_SIGMA
    if calibration is not None or (info.correction not in (None, NO_CORRECTION)) or flags & Flag.CALIBRATED:
        return STORED_OFFSET_SIGMA
    if info.orientation == "world":
        return DEVICE_OFFSET_SIGMA
    return RAW_OFFSET_SIGMA


def in_force(info: SensorInfo, flags: int, calibration: Calibration | None) -> Calibration | None:
    """Return the calibration to correct a sensor by, None to leave the sensor's own correction in force.

    A tag that corrects by itself and did not tell how cannot be corrected anew: it would be corrected twice.

    Parameters
    ----------
    flags : int
        ``Flag`` of all samples of the take so far, together.
    """
    corrects = flags & (Flag.CALIBRATED | Flag.OFFSET_OK)
    if uses_wire_quaternions(info) and info.correction is None and corrects:
        return None
    return calibration


def goes_on(info: SensorInfo, is_same_epoch: bool, silent_for: float, doubt: float) -> bool:
    """Return whether the sensor's own quaternion tells how it turned during a silence.

    That of a tag does while it goes on integrating, as long as an offset of ``doubt`` rad/s turned it by less than
    2 degrees in ``silent_for`` s; that of a device with a heading of its own always does.
    """
    return info.common_world or (is_same_epoch and doubt * silent_for <= LARGEST_CARRY)


def flags_of(stream: Stream) -> int:
    """Return the flags of all samples together."""
    return int(np.bitwise_or.reduce(stream.flags)) if len(stream) else 0


def _track(stream: Stream, wanted: str, calibration: Calibration | None) -> SensorTrack:
    info = stream.info
    flags = flags_of(stream)
    calibration = in_force(info, flags, calibration)
    correction = None if calibration is None else calibration.correction
    runs = runs_of(stream, correction)
    prior = prior_offset_sigma(info, flags, calibration)
    # An estimator asked to repeat the device must not be improved upon.
    offset, sigma = (np.zeros(3), prior) if wanted == "device" else measure_offset(runs, info.frame_s, prior)
    doubt = max(float(np.abs(offset).max()), sigma)
    chains = runs[:1]
    for run in runs[1:]:
        before = chains[-1]
        known = bool(np.isfinite(before.orientation[-1] + run.orientation[0]).all())
        silent_for = float(run.time[0] - before.time[-1])
        if known and goes_on(info, before.epoch == run.epoch, silent_for, doubt):
            chains[-1] = chained(before, run, info, correction)
        else:
            chains.append(run)
    name = estimator_for(info, wanted)
    attitudes = []
    for chain in chains:
        chain.increments[1:] -= offset * _step_lengths(chain, info.frame_s)[:, None]
        attitudes.append(open_estimator(name, info.frame_s, sigma).run(chain))
    return _joined(info, name, chains, attitudes, offset, sigma)


def _step_lengths(chain: Run, frame_s: float) -> NDArray[np.float64]:
    """Return the time from each frame to the next, (n - 1,), s: longer in a silence, which has few steps."""
    is_silent = chain.silent[1:] | chain.silent[:-1]
    return np.where(is_silent, np.diff(chain.time), frame_s)


def measure_offset(runs: list[Run], frame_s: float, prior: float) -> tuple[NDArray[np.float64], float]:
    """Return the offset (3,) rad/s left in the runs and its sigma: from a table if they lay on one, else standing."""
    best: rest.Rest | None = None
    for spread in (rest.RATE_SPREAD_TABLE, rest.RATE_SPREAD_WORN):
        for run in runs:
            found = rest.find_rest(run.increments[1:] / frame_s, run.acceleration[1:], frame_s, spread)
            if found is not None and (best is None or found.sigma.max() < best.sigma.max()):
                best = found
    if best is None:
        return np.zeros(3), prior
    offset, sigma = rest.combine(best.offset, np.maximum(best.sigma, rest.RESOLUTION), prior)
    return offset, float(sigma.max())


def _joined(
    info: SensorInfo,
    name: str,
    chains: list[Run],
    attitudes: list[NDArray[np.float64]],
    offset: NDArray[np.float64],
    sigma: float,
) -> SensorTrack:
    """Return chains of runs as one track, without the frames that only led across silences."""
    lengths = [len(chain.time) for chain in chains]

    def join(parts: list[NDArray[np.float64]], width: int) -> NDArray[np.float64]:
        return np.concatenate(parts) if parts else np.empty((0, width))

    attitude = join(attitudes, 4)
    silent = join([chain.silent.astype(np.float64) for chain in chains], 0).reshape(-1) > 0
    group = np.repeat(np.arange(len(chains), dtype=np.int32), lengths)
    resumed = np.flatnonzero(np.diff(silent.astype(np.int8), prepend=0) < 0)
    run = group + np.searchsorted(resumed, np.arange(len(silent)), side="right")
    speed = np.linalg.norm(join([chain.increments for chain in chains], 3), axis=1) / info.frame_s
    levelled = tells_gravity(join([chain.acceleration for chain in chains], 3), speed) & info.has_acceleration
    kept = ~silent & np.isfinite(attitude).all(axis=1)  # what an estimator cannot say is no attitude
    return SensorTrack(
        info=info,
        estimator=name,
        time=join([chain.time for chain in chains], 0).reshape(-1)[kept],
        attitude=attitude[kept],
        device=join([chain.orientation for chain in chains], 4)[kept],
        speed=speed[kept],
        lost=join([chain.lost.astype(np.float64) for chain in chains], 0).reshape(-1)[kept] > 0,
        run=run[kept].astype(np.int32),
        group=group[kept],
        offset=offset,
        offset_sigma=sigma,
        levelled=levelled[kept] | (name == "device"),
    )
