"""The two ends of a take file: who and when, the first and the last samples, and how many lie between.

A list of thousands of takes cannot read them. What is damaged in the middle is not noticed here.
"""

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from io import BytesIO
from itertools import islice
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import AttachmentIndex, Channel, Statistics, SummaryOffset

from studio.core.errors import NotATake
from studio.storage.block_reader import BlockReader, Messages
from studio.storage.facts import Identity, SensorRecord
from studio.storage.profile import (
    EVENT_TOPIC,
    IMU_TOPIC,
    MAGIC,
    MAX_BLOCK,
    MAX_CHANNELS,
    RECORD_HEAD_SIZE,
    SAMPLE_DTYPE,
)
from studio.storage.sample_table import Rows, sample_rows
from studio.storage.take_content import sensor_record

FIRST_CHUNKS = 64  # among these are the first samples or there are none: a block of 0.1 s has two or three chunks
WINDOWS = (1 << 16, 1 << 20, 2 * MAX_BLOCK)  # bytes; the first holds four blocks of 15 tags, the last any block
GROUP_LIMIT = 1 << 20  # bytes of one group of the summary; 1000 channels need 0.7 MB
_FOOTER = struct.Struct("<BQQQI")  # MCAP "Footer": opcode, length, start of summary, start of its offsets, CRC
_RECORD = struct.Struct("<BQ")
_NOT_MCAP = (
    McapError,
    struct.error,
    UnicodeDecodeError,
    ValueError,
    OverflowError,
    OSError,
)  # OSError: a place no file has
_RECOVERED = b'"kind":"recovered"'


@dataclass(frozen=True)
class Ends:
    """What the ends of a take file tell."""

    identity: Identity | None
    sensors: Mapping[int, SensorRecord]
    """By channel."""
    first: Rows
    """The samples of the first chunk that has any."""
    last: Rows
    """The samples of the last chunk that has any."""
    counts: Mapping[int, int] | None
    """Messages by channel; None when the file has no end that tells."""
    recovered: bool
    """Recording was cut off, and perhaps the file was given its end later."""


@dataclass
class _Closing:
    """What stands behind the data of a finished file."""

    data_end: int
    attachments: int
    """Where the first one is, bytes; ``data_end`` without any."""
    counts: Mapping[int, int] | None = None


def read_ends(file: Path, stream: BinaryIO) -> Ends:
    """Read the ends of a take file.

    Raises
    ------
    NotATake, WrittenByNewerStudio, TakeUnsafe, OSError
    """
    head = BlockReader(stream, file)
    first = next((rows for m in islice(head.messages(), FIRST_CHUNKS) if _is_imu(m, head.channels)
                  and (rows := sample_rows(m)) is not None), _no_rows())  # fmt: skip
    closing = _closing(stream, head)
    end = stream.seek(0, 2) if closing is None else closing.attachments
    last, told = _last(stream, end, head)
    recovered = closing is None or told
    if closing is not None and closing.attachments < closing.data_end:
        window = _read(stream, max(closing.data_end - WINDOWS[0], 0), closing.data_end)
        recovered |= _tells_recovered(_chunks(window, head), head.channels)
    counts = None if closing is None else closing.counts
    return Ends(head.identity, _sensors(head.channels, file), first, last, counts, recovered)


def _sensors(channels: Mapping[int, Channel], file: Path) -> dict[int, SensorRecord]:
    records: dict[int, SensorRecord] = {}
    for number, channel in channels.items():
        if channel.topic.startswith(IMU_TOPIC):
            record = sensor_record(channel, file)
            if record is not None:
                records[number] = record
    return records


def _last(stream: BinaryIO, end: int, head: BlockReader) -> tuple[Rows, bool]:
    """Return the last samples, and whether the blocks around them say "recovered"; learn channels on the way."""
    recovered = False
    for width in WINDOWS:
        start = max(end - width, 0)
        chunks = _chunks(_read(stream, start, end), head)
        recovered |= _tells_recovered(chunks, head.channels)
        for messages in reversed(chunks):
            rows = sample_rows(messages) if _is_imu(messages, head.channels) else None
            if rows is not None:
                return rows, recovered
        if start == 0:
            break
    return _no_rows(), recovered


def _chunks(window: bytes, head: BlockReader) -> list[Messages]:
    reader = BlockReader(BytesIO(window), head.path)
    reader.channels, reader.identity = head.channels, head.identity
    try:
        return list(reader.messages())
    except NotATake:  # no block begins in this window
        return []


def _is_imu(messages: Messages, channels: Mapping[int, Channel]) -> bool:
    channel = channels.get(messages.channel)
    return channel is not None and channel.topic.startswith(IMU_TOPIC)


def _tells_recovered(chunks: list[Messages], channels: Mapping[int, Channel]) -> bool:
    events = {number for number, channel in channels.items() if channel.topic == EVENT_TOPIC}
    return any(messages.channel in events and _RECOVERED in messages.data for messages in chunks)


def _closing(stream: BinaryIO, head: BlockReader) -> _Closing | None:
    """Return what stands behind the data, None when the file was cut off; learn channels on the way."""
    size = stream.seek(0, 2)
    footer_at = size - len(MAGIC) - _FOOTER.size
    if footer_at < 0:
        return None
    end = _read(stream, footer_at, size)
    opcode, _, summary_at, offsets_at, _ = _FOOTER.unpack_from(end)
    if opcode != Opcode.FOOTER or not end.endswith(MAGIC) or not 0 < summary_at <= offsets_at <= footer_at:
        return None
    closing = _Closing(data_end=summary_at, attachments=summary_at)
    try:
        for group in _records(_read(stream, offsets_at, footer_at), Opcode.SUMMARY_OFFSET):
            _learn(closing, stream, SummaryOffset.read(ReadDataStream(BytesIO(group))), head.channels)
    except _NOT_MCAP:
        return _Closing(data_end=summary_at, attachments=summary_at)
    return closing


def _learn(closing: _Closing, stream: BinaryIO, group: SummaryOffset, channels: dict[int, Channel]) -> None:
    kind = group.group_opcode
    if kind not in (Opcode.CHANNEL, Opcode.STATISTICS, Opcode.ATTACHMENT_INDEX) or group.group_length > GROUP_LIMIT:
        return
    for content in _records(_read(stream, group.group_start, group.group_start + group.group_length), kind):
        if kind == Opcode.CHANNEL and int.from_bytes(content[:2], "little") in channels:
            continue
        data = ReadDataStream(BytesIO(content))
        if kind == Opcode.STATISTICS:
            closing.counts = Statistics.read(data).channel_message_counts
        elif kind == Opcode.CHANNEL:
            channel = Channel.read(data)
            channels[channel.id] = channel
        else:
            closing.attachments = min(closing.attachments, AttachmentIndex.read(data).offset)


def _records(data: bytes, kind: int) -> Iterator[bytes]:
    position = 0
    for _ in range(MAX_CHANNELS):
        if position + RECORD_HEAD_SIZE > len(data):
            return
        opcode, length = _RECORD.unpack_from(data, position)
        position += RECORD_HEAD_SIZE
        if opcode == kind:
            yield data[position : position + length]
        position += length


def _read(stream: BinaryIO, start: int, end: int) -> bytes:
    stream.seek(start)
    return stream.read(max(end - start, 0))


def _no_rows() -> Rows:
    return np.empty(0, SAMPLE_DTYPE)
