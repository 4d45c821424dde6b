"""Tags that nobody wears: on a table, or all in one box that is turned for the calibration of their gyroscopes."""

import math

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.body_truth import Carried
from studio.acquisition.synthetic.postures import smooth_step
from studio.core import frames, rotation
from studio.core.body import PLACES, SEGMENTS

Array = NDArray[np.float64]

TABLE_HEIGHT = 0.75  # m

TURN_AXES = 12  # spread over the half sphere; nine determine the six coefficients well (accuracy.md, section 2)
FIRST_REST = 10.0  # s, for the offsets
TURN_TIME = 2.5  # s for one whole turn: at most 270 °/s, well inside the range
REST_TIME = 3.0  # s between turns
STOP_ERROR = math.radians(1.0)  # rad, SD; how far from the whole turn a hand stops
WOBBLE = math.radians(2.0)  # rad, SD of each axis of the wobble in mid-turn


class Table:
    """All tags lie still."""

    def carried(self, times: Array) -> Carried:
        """Return carriers at rest; how each tag lies is its random mounting."""
        n, places = len(times), len(PLACES)
        position = np.zeros((n, places, 3))
        position[..., 0] = 0.1 * np.arange(places)
        position[..., 2] = TABLE_HEIGHT
        return Carried(np.tile(frames.N_POSE, (n, places, 1)), position, np.zeros((n, places)))

    def true_pose(self, times: Array) -> tuple[Array, Array]:
        """Return the N-pose: there is no body."""
        return np.tile(frames.N_POSE, (len(times), SEGMENTS, 1)), np.zeros((len(times), 3))


class TurnedBox:
    """A box of tags: rest, then whole turns about spread axes with rests between, again and again."""

    def __init__(self, generator: np.random.Generator) -> None:
        k = np.arange(TURN_AXES)
        # the golden spiral over the half sphere
        z = (k + 0.5) / TURN_AXES
        around = k * math.pi * (3.0 - math.sqrt(5.0))
        flat = np.sqrt(1.0 - z * z)
        self._axes = np.stack([flat * np.cos(around), flat * np.sin(around), z], axis=-1)
        self._generator = generator
        self._angles: list[float] = []
        self._wobbles: list[Array] = []
        self._rests: list[Array] = [np.array(frames.N_POSE)]
        """world_from_box before each turn."""

    def carried(self, times: Array) -> Carried:
        """Return the box 15 times: the tags are fixed in it, each its own way."""
        box = self._box(times)
        n, places = len(times), len(PLACES)
        position = np.zeros((n, places, 3))
        position[..., 2] = TABLE_HEIGHT
        return Carried(np.tile(box[:, None], (1, places, 1)), position, np.zeros((n, places)))

    def true_pose(self, times: Array) -> tuple[Array, Array]:
        """Return all segments turned like the box: there is no body."""
        return np.tile(self._box(times)[:, None], (1, SEGMENTS, 1)), np.zeros((len(times), 3))

    def _box(self, times: Array) -> Array:
        """Return world_from_box, (n, 4)."""
        since = times - FIRST_REST
        turn = np.maximum(np.floor(since / (TURN_TIME + REST_TIME)), 0.0).astype(np.int64)
        self._turn_until(int(turn.max(initial=0)))
        part = (since - turn * (TURN_TIME + REST_TIME)) / TURN_TIME
        share = smooth_step(part)
        inside = np.clip(part, 0.0, 1.0)
        bump = 64.0 * (inside * (1.0 - inside)) ** 3  # 0 at both ends with its first two derivatives, 1 in the middle
        angle = np.array(self._angles)[turn] * share
        turned = rotation.from_rotation_vector(self._axes[turn % TURN_AXES] * angle[:, None])
        wobbled = rotation.from_rotation_vector(np.array(self._wobbles)[turn] * bump[:, None])
        return rotation.multiply(rotation.multiply(np.array(self._rests)[turn], turned), wobbled)

    def _turn_until(self, last: int) -> None:
        while len(self._angles) <= last:
            axis = self._axes[len(self._angles) % TURN_AXES]
            angle = 2.0 * math.pi + float(self._generator.normal()) * STOP_ERROR
            self._angles.append(angle)
            self._wobbles.append(self._generator.normal(size=3) * WOBBLE)
            self._rests.append(rotation.multiply(self._rests[-1], rotation.from_rotation_vector(axis * angle)))
