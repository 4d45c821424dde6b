"""The running studio as the window sees it: one object that asks, and tells what came of it.

The three places where threads meet are here and nowhere else in ``ui``: ``session.buffer.snapshot``, the queue of
events, and ``runtime.call``.
"""

import math
import time
from collections.abc import Callable, Coroutine, Mapping
from concurrent.futures import Future
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from queue import Empty
from typing import Any, TypeVar

from PySide6.QtCore import QObject, Signal

from studio.acquisition.health import HealthSnapshot
from studio.capture import events
from studio.capture.live_buffer import LiveBuffer
from studio.capture.live_session import LiveSession
from studio.capture.runtime import Runtime
from studio.capture.setups import setup_for
from studio.capture.sources import open_source
from studio.capture.worker import Worker
from studio.core.errors import StudioError
from studio.core.rest import Rest
from studio.core.sample import NO_CORRECTION, Correction, SensorId, SensorInfo
from studio.core.take import Alignment, Assignment, Calibration, Mark, Setup
from studio.storage.person_file import Person
from studio.storage.take_file import Saved
from studio.ui.operation import Operation

T = TypeVar("T")

HEALTH_EVERY = 0.25  # s


class StudioModel(QObject):
    """Connect, assign, align, record; what is running is read from here."""

    source_changed = Signal()
    """Another source, or none."""
    sensors_changed = Signal()
    """A sensor appeared, or more is known of one."""
    health_changed = Signal()
    setup_changed = Signal()
    aligned = Signal(object)
    """An Alignment is in force."""
    alignment_refused = Signal(object)
    """AlignmentError."""
    recording_started = Signal(object)
    """The folder of the take."""
    recording_full = Signal()
    """Nothing more can be kept: the disk, or the source's end."""
    recording_saved = Signal(object)
    """Saved."""
    recording_failed = Signal(object)
    """StudioError."""
    refused = Signal(object)
    """StudioError of anything else."""

    def __init__(self, library: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.library = library
        self.person = ""
        self.source = ""
        self.connecting = False
        self.alignment: Alignment | None = None
        self.aligned_at: datetime | None = None
        self.health: Mapping[SensorId, HealthSnapshot] = {}
        self.queue_fill = 0.0
        self.seconds_left: float | None = None
        self.worker = Worker()
        self._runtime = Runtime()
        self._session = LiveSession()
        self._operations: list[Operation] = []
        self._health_at = -math.inf

    @property
    def buffer(self) -> LiveBuffer:
        """The last minute of what the sensors said."""
        return self._session.buffer

    @property
    def infos(self) -> Mapping[SensorId, SensorInfo]:
        """What is known of each sensor."""
        return dict(self._session.infos)

    @property
    def setup(self) -> Setup:
        """The setup in force."""
        return self._session.setup

    def open(self, source: str) -> None:
        """Connect to a source instead of the one that is open."""
        self.connecting, self.source = True, source
        self.source_changed.emit()
        self._ask(self._connect(source), self._connected)

    def close_source(self) -> None:
        """Disconnect."""
        self._ask(self._disconnect(), self._disconnected)

    def assign(self, assignment: Assignment) -> None:
        """Put sensors on other places: the body must be aligned again."""
        self.adopt(replace(self.setup, assignment=assignment))

    def adopt(self, setup: Setup) -> None:
        """Put another setup in force."""
        if setup.assignment != self.setup.assignment:
            self.alignment = None
        self._ask(self._adopt(setup), self._adopted)

    def keep_rest(self, sensor: SensorId, rest: Rest) -> None:
        """Correct a gyroscope by the offset it showed while it lay still; its gain stays."""
        info = self.infos.get(sensor)
        if info is None:
            return
        gain = (info.correction or NO_CORRECTION).gain
        x, y, z = (float(value) for value in rest.offset)
        sx, sy, sz = (float(value) for value in rest.sigma)
        now = datetime.now(UTC).isoformat(timespec="seconds")
        fresh = Calibration(sensor, Correction((x, y, z), gain), now, "rest", offset_sigma=(sx, sy, sz))
        others = tuple(known for known in self.setup.calibrations if known.sensor != sensor)
        self.adopt(replace(self.setup, calibrations=(*others, fresh)))

    def hold(self, pose: Mark) -> None:
        """A pose was held; times on the clock of the samples."""
        self._ask(self._hold(pose), _nothing)

    def start_recording(self, name: str) -> None:
        """Start a take."""
        started = self._session.start_recording(self.library, self.person, name, self.source)
        self._ask(started, _nothing, self.recording_failed.emit)

    def stop_recording(self) -> None:
        """Close the take; ``recording_saved`` comes when it was read back."""
        self._ask(self._session.stop_recording(), self._saved, self.recording_failed.emit)

    def mark(self, label: str) -> None:
        """Set a marker now."""
        self._ask(self._mark(label), _nothing)

    def run(self, operation: Operation, start: Callable[[Callable[[str, float], None]], "Future[Any]"]) -> None:
        """Start an operation and look after it until it is over."""
        operation.begin(start)
        self._operations.append(operation)

    def tick(self, now: float) -> None:
        """Tell what has happened since the last tick."""
        while True:
            try:
                event = self._session.events.get_nowait()
            except Empty:
                break
            self._tell(event)
        for operation in [*self._operations]:
            operation.poll()
        self._operations = [operation for operation in self._operations if operation.is_running]
        if now - self._health_at >= HEALTH_EVERY:
            self._health_at = now
            self._ask(self._look(), self._looked)

    def shut_down(self) -> None:
        """Stop everything in order; a recording is closed and read back first."""
        if self._session.recording is not None:
            self._runtime.call(self._session.stop_recording()).result()
        self._runtime.call(self._session.disconnect()).result()
        self._runtime.stop()
        self.worker.close()

    def _ask(
        self,
        coroutine: Coroutine[Any, Any, T],
        done: Callable[[T], None],
        refused: Callable[[StudioError], None] | None = None,
    ) -> None:
        operation = Operation(self)
        operation.done.connect(done)
        operation.refused.connect(refused or self.refused.emit)
        self.run(operation, lambda tell: self._runtime.call(coroutine))

    async def _connect(self, source: str) -> None:
        await self._session.disconnect()
        opened = await open_source(source)
        self._session.forget()
        await self._session.connect(source, opened.link)
        await self._session.sensors_known()
        self._session.adopt(setup_for(self._session.infos, opened.setup, Person()))

    async def _disconnect(self) -> None:
        await self._session.disconnect()
        self._session.forget()

    async def _adopt(self, setup: Setup) -> None:
        self._session.adopt(setup)

    async def _hold(self, pose: Mark) -> None:
        self._session.held(pose)

    async def _mark(self, label: str) -> None:
        self._session.mark(label)

    async def _look(self) -> tuple[dict[SensorId, HealthSnapshot], float, float | None, bool]:
        recording = self._session.recording
        fill = 0.0 if recording is None else recording.writer.fill
        left = None if recording is None else recording.writer.seconds_left
        full = recording is not None and recording.full.is_set()
        now = time.perf_counter()
        return {s: health.snapshot(now) for s, health in self._session.health().items()}, fill, left, full

    def _connected(self, _: object) -> None:
        self.connecting = False
        self.source_changed.emit()
        self.setup_changed.emit()

    def _disconnected(self, _: object) -> None:
        self.source, self.connecting, self.alignment = "", False, None
        self.source_changed.emit()

    def _adopted(self, _: object) -> None:
        self.setup_changed.emit()

    def _saved(self, saved: Saved) -> None:
        self.recording_saved.emit(saved)

    def _looked(self, told: tuple[dict[SensorId, HealthSnapshot], float, float | None, bool]) -> None:
        self.health, self.queue_fill, self.seconds_left, full = told
        self.health_changed.emit()
        if full:
            self.recording_full.emit()

    def _tell(self, event: events.Event) -> None:
        if isinstance(event, events.SensorFound):
            self.sensors_changed.emit()
        elif isinstance(event, events.Aligned):
            self.alignment, self.aligned_at = event.alignment, datetime.now(UTC)
            self.aligned.emit(event.alignment)
        elif isinstance(event, events.AlignmentRefused):
            self.alignment_refused.emit(event.error)
        elif isinstance(event, events.RecordingStarted):
            self.recording_started.emit(event.folder)
        elif isinstance(event, events.LinkEnded):
            self.recording_full.emit()
            if event.error is not None:
                self.refused.emit(event.error)


def _nothing(_: object) -> None:
    """An answer nobody waits for."""
