"""Paper 003: the gyroscope alone, relative to a start that is levelled once."""

import math

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.frames import UP
from studio.core.rest import RATE_SPREAD_WORN, find_rest
from studio.core.runs import Run

LEVEL_TIME = 1.0  # s; live, the first second levels the start frame


class GyroOnly:
    """Integrated turning; the accelerometer serves once, to level the start frame at rest (contracts §4)."""

    def __init__(self, frame_s: float, offset_sigma: float) -> None:
        """Begin before the first frame.

        Parameters
        ----------
        frame_s : s, from one step to the next
        offset_sigma : rad/s, standard uncertainty of what is left of the gyroscope's offset; nothing here corrects it
        """
        self._frame_s = frame_s
        self._start_from_sensor = rotation.IDENTITY
        self._level_frames = math.ceil(LEVEL_TIME / frame_s)
        self._up_in_start = np.zeros(3)
        self._world_from_start = rotation.IDENTITY

    def step(
        self, increment: NDArray[np.float64], acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Advance by one frame."""
        self._start_from_sensor = rotation.multiply(self._start_from_sensor, rotation.from_rotation_vector(increment))
        if self._level_frames > 0 and math.isfinite(acceleration[0]):
            self._level_frames -= 1
            self._up_in_start = self._up_in_start + rotation.rotate(self._start_from_sensor, acceleration)
            self._world_from_start = levelling(self._up_in_start)
        return rotation.multiply(self._world_from_start, self._start_from_sensor)

    def forget_offset(self, offset_sigma: float) -> None:
        """Go on: no offset was learned."""

    def learned_offset(self) -> None:
        """Return None: no offset is looked for."""

    def run(self, run: Run) -> NDArray[np.float64]:
        """Return the integral, levelled over the stillest stretch of the run (its first second when none is still)."""
        start_from_sensor = cumulative_product(rotation.from_rotation_vector(run.increments))
        return rotation.multiply(levelling(up_in_start(run, start_from_sensor, self._frame_s)), start_from_sensor)


def up_in_start(run: Run, start_from_sensor: NDArray[np.float64], frame_s: float) -> NDArray[np.float64]:
    """Return the summed specific force (3,) at rest, in the frame in which the run started."""
    rest = find_rest(run.increments / frame_s, run.acceleration, frame_s, RATE_SPREAD_WORN)
    still = slice(0, math.ceil(LEVEL_TIME / frame_s)) if rest is None else slice(rest.first, rest.last)
    force = run.acceleration[still]
    known = np.isfinite(force).all(axis=1)
    return np.asarray(rotation.rotate(start_from_sensor[still][known], force[known]).sum(axis=0))


def levelling(up: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest rotation (4,) that turns the direction ``up`` (3,) to world z; identity for NaN or zero."""
    length = float(np.linalg.norm(up))
    if not length > 0:
        return rotation.IDENTITY
    direction = up / length
    axis = np.cross(direction, UP)
    sine = float(np.linalg.norm(axis))
    angle = math.atan2(sine, float(direction[2]))
    axis = axis / sine if sine > rotation.SMALL_ANGLE else np.array([1.0, 0.0, 0.0])
    return rotation.from_rotation_vector(axis * angle)


def cumulative_product(steps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the running products q0, q0 q1, q0 q1 q2, … (n, 4) of unit quaternions.

    In about sqrt(n) vectorised products: blocks side by side, then the blocks one after the other.
    """
    count = len(steps)
    length = max(1, math.isqrt(count))
    blocks = -(-count // length)
    padded = np.concatenate([steps, np.tile(rotation.IDENTITY, (blocks * length - count, 1))]).reshape(
        blocks, length, 4
    )
    for column in range(1, length):
        padded[:, column] = rotation.multiply(padded[:, column - 1], padded[:, column])
    before = rotation.IDENTITY
    for block in padded:
        block[:] = rotation.multiply(before, block)
        before = rotation.normalise(block[-1])
    return rotation.normalise(padded.reshape(-1, 4)[:count])
