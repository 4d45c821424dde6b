"""What is on disk of a take: counts, the digest it must show when read back, and the index for its end."""

import hashlib
import zlib
from collections import Counter
from collections.abc import Mapping

from mcap.opcode import Opcode
from mcap.records import (
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    McapRecord,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from studio.storage.blocks import Block, ChunkFacts, encode, index_length
from studio.storage.profile import MAGIC, SCHEMAS


class Ledger:
    """Adds up the blocks that were written, in their order."""

    def __init__(self) -> None:
        self.size = 0
        """bytes"""
        self.counts: Counter[int] = Counter()
        """Messages by channel."""
        self.until: float | None = None
        """s, ``Sample.time`` of the last sample that is safe."""
        self._crc = 0
        self._content = hashlib.blake2b(digest_size=16)
        # An hour has 144,000 chunks, whose indexes are much alike: packed they take 6 MB instead of 22.
        self._packer = zlib.compressobj(1)
        self._packed = bytearray()
        self._index_size = 0
        self._chunks = 0
        self._start: int | None = None
        self._end = 0
        self._metadata: list[MetadataIndex] = []
        self._attachments: list[AttachmentIndex] = []

    def add(self, block: Block) -> None:
        """Count a block that has been written."""
        for chunk in block.chunks:
            self._add_chunk(chunk)
        for facts in block.metadata:
            self._metadata.append(MetadataIndex(self.size + facts.offset, facts.length, facts.name))
        for facts in block.attachments:
            self._attachments.append(
                AttachmentIndex(
                    offset=self.size + facts.offset,
                    length=facts.length,
                    log_time=facts.log_time,
                    create_time=facts.log_time,
                    data_size=facts.data_size,
                    name=facts.name,
                    media_type=facts.media_type,
                )
            )
        self._crc = zlib.crc32(block.data, self._crc)
        self.size += len(block.data)
        self.until = self.until if block.until is None else block.until

    def digest(self) -> bytes:
        """Return the digest of the messages of all chunks, in order."""
        return self._content.digest()

    def index_size(self) -> int:
        """Return about how long the end of the file is with its index, bytes."""
        return self._index_size + (64 << 10)

    def closing(self, channels: Mapping[str, Channel], *, indexed: bool) -> bytes:
        """Return what ends the file: the summary and the footer.

        Parameters
        ----------
        indexed : without the index of chunks the end is a few kB; readers then read from the start.
        """
        data_end = encode(DataEnd(self._crc))
        summary_start = self.size + len(data_end)
        summary = bytearray()
        offsets: list[SummaryOffset] = []
        for opcode, records in self._groups(channels, indexed=indexed):
            if records:
                offsets.append(SummaryOffset(opcode, summary_start + len(summary), len(records)))
                summary += records
        offset_start = summary_start + len(summary)
        summary += encode(*offsets)
        footer = encode(Footer(summary_start, offset_start, 0))
        crc = zlib.crc32(footer[:-4], zlib.crc32(summary))
        return data_end + bytes(summary) + footer[:-4] + crc.to_bytes(4, "little") + MAGIC

    def _groups(self, channels: Mapping[str, Channel], *, indexed: bool) -> list[tuple[int, bytes]]:
        schemas: list[McapRecord] = [Schema(id=i, name=n, encoding=e, data=t.encode()) for i, n, e, t in SCHEMAS]
        statistics = Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(channels),
            channel_message_counts=dict(self.counts),
            chunk_count=self._chunks,
            message_count=self.counts.total(),
            message_end_time=self._end,
            message_start_time=self._start or 0,
            metadata_count=len(self._metadata),
            schema_count=len(SCHEMAS),
        )
        return [
            (Opcode.SCHEMA, encode(*schemas)),
            (Opcode.CHANNEL, encode(*channels.values())),
            (Opcode.STATISTICS, encode(statistics)),
            (Opcode.CHUNK_INDEX, self._chunk_indexes() if indexed else b""),
            (Opcode.ATTACHMENT_INDEX, encode(*self._attachments)),
            (Opcode.METADATA_INDEX, encode(*self._metadata)),
        ]

    def _chunk_indexes(self) -> bytes:
        return zlib.decompress(self._packed + self._packer.copy().flush())

    def _add_chunk(self, chunk: ChunkFacts) -> None:
        at = index_at = self.size + chunk.offset + chunk.length
        offsets: dict[int, int] = {}
        for channel, messages in chunk.counts:
            offsets[channel] = at
            at += index_length(messages)
            self.counts[channel] += messages
        index = encode(
            ChunkIndex(
                chunk_length=chunk.length,
                chunk_start_offset=self.size + chunk.offset,
                compression="",
                compressed_size=chunk.data_size,
                message_end_time=chunk.end,
                message_index_length=at - index_at,
                message_index_offsets=offsets,
                message_start_time=chunk.start,
                uncompressed_size=chunk.data_size,
            )
        )
        self._packed += self._packer.compress(index)
        self._index_size += len(index)
        self._content.update(chunk.data)
        self._chunks += 1
        self._start = chunk.start if self._start is None else min(self._start, chunk.start)
        self._end = max(self._end, chunk.end)
