"""The strap rule: how a tag sits on each place when it was put on as the pictures show (contracts §3c).

It stands in for a heading that nothing measured, and is worth ``STRAP_SIGMA``. The same rule, with its words
for people, is ``resources/places.json``.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from studio.core import rotation
from studio.core.attitude.gyro_only import levelling
from studio.core.body import PLACES, REFERENCE_POSES, SEGMENT_OF, Place, reference_pose
from studio.core.frames import UP
from studio.core.hold import hold_all
from studio.core.take import Mark
from studio.core.track import SensorTrack

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


def level_by_straps(
    worn: Mapping[Place, SensorTrack], poses: Sequence[Mark], take_s: float
) -> dict[Place, SensorTrack]:
    """Return the tracks with world z upwards, where only the strap rule and a held pose tell what is up.

    A sensor that sends neither acceleration nor an orientation of its own knows how it turned and nothing more.
    What of it lies in no hold stays as it is, and so do all sensors that feel gravity.
    """
    levelled = dict(worn)
    for mark in poses:
        if mark.label not in REFERENCE_POSES:
            continue
        for place, hold in hold_all(worn, mark, take_s, required=False).items():
            if hold.levelled or not hold.is_still():
                continue
            up_in_segment = rotation.rotate(rotation.inverse(reference_pose(mark.label)[SEGMENT_OF[place]]), UP)
            believed_up = rotation.rotate(hold.attitude, rotation.rotate(strap_rule()[place], up_in_segment))
            track = levelled[place]
            turned = rotation.multiply(levelling(believed_up), worn[place].attitude)
            in_group = (track.group == hold.group)[:, None]
            levelled[place] = replace(
                track, attitude=np.where(in_group, turned, track.attitude), levelled=track.levelled | in_group[:, 0]
            )
    return levelled
