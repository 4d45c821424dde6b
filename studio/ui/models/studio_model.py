"""The running studio as the window sees it: one object that asks, and tells what came of it.

The three places where threads meet are here and nowhere else in ``ui``: ``session.buffer.snapshot``, the queue of
events, and ``runtime.call``.
"""

import asyncio
import contextlib
import math
import time
from collections.abc import Callable, Collection, Coroutine, Mapping
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from queue import Empty
from typing import Any, TypeVar

import numpy as np
from PySide6.QtCore import QObject, Signal

from studio.acquisition.health import HealthSnapshot
from studio.capture import events
from studio.capture.live_buffer import LiveBuffer
from studio.capture.live_session import LiveSession
from studio.capture.next_take import NextTake, next_take
from studio.capture.procedures.judged_hold import Judged
from studio.capture.runtime import Runtime
from studio.capture.setups import remember, rest_calibration, setup_for
from studio.capture.sources import open_source
from studio.capture.worker import Worker
from studio.core.body import Place
from studio.core.errors import StudioError
from studio.core.rest import Rest
from studio.core.sample import SensorId, SensorInfo
from studio.core.take import Alignment, Assignment, Mark, Setup
from studio.storage.person_file import Person, load_person
from studio.ui.operation import Operation

T = TypeVar("T")

HEALTH_EVERY = 0.25  # s
FLAGS_SECONDS = 1.0  # s
LAST_WORDS = 5.0  # s; a note or a name is on the disk within milliseconds, unless the disk is asleep


class StudioModel(QObject):
    """Connect, assign, align, record; what is running is read from here."""

    source_changed = Signal()
    """Another source, or none."""
    source_refused = Signal(object)
    """StudioError: the source cannot be opened, or was lost."""
    sensors_changed = Signal()
    """A sensor appeared, or more is known of one."""
    health_changed = Signal()
    setup_changed = Signal()
    person_changed = Signal()
    """Somebody else is captured: no body is calibrated, and nothing of the one before counts."""
    aligned = Signal(object)
    """An Alignment is in force."""
    alignment_refused = Signal(object)
    """AlignmentError."""
    hold_judged = Signal(object)
    """Judged: what became of the hold that was asked about."""
    noted = Signal(str, object)
    """Something happened on a link: its kind, and its facts."""
    recording_started = Signal(object)
    """The folder of the take."""
    recording_full = Signal()
    """Nothing more can be kept: the disk, or the source's end."""
    next_take_changed = Signal()
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
        self.next_take = NextTake("", 1)
        self.worker = Worker()
        self._runtime = Runtime()
        self._session = LiveSession()
        self._operations: list[Operation] = []
        self._health_at = -math.inf
        self._knows_body = False
        self._is_closed = False
        self._disk = ThreadPoolExecutor(1, "disk")
        """One thread: a star and the mark that follows it must not overtake each other."""
        self.heard_at = -math.inf
        """s, clock of ``now``: when a sample of any sensor last came in."""
        self._received = 0
        self._why_closed: StudioError | None = None
        self._wish = 0
        """Counts what was asked of sources: answers to older wishes count for nothing."""
        self._attempt: Operation | None = None
        self._unread: StudioError | None = None
        """Why nothing is known of the person although the sensors could be opened."""

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

    @property
    def is_simulated(self) -> bool:
        """Whether the source is the simulated performer."""
        return self.source.startswith("synthetic")

    @property
    def is_recording(self) -> bool:
        """Whether samples are being kept."""
        return self._session.recording is not None

    def now(self) -> float:
        """Return the clock of the samples, s."""
        return time.perf_counter()

    def flags(self, sensor: SensorId) -> int:
        """Return the flags a sensor raised lately."""
        window = self.buffer.snapshot((sensor,), FLAGS_SECONDS).get(sensor)
        return 0 if window is None or not len(window.flags) else int(np.bitwise_or.reduce(window.flags))

    def open(self, source: str) -> None:
        """Connect to a source instead of the one that is open."""
        if self.is_recording:
            return
        self._give_up()
        self.connecting, self.source = True, source
        self.source_changed.emit()
        self._attempt = self._ask(self._connect(source), self._connected, self._lost)

    def close_source(self) -> None:
        """Disconnect."""
        if self.is_recording:
            return
        self._give_up()
        self._ask(self._disconnect(), partial(self._disconnected, self._wish))

    def assign(self, assignment: Assignment) -> None:
        """Put sensors on other places: the body must be aligned again."""
        self.adopt(replace(self.setup, assignment=assignment))

    def set_stature(self, stature: float) -> None:
        """Enter the height of the person, m."""
        self.adopt(replace(self.setup, stature=stature, stature_known=True))

    def adopt(self, setup: Setup) -> None:
        """Put another setup in force."""
        if setup.assignment != self.setup.assignment:
            self.alignment = None
        self._ask(self._adopt(setup, self.person), self._adopted)

    def keep_rests(self, rests: Mapping[SensorId, Rest]) -> None:
        """Correct gyroscopes by the offset they showed while they lay still; their gains stay."""
        now = datetime.now(UTC).isoformat(timespec="seconds")
        infos = self.infos
        fresh = [rest_calibration(infos[sensor], rest, now) for sensor, rest in rests.items() if sensor in infos]
        others = [known for known in self.setup.calibrations if known.sensor not in rests]
        self.adopt(replace(self.setup, calibrations=(*others, *fresh)))

    def hold(self, pose: Mark, only: Collection[Place] = ()) -> None:
        """A pose was held, by the whole body or to repeat some limbs; times on the clock of the samples."""
        self._ask(self._hold(pose, only), self.hold_judged.emit)

    def choose_person(self, code: str) -> None:
        """Capture another person: their stature and, where the source knows no body, what they wore last."""
        if code == self.person:
            return
        self.person = code
        if not self._knows_body:
            self.alignment = None
        self._ask(self._meet(code), self._met, self._not_met)

    def look_for_next_take(self) -> None:
        """Find out which number the next take will have."""
        library, person = self.library, "" if self.is_simulated else self.person
        self.work(lambda: next_take(library, person), self._found_next_take)

    def start_recording(self, name: str) -> None:
        """Start a take."""
        # Nobody wears the simulated suit: its takes never stand among a person's.
        person = "" if self.is_simulated else self.person
        started = self._session.start_recording(self.library, person, name, self.source)
        self._ask(started, _nothing, self.recording_failed.emit)

    def stop_recording(self) -> None:
        """Close the take; ``recording_saved`` comes when it was read back."""
        self._ask(self._session.stop_recording(), self.recording_saved.emit, self.recording_failed.emit)

    def mark(self, label: str) -> None:
        """Set a marker now."""
        self._ask(self._mark(label), _nothing)

    def run(self, operation: Operation, start: Callable[[Callable[[str, float], None]], "Future[Any]"]) -> None:
        """Start an operation and look after it until it is over."""
        operation.begin(start)
        self._operations.append(operation)

    def work(
        self, task: Callable[[], T], done: Callable[[T], None], refused: Callable[[StudioError], None] | None = None
    ) -> None:
        """Let something that waits for the disk be done away from the Qt thread, one thing after the other."""
        self._ask(self._on_disk(task), done, refused)

    def tick(self, now: float) -> None:
        """Tell what has happened since the last tick."""
        while True:
            try:
                event = self._session.events.get_nowait()
            except Empty:
                break
            self._tell(event)
        for operation in [*self._operations]:
            operation.poll()  # what it tells may begin another one
            if not operation.is_running:
                self._operations.remove(operation)
                operation.deleteLater()
        if now - self._health_at >= HEALTH_EVERY:
            self._health_at = now
            self._ask(self._look(), self._looked)

    def shut_down(self) -> None:
        """Stop everything in order: what was asked for is done, a recording is closed and read back first."""
        self._is_closed = True
        end = self.now() + LAST_WORDS
        for operation in self._operations:
            operation.wait(max(end - self.now(), 0.0))
        if self._session.recording is not None:
            with contextlib.suppress(StudioError):  # what was kept is on the disk, and found at the next start
                self._runtime.call(self._session.stop_recording()).result()
        self._runtime.call(self._session.disconnect()).result()
        self._runtime.stop()
        self._disk.shutdown()
        self.worker.close()

    def _ask(
        self,
        coroutine: Coroutine[Any, Any, T],
        done: Callable[[T], None],
        refused: Callable[[StudioError], None] | None = None,
    ) -> Operation:
        operation = Operation(self)
        if self._is_closed:
            coroutine.close()
            return operation
        operation.done.connect(done)
        operation.refused.connect(refused or self.refused.emit)
        self.run(operation, lambda tell: self._runtime.call(coroutine))
        return operation

    def _give_up(self) -> None:
        """Another source is wanted, or none: what becomes of the one being opened is of no interest any more."""
        self._wish += 1
        if self._attempt is not None and self.connecting:
            self._attempt.cancel()
        self._attempt = None

    async def _on_disk(self, task: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._disk, task)

    async def _connect(self, source: str) -> None:
        await self._session.disconnect()
        self._session.forget()
        self._knows_body = False
        opened = await open_source(source)
        self._knows_body = opened.setup is not None
        await self._session.connect(source, opened.link)
        await self._session.sensors_known()
        try:
            person = await asyncio.to_thread(load_person, self.library, self.person)
        except StudioError as refusal:  # the sensors can be used without what is known of the person
            person, self._unread = Person(), refusal
        self._session.adopt(setup_for(self._session.infos, opened.setup, person))

    async def _disconnect(self) -> None:
        await self._session.disconnect()
        self._session.forget()

    async def _adopt(self, setup: Setup, person: str) -> None:
        self._session.adopt(setup)
        if not self._knows_body:
            await asyncio.to_thread(remember, self.library, person, setup)

    async def _meet(self, code: str) -> None:
        if not self._knows_body:
            self._session.forget_body()
        person = await asyncio.to_thread(load_person, self.library, code)
        if self._session.infos and not self._knows_body:
            known = setup_for(self._session.infos, None, person)
            self._session.adopt(replace(known, calibrations=self._session.setup.calibrations))

    async def _hold(self, pose: Mark, only: Collection[Place]) -> Judged:
        return await self._session.held(pose, only)

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
        self.connecting, self._attempt = False, None
        if self._unread is not None:
            refusal, self._unread = self._unread, None
            self.refused.emit(refusal)
        self.look_for_next_take()
        self.source_changed.emit()
        self.setup_changed.emit()

    def _lost(self, error: StudioError) -> None:
        """Close the source, and then tell why."""
        self._why_closed = error
        self._ask(self._disconnect(), partial(self._disconnected, self._wish))

    def _disconnected(self, wish: int, _: object) -> None:
        if wish != self._wish:  # another source was asked for meanwhile
            return
        self.source, self.connecting, self.alignment = "", False, None
        self.health = {}
        self.source_changed.emit()
        if self._why_closed is not None:
            error, self._why_closed = self._why_closed, None
            self.source_refused.emit(error)

    def _adopted(self, _: object) -> None:
        self.setup_changed.emit()

    def _met(self, _: object) -> None:
        self.person_changed.emit()
        self.setup_changed.emit()

    def _not_met(self, error: StudioError) -> None:
        self._met(None)
        self.refused.emit(error)

    def _found_next_take(self, found: NextTake) -> None:
        self.next_take = found
        self.next_take_changed.emit()

    def _looked(self, told: tuple[dict[SensorId, HealthSnapshot], float, float | None, bool]) -> None:
        self.health, self.queue_fill, self.seconds_left, full = told
        received = sum(snapshot.received for snapshot in self.health.values())
        if received != self._received:
            self._received, self.heard_at = received, self.now()
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
        elif isinstance(event, events.LinkNoted):
            self.noted.emit(event.kind, event.facts)
        elif isinstance(event, events.LinkEnded):
            self.recording_full.emit()
            if event.error is not None and event.source == self.source and not self.connecting:
                self._lost(event.error)
        elif isinstance(event, events.MistakeMade):
            self.recording_full.emit()
            raise event.mistake


def _nothing(_: object) -> None:
    """An answer nobody waits for."""
