"""Take file to ``Take``: everything that is undamaged, and an account of what is not."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from pathlib import Path
from struct import Struct

import numpy as np

from studio.core.errors import Damaged, NotATake, TakeUnsafe
from studio.core.sample import SensorInfo, Stream
from studio.core.take import Take
from studio.storage.block_reader import BlockReader
from studio.storage.documents import State
from studio.storage.facts import Anchor, Event, Identity
from studio.storage.limits import frames_fault, nominal_frame
from studio.storage.profile import IMU_TOPIC, PART_FILE, RAW_TOPIC, TAKE_FILE
from studio.storage.sample_table import Rows
from studio.storage.take_content import TakeContent, bodies, sensor_record
from studio.storage.take_json import load_document

_RAW = Struct("<qI")


@dataclass(frozen=True)
class ReadReport:
    """What of a take file could be read."""

    finished: bool
    """The file has its end: recording was stopped and not cut off."""
    recovered: bool
    """The recording was cut off, and perhaps given its end later; what is there is what was safe by then."""
    chunks: int
    damaged: int
    """Chunks, blocks and messages that could not be used."""
    samples: int
    until_s: float
    """s of take time, the last sample."""
    document: State
    """What was found in the place of take.json."""


def take_file(path: Path) -> Path:
    """Return the take file in a folder, or the file itself; NotATake when there is none."""
    if path.is_file():
        return path
    for name in (TAKE_FILE, PART_FILE):
        if (path / name).is_file():
            return path / name
    raise NotATake(str(path))


def read_take(path: Path) -> tuple[Take, ReadReport]:
    """Read a take from its folder or file, finished or not, as take.json has it now.

    Raises
    ------
    NotATake, WrittenByNewerStudio, TakeUnsafe, Damaged
        Damaged only when nothing can be used: a take with holes is read, and the report tells.
    """
    with _opened(path) as (reader, file):
        content = TakeContent(reader, file)
    if reader.identity is None and not content.infos:
        raise Damaged(str(file), 0.0)
    streams = tuple(_stream(info, content.take_rows(sensor), content.zero) for sensor, info in content.infos.items())
    fault = frames_fault(streams)
    if fault:
        raise TakeUnsafe(str(file), f"{fault} of the samples leaves far more out than it tells")
    take = _take(reader.identity, streams, content)
    # Beside a single file that somebody was sent there may be anything.
    document, state = load_document(file.parent, take.name, repair=path.is_dir())
    report = ReadReport(
        finished=reader.finished,
        recovered=not reader.finished or any(event.kind == "recovered" for event in content.events),
        chunks=reader.chunks,
        damaged=reader.damaged + content.unusable,
        samples=sum(map(len, streams)),
        until_s=take.duration(),
        document=state,
    )
    return document.applied(take), report


def read_raw(path: Path) -> Iterator[tuple[str, float, bytes]]:
    """Yield (link, s of take time, bytes) as the reads of each link gave them."""
    with _opened(path) as (reader, file):
        zero = take_zero(file)
        for messages in reader.messages():
            channel = reader.channels.get(messages.channel)
            if channel is None or not channel.topic.startswith(RAW_TOPIC):
                continue
            for body in bodies(messages):
                for received, data in _pieces(body):
                    yield channel.topic.removeprefix(RAW_TOPIC), received - zero, data


def read_events(path: Path) -> list[Event]:
    """Return everything that was noted while recording, in order, in take time."""
    with _opened(path) as (reader, file):
        content = TakeContent(reader, file)
    return [Event(event.kind, event.received - content.zero, event.facts) for event in content.events]


def read_attachment(path: Path, name: str) -> bytes | None:
    """Return an attachment put together from its parts, None when it is not there or not whole."""
    parts: dict[int, bytes] = {}
    expected = 0
    with _opened(path) as (reader, _):
        for attachment in reader.attachments():
            if attachment.name == name:
                return bytes(attachment.data)
            called, _, position = attachment.name.rpartition(".part-")
            part, _, count = position.partition("-of-")
            if called == name and part.isdecimal() and count.isdecimal():
                parts[int(part)] = attachment.data
                expected = int(count)
    if not expected or set(parts) != set(range(1, expected + 1)):
        return None
    return b"".join(parts[part] for part in sorted(parts))


def take_zero(path: Path) -> float:
    """Return take time 0 on the clock of ``Sample.time`` while it was recorded, s."""
    with _opened(path) as (reader, _):
        for _ in reader.messages():
            for channel in reader.channels.values():
                record = sensor_record(channel, path) if channel.topic.startswith(IMU_TOPIC) else None
                if record is not None:
                    return record.zero_s
    return 0.0


def started_at(anchor: Anchor, zero: float) -> str:
    """Return the UTC of take time 0; as the anchor has it when they are the same instant."""
    elapsed = zero - anchor.monotonic
    if not anchor.utc or elapsed == 0 or not math.isfinite(elapsed):
        return anchor.utc
    try:
        return (datetime.fromisoformat(anchor.utc) + timedelta(seconds=elapsed)).isoformat()
    except (ValueError, OverflowError):
        return ""


def _stream(info: SensorInfo, rows: Rows, zero: float) -> Stream:
    time = rows["time"] - zero
    return Stream(
        info=replace(info, frame_s=nominal_frame(info, time)),
        arrival=rows["sequence"].astype(np.int64),
        epoch=rows["epoch"].astype(np.int32),
        frame=rows["frame"].astype(np.int64),
        device_time=rows["device_time"].astype(np.float64),
        time=time,
        received=rows["received"] - zero,
        orientation=rows["orientation"].astype(np.float64),
        rate=rows["rate"].astype(np.float64),
        acceleration=rows["acceleration"].astype(np.float64),
        flags=rows["flags"].astype(np.uint32),
        battery=rows["battery"].astype(np.float64),
        temperature=rows["temperature"].astype(np.float64),
        rssi=rows["rssi"].astype(np.float64),
    )


def _take(known: Identity | None, streams: tuple[Stream, ...], content: TakeContent) -> Take:
    if known is None:
        return Take("", "", "", "", streams, content.marks)
    return Take(
        name=known.name,
        person=known.person,
        source=known.source,
        started=started_at(known.anchor, content.zero),
        streams=streams,
        marks=content.marks,
        setup=known.setup,
        versions=known.versions,
    )


def _pieces(body: bytes) -> Iterator[tuple[float, bytes]]:
    position = 0
    while position + _RAW.size <= len(body):
        received, size = _RAW.unpack_from(body, position)
        position += _RAW.size
        if size > len(body) - position:
            return
        yield received * 1e-9, body[position : position + size]
        position += size


@contextmanager
def _opened(path: Path) -> Iterator[tuple[BlockReader, Path]]:
    file = take_file(path)
    try:
        stream = file.open("rb")
    except OSError as error:
        raise NotATake(str(file)) from error
    with stream:
        yield BlockReader(stream, file), file
