"""Reads the blocks of a take file one by one, whatever was done to the file; holds one block at a time."""

import struct
import zlib
from collections.abc import Iterator
from io import BytesIO
from itertools import islice
from pathlib import Path
from struct import unpack_from
from typing import BinaryIO, NamedTuple

from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Header, Metadata

from studio.core.errors import NotATake, SetupError, TakeUnsafe, WrittenByNewerStudio
from studio.storage.blocks import CHUNK_HEAD, head_is_whole, parse_head
from studio.storage.facts import NOT_JSON, Identity, cleaned_identity, from_json
from studio.storage.limits import LARGEST_NUMBER, setup_fault
from studio.storage.profile import (
    BLOCK_HEAD,
    BLOCK_HEAD_SIZE,
    FAMILY,
    MAGIC,
    MAX_BLOCK,
    MAX_CHANNELS,
    MAX_CHUNK,
    MESSAGE,
    MESSAGE_HEAD_SIZE,
    PROFILE,
    RECORD_HEAD_SIZE,
    SYNC,
)

WINDOW = 1 << 20  # bytes read at a time while looking for the next block
MAX_GARBAGE = 512 << 20  # bytes of one file that are no take: half an hour of 15 tags; looking through them takes 1 s
MAX_RECORDS = 4096  # in one block; MAX_CHANNELS with one index each, their schemas and a few chunks
_RECORD = "<BQ"
_NO_RECORD = (McapError, struct.error, UnicodeDecodeError, ValueError, OverflowError)
"""What reading a record raises whose lengths contradict each other."""


class Record(NamedTuple):
    """One record of a block."""

    opcode: int
    content: bytes
    trusted: bool
    """The CRC of the whole block was right."""


class Messages(NamedTuple):
    """The messages of one chunk, undamaged; all are of one size."""

    channel: int
    """of the first message"""
    data: bytes


class BlockReader:
    """Walks through a take file; after a walk it knows the channels, the identity and the damage."""

    def __init__(self, stream: BinaryIO, path: Path) -> None:
        self.channels: dict[int, Channel] = {}
        self.identity: Identity | None = None
        self.chunks = 0
        self.damaged = 0
        """Chunks and blocks that could not be used."""
        self.finished = False
        """The file has its end."""
        self._stream = stream
        self.path = path
        self.size = stream.seek(0, 2)
        """bytes of the file"""
        self.take = b""
        """The identity of the file, 8 bytes."""
        self._number = 0
        self._garbage = 0
        self._header = self._read_header()

    def messages(self) -> Iterator[Messages]:
        """Yield every undamaged chunk, in order."""
        for records in self.blocks():
            for record in records:
                if record.opcode == Opcode.CHUNK:
                    messages = self.chunk(record)
                    if messages is not None:
                        yield messages

    def attachments(self) -> Iterator[Attachment]:
        """Yield every undamaged part of an attachment, in order."""
        for records in self.blocks():
            for record in records:
                attachment = read_attachment_record(record)
                if attachment is not None:
                    yield attachment

    def blocks(self) -> Iterator[list[Record]]:
        """Yield the records of each block; learn channels and identity on the way."""
        position = self._first_block()
        while position is not None:
            head = self._read(position, BLOCK_HEAD_SIZE)
            if not self._is_ours(head):
                if self._is_end(position):
                    self.finished = True
                    return
                position = self._next_sync(position + 1)
                continue
            fields = parse_head(head)
            self._count_missing(int(fields["number"]))
            body_at = position + BLOCK_HEAD_SIZE
            body = self._read(body_at, int(fields["body_length"]))
            cut_off = len(body) < fields["body_length"]
            whole = not cut_off and zlib.crc32(body) == fields["body_crc"]
            records = list(islice(_split(body, whole, cut_off), MAX_RECORDS + 1))
            if len(records) > MAX_RECORDS:
                raise TakeUnsafe(str(self.path), f"a block has more than {MAX_RECORDS} records")
            for record in records:
                self._learn(record)
            yield records
            if whole or head_is_whole(self._read(body_at + len(body), BLOCK_HEAD_SIZE)):
                position = body_at + len(body)
            else:
                self._waste(len(body))
                position = self._next_sync(body_at)
        if not self.take:
            self._refuse()

    def chunk(self, record: Record) -> Messages | None:
        """Return the messages of a chunk whose CRC is right, None when it is damaged; count which."""
        messages = self._undamaged(record)
        if messages is None:
            self.damaged += 1
        else:
            self.chunks += 1
        return messages

    def _undamaged(self, record: Record) -> Messages | None:
        content = record.content
        if len(content) < CHUNK_HEAD.size - RECORD_HEAD_SIZE + MESSAGE_HEAD_SIZE:
            return None
        _, _, size, crc, compression, data_size = unpack_from("<QQQIIQ", content)
        data = content[CHUNK_HEAD.size - RECORD_HEAD_SIZE :]
        if compression:
            if record.trusted:
                raise TakeUnsafe(str(self.path), "a chunk is compressed, which no take is")
            return None
        if size != len(data) or data_size != len(data) or zlib.crc32(data) != crc:
            return None
        if size > MAX_CHUNK:
            raise TakeUnsafe(str(self.path), f"a chunk has {size} bytes, more than {MAX_CHUNK}")
        opcode, length, channel = unpack_from("<BQH", data)
        stride = RECORD_HEAD_SIZE + length
        if opcode != MESSAGE or stride < MESSAGE_HEAD_SIZE or len(data) % stride:
            return None
        return Messages(channel, data)

    def _learn(self, record: Record) -> None:
        if not record.trusted or record.opcode not in (Opcode.CHANNEL, Opcode.METADATA):
            return
        try:
            if record.opcode == Opcode.CHANNEL:
                # They stand again every 10 s; the first two bytes are the id.
                if int.from_bytes(record.content[:2], "little") not in self.channels:
                    channel = Channel.read(_stream(record.content))
                    self.channels[channel.id] = channel
            elif self.identity is None:
                self._learn_identity(Metadata.read(_stream(record.content)).metadata)
        except (*_NO_RECORD, *NOT_JSON):
            self.damaged += 1
        if len(self.channels) > MAX_CHANNELS:
            raise TakeUnsafe(str(self.path), f"more than {MAX_CHANNELS} channels")

    def _learn_identity(self, facts: dict[str, str]) -> None:
        profile = facts.get("profile", PROFILE)
        if profile != PROFILE:
            raise WrittenByNewerStudio(str(self.path), profile[:64], PROFILE)
        if "take" in facts:
            self.identity = cleaned_identity(self._believed(facts["take"]))

    def _believed(self, text: str) -> Identity:
        try:
            identity = from_json(text, Identity)
        except SetupError as error:  # two sensors on one place
            raise TakeUnsafe(str(self.path), "its setup contradicts itself") from error
        fault = setup_fault(identity.setup) or ("" if abs(identity.anchor.monotonic) <= LARGEST_NUMBER else "monotonic")
        if fault:
            raise TakeUnsafe(str(self.path), f"{fault} is not possible")
        return identity

    def _count_missing(self, number: int) -> None:
        self.damaged += number - self._number - 1
        self._number = number

    def _is_ours(self, head: bytes) -> bool:
        if not head_is_whole(head):
            return False
        fields = parse_head(head)
        if fields["body_length"] > MAX_BLOCK:
            raise TakeUnsafe(str(self.path), f"a block has {fields['body_length']} bytes, more than {MAX_BLOCK}")
        take = fields["take"].tobytes()
        self.take = self.take or take
        # Pages of another take, or of this one a second time, are what a power cut may leave.
        return bool(take == self.take and fields["number"] > self._number)

    def _is_end(self, position: int) -> bool:
        opcode_and_length = self._read(position, RECORD_HEAD_SIZE)
        if len(opcode_and_length) < RECORD_HEAD_SIZE or unpack_from(_RECORD, opcode_and_length) != (Opcode.DATA_END, 4):
            return False
        return self._read(self.size - len(MAGIC), len(MAGIC)) == MAGIC

    def _first_block(self) -> int | None:
        self._number = self._garbage = self.chunks = self.damaged = 0
        self.take, self.finished = b"", False
        after_header = len(MAGIC) + RECORD_HEAD_SIZE + len(self._header)
        if head_is_whole(self._read(after_header, BLOCK_HEAD_SIZE)):
            return after_header
        return self._next_sync(0)

    def _next_sync(self, position: int) -> int | None:
        """Return where the next block head may start, None when there is none."""
        position += RECORD_HEAD_SIZE
        while position < self.size:
            window = self._read(position, WINDOW)
            found = window.find(SYNC)
            if found >= 0:
                self._waste(found)
                return position + found - RECORD_HEAD_SIZE
            # A mark may lie across the border of two windows.
            position += max(len(window) - len(SYNC) + 1, 1)
            self._waste(len(window))
        return None

    def _waste(self, size: int) -> None:
        self._garbage += size
        if self._garbage > MAX_GARBAGE:
            raise TakeUnsafe(str(self.path), f"more than {MAX_GARBAGE >> 20} MiB of it are no take")

    def _read_header(self) -> bytes:
        lead = self._read(0, len(MAGIC) + RECORD_HEAD_SIZE)
        if len(lead) < len(MAGIC) + RECORD_HEAD_SIZE or not lead.startswith(MAGIC):
            return b""
        opcode, length = unpack_from(_RECORD, lead, len(MAGIC))
        if opcode != Opcode.HEADER or length > WINDOW:
            return b""
        return self._read(len(lead), length)

    def _refuse(self) -> None:
        """Say why there is no block in this file."""
        try:
            profile = Header.read(_stream(self._header)).profile
        except _NO_RECORD:
            profile = ""
        if profile.startswith(FAMILY) and profile != PROFILE:
            raise WrittenByNewerStudio(str(self.path), profile[:64], PROFILE)
        raise NotATake(str(self.path))

    def _read(self, position: int, length: int) -> bytes:
        self._stream.seek(position)
        return self._stream.read(length)


def read_attachment_record(record: Record) -> Attachment | None:
    """Return one part of an attachment, None when the record is something else or damaged."""
    if record.opcode != Opcode.ATTACHMENT or not record.trusted:
        return None
    try:
        attachment: Attachment = Attachment.read(_stream(record.content))
    except _NO_RECORD:
        return None
    return attachment


def _split(body: bytes, trusted: bool, cut_off: bool) -> Iterator[Record]:
    """Yield the records of a block as far as their lengths make sense.

    Parameters
    ----------
    cut_off : the file ends within this block. A kill in the middle of a write does that (Linux ends a
        write between two pages); it is what "not finished" says, and no damage.
    """
    position = 0
    while position + RECORD_HEAD_SIZE <= len(body):
        opcode, length = unpack_from(_RECORD, body, position)
        start = position + RECORD_HEAD_SIZE
        if opcode == BLOCK_HEAD or length > len(body) - start:
            if not cut_off:
                yield Record(Opcode.CHUNK, b"", False)  # stands for the chunk that is lost
            return
        yield Record(opcode, body[start : start + length], trusted)
        position = start + length


def _stream(content: bytes) -> ReadDataStream:
    return ReadDataStream(BytesIO(content))
