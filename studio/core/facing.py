"""Which way the wearer faced, when the sensors share a heading that is not the wearer's.

Knees bend backwards and elbows forwards, both about the left-right axis: the summed bending of all hinges
since the hold points left, and facing is a quarter turn to the right of it.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Place
from studio.core.track import SensorTrack, attitude_at

SMALLEST_BENDING = math.radians(20.0)  # of the hinge that bends most; below it the direction is noise
RATE = 10.0  # Hz; bending is slow

# Parent, child, and the way the joint bends about the right axis (biomechanics-and-formats §2.1)
_HINGES = (
    (Place.LEFT_THIGH, Place.LEFT_SHANK, -1.0),
    (Place.RIGHT_THIGH, Place.RIGHT_SHANK, -1.0),
    (Place.LEFT_UPPER_ARM, Place.LEFT_FOREARM, 1.0),
    (Place.RIGHT_UPPER_ARM, Place.RIGHT_FOREARM, 1.0),
)


def facing_from_hinges(
    worn: Mapping[Place, SensorTrack], turns: Mapping[Place, float], reference_s: float
) -> float | None:
    """Return the heading of the wearer's forward direction in the common world, rad; None when no hinge bends enough.

    Parameters
    ----------
    turns : mapping
        rad, turns each track's own heading into the common one about z.
    reference_s : float, s
        When the wearer stood straight.
    """
    left = np.zeros(3)
    for parent, child, direction in _HINGES:
        if parent in worn and child in worn:
            left += _bending(worn[parent], turns[parent], worn[child], turns[child], reference_s) * -direction
    if not np.hypot(left[0], left[1]) > 0:
        return None
    return math.atan2(float(left[1]), float(left[0])) - math.pi / 2


def _bending(
    parent: SensorTrack, parent_turn: float, child: SensorTrack, child_turn: float, reference_s: float
) -> NDArray[np.float64]:
    """Return a joint's weighted mean rotation vector (3,) since the reference, common world axes; zero when it hardly
    bends."""
    start, stop = max(parent.time[0], child.time[0]), min(parent.time[-1], child.time[-1])
    time = np.concatenate([[reference_s], np.arange(start, stop, 1 / RATE)])

    def moved(track: SensorTrack, turn: float) -> NDArray[np.float64]:
        headed = rotation.multiply(rotation.about(2, turn), attitude_at(track, time))
        return rotation.multiply(headed[1:], rotation.inverse(headed[0]))

    bent = rotation.to_rotation_vector(
        rotation.multiply(rotation.inverse(moved(parent, parent_turn)), moved(child, child_turn))
    )
    angle = np.linalg.norm(bent, axis=1)
    if len(angle) == 0 or angle.max() < SMALLEST_BENDING:
        return np.zeros(3)
    return np.asarray((bent * angle[:, None]).mean(axis=0))
