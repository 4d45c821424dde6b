"""From the measured segments to all 23: what is not measured follows stated rules (contracts §5).

Spine, Spine1, Spine2 lie at 1/4, 1/2, 3/4 between Hips and Spine3. Without a pelvis sensor the Hips take
the chest's heading and stay upright; without a chest sensor the trunk is rigid with the Hips. Any other
segment without a sensor is rigid with its nearest measured ancestor as in the reference pose.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core import frames, rotation
from studio.core.body import SEGMENT_OF, SEGMENTS, Place, Segment, measured_ancestor, reference_pose

_SPINE = [Segment.Spine, Segment.Spine1, Segment.Spine2]
_SPINE_FRACTION = np.array([0.25, 0.5, 0.75])


class FullBody:
    """The rules for one set of measured places, prepared once and applied to any number of poses."""

    def __init__(self, places: Sequence[Place], pose: str) -> None:
        """Prepare for sensors on ``places``, in this order, aligned in the reference pose called ``pose``."""
        reference = reference_pose(pose)
        self._segments = [int(SEGMENT_OF[place]) for place in places]
        measured = [segment in self._segments for segment in range(SEGMENTS)]
        self._chest = self._segments.index(Segment.Spine3) if measured[Segment.Spine3] else None
        self._hips_measured = measured[Segment.Hips]
        self._ancestor = [max(measured_ancestor(segment, measured), 0) for segment in range(SEGMENTS)]
        self._ancestor_from_segment = rotation.multiply(rotation.inverse(reference[self._ancestor]), reference)

    def complete(self, measured: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ``world_from_segment`` (..., 23, 4) for the measured places' (..., places, 4)."""
        known = np.empty((*measured.shape[:-2], SEGMENTS, 4))
        known[..., self._segments, :] = measured
        if not self._hips_measured:
            known[..., 0, :] = self._upright_hips(measured)
        world = rotation.multiply(known[..., self._ancestor, :], self._ancestor_from_segment)
        if self._chest is not None:
            hips, chest = world[..., :1, :], world[..., Segment.Spine3 : Segment.Spine3 + 1, :]
            world[..., _SPINE, :] = rotation.slerp(hips, chest, _SPINE_FRACTION)
        return world

    def _upright_hips(self, measured: NDArray[np.float64]) -> NDArray[np.float64]:
        if self._chest is None:
            return frames.N_POSE
        since_hold = rotation.multiply(measured[..., self._chest, :], rotation.inverse(frames.N_POSE))
        return rotation.multiply(rotation.about(2, rotation.twist_about(since_hold, 2)), frames.N_POSE)
