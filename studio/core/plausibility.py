"""Whether a pose was held that was not the one named: where gravity alone makes it certain, it is refused.

One hold fixes the body exactly, whatever it looked like, and a second one leaves little over: how far limbs
tilted in between, how gravity lies in tags whose straps are known, and further holds. What only the motion
shows is a doubt and no proof, because headings drift: it becomes a note.
"""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import ARMS, REFERENCE_POSES, SEGMENT_OF, Place, reference_pose
from studio.core.errors import PoseNotHeld
from studio.core.frames import UP
from studio.core.hold import Hold
from studio.core.pose import Motion
from studio.core.strapping import strap_rule
from studio.core.take import Alignment, LimbAlignment, Mounting

UPRIGHT = math.radians(10.0)  # a trunk that tilts less than this did not bow; a bow tilts it by 20° to 60°
RAISED = math.radians(60.0)  # arms in T-pose tilt by 90°, in the bow by 30° to 55°
BENT_HIPS = math.radians(20.0)  # of the thighs; in T-pose they hang
CONTRADICTION = math.radians(45.0)  # three times what a strap put on by eye is worth
AGREEMENT = math.radians(30.0)  # two times that
BETTER = math.radians(15.0)  # a bow tilts by 25° and more
MOST = 0.8  # of the limbs
FEWEST = 3  # limbs; two tags may have been exchanged
OTHER_POSE = math.radians(45.0)  # a trunk that leans by more was not upright
BENT_BACKWARDS = math.radians(20.0)
THINNING = 5  # frames
LONG_ENOUGH = 0.5  # s in all
LEANING, CROUCHED = math.radians(20.0), math.radians(30.0)  # trunk and knees; nobody does that most of the time

_BACK = (Place.HEAD, Place.CHEST)
_THIGHS = (Place.LEFT_THIGH, Place.RIGHT_THIGH)
_TRUNK = (Place.HEAD, Place.CHEST, Place.PELVIS)
_KNEES = ((Place.LEFT_THIGH, Place.LEFT_SHANK), (Place.RIGHT_THIGH, Place.RIGHT_SHANK))
_ELBOWS = ((Place.LEFT_UPPER_ARM, Place.LEFT_FOREARM), (Place.RIGHT_UPPER_ARM, Place.RIGHT_FOREARM))
_NAMES = {Place.LEFT_SHANK: "left knee", Place.RIGHT_SHANK: "right knee"} | {
    Place.LEFT_FOREARM: "left elbow",
    Place.RIGHT_FOREARM: "right elbow",
}


def refuse_wrong_poses(label: str, first: Mapping[Place, Hold], bow: Mapping[Place, Hold], mounting: Mounting) -> None:
    """Raise PoseNotHeld when the reference or the bow was certainly another pose.

    Parameters
    ----------
    label : str
        Name of the reference pose.
    first, bow : mapping
        The reference hold and the bow, of sensors that feel gravity.
    """
    _refuse_raised_arms(first, bow)
    if mounting == "strapped":
        _refuse_exchange(label, first, bow)
        _refuse_other_reference(label, first)


def misheld(alignment: Alignment, pose: str, holds: Mapping[Place, Hold]) -> set[Place]:
    """Return the limbs whose gravity says that they were nowhere near a reference pose in a further hold of it."""
    found = set()
    for place, limb in alignment.limbs.items():
        if limb.source != "unknown" and place in holds:
            up = rotation.rotate(rotation.inverse(np.array(limb.sensor_from_segment)), holds[place].up())
            if _angle(up, _up_in_segment(pose, place)) > OTHER_POSE:
                found.add(place)
    return found


def doubts(whole: Motion) -> tuple[str, ...]:
    """Return notes on a motion that hardly any body makes."""
    motion = _thinned(whole)
    notes = []
    backwards = [
        f"{_NAMES[child]} by up to {math.degrees(most):.0f}°"
        for pairs, bends in ((_KNEES, -1.0), (_ELBOWS, 1.0))
        for parent, child in pairs
        if (most := _bent_backwards(motion, parent, child, bends)) > 0
    ]
    if backwards:
        notes.append(
            f"Bent the wrong way: {', '.join(backwards)}. Were the poses held as shown, and does every tag sit "
            "where it is said to sit?"
        )
    if motion.alignment.pose == "n" and _is_crouched(motion):
        notes.append("Most of the time the trunk leans forwards and the knees are bent: were N-pose and bow exchanged?")
    return tuple(notes)


def _thinned(motion: Motion) -> Motion:
    """Return some rows of a motion: bending is slow, and half an hour of it is large."""
    rows = slice(None, None, THINNING)
    return replace(
        motion,
        time=motion.time[rows],
        frame_s=motion.frame_s * THINNING,
        world_from_segment=motion.world_from_segment[rows],
        hips=motion.hips[rows],
        measured={place: there[rows] for place, there in motion.measured.items()},
        lost={place: there[rows] for place, there in motion.lost.items()},
    )


def _refuse_raised_arms(first: Mapping[Place, Hold], bow: Mapping[Place, Hold]) -> None:
    tilts = {place: _angle(first[place].up(), hold.up()) for place, hold in bow.items() if place in first}
    trunk = [tilts[place] for place in _TRUNK if place in tilts]
    # A pelvis may stay upright while the back bends, and nobody bends the hips for a T-pose.
    is_bow = not any(place in tilts for place in _BACK) or any(tilts.get(place, 0.0) >= BENT_HIPS for place in _THIGHS)
    raised = tuple(place.value for place in ARMS if tilts.get(place, 0.0) > RAISED)
    if trunk and max(trunk) < UPRIGHT and not is_bow and len(raised) > 1:
        raise PoseNotHeld("bow", raised, "t")


def _refuse_exchange(label: str, first: Mapping[Place, Hold], bow: Mapping[Place, Hold]) -> None:
    if label != "n":
        return
    both = [place for place in first if place in bow]
    better = tuple(
        place.value
        for place in both
        if _off_strap(bow[place], "n", place) + BETTER < _off_strap(first[place], "n", place)
    )
    if len(both) >= FEWEST and len(better) >= MOST * len(both):
        raise PoseNotHeld("n", better, "bow")


def _refuse_other_reference(label: str, first: Mapping[Place, Hold]) -> None:
    wrong = [place for place, hold in first.items() if _off_strap(hold, label, place) > CONTRADICTION]
    if len(wrong) < 2:
        return
    for other in REFERENCE_POSES:
        if other != label and all(_off_strap(first[place], other, place) < AGREEMENT for place in wrong):
            raise PoseNotHeld(label, tuple(place.value for place in wrong), other)


def _off_strap(hold: Hold, pose: str, place: Place) -> float:
    """Return the angle, rad, between felt gravity and that of a tag strapped on as shown in a reference pose."""
    return _angle(hold.up(), rotation.rotate(strap_rule()[place], _up_in_segment(pose, place)))


def _up_in_segment(pose: str, place: Place) -> NDArray[np.float64]:
    return rotation.rotate(rotation.inverse(reference_pose(pose)[SEGMENT_OF[place]]), UP)


def _angle(a: NDArray[np.float64], b: NDArray[np.float64]) -> float:
    return math.atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def _bent_backwards(motion: Motion, parent: Place, child: Place, bends: float) -> float:
    """Return how far a hinge bends the way it cannot, rad; 0 when it does not for long, or may as well not."""
    limbs = motion.alignment.limbs
    if parent not in motion.measured or child not in motion.measured:
        return 0.0
    known = motion.measured[parent] & motion.measured[child]
    bent = _flexion(motion, parent, child, bends)[known]
    limit = BENT_BACKWARDS + 2 * _heading_doubt(limbs[parent], limbs[child])
    backwards = -bent[bent < -limit]
    return float(backwards.max()) if len(backwards) * motion.frame_s > LONG_ENOUGH else 0.0


def _heading_doubt(parent: LimbAlignment, child: LimbAlignment) -> float:
    return math.hypot(parent.heading_sigma, child.heading_sigma)


def _flexion(motion: Motion, parent: Place, child: Place, bends: float) -> NDArray[np.float64]:
    joint = motion.parent_from_child(SEGMENT_OF[parent], SEGMENT_OF[child])
    return bends * np.asarray(rotation.twist_about(joint, 2))


def _is_crouched(motion: Motion) -> bool:
    """Return whether the trunk leans forwards and both knees are bent in the median of the time."""
    measured = {place: there for place, there in motion.measured.items() if there.any()}
    trunk = next((place for place in (Place.CHEST, Place.PELVIS) if place in measured), None)
    if trunk is None or not all(place in measured for knee in _KNEES for place in knee):
        return False
    for thigh, shank in _KNEES:
        known = measured[thigh] & measured[shank]
        if not known.any() or np.median(_flexion(motion, thigh, shank, -1.0)[known]) < CROUCHED:
            return False
    along = rotation.rotate(motion.world_from_segment[measured[trunk], SEGMENT_OF[trunk]], np.array([0.0, 1.0, 0.0]))
    return bool(np.median(np.arccos(np.clip(along[:, 2], -1.0, 1.0))) > LEANING)
