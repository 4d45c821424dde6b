"""The strap rule: how a tag sits on each place when it was put on as the pictures show (contracts §3c).

It stands in for a heading that nothing measured, and is worth ``STRAP_SIGMA``. The same rule, with its words
for people, is ``resources/places.json``.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from studio.core import rotation
from studio.core.body import PLACES, Place

STRAP_SIGMA = math.radians(15)  # rad, about any axis; what a strap put on by eye is worth (contracts §3c)

_AXES = {
    f"{sign}{name}": (1.0 if sign == "+" else -1.0) * axis
    for name, axis in zip("xyz", np.eye(3), strict=True)
    for sign in "+-"
}


class Strap(NamedTuple):
    """Where arrow and face of a tag point, as signed segment axes (x forward, y up, z right)."""

    arrow: str
    """Sensor x."""
    face: str
    """Sensor z."""


STRAPS: Mapping[Place, Strap] = {
    Place.HEAD: Strap("+y", "+x"),
    Place.CHEST: Strap("+y", "+x"),
    Place.LEFT_UPPER_ARM: Strap("+y", "-z"),
    Place.RIGHT_UPPER_ARM: Strap("+y", "+z"),
    Place.LEFT_FOREARM: Strap("+y", "-z"),
    Place.RIGHT_FOREARM: Strap("+y", "+z"),
    Place.LEFT_HAND: Strap("+y", "-z"),
    Place.RIGHT_HAND: Strap("+y", "+z"),
    Place.PELVIS: Strap("+y", "-x"),
    Place.LEFT_THIGH: Strap("+y", "+x"),
    Place.RIGHT_THIGH: Strap("+y", "+x"),
    Place.LEFT_SHANK: Strap("+y", "+x"),
    Place.RIGHT_SHANK: Strap("+y", "+x"),
    Place.LEFT_FOOT: Strap("+x", "+y"),
    Place.RIGHT_FOOT: Strap("+x", "+y"),
}
"""Arrow towards the head (feet: towards the toes) with the body in N-pose; faces outwards."""


def strap_rule() -> dict[Place, rotation.Array]:
    """Return ``sensor_from_segment`` (4,) of a tag on each place."""
    rule = {}
    for place in PLACES:
        arrow, face = _AXES[STRAPS[place].arrow], _AXES[STRAPS[place].face]
        # Rows are the sensor's axes in segment axes; the sensor is right-handed, so y = z × x.
        rule[place] = rotation.from_matrix(np.stack([arrow, np.cross(face, arrow), face]))
    return rule
