"""Where the stage gets its bodies from when a take is looked at."""

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Place, Skeleton
from studio.core.pose import Motion
from studio.ui.models.stage_pose import StagePose

BRIDGE = 0.1  # s; frames further apart are not blended, because nobody knows how the body came from one to the other
PATH_POINTS = 600  # a path across a screen of 1280 px has a point every 2 px


class PoseSource(Protocol):
    """Bodies over time."""

    @property
    def skeleton(self) -> Skeleton:
        """Lengths of the body."""
        ...

    def pose_at(self, time: float) -> StagePose | None:
        """Return the body at a time, s; the same object as long as nothing of it changes."""
        ...

    def window(self, from_s: float, to_s: float) -> NDArray[np.float64]:
        """Return the path the hips went on the floor between two times, (n, 2), m, world."""
        ...


class MotionSource:
    """The poses of a motion; nothing is computed before it is asked for."""

    def __init__(self, motion: Motion, words: Mapping[Place, str]) -> None:
        """``words`` are the names of the places, shown beside limbs whose sensor is silent."""
        self._motion = motion
        self._words = words
        self._shown: tuple[int, float] | None = None
        self._pose: StagePose | None = None

    @property
    def skeleton(self) -> Skeleton:
        """Lengths of the body."""
        return self._motion.skeleton

    def pose_at(self, time: float) -> StagePose | None:
        """Return the body at a time, s: between two frames along the shortest way."""
        motion = self._motion
        if not len(motion):
            return None
        row, share = self._between(time)
        if (row, share) != self._shown:
            self._shown = (row, share)
            self._pose = self._blended(row, share)
        return self._pose

    def window(self, from_s: float, to_s: float) -> NDArray[np.float64]:
        """Return the path the hips went on the floor between two times, (n, 2), m, world."""
        first, after = np.searchsorted(self._motion.time, [from_s, to_s + self._motion.frame_s / 2])
        every = max(-(-int(after - first) // PATH_POINTS), 1)
        points = self._motion.hips[first:after:every, :2]
        return np.asarray(points[np.isfinite(points).all(axis=1)])

    def _between(self, time: float) -> tuple[int, float]:
        """Return a row and the share of the way to the next, 0…1."""
        times = self._motion.time
        after = int(np.searchsorted(times, time, side="right"))
        if after == 0:
            return 0, 0.0
        before = after - 1
        if after == len(times):
            return before, 0.0
        step = float(times[after] - times[before])
        if step > BRIDGE:
            return before, 0.0
        return before, float(time - times[before]) / step

    def _blended(self, row: int, share: float) -> StagePose:
        motion = self._motion
        world, hips = motion.world_from_segment[row], motion.hips[row]
        if share > 0.0:
            world = rotation.slerp(world, motion.world_from_segment[row + 1], np.full(len(world), share))
            hips = hips + (motion.hips[row + 1] - hips) * share
        nearest = row + (share > 0.5)
        measured = frozenset(place for place, known in motion.measured.items() if known[nearest])
        silent = {place: self._words.get(place, place.value) for place in motion.measured if place not in measured}
        return StagePose(world, motion.skeleton.joint_positions(world, hips), measured, silent)
