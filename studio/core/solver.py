"""From a take to a motion, and from live samples to poses: one chain, two ways to run it.

offset and gain → attitude → alignment → 23 segments → hips. ``solve(take, method="live")`` is ``Solver.push``
in a loop over the samples in their order of arrival; ``offline`` may look ahead and resamples every sensor
to one regular grid.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.alignment import align, refused_holds, require_headings, worse_limbs
from studio.core.body import REFERENCE_POSES, Place, Skeleton
from studio.core.errors import AlignmentError, HeadingsUnknown, MovedDuringHold, NoSensorWorn, PoseMissing, PoseTooShort
from studio.core.full_body import FullBody
from studio.core.headings import GroupHeadings, drifted, headings_of
from studio.core.hold import hold_all
from studio.core.live_frames import FrameLog
from studio.core.live_solver import Solver, samples_of
from studio.core.plausibility import doubts, misheld
from studio.core.pose import Method, Motion
from studio.core.root import Root, put_under_hold
from studio.core.sample import SensorId
from studio.core.strapping import level_by_straps
from studio.core.take import Alignment, Calibration, CarriedAlignment, Mark, Take
from studio.core.track import SensorTrack, attitude_at, flags_of, in_force, tracks_of

CHUNK = 4096  # poses at a time: the working set stays in the cache
ASSUMED_POSE = 1.0  # s at the start of a take without any marked pose


@dataclass(frozen=True)
class SolveOptions:
    """What a person may choose when a take is solved again."""

    attitude: str = "vqf"
    method: Method = "offline"
    poses: tuple[Mark, ...] = ()
    """Held poses that replace those marked in the take; empty keeps the marked ones."""
    calibrations: Mapping[SensorId, Calibration] | None = None
    """None: those recorded in the take."""


@dataclass(frozen=True)
class Solution:
    """A motion and what it was made from."""

    motion: Motion
    tracks: Mapping[SensorId, SensorTrack] = field(repr=False)


class Aligned(NamedTuple):
    """How the sensors of a take sit on the body."""

    alignment: Alignment
    headings: GroupHeadings
    notes: tuple[str, ...]
    """What had to be assumed, in plain words."""


def solve(take: Take, options: SolveOptions | None = None) -> Solution:
    """Return the motion of a take.

    Raises
    ------
    AlignmentError
        No pose is known, limbs moved in it, or no limb's heading is known.
    """
    chosen = options or SolveOptions()
    if chosen.method == "live":
        return _solve_live(take, chosen)
    tracks = solve_tracks(take, chosen)
    aligned = find_alignment(take, tracks, chosen)
    alignment, headings = aligned.alignment, aligned.headings
    worn = {p: tracks[s] for p, s in take.setup.assignment.sensors.items() if s in tracks and p in alignment.limbs}
    frame_s = min(track.info.frame_s for track in worn.values())
    time = np.arange(np.floor(take.duration() / frame_s + 1e-6) + 1) * frame_s
    known = [place for place in take.setup.assignment.places() if headings.get(place)]
    body = FullBody(known, alignment.pose)
    skeleton = Skeleton.from_stature(take.setup.stature)
    root = Root(skeleton)
    world = np.empty((len(time), 23, 4))
    hips = np.empty((len(time), 3))
    for start in range(0, len(time), CHUNK):
        part = slice(start, start + CHUNK)
        segments = [_segment(worn[place], alignment, place, headings[place], time[part]) for place in known]
        world[part] = body.complete(np.stack(segments, axis=-2))
        hips[part] = root.run(world[part], np.full(len(time[part]), frame_s))
    put_under_hold(hips, time, alignment)
    masks = {place: _coverage(worn[place], headings.get(place, {}), time) for place in worn}
    motion = Motion(
        time=time,
        frame_s=frame_s,
        world_from_segment=world,
        hips=hips,
        skeleton=skeleton,
        measured={place: measured for place, (measured, _) in masks.items()},
        lost={place: lost for place, (_, lost) in masks.items()},
        alignment=alignment,
        method="offline",
        attitude=chosen.attitude,
        notes=(*aligned.notes, *_notes(take, tracks, chosen)),
    )
    return Solution(replace(motion, notes=(*motion.notes, *doubts(motion))), tracks)


def solve_tracks(take: Take, options: SolveOptions) -> dict[SensorId, SensorTrack]:
    """Return the attitude of every sensor, without any body."""
    tracks = tracks_of(take, options.attitude, _calibrations(take, options))
    if take.setup.mounting == "strapped":
        worn = level_by_straps(_worn(take, tracks), _poses(take, options), take.duration())
        tracks |= {take.setup.assignment.sensors[place]: track for place, track in worn.items()}
    return tracks


def find_alignment(take: Take, tracks: Mapping[SensorId, SensorTrack], options: SolveOptions) -> Aligned:
    """Return how the sensors sit: by the poses held in the take, as carried into it, or by its first second.

    Poses held in the take count where they tell of no limb less than what is carried into it.

    Raises
    ------
    AlignmentError
        No pose is known, limbs moved in all, or no limb's heading is known.
    """
    poses, carried = _poses(take, options), take.setup.carried
    if any(mark.label in REFERENCE_POSES for mark in poses):
        try:
            held = _held(take, tracks, poses)
        except NoSensorWorn:
            raise
        except AlignmentError:
            if carried is None:
                raise
        else:
            # One more N-pose tells where everybody faced, and less of the straps than what was held before the take.
            if carried is None or not worse_limbs(held.alignment, carried.alignment):
                return held
    if carried is not None:
        return _carried(take, tracks, poses, carried)
    assumed = Mark(0.0, "pose", "n", min(ASSUMED_POSE, take.duration()))
    try:
        aligned = _held(take, tracks, (assumed, *poses))
    except (MovedDuringHold, PoseTooShort):
        raise PoseMissing(take.duration()) from None
    note = "No pose was marked: the first second is taken for N-pose, and all angles are relative to it."
    return aligned._replace(notes=(note, *aligned.notes))


def _held(take: Take, tracks: Mapping[SensorId, SensorTrack], poses: tuple[Mark, ...]) -> Aligned:
    setup, duration = take.setup, take.duration()
    alignment = align(tracks, setup.assignment, poses, setup.mounting, duration)
    require_headings(alignment)
    headings = headings_of(_worn(take, tracks), alignment, poses, duration)
    refused = refused_holds(tracks, setup.assignment, poses, alignment, duration)
    notes = [f"Moved in the hold {hold.pose}, so that it tells nothing: {_listed(hold.places)}." for hold in refused]
    notes += [*_stood_otherwise(take, tracks, alignment, poses), *_drifted(take, tracks, alignment, poses, headings)]
    return Aligned(alignment, headings, (*notes, *_unknown(alignment, headings)))


def _stood_otherwise(
    take: Take, tracks: Mapping[SensorId, SensorTrack], alignment: Alignment, poses: tuple[Mark, ...]
) -> list[str]:
    notes = []
    for mark in poses:
        if mark.label in REFERENCE_POSES:
            holds = hold_all(_worn(take, tracks), mark, take.duration(), required=False)
            limbs = misheld(alignment, mark.label, holds)
            if limbs:
                names = _listed(place.value for place in alignment.limbs if place in limbs)
                notes.append(
                    f"Not held like the pose {mark.label} at {mark.time:.1f} s, so that it tells nothing: {names}."
                )
    return notes


def _drifted(
    take: Take,
    tracks: Mapping[SensorId, SensorTrack],
    alignment: Alignment,
    poses: tuple[Mark, ...],
    headings: GroupHeadings,
) -> list[str]:
    notes = []
    for mark, limbs in drifted(_worn(take, tracks), alignment, poses, take.duration(), headings):
        named = _listed(f"{place.value} by {abs(math.degrees(angle)):.0f}°" for place, angle in limbs.items())
        notes.append(f"In the pose {mark.label} held at {mark.time:.1f} s, headings had drifted: {named}.")
    return notes


def _carried(
    take: Take, tracks: Mapping[SensorId, SensorTrack], poses: tuple[Mark, ...], carried: CarriedAlignment
) -> Aligned:
    worn = _worn(take, tracks)
    if not worn:
        raise NoSensorWorn(len(tracks))
    headings = headings_of(worn, carried.alignment, poses, take.duration(), carried)
    if not any(headings.values()):
        raise HeadingsUnknown(tuple(place.value for place in worn))
    since = carried.time - carried.alignment.to_s
    note = f"The body was calibrated {since:.0f} s before the take began; no pose was held in it."
    if any(mark.label in REFERENCE_POSES for mark in poses):
        note = (
            f"The body was calibrated {since:.0f} s before the take began; the poses held in it tell less of how the "
            "tags sit and could not be used for that."
        )
    otherwise = _stood_otherwise(take, tracks, carried.alignment, poses)
    otherwise += _drifted(take, tracks, carried.alignment, poses, headings)
    return Aligned(carried.alignment, headings, (note, *otherwise, *_unknown(carried.alignment, headings)))


def _worn(take: Take, tracks: Mapping[SensorId, SensorTrack]) -> dict[Place, SensorTrack]:
    return {place: tracks[sensor] for place, sensor in take.setup.assignment.sensors.items() if sensor in tracks}


def _unknown(alignment: Alignment, headings: GroupHeadings) -> tuple[str, ...]:
    unknown = [place.value for place in alignment.limbs if not headings.get(place)]
    return (f"Heading unknown, so shown without a sensor of its own: {_listed(unknown)}.",) if unknown else ()


def _listed(places: Iterable[str]) -> str:
    return ", ".join(place.replace("_", " ") for place in places)


def _calibrations(take: Take, options: SolveOptions) -> Mapping[SensorId, Calibration]:
    if options.calibrations is not None:
        return options.calibrations
    return {calibration.sensor: calibration for calibration in take.setup.calibrations}


def _poses(take: Take, options: SolveOptions) -> tuple[Mark, ...]:
    return options.poses or take.poses()


def _segment(
    track: SensorTrack, alignment: Alignment, place: Place, headings: Mapping[int, float], time: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return world_from_segment (n, 4) of one place."""
    sensor_from_segment = np.array(alignment.limbs[place].sensor_from_segment)
    nearest = _nearest(track, time)
    # Where a restarted sensor has no heading yet, a known one stands in; ``measured`` is False there.
    fallback = next(iter(headings.values()))
    heading = np.array([headings.get(int(group), fallback) for group in track.group[nearest]])
    headed = rotation.multiply(rotation.about(2, heading), attitude_at(track, time))
    return rotation.multiply(headed, sensor_from_segment)


def _nearest(track: SensorTrack, time: NDArray[np.float64]) -> NDArray[np.intp]:
    after = np.clip(np.searchsorted(track.time, time), 1, max(len(track.time) - 1, 1))
    closer = time - track.time[after - 1] < track.time[np.minimum(after, len(track.time) - 1)] - time
    return np.asarray(np.where(closer, after - 1, np.minimum(after, len(track.time) - 1)))


def _coverage(
    track: SensorTrack, headings: Mapping[int, float], time: NDArray[np.float64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return (measured, lost) on the grid."""
    if not len(track.time):
        return np.zeros(len(time), bool), np.ones(len(time), bool)
    nearest = _nearest(track, time)
    near = np.abs(track.time[nearest] - time) <= track.info.frame_s
    known = np.isin(track.group[nearest], list(headings))
    return near & known, track.lost[nearest] | ~near


def _notes(take: Take, tracks: Mapping[SensorId, SensorTrack], options: SolveOptions) -> tuple[str, ...]:
    notes = []
    if not take.setup.stature_known:
        notes.append(f"Nobody entered a stature: {take.setup.stature:.2f} m is assumed for all lengths.")
    other = sorted({t.estimator for t in tracks.values() if t.estimator != options.attitude})
    if other:
        notes.append(f"Some sensors cannot serve the attitude filter {options.attitude}; they use {', '.join(other)}.")
    doubled = _not_corrected(take, options)
    if doubled:
        notes.append(
            "These tags correct by themselves and did not tell how, so that no other calibration was applied: "
            f"{_listed(doubled)}."
        )
    return tuple(notes)


def _not_corrected(take: Take, options: SolveOptions) -> list[str]:
    """Return the places, or the names, of tags whose calibration is not in force because it would be a second one."""
    calibrations = _calibrations(take, options)
    names = []
    for stream in take.streams:
        calibration = calibrations.get(stream.info.sensor)
        if calibration is not None and in_force(stream.info, flags_of(stream), calibration) is None:
            place = take.setup.assignment.place_of(stream.info.sensor)
            names.append(stream.info.sensor if place is None else place.value)
    return names


def _solve_live(take: Take, options: SolveOptions) -> Solution:
    """Replay the samples through ``Solver`` in their order of arrival; the alignment found on the way holds for all."""
    solver = Solver(take.setup, options.attitude, _calibrations(take, options))
    for stream in take.streams:
        solver.add_sensor(stream.info)
    history = FrameLog(take.setup.assignment.sensors.values())
    for sample in samples_of(take):
        history.extend(solver.push(sample))
    tracks = solver.tracks()
    aligned = find_alignment(take, tracks, options)
    solver.use(aligned.alignment, aligned.headings)
    motion = solver.motion(history, (*aligned.notes, *_notes(take, tracks, options)))
    return Solution(replace(motion, notes=(*motion.notes, *doubts(motion))), tracks)
