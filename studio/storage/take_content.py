"""What the chunks of a take file hold, sorted by what it is; what cannot be used is counted."""

from collections.abc import Iterator
from pathlib import Path
from struct import Struct

from mcap.records import Channel

from studio.core.errors import TakeUnsafe
from studio.core.sample import SensorId, SensorInfo
from studio.core.take import Mark
from studio.storage.block_reader import BlockReader, Messages
from studio.storage.facts import (
    NOT_JSON,
    Event,
    SensorRecord,
    clean,
    cleaned,
    event_mark,
    event_sensor,
    from_json,
)
from studio.storage.limits import LARGEST_NUMBER, believe, is_plausible_mark, sensor_fault
from studio.storage.profile import (
    EVENT_TOPIC,
    IMU_TOPIC,
    MAX_EVENTS,
    MAX_SAMPLES,
    MESSAGE_HEAD_SIZE,
    RECORD_HEAD_SIZE,
    SAMPLE_DTYPE,
)
from studio.storage.sample_table import Rows, SampleTable, sample_rows

MAX_SENSORS = 240  # 16 suits of 15 tags
MAX_EARLY = 64 << 20  # bytes; channels stand again every 10 s, in which eight receivers at 1 Mbaud send 8 MB
_LENGTH = Struct("<Q")


class TakeContent:
    """Sensors, samples, events and marks of one take file."""

    def __init__(self, reader: BlockReader, file: Path) -> None:
        """Read all of it.

        Raises
        ------
        NotATake, WrittenByNewerStudio, TakeUnsafe
        """
        self.infos: dict[SensorId, SensorInfo] = {}
        self.events: list[Event] = []
        self.marks: tuple[Mark, ...] = ()
        self.zero = 0.0
        """s, take time 0 on the clock of ``Sample.time``."""
        self.unusable = 0
        """Chunks, messages and readings."""
        self._file = file
        # A block may be made to lie in another, and each of its samples would then be read many times.
        self._most_samples = min(MAX_SAMPLES, reader.size // SAMPLE_DTYPE.itemsize)
        self._channels: dict[SensorId, int] = {}
        self._samples = SampleTable()
        self._told: list[SensorInfo] = []
        self._read(reader)

    def take_rows(self, sensor: SensorId) -> Rows:
        """Return the rows of a sensor in the order of arrival, only once: the largest thing there is."""
        rows, unbelieved = believe(self._samples.take(self._channels[sensor]), self.zero)
        self.unusable += unbelieved
        return rows

    def _read(self, reader: BlockReader) -> None:
        unknown: list[Messages] = []
        size = 0
        for messages in reader.messages():
            if messages.channel in reader.channels:
                self._add(messages, reader.channels[messages.channel])
            elif (size := size + len(messages.data)) <= MAX_EARLY:
                unknown.append(messages)
            else:
                self.unusable += 1
        # Where the start is damaged, the channels are known only from their repetition further on.
        for messages in unknown:
            if messages.channel in reader.channels:
                self._add(messages, reader.channels[messages.channel])
            else:
                self.unusable += 1
        if reader.identity is not None:
            self.zero = reader.identity.anchor.monotonic
        self._add_sensors(reader)
        self.infos |= {info.sensor: info for info in self._told if info.sensor in self.infos}
        self.marks = tuple(self._marks())

    def _add(self, messages: Messages, channel: Channel) -> None:
        if channel.topic == EVENT_TOPIC:
            self._add_events(messages)
        elif channel.topic.startswith(IMU_TOPIC):
            rows = sample_rows(messages)
            if rows is None:
                self.unusable += 1
            else:
                self._samples.add(rows)
        if self._samples.rows > self._most_samples:
            raise TakeUnsafe(str(self._file), f"more than {self._most_samples} samples")

    def _add_events(self, messages: Messages) -> None:
        for body in bodies(messages):
            try:
                event = from_json(body, Event)
                if event.kind == "sensor":
                    self._add_told(event_sensor(event))
            except NOT_JSON:
                self.unusable += 1
                continue
            self.events.append(event)
        if len(self.events) > MAX_EVENTS:
            raise TakeUnsafe(str(self._file), f"more than {MAX_EVENTS} events")

    def _add_told(self, info: SensorInfo) -> None:
        if sensor_fault(info):
            self.unusable += 1
        else:
            self._told.append(info)

    def _marks(self) -> Iterator[Mark]:
        for event in self.events:
            if event.kind == "mark":
                try:
                    mark = event_mark(event, self.zero)
                except NOT_JSON:
                    self.unusable += 1
                    continue
                if is_plausible_mark(mark):
                    yield mark
                else:
                    self.unusable += 1

    def _add_sensors(self, reader: BlockReader) -> None:
        for channel in reader.channels.values():
            if channel.topic.startswith(IMU_TOPIC):
                self._add_sensor(channel)
        if len(self.infos) > MAX_SENSORS:
            raise TakeUnsafe(str(self._file), f"more than {MAX_SENSORS} sensors")
        # Samples of sensors of which nothing is known, or that stand in a chunk of something else.
        self.unusable += self._samples.rows - sum(self._samples.count(c) for c in self._channels.values())

    def _add_sensor(self, channel: Channel) -> None:
        name = channel.topic.removeprefix(IMU_TOPIC)
        record = sensor_record(channel, self._file)
        if record is None:
            self.unusable += 1
            return
        if record.info.sensor != name or clean(name) != name or name in self.infos:
            raise TakeUnsafe(str(self._file), "a channel and its sensor have different names")
        sensor = SensorId(name)
        if not self.infos:
            self.zero = record.zero_s
        self.infos[sensor] = cleaned(record.info)
        self._channels[sensor] = channel.id


def sensor_record(channel: Channel, file: Path) -> SensorRecord | None:
    """Return what the channel of a sensor says, None when that is unreadable.

    Raises
    ------
    TakeUnsafe
        It says what cannot be true and without which its samples are of no use.
    """
    try:
        record = from_json(channel.metadata.get("sensor", ""), SensorRecord)
    except NOT_JSON:
        return None
    fault = sensor_fault(record.info) or ("" if abs(record.zero_s) <= LARGEST_NUMBER else "zero_s")
    if fault:
        raise TakeUnsafe(str(file), f"{fault} of a sensor is not possible")
    return record


def bodies(messages: Messages) -> Iterator[bytes]:
    """Yield the messages of a chunk without their heads."""
    (length,) = _LENGTH.unpack_from(messages.data, 1)
    stride = RECORD_HEAD_SIZE + length
    for start in range(0, len(messages.data), stride):
        yield messages.data[start + MESSAGE_HEAD_SIZE : start + stride]
