"""One recording: what is kept, from when, until when."""

import asyncio
from collections.abc import Mapping

from studio.core.sample import Sample, SensorId, SensorInfo
from studio.core.take import Mark
from studio.storage.take_writer import TakeWriter


class Recording:
    """Feeds the take-writer. Lives on the acquisition thread."""

    def __init__(self, writer: TakeWriter, seconds: float) -> None:
        self.writer = writer
        self.first: float | None = None
        """Clock of ``Sample.time``: the first kept sample."""
        self.full = asyncio.Event()
        """Set when the length asked for is reached, or when nothing more can be kept."""
        self._length = seconds
        self._known: dict[SensorId, SensorInfo] = {}

    def sample(self, sample: Sample, info: SensorInfo) -> None:
        """Keep a sample, unless it comes after the end."""
        if self.first is None:
            self.first = sample.time
        if self.writer.failure is not None or sample.time >= self.first + self._length:
            self.full.set()
            return
        if self._known.get(sample.sensor) is not info:
            (self.writer.update_info if sample.sensor in self._known else self.writer.add_sensor)(info)
            self._known[sample.sensor] = info
        self.writer.sample(sample)

    def raw(self, link: str, received: float, data: bytes) -> None:
        """Keep bytes as they came."""
        if not self.full.is_set():
            self.writer.raw(link, received, data)

    def note(self, kind: str, facts: Mapping[str, object], received: float) -> None:
        """Keep something that happened."""
        if not self.full.is_set():
            self.writer.event(kind, facts, received)

    def mark(self, mark: Mark) -> None:
        """Keep a mark, unless it lies after the end."""
        if self.first is None or mark.time < self.first + self._length:
            self.writer.mark(mark)
