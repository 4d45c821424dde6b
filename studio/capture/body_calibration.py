"""The body calibration in force: the holds it was made of, and what of it a take must carry."""

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.capture.procedures.judged_hold import BodyHolds, Judged
from studio.core import rotation
from studio.core.alignment import heading_in, worse_limbs
from studio.core.body import Place
from studio.core.headings import turn_between, wrapped
from studio.core.hold import hold_all
from studio.core.live_solver import Solver
from studio.core.plausibility import misheld
from studio.core.sample import Quaternion, SensorId
from studio.core.take import Alignment, CarriedAlignment, LimbAlignment, Mark, Setup
from studio.core.track import SensorTrack, attitude_at, prior_offset_sigma

AROUND = 0.2  # s of samples looked at before and after a hold or an instant; ten frames of 20 ms
NEAR = 0.1  # s; a sensor silent for longer around the start of a take is not known to have gone on
SHOWN_OFFSET = math.radians(0.3)  # rad/s; what holding still leaves of any offset (0.05 to 0.3, as sitting does)


class _Kept(NamedTuple):
    """A limb whose tag sits as before, and by which hold and in which heading group its heading is known."""

    limb: LimbAlignment
    held_at: float
    group: int


class BodyCalibration:
    """Holds are added, judged and put into force; all times are on the clock of ``Sample.time``."""

    def __init__(self) -> None:
        self.alignment: Alignment | None = None
        """In force."""
        self.marks: list[tuple[Mark, frozenset[Place]]] = []
        """All holds since the places were last assigned, with the limbs that were repeated; in their order."""
        self._holds = BodyHolds()
        self._held_at: dict[Place, float] = {}
        self._groups: dict[Place, int] = {}

    def clear(self) -> None:
        """Forget all: other sensors, or other places."""
        self.alignment = None
        self.marks.clear()
        self._holds.clear()
        self._held_at.clear()
        self._groups.clear()

    def add(self, mark: Mark, only: Collection[Place], solver: Solver, setup: Setup) -> Judged:
        """Judge a hold of the whole body, or of the limbs ``only`` while the others stay as they are.

        What can be used is in force afterwards; else the calibration from before stays. A limb of which the new
        hold tells less than was known takes nothing but its heading from it.
        """
        self.marks.append((mark, frozenset(only)))
        self._holds.add(mark, only)
        tracks = solver.tracks([(start - AROUND, end + AROUND) for start, end in self._holds.spans()])
        judged = self._holds.judge(tracks, setup.assignment, setup.mounting, solver.kept())
        alignment = judged.alignment
        if alignment is None or all(limb.source == "unknown" for limb in alignment.limbs.values()):
            return judged
        before, known = self.alignment, {p: limb for p, limb in alignment.limbs.items() if limb.source != "unknown"}
        at = {place: held for place in alignment.limbs if (held := self._holds.reference_of(place)) is not None}
        held_at = {place: max(at[place].time, at[place].end) for place in known if place in at}
        groups = {
            place: int(track.group[_row_at(track, 0.5 * (at[place].time + end))])
            for place, end in held_at.items()
            for track in (tracks[setup.assignment.sensors[place]],)
        }
        worse: set[Place] = set() if before is None else worse_limbs(alignment, before)
        if before is not None and worse:
            worn = {place: tracks[sensor] for place, sensor in setup.assignment.sensors.items() if sensor in tracks}
            kept = self._kept(before, worse, worn, at, solver.kept())
            # The hold whose samples tell how the tags sit is still the one from before.
            alignment = replace(before, limbs={**alignment.limbs, **{p: one.limb for p, one in kept.items()}})
            held_at |= {place: one.held_at for place, one in kept.items()}
            groups |= {place: one.group for place, one in kept.items()}
            judged = judged._replace(alignment=alignment)
        self.alignment, self._held_at, self._groups = alignment, held_at, groups
        solver.use(alignment, {p: {group: alignment.limbs[p].heading} for p, group in self._groups.items()})
        return judged

    def _kept(
        self,
        before: Alignment,
        worse: Collection[Place],
        worn: Mapping[Place, SensorTrack],
        at: Mapping[Place, Mark],
        take_s: float,
    ) -> dict[Place, _Kept]:
        """Return the limbs of which a new hold tells less: it renews their headings, and their tags sit as before."""
        holds = {mark: hold_all(worn, mark, take_s, required=False) for mark in {at[p] for p in worse if p in at}}
        kept = {}
        for mark, held in holds.items():
            still = {p: hold for p, hold in held.items() if p in worse and at.get(p) == mark and hold.is_still()}
            for place in still.keys() - misheld(before, mark.label, still):
                limb, hold = before.limbs[place], still[place]
                heading = heading_in(hold, mark.label, place, np.array(limb.sensor_from_segment))
                fresh = replace(limb, heading=heading, spread=hold.spread)
                kept[place] = _Kept(fresh, max(mark.time, mark.end), hold.group)
        went_on = {place: one for place, one in kept.items() if self._groups.get(place) == one.group}
        was = {place: before.limbs[place].heading for place in went_on}
        turn = turn_between({place: one.limb.heading for place, one in went_on.items()}, was) or 0.0
        for place in (set(worse) - kept.keys()) & self._groups.keys():  # who was silent turned with the others
            limb = before.limbs[place]
            turned = replace(limb, heading=wrapped(limb.heading + turn))
            kept[place] = _Kept(turned, self._held_at[place], self._groups[place])
        return kept

    def is_within(self, first: float) -> bool:
        """Return whether a take that begins at ``first`` has the samples of the reference hold in force, if any is."""
        return self.alignment is None or self.alignment.from_s >= first

    def carried(self, first: float | None, solver: Solver, setup: Setup) -> CarriedAlignment | None:
        """Return what a take that begins at ``first`` must know of a calibration whose holds it does not have.

        None when there is no calibration, or when the take has the samples of its reference hold.

        Notes
        -----
        ``heading_sigma`` grows with the age of the hold by what the gyroscope's offset may have turned the
        heading since: its prior uncertainty, at most what a hold leaves of it, times the age.
        """
        alignment = self.alignment
        if alignment is None or first is None or self.is_within(first):
            return None
        limbs = dict(alignment.limbs)
        wearer_from_sensor: dict[Place, Quaternion] = {}
        for place, group in self._groups.items():
            limb, sensor = alignment.limbs[place], setup.assignment.sensors[place]
            grown = _offset_sigma(sensor, solver, setup) * max(first - self._held_at[place], 0.0)
            limbs[place] = replace(limb, heading_sigma=min(math.hypot(limb.heading_sigma, grown), math.pi))
            attitude = _attitude_at(first, solver.tracks([(first - AROUND, first + AROUND)], (sensor,))[sensor], group)
            if attitude is not None:
                w, x, y, z = rotation.multiply(rotation.about(2, np.array(limb.heading)), attitude).tolist()
                wearer_from_sensor[place] = (w, x, y, z)
        moved = replace(alignment, from_s=alignment.from_s - first, to_s=alignment.to_s - first, limbs=limbs)
        return CarriedAlignment(moved, 0.0, wearer_from_sensor)


def _offset_sigma(sensor: SensorId, solver: Solver, setup: Setup) -> float:
    calibration = next((known for known in setup.calibrations if known.sensor == sensor), None)
    info, flags = solver.newest(sensor)
    return min(prior_offset_sigma(info, flags, calibration), SHOWN_OFFSET)


def _attitude_at(time: float, track: SensorTrack, group: int) -> NDArray[np.float64] | None:
    """Return world_from_sensor (4,) at a time, None when its heading is another by then, or nobody knows."""
    if len(track.time) == 0:
        return None
    row = _row_at(track, time)
    if abs(track.time[row] - time) > NEAR or track.group[row] != group:
        return None
    return np.asarray(attitude_at(track, np.array([time]))[0])


def _row_at(track: SensorTrack, time: float) -> int:
    return int(np.argmin(np.abs(track.time - time)))
