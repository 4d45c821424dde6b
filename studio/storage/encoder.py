"""Samples, bytes of links and events to blocks of a take file. No file is touched here."""

import math
import secrets
import struct
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mcap.records import Attachment, Channel, Header, Metadata, Schema
from numpy.typing import NDArray

from studio import __version__
from studio.core.sample import Sample, SensorId, SensorInfo
from studio.storage.blocks import Block, BlockBuilder, RecordFacts, encode
from studio.storage.facts import TEXT_LIMIT, Event, Identity, SensorRecord, event_json, sensor_event, to_json
from studio.storage.profile import (
    CDR_LITTLE_ENDIAN,
    EVENT_TOPIC,
    IMU_TOPIC,
    MAGIC,
    MESSAGE,
    MESSAGE_ENCODING,
    PART,
    PROFILE,
    RAW_TOPIC,
    SAMPLE_DTYPE,
    SAMPLE_LENGTH,
    SCHEMAS,
    part_name,
)

ROWS_PER_BLOCK = 4096  # 0.7 MB: what a stalled disk left over is cut into pieces a reader can hold
RAW_PER_BLOCK = 1 << 20  # bytes of one link, likewise
EVENTS_PER_BLOCK = 128
EVENT_LIMIT = 1 << 14  # bytes; all events of a chunk are padded to the longest
REPEAT = 10.0  # s; how often the channels stand again, so that damage at the start costs no more
_LATEST = 2**63 - 1  # ns; beyond it other readers' signed times overflow
_SAMPLE = struct.Struct("<BQHIQQI13dq3diI")
_RAW = struct.Struct("<qI")


class RawBytes(NamedTuple):
    """Bytes of one link as one read gave them."""

    link: str
    received: float
    data: bytes


class TakeEncoder:
    """Turns what is recorded into blocks; remembers channels and counts arrivals."""

    def __init__(self, identity: Identity, zero: float | None = None) -> None:
        self.identity = identity
        self.take = secrets.token_bytes(8)
        self.channels: dict[str, Channel] = {}
        self.samples = 0
        self._zero = zero
        self._infos: dict[SensorId, SensorInfo] = {}
        self._imu: dict[SensorId, int] = {}
        self._raw: dict[str, int] = {}
        self._sequence: dict[int, int] = {}
        self._blocks = 0
        self._repeated = -math.inf
        self._told: list[Event] = []
        self._new: list[Channel] = []
        self.latest = identity.anchor.monotonic
        """s, the latest arrival that was encoded."""

    @property
    def zero(self) -> float:
        """Take time 0 on the clock of ``Sample.time``: the first kept sample; the anchor before there is one."""
        return self.identity.anchor.monotonic if self._zero is None else self._zero

    def opening(self) -> Block:
        """Return what stands before the first sample: magic, header, identity, schemas."""
        lead = MAGIC + encode(Header(PROFILE, f"kinetag-studio {__version__}"))
        builder = self._builder()
        self._add_identity(builder)
        self._channel(EVENT_TOPIC, 3, {})
        self._add_channels(builder, (*schema_records(), *self.channels.values()))
        self._new.clear()
        block = builder.finish()
        shifted = tuple(facts._replace(offset=facts.offset + len(lead)) for facts in block.metadata)
        return Block(lead + block.data, metadata=shifted)

    def add_sensor(self, info: SensorInfo) -> None:
        """Tell what is known of a sensor before its first sample, or what became known since."""
        if not math.isfinite(info.frame_s):
            info = replace(info, frame_s=0.0)
        if info == self._infos.get(info.sensor):
            return
        if info.sensor in self._imu:
            self._told.append(sensor_event(info, self.latest))
        self._infos[info.sensor] = info

    def blocks(self, samples: Sequence[Sample], raw: Sequence[RawBytes], events: Sequence[Event]) -> Iterator[Block]:
        """Yield blocks with all of these; usually one."""
        yield from self.row_blocks(self._rows(samples), raw, events)

    def row_blocks(
        self, rows: NDArray[np.void], raw: Sequence[RawBytes] = (), events: Sequence[Event] = ()
    ) -> Iterator[Block]:
        """Yield blocks with samples given as they stand in the file."""
        told = [*self._told, *events]
        self._told.clear()
        raw_pieces = list(_joined(raw))
        event_pieces = [told[i : i + EVENTS_PER_BLOCK] for i in range(0, len(told), EVENTS_PER_BLOCK)]
        row_pieces = [rows[i : i + ROWS_PER_BLOCK] for i in range(0, len(rows), ROWS_PER_BLOCK)]
        while raw_pieces or event_pieces or row_pieces:
            yield self._block(
                raw_pieces.pop(0) if raw_pieces else {},
                row_pieces.pop(0) if row_pieces else None,
                event_pieces.pop(0) if event_pieces else [],
            )

    def attachment(self, name: str, media_type: str, data: bytes) -> Iterator[Block]:
        """Yield blocks that carry ``data`` in parts a reader can hold."""
        parts = max(1, -(-len(data) // PART))
        for part in range(parts):
            piece = data[part * PART : (part + 1) * PART]
            called = part_name(name, part, parts)
            time = nanoseconds(self.latest)
            record = encode(Attachment(create_time=time, log_time=time, name=called, media_type=media_type, data=piece))
            builder = self._builder()
            offset = builder.add(record)
            builder.attachments.append(RecordFacts(offset, len(record), called, media_type, time, len(piece)))
            yield builder.finish()

    def last_words(self) -> Block:
        """Return the identity and all channels once more, for a file whose start is damaged."""
        builder = self._builder()
        self._add_identity(builder)
        self._add_channels(builder, (*schema_records(), *self.channels.values()))
        return builder.finish()

    def forget_block(self) -> None:
        """Take back the number of the latest block, which is not going to be in the file: a gap means damage."""
        self._blocks -= 1

    def channel_of(self, info: SensorInfo) -> int:
        """Return the channel of a sensor, which then stands in the file before its first sample."""
        sensor = info.sensor
        if sensor not in self._imu:
            self._infos.setdefault(sensor, info)
            facts = to_json(SensorRecord(self.zero, self._infos[sensor])).decode()
            self._imu[sensor] = self._channel(IMU_TOPIC + sensor, 1, {"sensor": facts})
        return self._imu[sensor]

    def _rows(self, samples: Sequence[Sample]) -> NDArray[np.void]:
        if not samples:
            return np.empty(0, SAMPLE_DTYPE)
        if self._zero is None:
            self._zero = next((s.time for s in samples if math.isfinite(s.time)), self.latest)
        size, pack, imu = SAMPLE_DTYPE.itemsize, _SAMPLE.pack_into, self._imu
        buffer, offset, arrival = bytearray(size * len(samples)), 0, self.samples
        for sensor, epoch, frame, device_time, time, received, q, rate, accel, flags, battery, warmth, rssi in samples:
            channel = imu.get(sensor) or self.channel_of(self._infos.get(sensor, SensorInfo(sensor, 0.0)))
            pack(
                buffer, offset, MESSAGE, SAMPLE_LENGTH, channel, arrival & 0xFFFFFFFF, 0, 0, CDR_LITTLE_ENDIAN,
                device_time, time, received, *q, *rate, *accel, frame, battery, warmth, rssi, epoch, flags,
            )  # fmt: skip
            offset += size
            arrival += 1
        self.samples = arrival
        rows = np.frombuffer(buffer, SAMPLE_DTYPE)
        stamp(rows)
        return rows

    def _block(self, raw: dict[str, tuple[float, bytes]], rows: NDArray[np.void] | None, events: list[Event]) -> Block:
        builder = self._builder()
        for link in raw:
            if link not in self._raw:
                self._raw[link] = self._channel(RAW_TOPIC + link, 2, {})
        self._note_latest(rows, raw, events)
        if self._new or self.latest - self._repeated >= REPEAT:
            again = self.latest - self._repeated >= REPEAT
            self._add_channels(builder, (*schema_records(), *self.channels.values()) if again else self._new)
            self._repeated = self.latest if again else self._repeated
            self._new.clear()
        for link, (received, data) in raw.items():
            self._add_messages(builder, self._raw[link], [nanoseconds(received)], [data])
        if rows is not None:
            builder.add_rows(rows)
        if events:
            bodies = [_event_body(event) for event in events]
            width = max(map(len, bodies))
            times = [nanoseconds(event.received) for event in events]
            self._add_messages(builder, self._event_channel, times, [body.ljust(width) for body in bodies])
        return builder.finish()

    @property
    def _event_channel(self) -> int:
        return self.channels[EVENT_TOPIC].id

    def _note_latest(
        self, rows: NDArray[np.void] | None, raw: dict[str, tuple[float, bytes]], events: list[Event]
    ) -> None:
        times = [received for received, _ in raw.values()] + [event.received for event in events]
        if rows is not None:
            times.append(float(rows["received"][-1]))
        self.latest = max([self.latest, *(time for time in times if math.isfinite(time))])

    def _add_messages(self, builder: BlockBuilder, channel: int, times: list[int], bodies: list[bytes]) -> None:
        first = self._sequence.get(channel, 0)
        builder.add_messages(channel, first, times, bodies)
        self._sequence[channel] = first + len(bodies)

    def _add_identity(self, builder: BlockBuilder) -> None:
        record = encode(identity_record(self.identity))
        builder.metadata.append(RecordFacts(builder.add(record), len(record), "kinetag"))

    def _add_channels(self, builder: BlockBuilder, records: Iterable[Schema | Channel]) -> None:
        builder.add(encode(*records))

    def _channel(self, topic: str, schema: int, metadata: dict[str, str]) -> int:
        channel = Channel(
            id=len(self.channels) + 1,
            topic=topic,
            message_encoding=MESSAGE_ENCODING[schema],
            metadata=metadata,
            schema_id=schema,
        )
        self.channels[topic] = channel
        self._new.append(channel)
        return channel.id

    def _builder(self) -> BlockBuilder:
        self._blocks += 1
        return BlockBuilder(self.take, self._blocks)


def nanoseconds(time: float) -> int:
    """Return s as ns for MCAP, which knows no time before 0; the exact time stands in the message."""
    return min(max(round(time * 1e9), 0), _LATEST) if math.isfinite(time) else 0


def stamp(rows: NDArray[np.void]) -> None:
    """Set MCAP's integer times from the exact ones."""
    for stamped, exact in (("log_time", "received"), ("publish_time", "time")):
        seconds = np.nan_to_num(rows[exact], nan=0.0, posinf=0.0, neginf=0.0)
        # float64 next below 2**63: the cast of 2**63 itself is undefined
        rows[stamped] = np.clip(np.rint(seconds * 1e9), 0.0, np.nextafter(2.0**63, 0.0)).astype(np.uint64)


def _event_body(event: Event) -> bytes:
    body = event_json(event)
    if len(body) <= EVENT_LIMIT:
        return body
    return event_json(Event(event.kind[:TEXT_LIMIT], event.received, {"too_long": len(body)}))


def identity_record(identity: Identity) -> Metadata:
    """Return what a take file says about itself."""
    return Metadata("kinetag", {"profile": PROFILE, "take": to_json(identity).decode()})


def schema_records() -> tuple[Schema, ...]:
    """Return the schemas of every take."""
    return tuple(Schema(id=id_, name=name, encoding=kind, data=text.encode()) for id_, name, kind, text in SCHEMAS)


def _joined(raw: Sequence[RawBytes]) -> Iterator[dict[str, tuple[float, bytes]]]:
    """Yield one message per link, until all bytes are in; cut where one would grow too long."""
    parts: dict[str, list[bytes]] = {}
    sizes: dict[str, int] = {}
    first: dict[str, float] = {}
    for link, received, data in raw:
        for start in range(0, max(len(data), 1), RAW_PER_BLOCK):
            piece = data[start : start + RAW_PER_BLOCK]
            if sum(sizes.values()) + _RAW.size + len(piece) > RAW_PER_BLOCK + _RAW.size:
                yield {name: (first[name], b"".join(parts[name])) for name in parts}
                parts, sizes, first = {}, {}, {}
            parts.setdefault(link, []).append(_RAW.pack(nanoseconds(received), len(piece)) + piece)
            sizes[link] = sizes.get(link, 0) + _RAW.size + len(piece)
            first.setdefault(link, received)
    if parts:
        yield {name: (first[name], b"".join(parts[name])) for name in parts}
