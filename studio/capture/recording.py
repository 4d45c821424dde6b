"""One recording: what is kept, from when, until when."""

import asyncio
import time
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

import studio
from studio.acquisition.dialects.tag_advert import VERSION as PROTOCOL_VERSION
from studio.acquisition.health import SensorHealth
from studio.core.sample import Sample, SensorId, SensorInfo
from studio.core.take import Mark, Setup
from studio.storage.facts import Anchor
from studio.storage.profile import PROFILE
from studio.storage.session_folder import open_session
from studio.storage.take_writer import TakeWriter

MARGIN = 0.5  # s that the last samples may be on their way; 25 frames of 20 ms
HEALTH_EVERY = 10.0  # s between two notes of counts and clocks in the take
HEALTH_KEPT = ("received", "lost", "malformed", "duplicates", "late", "rate", "jitter", "offset", "skew", "rssi")


class TakeIdentity(NamedTuple):
    """What a take says of itself from its first byte on."""

    library: Path
    person: str
    name: str
    source: str
    setup: Setup
    anchor: Anchor


def anchor_now() -> Anchor:
    """Return this instant on both clocks of this computer."""
    return Anchor(datetime.now(UTC).isoformat(), time.perf_counter())


def open_take(take: TakeIdentity) -> TakeWriter:
    """Make the folder and the file of a take; waits for the disk.

    Raises
    ------
    RecordingError, SetupError
    """
    session = open_session(take.library, take.person, datetime.now(UTC).astimezone().date())
    versions = {"studio": studio.__version__, "protocol": str(PROTOCOL_VERSION), "profile": PROFILE}
    return TakeWriter(
        session,
        take.name,
        person=take.person,
        source=take.source,
        setup=take.setup,
        versions=versions,
        anchor=take.anchor,
    )


class Recording:
    """Feeds the take-writer. Lives on the acquisition thread."""

    def __init__(self, writer: TakeWriter, seconds: float, began: float) -> None:
        """``began``: s, clock of ``Sample.received``, for a take into which nothing ever comes."""
        self.writer = writer
        self.first: float | None = None
        """Clock of ``Sample.time``: the first kept sample."""
        self.full = asyncio.Event()
        """Set when the length asked for is reached, or when nothing more can be kept."""
        self.silent_for = 0.0
        """s at the end into which nothing came, when that is how it ended."""
        self._began = began
        self._newest = began
        self._length = seconds
        self._health_noted = float("-inf")
        self._known: dict[SensorId, SensorInfo] = {}

    def sample(self, sample: Sample, info: SensorInfo) -> None:
        """Keep a sample, unless it comes after the end."""
        if self.first is None:
            self.first, self._began = sample.time, sample.received
            self._newest = sample.time
        if self.writer.failure is not None or sample.time >= self.first + self._length:
            self.full.set()
            return
        if self._known.get(sample.sensor) is not info:
            (self.writer.update_info if sample.sensor in self._known else self.writer.add_sensor)(info)
            self._known[sample.sensor] = info
        self._newest = max(self._newest, sample.time)
        self.writer.sample(sample)

    def look(self, now: float, heard: float) -> None:
        """End when the length has passed and nothing has come any more.

        Parameters
        ----------
        now, heard : float, s
            This computer's clock, and what it said when a sample came last. Both are asked: a replay at half
            speed takes twice its length, and goes on sending.
        """
        if self.writer.failure is not None:
            self.full.set()
        elif not self.full.is_set() and min(now - self._began - self._length, now - heard) >= MARGIN:
            missing = self._length if self.first is None else self.first + self._length - self._newest
            # Up to the margin it may be that the last samples were lost on their way.
            self.silent_for = missing if missing > MARGIN else 0.0
            self.full.set()

    def raw(self, link: str, received: float, data: bytes) -> None:
        """Keep bytes as they came."""
        if not self.full.is_set():
            self.writer.raw(link, received, data)

    def note(self, kind: str, facts: Mapping[str, object], received: float) -> None:
        """Keep something that happened."""
        if not self.full.is_set():
            self.writer.event(kind, facts, received)

    def health_is_due(self, now: float) -> bool:
        """Return whether it is time to keep the counts again; ``now`` is s on the clock of ``Sample.time``."""
        return now - self._health_noted >= HEALTH_EVERY

    def note_health(self, counts: Iterable[SensorHealth], now: float) -> None:
        """Keep the counts and clocks of all sensors, also at the end: what the samples alone do not tell."""
        self._health_noted = now
        for health in counts:
            told = health.snapshot(now)
            facts = {name: getattr(told, name) for name in HEALTH_KEPT}
            self.writer.event("health", {"sensor": told.sensor, **facts}, now)

    def mark(self, mark: Mark) -> None:
        """Keep a mark, unless it lies after the end."""
        if self.first is None or mark.time < self.first + self._length:
            self.writer.mark(mark)
