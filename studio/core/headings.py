"""The heading of every stretch of every sensor: what one hold cannot tell, because sensors start anew.

A restarted tag, or one that was silent too long, has a heading of its own from then on: another heading group.
A further hold of a reference pose gives it back, but whoever repeats a pose need not face as in the first: how
far the wearer turned is told by the limbs whose heading went on.
"""

import math
import statistics
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from studio.core import rotation
from studio.core.alignment import heading_in
from studio.core.body import REFERENCE_POSES, Place
from studio.core.hold import Hold, hold_all
from studio.core.plausibility import misheld
from studio.core.take import Alignment, CarriedAlignment, Mark
from studio.core.track import SensorTrack, attitude_at

NEAR = 0.1  # s; a sensor silent for longer around the moment of carrying is not known to have gone on

GroupHeadings = Mapping[Place, Mapping[int, float]]
"""For each place the heading, rad, of each heading group of its track that is known."""


class _Held(NamedTuple):
    groups: dict[Place, int]
    facing_x: dict[Place, float]
    """Heading of each limb, rad, if the wearer faced world x in this hold."""


def headings_of(
    worn: Mapping[Place, SensorTrack],
    alignment: Alignment,
    poses: Sequence[Mark],
    take_s: float,
    carried: CarriedAlignment | None = None,
) -> dict[Place, dict[int, float]]:
    """Return the headings that the alignment and the holds of a take tell.

    Parameters
    ----------
    worn : mapping
        The tracks that ``alignment``, or what is carried into the take, is to be put on.
    poses : sequence of Mark
        Those of a reference pose count, in which a limb kept still.
    carried : CarriedAlignment or None
        None: the reference hold of ``alignment`` lies in the take.
    """
    limbs = [place for place in worn if place in alignment.limbs and alignment.limbs[place].source != "unknown"]
    if carried is None:
        reference = Mark(alignment.from_s, "pose", alignment.pose, alignment.to_s)
        first = hold_all(worn, reference, take_s, required=False)
        found = {p: {first[p].group: alignment.limbs[p].heading} if p in first else {} for p in limbs}
    else:
        found = {place: _heading_at(worn[place], place, carried) for place in limbs}
    holds = [held for _, held in _further_holds(worn, alignment, poses, take_s)]
    while any(_learn(found, held) for held in holds):  # what one hold tells may be what another needs
        pass
    return found


def drifted(
    worn: Mapping[Place, SensorTrack],
    alignment: Alignment,
    poses: Sequence[Mark],
    take_s: float,
    headings: GroupHeadings,
) -> list[tuple[Mark, dict[Place, float]]]:
    """Return for each hold how far, rad, headings in force are off in it, of the limbs beyond three sigma.

    Where the wearer faced is told by the limbs together; nothing is corrected by it.
    """
    found = []
    for mark, held in _further_holds(worn, alignment, poses, take_s):
        known = {p: headings[p][group] for p, group in held.groups.items() if group in headings.get(p, {})}
        turn = turn_between(known, held.facing_x)
        if turn is None:
            continue
        off = {place: wrapped(known[place] - held.facing_x[place] - turn) for place in known}
        limbs = {p: angle for p, angle in off.items() if abs(angle) > 3 * alignment.limbs[p].heading_sigma}
        if limbs:
            found.append((mark, limbs))
    return found


def turn_between(before: Mapping[Place, float], after: Mapping[Place, float]) -> float | None:
    """Return how far the wearer turned from one hold to another, rad; None when no limb tells.

    Parameters
    ----------
    before, after : mapping
        rad, the headings of the same tracks if the wearer faced world x in either hold: the worlds of the sensors
        did not turn, so that the difference is the wearer's turn. The median of the limbs counts.
    """
    turns = [before[place] - heading for place, heading in after.items() if place in before]
    if not turns:
        return None
    # Angles around one of them do not wrap unless they contradict each other by half a turn.
    first = turns[0]
    return first + statistics.median(wrapped(turn - first) for turn in turns)


def wrapped(angle: float) -> float:
    """Return an angle in rad between -π and π."""
    return math.remainder(angle, 2 * math.pi)


def _further_holds(
    worn: Mapping[Place, SensorTrack], alignment: Alignment, poses: Sequence[Mark], take_s: float
) -> list[tuple[Mark, _Held]]:
    limbs = [place for place in worn if place in alignment.limbs and alignment.limbs[place].source != "unknown"]
    holds = []
    for mark in poses:
        if mark.label in REFERENCE_POSES:
            everyone = hold_all(worn, mark, take_s, required=False)
            # Who stood otherwise than the pose says is not told a heading by it.
            usable = set(limbs) & everyone.keys() - misheld(alignment, mark.label, everyone)
            holds.append((mark, _held(mark.label, {p: everyone[p] for p in limbs if p in usable}, alignment)))
    return holds


def _held(pose: str, holds: Mapping[Place, Hold], alignment: Alignment) -> _Held:
    still = {place: hold for place, hold in holds.items() if hold.is_still()}
    return _Held(
        {place: hold.group for place, hold in still.items()},
        {p: heading_in(h, pose, p, np.array(alignment.limbs[p].sensor_from_segment)) for p, h in still.items()},
    )


def _learn(found: dict[Place, dict[int, float]], held: _Held) -> bool:
    """Give the limbs of a hold their headings; False when it tells nothing new."""
    known = {place: found[place][group] for place, group in held.groups.items() if group in found[place]}
    turn = turn_between(known, held.facing_x)
    if turn is None or len(known) == len(held.groups):
        return False
    for place, group in held.groups.items():
        found[place].setdefault(group, wrapped(held.facing_x[place] + turn))
    return True


def _heading_at(track: SensorTrack, place: Place, carried: CarriedAlignment) -> dict[int, float]:
    """Return the heading of the group in which a sensor was when the calibration was carried into the take."""
    wearer_from_sensor = carried.wearer_from_sensor.get(place)
    if wearer_from_sensor is None or not len(track.time):
        return {}
    row = int(np.argmin(np.abs(track.time - carried.time)))
    if abs(track.time[row] - carried.time) > NEAR:
        return {}
    attitude = attitude_at(track, np.array([carried.time]))[0]
    turn = rotation.multiply(np.array(wearer_from_sensor), rotation.inverse(attitude))
    return {int(track.group[row]): float(rotation.twist_about(turn, 2))}
