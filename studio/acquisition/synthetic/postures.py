"""Joint angles of named postures, and smooth ways into and out of them.

Angles are written as a clinician says them: flexion, adduction, internal rotation (and dorsiflexion,
pronation, ulnar deviation) positive on both sides, trunk and head flexion positive forwards. ``ANGLE_SIGNS``
turns them into the signed angles about segment axes of biomechanics-and-formats, section 2.1.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.body import PLACES, Place

Array = NDArray[np.float64]

JOINT_PLACES: dict[str, tuple[Place, ...]] = {
    "pelvis": (Place.PELVIS,),
    "trunk": (Place.CHEST,),
    "neck": (Place.HEAD,),
    "shoulder": (Place.LEFT_UPPER_ARM, Place.RIGHT_UPPER_ARM),
    "elbow": (Place.LEFT_FOREARM, Place.RIGHT_FOREARM),
    "wrist": (Place.LEFT_HAND, Place.RIGHT_HAND),
    "hip": (Place.LEFT_THIGH, Place.RIGHT_THIGH),
    "knee": (Place.LEFT_SHANK, Place.RIGHT_SHANK),
    "ankle": (Place.LEFT_FOOT, Place.RIGHT_FOOT),
}
"""Each joint by the place of the segment beyond it, left before right."""

FLEXES_BACKWARDS = ("pelvis", "trunk", "neck", "knee")
"""Joints whose flexion turns about -z of the segment (forward tilt of pelvis, trunk and head; the knee)."""


def _angle_signs() -> Array:
    signs = np.ones((len(PLACES), 3))
    for joint, places in JOINT_PLACES.items():
        for place in places:
            mirrored = -1.0 if place.value.startswith("left_") else 1.0
            signs[PLACES.index(place)] = (mirrored, mirrored, -1.0 if joint in FLEXES_BACKWARDS else 1.0)
    return signs


ANGLE_SIGNS: Array = _angle_signs()
"""(15, 3), from clinical (adduction, internal rotation, flexion) to angles about x, y, z of the segment."""
ANGLE_SIGNS.flags.writeable = False

JointAngles = tuple[float, float, float]
"""Degrees: flexion, adduction, internal rotation."""


def posture(joints: Mapping[str, JointAngles]) -> Array:
    """Return the angles of one posture, (15, 3), rad, about x, y, z of the segment, rows in the order of ``PLACES``.

    Parameters
    ----------
    joints : names of ``JOINT_PLACES`` for both sides, or with ``left_`` or ``right_`` in front for one
    """
    clinical = np.zeros((len(PLACES), 3))
    for name, (flexion, adduction, rotation) in joints.items():
        side, _, joint = name.rpartition("_")
        for place in JOINT_PLACES[joint]:
            if place.value.startswith(side):
                clinical[PLACES.index(place)] = (adduction, rotation, flexion)
    return np.deg2rad(clinical) * ANGLE_SIGNS


def smooth_step(x: Array) -> Array:
    """Return 0 before 0, 1 after 1 and the quintic between: twice continuously differentiable."""
    y = np.clip(x, 0.0, 1.0)
    return np.asarray(y * y * y * (10.0 + y * (6.0 * y - 15.0)))


def smooth_step_integral(x: Array) -> Array:
    """Return the integral of ``smooth_step`` from 0 to x."""
    y = np.clip(x, 0.0, 1.0)
    return np.asarray(y**4 * (2.5 + y * (y - 3.0)) + np.maximum(x - 1.0, 0.0))


@dataclass(frozen=True, slots=True)
class Excursion:
    """A posture that is entered, held and left."""

    angles: Array
    """(15, 3), rad."""
    start: float
    """s, when the way into it begins."""
    rise: float
    """s, how long the way in takes."""
    leave: float
    """s, when the way back begins."""
    fall: float
    """s, how long the way back takes."""

    def share(self, times: Array) -> Array:
        """Return how much of the posture is taken, 0…1, (n,)."""
        into = smooth_step((times - self.start) / self.rise)
        return np.asarray(into - smooth_step((times - self.leave) / self.fall))
