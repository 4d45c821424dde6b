"""Take file to ``Take``: everything that is undamaged, and an account of what is not."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path
from struct import Struct

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import Damaged, NotATake, TakeUnsafe
from studio.core.sample import SensorId, SensorInfo, Stream
from studio.core.take import Mark, Take
from studio.storage.block_reader import BlockReader, Messages
from studio.storage.documents import State
from studio.storage.facts import (
    NOT_JSON,
    Anchor,
    Event,
    SensorRecord,
    clean,
    cleaned,
    event_mark,
    event_sensor,
    from_json,
)
from studio.storage.profile import (
    EVENT_TOPIC,
    IMU_TOPIC,
    MAX_SAMPLES,
    MESSAGE,
    MESSAGE_HEAD_SIZE,
    PART_FILE,
    RAW_TOPIC,
    RECORD_HEAD_SIZE,
    SAMPLE_DTYPE,
    SAMPLE_LENGTH,
    TAKE_FILE,
)
from studio.storage.take_json import load_document

MAX_EVENTS = 1_000_000  # a marker every 40 ms for 12 h
_RAW = Struct("<qI")
_LENGTH = Struct("<Q")


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
        content = _collect(reader, file)
    if reader.identity is None and not content.zeros:
        raise Damaged(str(file), 0.0)
    zero = next(iter(content.zeros.values()), reader.identity.anchor.monotonic if reader.identity else 0.0)
    infos = content.infos | {info.sensor: info for info in content.told if info.sensor in content.infos}
    streams = tuple(_stream(infos[sensor], rows, zero) for sensor, rows in content.rows.items())
    take = _take(reader, streams, content.marks(zero), zero)
    # Beside a single file that somebody was sent there may be anything.
    document, state = load_document(file.parent, take.name, repair=path.is_dir())
    report = ReadReport(
        finished=reader.finished,
        recovered=not reader.finished or any(event.kind == "recovered" for event in content.events),
        chunks=reader.chunks,
        damaged=reader.damaged + content.unusable,
        samples=sum(map(len, streams)),
        until_s=max((float(stream.time[-1]) for stream in streams if len(stream)), default=0.0),
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
            for body in _bodies(messages):
                for received, data in _pieces(body):
                    yield channel.topic.removeprefix(RAW_TOPIC), received - zero, data


def read_events(path: Path) -> list[Event]:
    """Return everything that was noted while recording, in order, in take time."""
    with _opened(path) as (reader, file):
        content = _collect(reader, file)
    zero = next(iter(content.zeros.values()), 0.0)
    return [Event(event.kind, event.received - zero, event.facts) for event in content.events]


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
                if channel.topic.startswith(IMU_TOPIC):
                    try:
                        return from_json(channel.metadata.get("sensor", ""), SensorRecord).zero_s
                    except NOT_JSON:
                        continue
    return 0.0


def sample_rows(messages: Messages) -> NDArray[np.void] | None:
    """Return the messages of a chunk of sensors as rows, None when they are something else."""
    if len(messages.data) % SAMPLE_DTYPE.itemsize:
        return None
    rows = np.frombuffer(messages.data, SAMPLE_DTYPE)
    if not ((rows["opcode"] == MESSAGE) & (rows["length"] == SAMPLE_LENGTH)).all():
        return None
    return rows


def started_at(anchor: Anchor, zero: float) -> str:
    """Return the UTC of take time 0; as the anchor has it when they are the same instant."""
    elapsed = zero - anchor.monotonic
    if not anchor.utc or elapsed == 0 or not math.isfinite(elapsed):
        return anchor.utc
    try:
        return (datetime.fromisoformat(anchor.utc) + timedelta(seconds=elapsed)).isoformat()
    except (ValueError, OverflowError):
        return ""


class _Content:
    """What the chunks of a take hold, sorted by what they are."""

    def __init__(self, file: Path) -> None:
        self.infos: dict[SensorId, SensorInfo] = {}
        self.zeros: dict[SensorId, float] = {}
        self.rows: dict[SensorId, NDArray[np.void]] = {}
        self.events: list[Event] = []
        self.told: list[SensorInfo] = []
        self.unusable = 0
        self._file = file

    def add_sensors(self, reader: BlockReader, chunks: list[Messages]) -> None:
        """Sort the rows of all chunks by sensor."""
        tables = [rows for rows in map(sample_rows, chunks) if rows is not None]
        self.unusable += len(chunks) - len(tables)
        table = np.concatenate(tables) if tables else np.empty(0, SAMPLE_DTYPE)
        used = 0
        for channel in reader.channels.values():
            if not channel.topic.startswith(IMU_TOPIC):
                continue
            rows = table[table["channel"] == channel.id]
            used += len(rows)
            if (np.diff(rows["sequence"].astype(np.int64)) < 0).any():
                rows = rows[np.argsort(rows["sequence"], kind="stable")]
            self._add_sensor(channel.topic.removeprefix(IMU_TOPIC), channel.metadata, rows)
        self.unusable += len(table) - used

    def add_events(self, messages: Messages) -> None:
        """Read the events of a chunk."""
        for body in _bodies(messages):
            try:
                event = from_json(body, Event)
            except NOT_JSON:
                self.unusable += 1
                continue
            self.events.append(event)
            if event.kind == "sensor":
                self._add_told(event)
        if len(self.events) > MAX_EVENTS:
            raise TakeUnsafe(str(self._file), f"more than {MAX_EVENTS} events")

    def marks(self, zero: float) -> tuple[Mark, ...]:
        """Return the marks among the events."""
        marks = []
        for event in self.events:
            if event.kind == "mark":
                try:
                    marks.append(event_mark(event, zero))
                except NOT_JSON:
                    self.unusable += 1
        return tuple(marks)

    def _add_told(self, event: Event) -> None:
        try:
            self.told.append(event_sensor(event))
        except NOT_JSON:
            self.unusable += 1

    def _add_sensor(self, name: str, metadata: dict[str, str], rows: NDArray[np.void]) -> None:
        try:
            record = from_json(metadata.get("sensor", ""), SensorRecord)
        except NOT_JSON:
            self.unusable += max(len(rows), 1)
            return
        if record.info.sensor != name or clean(name) != name or name in self.infos:
            raise TakeUnsafe(str(self._file), "a channel and its sensor have different names")
        sensor = SensorId(name)
        self.infos[sensor] = cleaned(record.info)
        self.zeros[sensor] = record.zero_s
        self.rows[sensor] = rows


def _collect(reader: BlockReader, file: Path) -> _Content:
    content = _Content(file)
    sensors: list[Messages] = []
    unknown: list[Messages] = []
    samples = 0
    for messages in reader.messages():
        channel = reader.channels.get(messages.channel)
        if channel is None:
            unknown.append(messages)
        elif channel.topic == EVENT_TOPIC:
            content.add_events(messages)
        elif channel.topic.startswith(IMU_TOPIC):
            sensors.append(messages)
            samples += len(messages.data) // SAMPLE_DTYPE.itemsize
        if samples > MAX_SAMPLES:
            raise TakeUnsafe(str(file), f"more than {MAX_SAMPLES} samples")
    # Where the start is damaged, the channels are known only from their repetition further on.
    known = [m for m in unknown if m.channel in reader.channels]
    content.unusable += len(unknown) - len(known)
    for messages in known:
        if reader.channels[messages.channel].topic == EVENT_TOPIC:
            content.add_events(messages)
    early = [m for m in known if reader.channels[m.channel].topic.startswith(IMU_TOPIC)]
    content.add_sensors(reader, early + sensors)
    return content


def _stream(info: SensorInfo, rows: NDArray[np.void], zero: float) -> Stream:
    return Stream(
        info=info,
        arrival=rows["sequence"].astype(np.int64),
        epoch=rows["epoch"].astype(np.int32),
        frame=rows["frame"].astype(np.int64),
        device_time=rows["device_time"].astype(np.float64),
        time=rows["time"] - zero,
        received=rows["received"] - zero,
        orientation=rows["orientation"].astype(np.float64),
        rate=rows["rate"].astype(np.float64),
        acceleration=rows["acceleration"].astype(np.float64),
        flags=rows["flags"].astype(np.uint32),
        battery=rows["battery"].astype(np.float64),
        temperature=rows["temperature"].astype(np.float64),
        rssi=rows["rssi"].astype(np.float64),
    )


def _take(reader: BlockReader, streams: tuple[Stream, ...], marks: tuple[Mark, ...], zero: float) -> Take:
    known = reader.identity
    if known is None:
        return Take("", "", "", "", streams, marks)
    return Take(
        name=known.name,
        person=known.person,
        source=known.source,
        started=started_at(known.anchor, zero),
        streams=streams,
        marks=marks,
        setup=known.setup,
        versions=known.versions,
    )


def _bodies(messages: Messages) -> Iterator[bytes]:
    (length,) = _LENGTH.unpack_from(messages.data, 1)
    stride = RECORD_HEAD_SIZE + length
    for start in range(0, len(messages.data), stride):
        yield messages.data[start + MESSAGE_HEAD_SIZE : start + stride]


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
