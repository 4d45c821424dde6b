"""A take that is in memory (imported, or made by a test) to its place in the library."""

from datetime import UTC, date, datetime
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.sample import Stream
from studio.core.take import Take
from studio.storage.encoder import TakeEncoder, stamp
from studio.storage.facts import Anchor, identity, mark_event
from studio.storage.filesystem import FILES, FileSystem
from studio.storage.profile import CDR_LITTLE_ENDIAN, MESSAGE, SAMPLE_DTYPE, SAMPLE_LENGTH
from studio.storage.session_folder import open_session
from studio.storage.take_file import TakeFile

_FIELDS = (
    "device_time", "time", "received", "orientation", "rate", "acceleration", "frame", "battery", "temperature", "rssi",
    "epoch", "flags",
)  # fmt: skip


def write_take(
    take: Take,
    library: Path,
    day: date | None = None,
    attachments: tuple[tuple[str, str, bytes], ...] = (),
    filesystem: FileSystem = FILES,
) -> Path:
    """Store a take and return its folder, when it has been read back.

    Parameters
    ----------
    day : of the session it goes into; None: the day the take was recorded, today where it does not tell
    attachments : (name, media type, bytes)

    Raises
    ------
    PersonCodeInvalid, DiskFull, FolderNotWritable, VerificationFailed
    """
    anchor = Anchor(take.started, 0.0)
    encoder = TakeEncoder(identity(take.name, take.person, take.source, take.setup, take.versions, anchor), zero=0.0)
    file = TakeFile(open_session(library, take.person, day or _day(take.started)), take.name, encoder, filesystem)
    marks = [mark_event(mark) for mark in take.marks]
    for block in encoder.row_blocks(take_rows(take.streams, encoder), events=marks):
        file.append(block)
    for name, media_type, data in attachments:
        for block in encoder.attachment(name, media_type, data):
            file.append(block)
    saved = file.finish()
    if file.failure is not None:
        raise file.failure
    return saved.folder


def _day(started: str) -> date:
    now = datetime.now(UTC).astimezone()
    try:
        return datetime.fromisoformat(started).astimezone(now.tzinfo).date()
    except (ValueError, OverflowError):
        return now.date()


def take_rows(streams: tuple[Stream, ...], encoder: TakeEncoder) -> NDArray[np.void]:
    """Return the samples of all streams in the order of arrival, as they stand in a take file."""
    tables = []
    for stream in streams:
        rows = np.zeros(len(stream), SAMPLE_DTYPE)
        rows["opcode"], rows["length"], rows["cdr"] = MESSAGE, SAMPLE_LENGTH, CDR_LITTLE_ENDIAN
        rows["channel"] = encoder.channel_of(stream.info)
        rows["sequence"] = stream.arrival
        for name in _FIELDS:
            rows[name] = getattr(stream, name)
        stamp(rows)
        tables.append(rows)
    table = np.concatenate(tables) if tables else np.empty(0, SAMPLE_DTYPE)
    return np.asarray(table[np.argsort(table["sequence"], kind="stable")])
