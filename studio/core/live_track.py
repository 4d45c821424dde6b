"""One sensor's attitude while it is sending: the live twin of ``runs`` and ``track``."""

import math

import numpy as np

from studio.core import single_rotation as single
from studio.core.attitude import open_estimator
from studio.core.runs import LONGEST_BRIDGE, recorrect, uses_wire_quaternions
from studio.core.sample import MISSING_QUATERNION, MISSING_VECTOR, Quaternion, Sample, SensorInfo, Vector
from studio.core.take import Calibration
from studio.core.track import CARRY_AFTER, LARGEST_CARRY, estimator_for, prior_offset_sigma, wanted_correction


class LiveTrack:
    """Steps an estimator through the samples of one sensor as they arrive, bridging short gaps."""

    def __init__(self, info: SensorInfo, wanted: str, calibration: Calibration | None) -> None:
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
        self._corrected_anew = False
        self._carry: Quaternion | None = None
        self._settling = 0
        self._turn = single.IDENTITY
        self._increment = np.zeros(3)
        self._force = np.zeros(3)
        self._device = np.zeros(4)

    def recalibrate(self, calibration: Calibration) -> None:
        """Correct the sensor anew: the next sample begins a run, because the filter has learned the old offset."""
        self._calibration = calibration
        self._corrected_anew = self.last is not None

    def push(self, sample: Sample) -> bool:
        """Take the next sample; False when it tells nothing about turning, or comes too late to be stepped."""
        by_rate = self.info.has_rate and not uses_wire_quaternions(self.info)
        if not math.isfinite(sample.rate[0] if by_rate else sample.orientation[0]):
            return False
        last = self.last
        if (
            last is None
            or self._corrected_anew
            or sample.epoch != last.epoch
            or (sample.frame - last.frame) * self.info.frame_s > LONGEST_BRIDGE
        ):
            self._begin(last, sample)
        elif sample.frame <= last.frame:
            return False
        else:
            self._bridge(last, sample)
        self.last = sample
        return True

    def _begin(self, last: Sample | None, sample: Sample) -> None:
        """Start a new run; its heading is carried over where the device's quaternion tells."""
        self._carry, self._corrected_anew = None, False
        if last is not None:
            self.run += 1
            gap = (sample.frame - last.frame) * self.info.frame_s
            sure = prior_offset_sigma(self.info, sample.flags, self._calibration) * gap <= LARGEST_CARRY
            if (sample.epoch == last.epoch and sure) or self.info.common_world:
                carry = single.multiply(self.attitude, single.inverse(last.orientation))
                self._carry = carry if math.isfinite(carry[0] + sample.orientation[0]) else None
            if self._carry is None:
                self.group += 1
        self._settling = round(CARRY_AFTER / self.info.frame_s) + 1
        self._turn = single.IDENTITY
        sigma = prior_offset_sigma(self.info, sample.flags, self._calibration)
        self._filter = open_estimator(self.estimator, self.info.frame_s, sigma)
        self.speed = 0.0
        self._step((0.0, 0.0, 0.0), sample.acceleration, sample.orientation)

    def _bridge(self, last: Sample, sample: Sample) -> None:
        before = self.attitude
        missing = sample.frame - last.frame
        x, y, z = self._turned(last, sample, missing * self.info.frame_s)
        increment = (x / missing, y / missing, z / missing)
        for _ in range(missing - 1):
            self._step(increment, MISSING_VECTOR, MISSING_QUATERNION)
        self._step(increment, sample.acceleration, sample.orientation)
        turned = single.to_rotation_vector(single.multiply(single.inverse(before), self.attitude))
        self.speed = math.hypot(*turned) / (missing * self.info.frame_s)

    def _turned(self, last: Sample, sample: Sample, elapsed: float) -> Vector:
        """Return the rotation vector since the last sample, rad, corrected as wanted."""
        if uses_wire_quaternions(self.info):
            raw = single.to_rotation_vector(single.multiply(single.inverse(last.orientation), sample.orientation))
            applied = self.info.correction
        elif self.info.has_rate:
            a, b, half = last.rate, sample.rate, 0.5 * elapsed
            raw, applied = ((a[0] + b[0]) * half, (a[1] + b[1]) * half, (a[2] + b[2]) * half), None
        else:
            return (0.0, 0.0, 0.0)
        wanted = wanted_correction(self._calibration)
        if wanted is None:
            return raw
        x, y, z = recorrect(np.array([raw]), elapsed, applied, wanted)[0].tolist()
        return (x, y, z)

    def _step(self, increment: Vector, force: Vector, device: Quaternion) -> None:
        self._increment[:] = increment
        self._force[:] = force
        self._device[:] = device
        w, x, y, z = self._filter.step(self._increment, self._force, self._device).tolist()
        estimate = (w, x, y, z)
        if self._settling > 0:
            self._settling -= 1
            if self._carry is not None and math.isfinite(device[0]):
                expected = single.multiply(self._carry, device)
                self._turn = single.about_up(single.heading(single.multiply(expected, single.inverse(estimate))))
        self.attitude = estimate if self._carry is None else single.multiply(self._turn, estimate)
