"""What a held pose is worth, limb by limb; and one limb repeated while the others stay as they are."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Literal, NamedTuple

from studio.core.alignment import Tracks, align, reference_mark, refused_holds, require_headings
from studio.core.body import PLACES, Place
from studio.core.errors import AlignmentError, MovedDuringHold
from studio.core.headings import turn_between, wrapped
from studio.core.take import Alignment, Assignment, HeadingSource, LimbAlignment, Mark, Mounting

GOOD = math.radians(1.0)  # rad, root mean square; a standing person sways with an SD of 0.5°

Grade = Literal["good", "fair", "moved", "silent"]


class Judged(NamedTuple):
    """A hold as the session judged it; both are there when some limbs moved and the others can be used."""

    alignment: Alignment | None
    error: AlignmentError | None


class LimbResult(NamedTuple):
    """What a hold gave for one limb."""

    place: Place
    degrees: float
    """Deviation from the mean during the hold: root mean square, or the largest when it was refused. NaN: silent."""
    grade: Grade
    source: HeadingSource
    heading_sigma: float
    """Degrees, one standard deviation."""


def limb_results(alignment: Alignment | None, error: AlignmentError | None) -> tuple[LimbResult, ...]:
    """Return a result for each limb that was judged, in the order of Table 1."""
    limbs: Mapping[Place, LimbAlignment] = {} if alignment is None else alignment.limbs
    found = {place: _result(place, limb) for place, limb in limbs.items()}
    if isinstance(error, MovedDuringHold):
        for name, degrees in zip(error.places, error.degrees, strict=True):
            found[Place(name)] = LimbResult(Place(name), degrees, "moved", "unknown", math.degrees(math.pi))
    return tuple(found[place] for place in PLACES if place in found)


def _result(place: Place, limb: LimbAlignment) -> LimbResult:
    sigma = math.degrees(limb.heading_sigma)
    # alignment gives exactly zero to whoever sent nothing during the hold
    if limb.source == "unknown" and limb.spread == 0.0:
        return LimbResult(place, math.nan, "silent", limb.source, sigma)
    grade: Grade = "good" if limb.spread <= GOOD else "fair"
    return LimbResult(place, math.degrees(limb.spread), grade, limb.source, sigma)


class BodyHolds:
    """The holds in force: of the whole body, and of limbs that were repeated alone."""

    def __init__(self) -> None:
        self._whole: dict[str, Mark] = {}
        self._repeated: dict[Place, dict[str, Mark]] = {}

    @property
    def poses(self) -> tuple[Mark, ...]:
        """The holds of the whole body, in the order of time."""
        return tuple(sorted(self._whole.values(), key=lambda mark: mark.time))

    def spans(self) -> list[tuple[float, float]]:
        """Return from when to when a pose of all these was held, s."""
        repeated = [mark for marks in self._repeated.values() for mark in marks.values()]
        return [(mark.time, max(mark.end, mark.time)) for mark in (*self._whole.values(), *repeated)]

    def reference_of(self, place: Place) -> Mark | None:
        """Return the hold that fixed the heading of a limb: its own, where it was repeated alone."""
        return reference_mark(tuple(self._repeated.get(place, {}).values())) or reference_mark(self.poses)

    def clear(self) -> None:
        """Forget all: other sensors, other places."""
        self._whole.clear()
        self._repeated.clear()

    def add(self, held: Mark, only: Collection[Place] = ()) -> None:
        """A pose was held: it replaces its like, for some limbs only or for all.

        A new reference of the whole body begins everything anew: what was held after the old one may have
        been held with other straps.
        """
        if only and held.label in self._whole:
            for place in only:
                self._repeated.setdefault(place, {})[held.label] = held
            return
        reference = reference_mark(self.poses)
        if reference is not None and reference.label == held.label:
            self.clear()
        self._whole[held.label] = held
        for limb in self._repeated.values():
            limb.pop(held.label, None)

    def judge(self, tracks: Tracks, assignment: Assignment, mounting: Mounting, take_s: float) -> Judged:
        """Return the alignment of all limbs that held still, and which did not."""
        alignment, error = judge(tracks, assignment, self.poses, mounting, take_s)
        if alignment is None:
            return Judged(None, error)
        moved = _moved_in(error)
        pose = error.pose if isinstance(error, MovedDuringHold) else alignment.pose
        for marks, places in self._groups():
            poses = sorted((self._whole | marks).values(), key=lambda mark: mark.time)
            fresh = judge(tracks, assignment, poses, mounting, take_s, places)
            if fresh.alignment is None and not isinstance(fresh.error, MovedDuringHold):
                return Judged(alignment, fresh.error)
            moved = {name: degrees for name, degrees in moved.items() if Place(name) not in places}
            if isinstance(fresh.error, MovedDuringHold):
                moved |= _moved_in(fresh.error)
                pose = fresh.error.pose
            if fresh.alignment is not None:
                alignment = merged(alignment, fresh.alignment, places)
        return Judged(alignment, _blamed(pose, moved) or _without_headings(alignment))

    def _groups(self) -> list[tuple[dict[str, Mark], list[Place]]]:
        groups: list[tuple[dict[str, Mark], list[Place]]] = []
        for place, marks in self._repeated.items():
            known = next((places for held, places in groups if held == marks), None)
            if known is not None:
                known.append(place)
            elif marks:
                groups.append((marks, [place]))
        return groups


def _moved_in(error: AlignmentError | None) -> dict[str, float]:
    return dict(zip(error.places, error.degrees, strict=True)) if isinstance(error, MovedDuringHold) else {}


def _without_headings(alignment: Alignment) -> AlignmentError | None:
    try:
        require_headings(alignment)
    except AlignmentError as error:
        return error
    return None


def judge(
    tracks: Tracks,
    assignment: Assignment,
    poses: Sequence[Mark],
    mounting: Mounting,
    take_s: float,
    only: Collection[Place] = (),
) -> Judged:
    """Return the alignment of all limbs that held still, and which did not.

    Parameters
    ----------
    only : places
        The limbs that are being repeated: nobody else is blamed for moving. Empty for the whole body.
    """
    moved: dict[str, float] = {}
    worn = dict(assignment.sensors)
    pose = poses[-1].label if poses else ""
    while True:
        try:
            alignment = align(tracks, Assignment(worn), poses, mounting, take_s)
        except MovedDuringHold as error:
            moved |= dict(zip(error.places, error.degrees, strict=True))
            pose = error.pose
            worn = {place: sensor for place, sensor in worn.items() if place.value not in moved}
            if worn:
                continue
            return Judged(None, _blamed(pose, moved, only))
        except AlignmentError as error:
            return Judged(None, error)
        break
    for refusal in refused_holds(tracks, Assignment(worn), poses, alignment, take_s):
        moved |= dict(zip(refusal.places, refusal.degrees, strict=True))
        pose = refusal.pose
    return Judged(alignment, _blamed(pose, moved, only) or _without_headings(alignment))


def _blamed(pose: str, moved: Mapping[str, float], only: Collection[Place] = ()) -> MovedDuringHold | None:
    names = tuple(place.value for place in PLACES if place.value in moved and (not only or place in only))
    return MovedDuringHold(pose, names, tuple(moved[name] for name in names)) if names else None


def merged(before: Alignment, fresh: Alignment, only: Collection[Place]) -> Alignment:
    """Return ``before`` with the limbs ``only`` taken from a fresh hold.

    A repeated hold may face another way than the first. How far is told by the limbs that were not to be
    repeated: the worlds of their sensors did not turn, so that the difference of their headings is the turn of
    the wearer. Without any, both holds count as facing the same way.
    """
    stayed = {place: limb.heading for place, limb in fresh.limbs.items() if place not in only and _is_known(limb)}
    was = {place: limb.heading for place, limb in before.limbs.items() if _is_known(limb)}
    turn = turn_between(was, stayed) or 0.0
    limbs = dict(before.limbs)
    for place in only:
        limb = fresh.limbs.get(place)
        if limb is not None:
            limbs[place] = replace(limb, heading=wrapped(limb.heading + turn)) if _is_known(limb) else limb
    return replace(before, limbs=limbs)


def _is_known(limb: LimbAlignment) -> bool:
    """Return whether something told the limb's heading."""
    return limb.source != "unknown"
