"""A line about each take of the library, and what people may change of it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import msgspec
import numpy as np

from studio.core.body import Place
from studio.core.errors import FolderNotWritable, NotATake, TakeFileError
from studio.storage.limits import LONGEST_TAKE
from studio.storage.sample_table import Rows
from studio.storage.session_folder import list_takes
from studio.storage.take_ends import Ends, read_ends
from studio.storage.take_json import Verdict, load_document, save_document
from studio.storage.take_reader import started_at, take_file

DAY_LENGTH = len("2026-11-24")


@dataclass(frozen=True)
class TakeSummary:
    """What the list of takes shows of one."""

    folder: Path
    person: str
    """Code; the name of the folder where the file does not tell."""
    session: str
    """The name of its folder: the day and a letter."""
    name: str
    started: str = ""
    """ISO 8601 UTC; empty when the recording does not tell."""
    duration_s: float = 0.0
    """s, from the first to the last kept sample."""
    samples: int = 0
    sensors: int = 0
    frame_s: float = math.nan
    """s, nominal, of the fastest sensor; NaN when no sensor tells."""
    places: tuple[Place, ...] = ()
    """Where sensors sat, in the order of Table 1."""
    lost: float = math.nan
    """Share of the samples that were expected and are not there, 0…1; NaN when it cannot be told."""
    recovered: bool = False
    """The recording was cut off."""
    verdict: Verdict = "none"
    notes: str = ""
    refusal: TakeFileError | None = None
    """Why the take cannot be read; all else is then what its folders tell."""


def summaries(library: Path) -> list[TakeSummary]:
    """Return a summary of each take of the library, newest first."""
    return sorted((summarise(take.folder) for take in list_takes(library)), key=age_order, reverse=True)


def age_order(summary: TakeSummary) -> tuple[float, str]:
    """Return what sorts takes from the oldest to the newest."""
    for told in (summary.started, summary.session[:DAY_LENGTH]):
        try:
            moment = datetime.fromisoformat(told)
            return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp(), str(summary.folder)
        except (ValueError, OverflowError):
            continue
    return 0.0, str(summary.folder)


def summarise(folder: Path) -> TakeSummary:
    """Return what the ends of a take's file and its ``take.json`` tell; a take that cannot be read says why."""
    bare = TakeSummary(folder, folder.parent.parent.name, folder.parent.name, folder.name)
    try:
        file = take_file(folder)
        with file.open("rb") as stream:
            ends = read_ends(file, stream)
    except TakeFileError as refusal:
        return replace(bare, refusal=refusal)
    except OSError:
        return replace(bare, refusal=NotATake(str(folder)))
    recorded = _recorded(bare, ends)
    document, _ = load_document(folder, recorded.name, repair=False)
    places = recorded.places if document.setup is None else document.setup.assignment.places()
    return replace(recorded, name=document.name, notes=document.notes, verdict=document.verdict, places=places)


def keep_summary(summary: TakeSummary) -> None:
    """Keep what people may change of a take: its name, notes and verdict.

    Raises
    ------
    NotATake, WrittenByNewerStudio, FolderNotWritable
        NotATake when the take or its whole library is gone meanwhile.
    """
    take_file(summary.folder)
    document, _ = load_document(summary.folder, summary.name, repair=False)
    changed = msgspec.structs.replace(document, name=summary.name, notes=summary.notes, verdict=summary.verdict)
    try:
        save_document(summary.folder, changed)
    except OSError as error:
        raise FolderNotWritable(str(summary.folder)) from error


def _recorded(bare: TakeSummary, ends: Ends) -> TakeSummary:
    zero = next((record.zero_s for record in ends.sensors.values()), math.nan)
    times = ends.last["time"] - zero
    times = times[np.abs(times) <= LONGEST_TAKE]
    duration = max(float(times.max()), 0.0) if len(times) else 0.0
    if ends.counts is not None:
        samples = sum(ends.counts.get(channel, 0) for channel in ends.sensors)
    else:  # messages of sensors carry their position among all samples of the take
        samples = int(ends.last["sequence"].max()) + 1 if len(ends.last) else 0
    expected = sum(_expected(ends, duration)) if samples else 0.0
    known = ends.identity
    frames = [record.info.frame_s for record in ends.sensors.values() if record.info.frame_s > 0]
    return replace(
        bare,
        person=known.person or bare.person if known else bare.person,
        name=known.name if known else bare.name,
        started=started_at(known.anchor, zero) if known else "",
        duration_s=duration,
        samples=samples,
        sensors=len(ends.sensors),
        frame_s=min(frames, default=math.nan),
        places=known.setup.assignment.places() if known else (),
        lost=min(max(1.0 - samples / expected, 0.0), 1.0) if expected > 0 else math.nan,
        recovered=ends.recovered,
    )


def _expected(ends: Ends, duration: float) -> Iterator[float]:
    """Yield how many samples each sensor sent, by its own count where that runs from end to end."""
    first, last = _Counted(ends.first), _Counted(ends.last)
    for channel, record in ends.sensors.items():
        begin, end = np.flatnonzero(first.channel == channel), np.flatnonzero(last.channel == channel)
        if len(begin) and len(end) and first.epoch[begin[0]] == last.epoch[end[-1]]:
            yield float(int(last.frame[end].max()) - int(first.frame[begin].min()) + 1)
            continue
        frame_s = record.info.frame_s
        yield math.floor(duration / frame_s + 1e-6) + 1.0 if frame_s > 0 else math.nan


class _Counted:
    """Columns of rows, each in one piece: they are looked at once for each sensor."""

    def __init__(self, rows: Rows) -> None:
        self.channel = rows["channel"].copy()
        self.epoch = rows["epoch"].copy()
        self.frame = rows["frame"].copy()
