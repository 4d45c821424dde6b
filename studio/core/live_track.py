"""One sensor's attitude while it is sending: the live twin of ``runs`` and ``track``."""

import math

import numpy as np

from studio.core import single_rotation as single
from studio.core.attitude import open_estimator
from studio.core.runs import is_bridged, recorrect, steps_across, uses_wire_quaternions
from studio.core.sample import (
    MISSING_QUATERNION,
    MISSING_VECTOR,
    NO_CORRECTION,
    Correction,
    Flag,
    Quaternion,
    Sample,
    SensorInfo,
    Vector,
)
from studio.core.take import Calibration
from studio.core.track import estimator_for, goes_on, in_force, prior_offset_sigma

CORRECTS = int(Flag.CALIBRATED | Flag.OFFSET_OK)
SMALLEST_LEARNED = math.radians(0.05)  # rad/s; what a person who stands still leaves of an offset at best
FILLED, IMU_ERROR = int(Flag.FILLED), int(Flag.IMU_ERROR)  # members of an IntFlag cost a microsecond each time


class LiveTrack:
    """Steps an estimator through the samples of one sensor as they arrive, bridging gaps."""

    def __init__(self, info: SensorInfo, wanted: str, calibration: Calibration | None) -> None:
        """Begin before the first sample.

        Parameters
        ----------
        wanted : key of ``attitude.ESTIMATORS``; a sensor that cannot serve it uses what it can
        calibration : offset and gain to be in force; None leaves what the sensor itself applied
        """
        self.info = info
        self.estimator = estimator_for(info, wanted)
        self.attitude: Quaternion = single.IDENTITY
        """world_from_sensor; the heading is that of ``group``."""
        self.speed = 0.0
        """rad/s, of the attitude: what the filter takes for offset is not turning."""
        self.group = 0
        self.run = 0
        self.last: Sample | None = None
        """The sample stepped last; None before the first."""
        self._calibration = calibration
        self._flags = 0
        self._increment = np.zeros(3)
        self._force = np.zeros(3)
        self._device = np.zeros(4)

    def recalibrate(self, calibration: Calibration) -> None:
        """Correct the sensor anew from here on: its attitude goes on, what was learned of its offset ends."""
        self._calibration = calibration
        if self.last is not None:
            self._filter.forget_offset(self._offset_sigma())

    def learned(self) -> tuple[Correction, float] | None:
        """Return the gyroscope's whole correction as the filter has it by now, and the offset's sigma, rad/s.

        None when it knows no better than before, or when the sensor corrects by itself and did not tell how.
        """
        found = None if self.last is None else self._filter.learned_offset()
        hidden = self.info.correction is None and self._flags & CORRECTS
        if found is None or hidden or not found[1] < self._offset_sigma() / 2:
            return None
        calibration = self._in_force()
        base = (self.info.correction or NO_CORRECTION) if calibration is None else calibration.correction
        x, y, z = (np.array(base.offset) + np.linalg.solve(np.array(base.gain), found[0])).tolist()
        return Correction((x, y, z), base.gain), max(found[1], SMALLEST_LEARNED)

    def accepts(self, sample: Sample) -> bool:
        """Return whether ``push`` would step the sample: it tells about turning, and does not come too late."""
        by_rate = self.info.has_rate and not uses_wire_quaternions(self.info)
        told = sum(sample.rate) if by_rate else sum(sample.orientation)
        return math.isfinite(told) and not sample.flags & IMU_ERROR and self._is_newer(sample)

    def is_heard(self, sample: Sample) -> bool:
        """Return whether the sample came in time, and tells of the tag instead of how it turned."""
        return bool(sample.flags & FILLED) and self.last is not None and self._is_newer(sample)

    def push(self, sample: Sample) -> bool:
        """Take the next sample; False when it tells nothing about turning, or comes too late to be stepped."""
        if not self.accepts(sample):
            return False
        last = self.last
        self._flags |= sample.flags
        if last is None:
            self._begin(sample)
        else:
            self._follow(last, sample)
        self.last = sample
        return True

    def _is_newer(self, sample: Sample) -> bool:
        return self.last is None or (sample.epoch, sample.frame) > (self.last.epoch, self.last.frame)

    def _follow(self, last: Sample, sample: Sample) -> None:
        if sample.epoch == last.epoch:
            missing = sample.frame - last.frame
            silent_for = missing * self.info.frame_s
            if is_bridged(silent_for, self.info.frame_s):
                self._bridge(last, sample, missing, silent_for)
                return
        else:
            silent_for = max(sample.time - last.time, self.info.frame_s)  # clocks are fitted anew, and step back
        self.run += 1
        known = math.isfinite(last.orientation[0] + sample.orientation[0])
        if known and goes_on(self.info, sample.epoch == last.epoch, silent_for, self._offset_sigma()):
            self._bridge(last, sample, steps_across(silent_for, self.info.frame_s), silent_for)
            return
        self.group += 1
        self._begin(sample)

    def _begin(self, sample: Sample) -> None:
        """Start a new filter, whose heading is its own."""
        self._filter = open_estimator(self.estimator, self.info.frame_s, self._offset_sigma())
        self.speed = 0.0
        self._step((0.0, 0.0, 0.0), sample.acceleration, sample.orientation)

    def _bridge(self, last: Sample, sample: Sample, steps: int, elapsed: float) -> None:
        before = self.attitude
        x, y, z = self._turned(last, sample, elapsed)
        increment = (x / steps, y / steps, z / steps)
        for _ in range(steps - 1):
            self._step(increment, MISSING_VECTOR, MISSING_QUATERNION)
        self._step(increment, sample.acceleration, sample.orientation)
        turned = single.to_rotation_vector(single.multiply(single.inverse(before), self.attitude))
        self.speed = math.hypot(*turned) / elapsed

    def _turned(self, last: Sample, sample: Sample, elapsed: float) -> Vector:
        """Return the rotation vector since the last sample, rad, corrected as wanted."""
        by_wire = uses_wire_quaternions(self.info)
        is_one_run = sample.epoch == last.epoch and is_bridged(elapsed, self.info.frame_s)
        if by_wire or not is_one_run:
            raw = single.to_rotation_vector(single.multiply(single.inverse(last.orientation), sample.orientation))
        elif self.info.has_rate:
            a, b, half = last.rate, sample.rate, 0.5 * elapsed
            raw = ((a[0] + b[0]) * half, (a[1] + b[1]) * half, (a[2] + b[2]) * half)
        else:
            return (0.0, 0.0, 0.0)
        calibration = self._in_force()
        if calibration is None or not (by_wire or is_one_run):  # a filter on the device corrects by itself
            return raw
        applied = self.info.correction if by_wire else None
        x, y, z = recorrect(np.array([raw]), elapsed, applied, calibration.correction)[0].tolist()
        return (x, y, z)

    def _in_force(self) -> Calibration | None:
        return None if self._calibration is None else in_force(self.info, self._flags, self._calibration)

    def _offset_sigma(self) -> float:
        return prior_offset_sigma(self.info, self._flags, self._in_force())

    def _step(self, increment: Vector, force: Vector, device: Quaternion) -> None:
        self._increment[:] = increment
        self._force[:] = force
        self._device[:] = device
        w, x, y, z = self._filter.step(self._increment, self._force, self._device).tolist()
        self.attitude = (w, x, y, z)
