"""The body calibration in force: the holds it was made of, and what of it a take must carry."""

import math
from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.capture.procedures.judged_hold import BodyHolds, Judged
from studio.core import rotation
from studio.core.body import Place
from studio.core.live_solver import Solver
from studio.core.sample import Quaternion, SensorId
from studio.core.take import Alignment, CarriedAlignment, Mark, Setup
from studio.core.track import SensorTrack, attitude_at, prior_offset_sigma

AROUND = 0.2  # s of samples looked at before and after a hold or an instant; ten frames of 20 ms
NEAR = 0.1  # s; a sensor silent for longer around the start of a take is not known to have gone on
SHOWN_OFFSET = math.radians(0.3)  # rad/s; what holding still leaves of any offset (0.05 to 0.3, as sitting does)


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

        What can be used is in force afterwards; else the calibration from before stays.
        """
        self.marks.append((mark, frozenset(only)))
        self._holds.add(mark, only)
        tracks = solver.tracks([(start - AROUND, end + AROUND) for start, end in self._holds.spans()])
        judged = self._holds.judge(tracks, setup.assignment, setup.mounting, solver.kept())
        alignment = judged.alignment
        if alignment is None or all(limb.source == "unknown" for limb in alignment.limbs.values()):
            return judged
        self.alignment = alignment
        self._held_at, self._groups = {}, {}
        for place, limb in alignment.limbs.items():
            held = self._holds.reference_of(place)
            if held is not None and limb.source != "unknown":
                track = tracks[setup.assignment.sensors[place]]
                self._held_at[place] = max(held.time, held.end)
                self._groups[place] = int(track.group[_row_at(track, 0.5 * (held.time + self._held_at[place]))])
        solver.use(alignment, {p: {group: alignment.limbs[p].heading} for p, group in self._groups.items()})
        return judged

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
