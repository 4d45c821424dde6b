"""Blocks of a take file: chunks of messages of one size, their index, and the head that finds them again."""

import struct
import zlib
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import McapRecord
from numpy.typing import NDArray

from studio.storage.profile import (
    BLOCK_DTYPE,
    BLOCK_HEAD,
    BLOCK_HEAD_SIZE,
    MESSAGE,
    MESSAGE_HEAD,
    MESSAGE_HEAD_SIZE,
    RECORD_HEAD_SIZE,
    SYNC,
)

# MCAP "Chunk": opcode, length, start, end, size, CRC, length of the compression's name (0), size again
CHUNK_HEAD = struct.Struct("<BQQQQIIQ")
CHUNK_HEAD_SIZE = CHUNK_HEAD.size
_MESSAGE_HEAD = struct.Struct("<BQHIQQ")
_INDEX_HEAD = struct.Struct("<BQHI")
_HEAD = struct.Struct("<BQ16s8sIII")
_CRC = struct.Struct("<I")
_ENTRY_DTYPE = np.dtype([("log_time", "<u8"), ("offset", "<u8")])


class ChunkFacts(NamedTuple):
    """What the index at the end of the file says about one chunk."""

    offset: int
    """bytes from the start of the block"""
    length: int
    data_size: int
    start: int
    """ns, earliest log time"""
    end: int
    """ns, latest log time"""
    counts: tuple[tuple[int, int], ...]
    """(channel, number of messages), in the order of the message indexes that follow the chunk"""
    data: bytes
    """The chunk's messages, for the digest of the whole take."""


class RecordFacts(NamedTuple):
    """What the index at the end of the file says about one metadata or attachment record."""

    offset: int
    """bytes from the start of the block"""
    length: int
    name: str
    media_type: str = ""
    log_time: int = 0
    data_size: int = 0


@dataclass(frozen=True)
class Block:
    """Bytes that are written at once, and what the ledger must know when they are on disk."""

    data: bytes
    chunks: tuple[ChunkFacts, ...] = ()
    metadata: tuple[RecordFacts, ...] = ()
    attachments: tuple[RecordFacts, ...] = ()
    until: float | None = None
    """s, ``Sample.time`` of the last sample in it."""


@dataclass
class BlockBuilder:
    """Collects the records of one block."""

    take: bytes
    """8 bytes, the identity of the file"""
    number: int
    parts: list[bytes] = field(default_factory=list)
    size: int = BLOCK_HEAD_SIZE
    chunks: list[ChunkFacts] = field(default_factory=list)
    metadata: list[RecordFacts] = field(default_factory=list)
    attachments: list[RecordFacts] = field(default_factory=list)
    until: float | None = None

    def add(self, data: bytes) -> int:
        """Append one record and return where it starts, bytes from the start of the block."""
        offset = self.size
        self.parts.append(data)
        self.size += len(data)
        return offset

    def add_rows(self, rows: NDArray[np.void]) -> None:
        """Append one chunk of equally long messages, given as they stand in the chunk."""
        self.until = float(rows["time"][-1])
        self._add_chunk(rows.tobytes(), rows["channel"], rows["log_time"], rows.itemsize)

    def add_messages(self, channel: int, sequence: int, log_times: list[int], bodies: list[bytes]) -> None:
        """Append one chunk of equally long ``bodies`` of one channel."""
        length = MESSAGE_HEAD_SIZE - RECORD_HEAD_SIZE + len(bodies[0])
        data = b"".join(
            _MESSAGE_HEAD.pack(MESSAGE, length, channel, sequence + i, time, time) + body
            for i, (time, body) in enumerate(zip(log_times, bodies, strict=True))
        )
        self.add_chunk(data)

    def add_chunk(self, data: bytes) -> None:
        """Append one chunk of equally long messages, given as bytes."""
        rows = message_heads(data)
        self._add_chunk(data, rows["channel"], rows["log_time"], rows.itemsize)

    def finish(self) -> Block:
        """Return the block with its head."""
        body = b"".join(self.parts)
        head = _HEAD.pack(
            BLOCK_HEAD,
            BLOCK_HEAD_SIZE - RECORD_HEAD_SIZE,
            SYNC,
            self.take,
            self.number,
            len(body),
            zlib.crc32(body),
        )
        data = head + _CRC.pack(zlib.crc32(head)) + body
        return Block(data, tuple(self.chunks), tuple(self.metadata), tuple(self.attachments), self.until)

    def _add_chunk(self, data: bytes, channels: NDArray[np.uint16], times: NDArray[np.uint64], stride: int) -> None:
        start, end = int(times.min()), int(times.max())
        head = CHUNK_HEAD.pack(
            Opcode.CHUNK,
            CHUNK_HEAD_SIZE - RECORD_HEAD_SIZE + len(data),
            start,
            end,
            len(data),
            zlib.crc32(data),
            0,
            len(data),
        )
        offset = self.add(head + data)
        counts = []
        entries = np.empty(len(times), _ENTRY_DTYPE)
        entries["log_time"] = times
        entries["offset"] = np.arange(len(times)) * stride
        order = np.argsort(channels, kind="stable")
        entries, channels = entries[order], channels[order]
        bounds = [0, *(np.flatnonzero(np.diff(channels)) + 1).tolist(), len(times)]
        for first, last in pairwise(bounds):
            self.add(_message_index(int(channels[first]), entries[first:last]))
            counts.append((int(channels[first]), last - first))
        self.chunks.append(ChunkFacts(offset, len(head) + len(data), len(data), start, end, tuple(counts), data))


def message_heads(data: bytes) -> NDArray[np.void]:
    """Return the equally long messages of a chunk as rows with the fields of MCAP's message head."""
    length = int.from_bytes(data[1:RECORD_HEAD_SIZE], "little")
    body = RECORD_HEAD_SIZE + length - MESSAGE_HEAD_SIZE
    return np.frombuffer(data, np.dtype([*MESSAGE_HEAD, ("body", f"V{body}")]))


def encode(*records: McapRecord) -> bytes:
    """Return MCAP records as bytes."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def index_length(messages: int) -> int:
    """Return the length of the message index of one channel, bytes."""
    return _INDEX_HEAD.size + messages * _ENTRY_DTYPE.itemsize


def head_is_whole(head: bytes) -> bool:
    """Return whether these are the bytes of an undamaged block head."""
    if len(head) != BLOCK_HEAD_SIZE or head[0] != BLOCK_HEAD:
        return False
    return head[RECORD_HEAD_SIZE : RECORD_HEAD_SIZE + 16] == SYNC and zlib.crc32(head[:-4]) == _CRC.unpack(head[-4:])[0]


def parse_head(head: bytes) -> np.void:
    """Return the fields of a whole block head."""
    return np.void(np.frombuffer(head, BLOCK_DTYPE)[0])


def _message_index(channel: int, entries: NDArray[np.void]) -> bytes:
    data = entries.tobytes()
    return _INDEX_HEAD.pack(Opcode.MESSAGE_INDEX, 6 + len(data), channel, len(data)) + data
