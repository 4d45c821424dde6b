"""How each sensor sits on its segment and which way it faced, out of held poses (contracts §3).

Without a magnetometer every sensor's attitude has its own unknown heading, and one held pose gives three
equations for four unknowns. The fourth fact is taken in this order, and stored: a second hold (a bow, or
another reference pose: T-pose tells of the arms, sitting of the thighs), a common heading sent by the
source, the strap rule. Paper 002's bias quaternion ``Q_B = Q_IMU^-1 Q_R`` is the case in which the fourth
fact is "the heading is already right"; its two-sided form is
``world_from_segment = heading * world_from_sensor * sensor_from_segment``.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import ARMS, REFERENCE_POSES, SEGMENT_OF, Place, reference_pose
from studio.core.errors import AlignmentError, HeadingsUnknown, MovedDuringHold, NoSensorWorn, PoseMissing, PoseTooShort
from studio.core.facing import facing_from_hinges
from studio.core.frames import UP
from studio.core.hold import Hold, hold_all
from studio.core.plausibility import refuse_wrong_poses
from studio.core.sample import Quaternion, SensorId
from studio.core.strapping import STRAP_SIGMA, strap_rule
from studio.core.take import Alignment, Assignment, HeadingSource, LimbAlignment, Mark, Mounting, PoseName
from studio.core.track import SensorTrack

SMALLEST_BOW = math.radians(20.0)  # of tilt between the holds
BOW_AXIS_SIGMA = math.radians(1.5)  # joints are no perfect hinges: the bow itself is not purely sagittal
TILT_SIGMA = math.radians(0.5)  # accelerometer of 5-10 mg
COMMON_WORLD_SIGMA = math.radians(15.0)  # facing taken from the knees' and elbows' bending
TILT_MISSED = math.radians(30.0)  # arms half as high, or thighs half as level, as they should be
STRAP_CONTRADICTION = math.radians(45.0)  # gravity disagrees by more: the tag does not sit as the rule says

# The way each segment turns about its right axis in the bow: trunk, head, shanks and (heels lifted) feet
# tip forwards (negative), arms and thighs are lifted forwards (positive).
_LIFTED = frozenset({*ARMS, Place.LEFT_THIGH, Place.RIGHT_THIGH})

# What was measured is worth the same however it was; what a strap is said to do is worth less.
_WORTH: Mapping[HeadingSource, int] = {"bow": 2, "two poses": 2, "common world": 2, "strap rule": 1, "unknown": 0}

NO_MOUNTING: Quaternion = (1.0, 0.0, 0.0, 0.0)

_POSE_NAMES: dict[str, PoseName] = {"n": "n", "t": "t", "sit": "sit"}

Tracks = Mapping[SensorId, SensorTrack]


def align(
    tracks: Tracks, assignment: Assignment, poses: Sequence[Mark], mounting: Mounting, take_s: float
) -> Alignment:
    """Return the alignment of all assigned places.

    Parameters
    ----------
    poses : sequence of Mark
        Kind ``pose``, labels ``n``, ``t``, ``sit``, ``bow``. The reference is the first ``n`` in which nobody
        moved, else the first such ``t``, else ``sit``. Of other holds, each limb takes the last in which it was
        as still.
    take_s : float, s
        Length of the take, for the messages.

    Raises
    ------
    NoSensorWorn, PoseMissing, PoseTooShort, MovedDuringHold, PoseNotHeld
        No reference can be used; this is what was wrong with the last. HeadingsUnknown is not raised here: a
        limb without heading is ``unknown`` (see ``require_headings``).
    """
    worn = {place: tracks[sensor] for place, sensor in assignment.sensors.items() if sensor in tracks}
    if not worn:
        raise NoSensorWorn(len(tracks))
    reference, first = _usable_reference(worn, poses, take_s)
    pose = _POSE_NAMES[reference.label]
    others = {
        label: _usable_holds(worn, label, [mark for mark in poses if mark is not reference], take_s)
        for label in ("bow", *REFERENCE_POSES)
    }
    refuse_wrong_poses(reference.label, _felt(worn, first), _felt(worn, others["bow"]), mounting)
    facing = _common_facing(worn, first, reference)
    # Who was silent during the hold has no heading.
    limbs = {place: LimbAlignment(NO_MOUNTING, 0.0, "unknown", math.pi, 0.0) for place in worn}
    for place, hold in first.items():
        if not hold.levelled:
            continue
        elsewhere = {label: holds[place] for label, holds in others.items() if place in holds}
        limbs[place] = _align_limb(place, hold, reference.label, elsewhere, facing.get(place), mounting)
    return Alignment(pose, reference.time, reference.end, limbs)


def _felt(worn: Mapping[Place, SensorTrack], holds: Mapping[Place, Hold]) -> dict[Place, Hold]:
    """Return the holds of sensors that feel gravity."""
    return {place: hold for place, hold in holds.items() if worn[place].info.has_acceleration and hold.levelled}


def require_headings(alignment: Alignment) -> None:
    """Raise HeadingsUnknown when no limb's heading is known: then no joint angle means anything."""
    unknown = tuple(place.value for place, limb in alignment.limbs.items() if limb.source == "unknown")
    if len(unknown) == len(alignment.limbs):
        raise HeadingsUnknown(unknown)


def worse_limbs(fresh: Alignment, before: Alignment) -> set[Place]:
    """Return the limbs of which another alignment knew better how their sensor sits."""
    both = fresh.limbs.keys() & before.limbs.keys()
    return {place for place in both if _WORTH[fresh.limbs[place].source] < _WORTH[before.limbs[place].source]}


def reference_mark(poses: Sequence[Mark]) -> Mark | None:
    """Return the hold that fixes the body if nobody moved in it: the first N-pose, else T-pose, else sitting."""
    return next(iter(_reference_marks(poses)), None)


def _reference_marks(poses: Sequence[Mark]) -> list[Mark]:
    return [mark for label in REFERENCE_POSES for mark in poses if mark.label == label]


def _usable_reference(
    worn: Mapping[Place, SensorTrack], poses: Sequence[Mark], take_s: float
) -> tuple[Mark, dict[Place, Hold]]:
    """Return the first reference in which no limb moved: whoever was refused holds the pose again."""
    refusal: AlignmentError = PoseMissing(take_s)
    for mark in _reference_marks(poses):
        try:
            holds = hold_all(worn, mark, take_s)
        except PoseTooShort as too_short:
            refusal = too_short
            continue
        moved = _moved(holds)
        if not moved:
            return mark, holds
        refusal = MovedDuringHold(mark.label, tuple(place.value for place in moved), tuple(moved.values()))
    raise refusal


def _usable_holds(
    worn: Mapping[Place, SensorTrack], label: str, poses: Sequence[Mark], take_s: float
) -> dict[Place, Hold]:
    """Return for each limb the last hold of a pose in which it kept still."""
    usable: dict[Place, Hold] = {}
    for mark in poses:
        if mark.label == label:
            holds = hold_all(worn, mark, take_s, required=False)
            usable |= {place: hold for place, hold in holds.items() if hold.is_still()}
    return usable


def refused_holds(
    tracks: Tracks, assignment: Assignment, poses: Sequence[Mark], alignment: Alignment, take_s: float
) -> tuple[MovedDuringHold, ...]:
    """Return the holds that might have told the heading of a limb that has none, had it not moved in them."""
    worn = {place: tracks[sensor] for place, sensor in assignment.sensors.items() if sensor in tracks}
    unknown = {place for place, limb in alignment.limbs.items() if limb.source == "unknown"}
    refused = []
    for mark in poses:
        if unknown and (mark.time, mark.label) != (alignment.from_s, alignment.pose):
            holds = hold_all(worn, mark, take_s, required=False)
            moved = _moved({place: hold for place, hold in holds.items() if place in unknown})
            if moved:
                names = tuple(place.value for place in moved)
                refused.append(MovedDuringHold(mark.label, names, tuple(moved.values())))
    return tuple(refused)


def _moved(holds: Mapping[Place, Hold]) -> dict[Place, float]:
    """Return by how many degrees the limbs moved that were not still."""
    return {place: round(math.degrees(hold.largest), 1) for place, hold in holds.items() if not hold.is_still()}


def _common_facing(
    worn: Mapping[Place, SensorTrack], first: Mapping[Place, Hold], reference: Mark
) -> dict[Place, NDArray[np.float64]]:
    """Return for each sensor with a common heading its attitude (4,) at the hold, turned so that the wearer faces x."""
    common = {p: h for p, h in first.items() if worn[p].info.common_world and np.isfinite(h.device).all()}
    headed = {}
    for place, hold in common.items():
        turn = rotation.twist_about(rotation.multiply(hold.device, rotation.inverse(hold.attitude)), 2)
        headed[place] = (float(turn), hold)
    turns = {place: turn for place, (turn, _) in headed.items()}
    facing = facing_from_hinges({place: worn[place] for place in common}, turns, reference.time)
    if facing is None:
        return {}
    return {
        place: rotation.multiply(rotation.about(2, turn - facing), hold.attitude)
        for place, (turn, hold) in headed.items()
    }


def _align_limb(
    place: Place,
    hold: Hold,
    pose: str,
    others: Mapping[str, Hold],
    headed: NDArray[np.float64] | None,
    mounting: Mounting,
) -> LimbAlignment:
    segment = SEGMENT_OF[place]
    reference = reference_pose(pose)[segment]
    up_in_segment = rotation.rotate(rotation.inverse(reference), UP)
    sensor_from_segment: NDArray[np.float64] | None = None
    source: HeadingSource = "unknown"
    sigma = math.pi
    if "bow" in others and pose != "sit":  # from sitting to the bow, thighs and shanks tilt the other way
        sensor_from_segment, sigma = from_bow(hold.up(), others["bow"].up(), up_in_segment, place in _LIFTED)
        source = "bow"
    if sensor_from_segment is None:
        for label in REFERENCE_POSES:
            if sensor_from_segment is None and label in others:
                other_up = rotation.rotate(rotation.inverse(reference_pose(label)[segment]), UP)
                sensor_from_segment, sigma = from_two_poses(hold.up(), others[label].up(), up_in_segment, other_up)
                source = "two poses"
    if sensor_from_segment is None and headed is not None:
        sensor_from_segment = rotation.multiply(rotation.inverse(headed), reference)
        source, sigma = "common world", COMMON_WORLD_SIGMA
    if sensor_from_segment is None and mounting == "strapped":
        sensor_from_segment = from_strap_rule(place, hold, reference)
        source, sigma = "strap rule", STRAP_SIGMA
    if sensor_from_segment is None:
        return LimbAlignment(NO_MOUNTING, 0.0, "unknown", math.pi, hold.spread)
    return _limb(hold, pose, place, sensor_from_segment, source, sigma)


def heading_in(hold: Hold, pose: str, place: Place, sensor_from_segment: NDArray[np.float64]) -> float:
    """Return the heading (rad) that a hold of a reference pose gives a sensor whose mounting is known."""
    reference = reference_pose(pose)[SEGMENT_OF[place]]
    before_heading = rotation.multiply(hold.attitude, sensor_from_segment)
    return float(rotation.twist_about(rotation.multiply(reference, rotation.inverse(before_heading)), 2))


def _limb(
    hold: Hold,
    pose: str,
    place: Place,
    sensor_from_segment: NDArray[np.float64],
    source: HeadingSource,
    sigma: float,
) -> LimbAlignment:
    """Let the hold fix the heading, and the rest of the mounting, so that the held pose comes out exactly."""
    reference = reference_pose(pose)[SEGMENT_OF[place]]
    heading = heading_in(hold, pose, place, sensor_from_segment)
    headed = rotation.multiply(rotation.about(2, heading), hold.attitude)
    exact = rotation.multiply(rotation.inverse(headed), reference)
    w, x, y, z = (float(c) for c in exact)
    return LimbAlignment((w, x, y, z), heading, source, sigma, hold.spread)


def from_bow(
    up_first: NDArray[np.float64], up_bow: NDArray[np.float64], up_in_segment: NDArray[np.float64], lifted: bool
) -> tuple[NDArray[np.float64] | None, float]:
    """Return sensor_from_segment (4,) and its heading's sigma (rad) from the upward directions in two holds.

    The axis that carries gravity from the first hold to the bow is the segment's right axis. None when the
    segment tilted less than 20 degrees, or when its right axis is vertical in the first hold (arms in T-pose).
    """
    axis = np.cross(up_first, up_bow)
    sine = float(np.linalg.norm(axis))
    tilt = math.atan2(sine, float(up_first @ up_bow))
    if tilt < SMALLEST_BOW or abs(float(up_in_segment[2])) > 0.5:
        return None, math.pi
    # Turning the segment by +θ about its right axis turns "up", seen from it, by -θ.
    right = axis / sine * (-1.0 if lifted else 1.0)
    sigma = math.hypot(TILT_SIGMA / math.sin(tilt), BOW_AXIS_SIGMA)
    return _from_pairs((up_first, right), (up_in_segment, np.array([0.0, 0.0, 1.0]))), sigma


def from_two_poses(
    up_first: NDArray[np.float64],
    up_other: NDArray[np.float64],
    first_in_segment: NDArray[np.float64],
    other_in_segment: NDArray[np.float64],
) -> tuple[NDArray[np.float64] | None, float]:
    """Return sensor_from_segment (4,) and sigma from "up" in two fully known poses.

    None when both look alike on this limb, or when it did not tilt as far as between these poses.
    """
    sine = float(np.linalg.norm(np.cross(first_in_segment, other_in_segment)))
    meant = math.atan2(sine, float(first_in_segment @ other_in_segment))
    tilt = math.atan2(float(np.linalg.norm(np.cross(up_first, up_other))), float(up_first @ up_other))
    if sine < math.sin(SMALLEST_BOW) or abs(tilt - meant) > TILT_MISSED:
        return None, math.pi
    sigma = math.hypot(TILT_SIGMA / sine, 2 * BOW_AXIS_SIGMA)
    return _from_pairs((up_first, up_other), (first_in_segment, other_in_segment)), sigma


def from_strap_rule(place: Place, hold: Hold, reference: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Return sensor_from_segment (4,) as the strap rule says, None when gravity contradicts it."""
    rule = strap_rule()[place]
    expected = rotation.rotate(rule, rotation.rotate(rotation.inverse(reference), UP))
    if float(expected @ hold.up()) < math.cos(STRAP_CONTRADICTION):
        return None
    return rule


def _from_pairs(
    in_sensor: tuple[NDArray[np.float64], NDArray[np.float64]],
    in_segment: tuple[NDArray[np.float64], NDArray[np.float64]],
) -> NDArray[np.float64]:
    """Return the rotation (4,) that fits the first pair of directions exactly and the second as nearly as it can."""

    def basis(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
        x = first / np.linalg.norm(first)
        z = np.cross(x, second)
        z = z / np.linalg.norm(z)
        return np.stack([x, np.cross(z, x), z], axis=1)

    return rotation.from_matrix(basis(*in_sensor) @ basis(*in_segment).T)
