"""Joint angles with the names and signs a clinician reads, out of a motion.

Segment axes are x forward, y up along the bone, z right on both sides; a joint is
``parent_from_child``. The signs of the table below are those of the right side; the left is mirrored
on x and y, so that flexion, adduction, internal rotation and pronation are positive on both sides.
Sequences are intrinsic; Z-X'-Y'' is the joint coordinate system of Grood and Suntay (1983).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.core import body, euler, frames, rotation
from studio.core.body import MEASURED_PARENT, SEGMENT_OF, Place
from studio.core.pose import Motion

Array = NDArray[np.float64]
Side = Literal["left", "right", ""]

PLANE_UNDEFINED_BELOW = np.radians(15.0)  # elevation; nearer to hanging, noise of 1 degree makes 4 of the plane
UNDEFINED_ABOVE = np.radians(165.0)  # elevation; overhead neither plane nor axial rotation can be told apart

# Turns forearm and hand axes of N-pose (palms to the thighs, x towards the thumb) into those of the
# anatomical position (x out of the palm), in which the wrist's angles are defined.
_SEGMENT_FROM_PALM: dict[Side, Array] = {
    "right": rotation.about(1, np.pi / 2),
    "left": rotation.about(1, -np.pi / 2),
}


@dataclass(frozen=True)
class JointAngle:
    """One angle over time."""

    name: str
    """snake_case with the side first, e.g. ``left_knee_flexion``."""
    values: Array
    """(n,), rad; NaN where a sensor of the joint was not measured or the angle does not exist."""
    positive: str
    """What a positive value means."""
    sequence: str
    """``ZXY`` or how else the angle is taken."""
    low_confidence: bool
    """Below what body-worn sensors can tell: soft tissue and alignment are as large as the angle."""


@dataclass(frozen=True)
class _Line:
    """An angle about one axis of the sequence a joint is taken apart in."""

    name: str
    axis: Literal["Z", "X", "Y"]
    sign: float
    """On the right."""
    positive: str
    low_confidence: bool = False


_HIP = (
    _Line("hip_flexion", "Z", 1, "thigh forward"),
    _Line("hip_adduction", "X", 1, "thigh towards the midline"),
    _Line("hip_internal_rotation", "Y", 1, "thigh turned inwards"),
)
_KNEE = (
    _Line("knee_flexion", "Z", -1, "shank backward"),
    _Line("knee_varus", "X", 1, "shank towards the midline", low_confidence=True),
    _Line("knee_internal_rotation", "Y", 1, "shank turned inwards", low_confidence=True),
)
_ANKLE = (
    _Line("ankle_dorsiflexion", "Z", 1, "toes up"),
    _Line("ankle_inversion", "X", 1, "sole towards the midline"),
    _Line("ankle_internal_rotation", "Y", 1, "toes inwards"),
)
_ELBOW = (
    _Line("elbow_flexion", "Z", 1, "forearm forward"),
    _Line("elbow_carrying_angle", "X", -1, "forearm away from the midline (valgus)", low_confidence=True),
    _Line("elbow_pronation", "Y", 1, "palm backward, from the palm at the thigh"),
)
_WRIST = (
    _Line("wrist_flexion", "Z", 1, "palm towards the forearm"),
    _Line("wrist_ulnar_deviation", "X", 1, "little finger towards the forearm"),
)
_TRUNK = (
    _Line("trunk_flexion", "Z", -1, "chest forward of the pelvis"),
    _Line("trunk_right_bending", "X", 1, "chest to the right"),
    _Line("trunk_left_rotation", "Y", 1, "chest turned to the left"),
)
_PELVIS = (
    _Line("pelvis_tilt", "Z", 1, "top of the pelvis backward (posterior)"),
    _Line("pelvis_list", "X", 1, "top of the pelvis to the right"),
    _Line("pelvis_rotation", "Y", 1, "turned to the left"),
)

_JOINTS: dict[Place, tuple[Side, tuple[_Line, ...]]] = {
    Place.CHEST: ("", _TRUNK),
    Place.LEFT_THIGH: ("left", _HIP),
    Place.RIGHT_THIGH: ("right", _HIP),
    Place.LEFT_SHANK: ("left", _KNEE),
    Place.RIGHT_SHANK: ("right", _KNEE),
    Place.LEFT_FOOT: ("left", _ANKLE),
    Place.RIGHT_FOOT: ("right", _ANKLE),
    Place.LEFT_FOREARM: ("left", _ELBOW),
    Place.RIGHT_FOREARM: ("right", _ELBOW),
    Place.LEFT_HAND: ("left", _WRIST),
    Place.RIGHT_HAND: ("right", _WRIST),
}
"""By the joint's child; the parent is ``MEASURED_PARENT``."""

_SHOULDERS: dict[Place, Side] = {Place.LEFT_UPPER_ARM: "left", Place.RIGHT_UPPER_ARM: "right"}


def joint_angles(motion: Motion) -> tuple[JointAngle, ...]:
    """Return the angles of every joint whose two sensors are worn, in the order pelvis, trunk, legs, arms.

    Notes
    -----
    The pelvis is taken against the world as Y-X'-Z'': heading first, so that tilt and list keep their
    meaning when the wearer turns round. In OpenSim's Z-X'-Y'' a lean forwards of 10 degrees would read
    as tilt -10 at heading 0, as list at 90 and as tilt +10 at 180; at heading 0 both agree.

    Angles run on without jumps at ±180 degrees while the sensors are measured and begin anew, within
    ±180, after a gap: how often someone turned meanwhile cannot be known.
    """
    return tuple(_angles(motion))


def _angles(motion: Motion) -> Iterator[JointAngle]:
    if Place.PELVIS in motion.measured:
        pelvis = rotation.multiply(rotation.inverse(frames.N_POSE), motion.world_from_segment[:, body.Segment.Hips])
        yield from _taken_apart(pelvis, motion.measured[Place.PELVIS], "", _PELVIS, "YXZ")
    for place, (side, lines) in _JOINTS.items():
        if _is_worn(motion, place):
            yield from _taken_apart(_joint(motion, place, side), _both_measured(motion, place), side, lines)
    for place, side in _SHOULDERS.items():
        if _is_worn(motion, place):
            yield from _shoulder(_joint(motion, place, side), _both_measured(motion, place), side)


def _is_worn(motion: Motion, place: Place) -> bool:
    return place in motion.measured and MEASURED_PARENT[place] in motion.measured


def _both_measured(motion: Motion, place: Place) -> NDArray[np.bool_]:
    return motion.measured[place] & motion.measured[MEASURED_PARENT[place]]


def _joint(motion: Motion, place: Place, side: Side) -> Array:
    """Return ``parent_from_child`` (n, 4); of the wrist in the axes of the palm."""
    turned = motion.parent_from_child(SEGMENT_OF[MEASURED_PARENT[place]], SEGMENT_OF[place])
    if place not in (Place.LEFT_HAND, Place.RIGHT_HAND):
        return turned
    palm = _SEGMENT_FROM_PALM[side]
    return rotation.multiply(rotation.multiply(rotation.inverse(palm), turned), palm)


def _taken_apart(
    parent_from_child: Array,
    measured: NDArray[np.bool_],
    side: Side,
    lines: tuple[_Line, ...],
    sequence: str = "ZXY",
) -> Iterator[JointAngle]:
    angles = np.full((len(measured), 3), np.nan)
    for run in _runs(measured):
        angles[run] = euler.unwrap_continuous(euler.to_euler(parent_from_child[run], sequence), sequence)
    for line in lines:
        mirrored = side == "left" and line.axis != "Z"
        values = angles[:, sequence.index(line.axis)] * (-line.sign if mirrored else line.sign)
        yield JointAngle(_named(side, line.name), values, line.positive, sequence, line.low_confidence)


def _shoulder(chest_from_arm: Array, measured: NDArray[np.bool_], side: Side) -> Iterator[JointAngle]:
    """Yield the arm's direction and its turning about itself.

    No sequence of three axes serves a whole arm: Z-X'-Y'' is singular at 90 degrees of abduction (the
    T-pose), Y-X'-Y'' with the arm hanging (the N-pose). The angle between the two y axes is not, and
    swing-twist keeps the axial rotation within 1.4 times the sensors' noise up to 90 degrees.
    """
    mirror = -1.0 if side == "left" else 1.0
    down_the_arm = rotation.rotate(chest_from_arm, np.array([0.0, -1.0, 0.0]))
    forward, below, outward = down_the_arm[:, 0], -down_the_arm[:, 1], mirror * down_the_arm[:, 2]
    elevation = np.arctan2(np.hypot(forward, outward), below)
    plane = np.arctan2(forward, outward)
    axial = mirror * euler.wrap(rotation.twist_about(chest_from_arm, 1))
    overhead = elevation > UNDEFINED_ABOVE
    known = measured & ~overhead
    yield JointAngle(
        _named(side, "shoulder_elevation"),
        np.where(measured, elevation, np.nan),
        "arm away from hanging; 180 is overhead",
        "angle between the long axes of chest and arm",
        low_confidence=False,
    )
    yield JointAngle(
        _named(side, "shoulder_plane_of_elevation"),
        _running_on(np.where(known & (elevation >= PLANE_UNDEFINED_BELOW), plane, np.nan)),
        "forward of sideways; 0 is sideways, 90 forward",
        "direction of the arm in the chest's transverse plane; empty below 15 and above 165 degrees of elevation",
        low_confidence=False,
    )
    yield JointAngle(
        _named(side, "shoulder_axial_rotation"),
        _running_on(np.where(known, axial, np.nan)),
        "turned inwards",
        "twist about the arm after the shortest swing; empty above 165 degrees of elevation",
        low_confidence=False,
    )


def _running_on(angle: Array) -> Array:
    """Return (n,) in rad without jumps of whole turns within each run of finite values."""
    out = angle.copy()
    for run in _runs(np.isfinite(angle)):
        out[run] = np.unwrap(angle[run])
    return out


def _runs(known: NDArray[np.bool_]) -> list[slice]:
    """Return the stretches in which ``known`` (n,) is True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], known, [False]]).astype(np.int8)))
    return [slice(start, stop) for start, stop in edges.reshape(-1, 2)]


def _named(side: Side, name: str) -> str:
    return f"{side}_{name}" if side else name
