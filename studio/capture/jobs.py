"""Offline work as frozen requests and plain functions: what the worker process runs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from studio.core.pose import Motion
from studio.core.sample import SensorId
from studio.core.solver import SolveOptions, solve, solve_tracks
from studio.core.take import Alignment, Calibration, Mark, Take
from studio.export.file_target import check_target
from studio.export.material import Material, Wish
from studio.export.registry import export_file
from studio.export.sidecar import digest_of
from studio.export.stand_ins import stand_ins
from studio.importers.bvh import read_bvh
from studio.storage.motion_file import load_motion, motion_key, save_motion
from studio.storage.tag_file import load_tag, read_calibration, tags_folder
from studio.storage.take_reader import read_take

Progress = Callable[[str, float], None]
"""Called with what is being done and how far it is, 0…1."""


@dataclass(frozen=True)
class SolveRequest:
    """Solve a take as a person chose."""

    take: Path
    attitude: str = "vqf"
    method: str = "offline"
    calibration: str = "recorded"
    """``recorded``, ``latest`` (of each tag, on this computer) or the path of a calibration file."""
    poses: tuple[Mark, ...] = ()
    stature: float | None = None
    """m, for this run only. None: as recorded."""


@dataclass(frozen=True)
class ExportRequest:
    """Solve a take if needed and write one file."""

    solve: SolveRequest
    exporter: str
    wish: Wish
    target: Path
    overwrite: bool = False
    """Whatever stands at the target is replaced; else only what this studio wrote from the same take."""


class Offset(NamedTuple):
    """What was subtracted from one gyroscope."""

    estimator: str
    value: tuple[float, ...]
    """rad/s, after the tag's own correction."""
    sigma: float
    """rad/s; NaN when nothing was measured."""


class SolveReport(NamedTuple):
    """What a person is told about a solved take; the motion itself is in ``derived/``."""

    key: str
    frames: int
    frame_s: float
    method: str
    attitude: str
    alignment: Alignment
    notes: tuple[str, ...]
    offsets: Mapping[SensorId, Offset]


@dataclass(frozen=True)
class Loaded:
    """A take with the options it is to be solved with."""

    take: Take
    options: SolveOptions
    key: str = field(repr=False)
    notes: tuple[str, ...]
    """What differs from the take as it was recorded."""


def run_solve(request: SolveRequest, progress: Progress) -> SolveReport:
    """Solve a take, keep its motion in ``derived/`` and return the report.

    Raises
    ------
    TakeFileError, CalibrationError, AlignmentError
    """
    loaded = load(request, progress)
    progress("solve", 0.2)
    solution = solve(loaded.take, loaded.options)
    motion = solution.motion
    keep(request.take, loaded.key, motion)
    progress("solve", 1.0)
    offsets = {
        sensor: Offset(track.estimator, tuple(track.offset.tolist()), track.offset_sigma)
        for sensor, track in solution.tracks.items()
    }
    notes = (*motion.notes, *loaded.notes)
    return SolveReport(
        loaded.key, len(motion), motion.frame_s, motion.method, motion.attitude, motion.alignment, notes, offsets
    )


def run_export(request: ExportRequest, progress: Progress) -> tuple[Path, tuple[str, ...]]:
    """Write a file, read it back, and return its path and the notes of the motion.

    Raises
    ------
    TakeFileError, CalibrationError, AlignmentError, ExportError
    """
    loaded = load(request.solve, progress)
    check_target(request.target, digest_of(loaded.take), request.exporter, overwrite=request.overwrite)
    progress("solve", 0.2)
    motion, orientations = None, {}
    if request.exporter in ("bvh", "joints"):
        motion, _ = motion_of(request.solve.take, loaded)
        stood_in = stand_ins(motion) if request.exporter == "bvh" else ()
        motion = replace(motion, notes=(*motion.notes, *loaded.notes, *stood_in))
    if request.exporter == "orientations":
        tracks = solve_tracks(loaded.take, loaded.options)
        orientations = {sensor: (track.time, track.attitude) for sensor, track in tracks.items()}
    progress("write", 0.6)
    material = Material(loaded.take, motion, orientations, read_bvh)
    written, _ = export_file(request.exporter, material, request.wish, request.target)
    progress("write", 1.0)
    return written, motion.notes if motion is not None else loaded.notes


def motion_of(folder: Path, loaded: Loaded) -> tuple[Motion, bool]:
    """Return the motion of a take, computed unless that was done before, and whether it is kept in ``derived/``."""
    kept = load_motion(folder, loaded.key)
    if kept is not None:
        return kept, True
    motion = solve(loaded.take, loaded.options).motion
    return motion, keep(folder, loaded.key, motion)


def load(request: SolveRequest, progress: Progress) -> Loaded:
    """Return the take of a request and its options."""
    progress("read", 0.0)
    recorded, _ = read_take(request.take)
    take = recorded
    if request.stature is not None:
        take = replace(take, setup=replace(take.setup, stature=request.stature, stature_known=True))
    options = SolveOptions(
        attitude=request.attitude,
        method="live" if request.method == "live" else "offline",
        poses=request.poses,
        calibrations=_calibrations(request.calibration, take),
    )
    return Loaded(take, options, motion_key(request.take, take, options), _departures(request, recorded))


def _departures(request: SolveRequest, recorded: Take) -> tuple[str, ...]:
    notes = []
    if request.stature is not None and (request.stature, True) != (
        recorded.setup.stature,
        recorded.setup.stature_known,
    ):
        before = f"{recorded.setup.stature:.2f} m" if recorded.setup.stature_known else "none"
        notes.append(f"Stature {request.stature:.2f} m for this run only; the take has {before}.")
    if request.poses and recorded.poses():
        named, kept = _spans(request.poses), _spans(recorded.poses())
        notes.append(f"The poses named for this run ({named}) replace all those of the take ({kept}).")
    return tuple(notes)


def _spans(poses: Sequence[Mark]) -> str:
    return ", ".join(f"{mark.label} {mark.time:.1f} to {np.fmax(mark.end, mark.time):.1f} s" for mark in poses)


def keep(folder: Path, key: str, motion: Motion) -> bool:
    """Keep a motion in ``derived/`` and return whether that was possible: not in a library that cannot be written."""
    try:
        save_motion(folder, key, motion)
    except OSError:
        return False
    return True


def _calibrations(choice: str, take: Take) -> Mapping[SensorId, Calibration] | None:
    if choice == "recorded":
        return None
    if choice == "latest":
        tags = [load_tag(stream.info.sensor, tags_folder()) for stream in take.streams]
        found = [tag.calibrations[0] for tag in tags if tag.calibrations]
    else:
        found = list(read_calibration(Path(choice)))
    newest: dict[SensorId, Calibration] = {}
    for calibration in found:
        newest.setdefault(calibration.sensor, calibration)
    return newest
