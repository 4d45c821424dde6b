"""Connect, assign, align, record, stop: the verbs of the running studio. Start reading here.

Everything runs on the acquisition thread (``Runtime.call``); the window reads ``buffer`` and ``events``.
"""

import asyncio
import math
import time
from collections import deque
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from queue import SimpleQueue
from typing import NamedTuple, Protocol, runtime_checkable

import studio
from studio.acquisition.dialects.tag_advert import VERSION as PROTOCOL_VERSION
from studio.acquisition.driver import Arrival, Cue, Known, Link
from studio.acquisition.health import SensorHealth
from studio.capture import events
from studio.capture.link_intake import LinkIntake
from studio.capture.live_buffer import LiveBuffer
from studio.capture.recording import Recording
from studio.core.alignment import align, require_headings
from studio.core.errors import AlignmentError, LinkError, NoData, StudioError, UnsupportedVersion
from studio.core.live_solver import Solver
from studio.core.sample import Sample, SensorId, SensorInfo
from studio.core.take import Mark, Setup
from studio.storage.facts import Anchor
from studio.storage.profile import PROFILE
from studio.storage.session_folder import open_session
from studio.storage.take_file import Saved
from studio.storage.take_writer import TakeWriter

PRE_ROLL = 2.0  # s kept from before R
SETTLED = 0.5  # s without a new sensor: all have been heard (25 frames)
PATIENCE = 10.0  # s of waiting for the first sample; an Arduino that resets on opening needs up to 8 s
HISTORY = 120.0  # s of attitudes kept for aligning
HEALTH_EVERY = 10.0  # s between two notes of counts and clocks in the take
HEALTH_KEPT = ("received", "lost", "malformed", "duplicates", "late", "rate", "jitter", "offset", "skew", "rssi")
BUSY_QUEUE = 0.5  # of the take-writer's queue; a source without a pace waits then


class Kept(NamedTuple):
    """Something of the pre-roll."""

    link: str
    piece: Arrival | Sample


@runtime_checkable
class KnowsTruth(Protocol):
    """A link that can hand over a file to be put into the take: the synthetic suit's true motion."""

    def truth_attachment(self) -> bytes:
        """Return the file."""


class LiveSession:
    """The links, the solver and at most one recording."""

    def __init__(self, *, attitude: str = "vqf", pre_roll: float = PRE_ROLL) -> None:
        self.buffer = LiveBuffer()
        self.events: SimpleQueue[events.Event] = SimpleQueue()
        self.setup = Setup()
        self.infos: dict[SensorId, SensorInfo] = {}
        self.recording: Recording | None = None
        self._attitude = attitude
        self._solver = Solver(self.setup, attitude, {}, HISTORY)
        self._intakes: dict[str, LinkIntake] = {}
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._poses: list[Mark] = []
        self._pre_roll: deque[Kept] = deque()
        self._pre_roll_s = pre_roll
        self._newest_sensor = float("inf")
        self._newest = float("-inf")
        self._health_noted = float("-inf")
        self._settled = asyncio.Event()
        self._ended = asyncio.Event()

    async def connect(self, source: str, link: Link) -> None:
        """Start reading an open link; it is called by its source from now on."""
        self._intakes[source] = LinkIntake(link)
        self._ended.clear()
        self._tasks[source] = asyncio.create_task(self._read(source, link), name=f"link {source}")

    async def disconnect(self) -> None:
        """Close all links."""
        for intake in self._intakes.values():
            await intake.link.close()
        for task in self._tasks.values():
            task.cancel()
        await asyncio.gather(*self._tasks.values(), return_exceptions=True)
        self._tasks.clear()
        self._intakes.clear()

    def forget(self) -> None:
        """Forget the sensors of a source that was closed."""
        self.infos.clear()
        self.buffer.clear()
        self._pre_roll.clear()
        self._poses.clear()
        self._settled.clear()
        self._newest_sensor, self._newest = math.inf, -math.inf
        self._solver = Solver(self.setup, self._attitude, {}, HISTORY)

    async def sensors_known(self, patience: float = PATIENCE) -> None:
        """Wait until sensors send and no new one has appeared for half a second.

        Raises
        ------
        NoData, UnsupportedVersion
            Nothing usable came within ``patience`` seconds.
        """
        waiting = {asyncio.create_task(e.wait()) for e in (self._settled, self._ended)}
        _, pending = await asyncio.wait(waiting, timeout=patience, return_when=asyncio.FIRST_COMPLETED)
        for task in pending:
            task.cancel()
        foreign = [v for intake in self._intakes.values() if (v := intake.foreign_version()) is not None]
        if not self.infos and foreign:
            raise UnsupportedVersion(foreign[0], PROTOCOL_VERSION)
        if not self.infos:
            raise NoData(", ".join(self._intakes), sum(intake.malformed() for intake in self._intakes.values()))

    def health(self) -> dict[SensorId, SensorHealth]:
        """Return the counts of all sensors."""
        return {sensor: health for intake in self._intakes.values() for sensor, health in intake.health().items()}

    def adopt(self, setup: Setup) -> None:
        """Put another setup in force; a new assignment needs a new alignment, by poses whose samples are still kept."""
        is_other = setup.assignment != self.setup.assignment or setup.calibrations != self.setup.calibrations
        self.setup = setup
        if is_other:
            calibrations = {calibration.sensor: calibration for calibration in setup.calibrations}
            self._solver = Solver(setup, self._attitude, calibrations, HISTORY)
            for info in self.infos.values():
                self._solver.add_sensor(info)
            for kept in self._pre_roll:  # the filters have seen what is about to be kept
                if isinstance(kept.piece, Sample):
                    self._solver.push(kept.piece)
            first = next((kept.piece.time for kept in self._pre_roll if isinstance(kept.piece, Sample)), math.inf)
            self._poses = [pose for pose in self._poses if pose.time >= first]
            self._align()

    async def start_recording(
        self, library: Path, person: str, name: str, source: str, seconds: float = math.inf
    ) -> Recording:
        """Start a take; what arrived in the last seconds before belongs to it.

        Parameters
        ----------
        seconds : float, s
            How much to keep from the first kept sample on; without an end by default.

        Raises
        ------
        RecordingError, SetupError
            Nothing was started.
        """
        anchor = Anchor(datetime.now(UTC).isoformat(), time.perf_counter())
        versions = {"studio": studio.__version__, "protocol": str(PROTOCOL_VERSION), "profile": PROFILE}
        setup = self.setup

        def open_file() -> TakeWriter:
            session = open_session(library, person, datetime.now(UTC).astimezone().date())
            return TakeWriter(
                session, name, person=person, source=source, setup=setup, versions=versions, anchor=anchor
            )

        recording = Recording(await asyncio.to_thread(open_file), seconds)
        for intake in self._intakes.values():
            link = intake.link
            recording.note("link", {"link": link.name, "dialect": link.dialect}, anchor.monotonic)
        for kept in self._pre_roll:
            if isinstance(kept.piece, Sample):
                recording.sample(kept.piece, self.infos[kept.piece.sensor])
            else:
                recording.raw(kept.link, kept.piece.received, kept.piece.data)
        for mark in self._poses:
            if recording.first is not None and mark.time >= recording.first:
                recording.mark(mark)
        recording.mark(Mark(max(self._newest, recording.first or 0.0), "record"))
        self._pre_roll.clear()
        self.recording = recording
        self.events.put(events.RecordingStarted(recording.writer.folder))
        return recording

    async def stop_recording(self) -> Saved:
        """Close the take and return once it has been read back.

        Raises
        ------
        RecordingError
            What was kept is safe; it could not be ended or did not read back whole. A disk that filled up while
            recording is no error here: ``recording.writer.failure`` tells.
        """
        recording, self.recording = self.recording, None
        if recording is None:
            raise ValueError("nothing is being recorded")
        self._note_health(recording)
        for intake in self._intakes.values():
            if isinstance(intake.link, KnowsTruth):
                recording.writer.attach("truth", "application/octet-stream", intake.link.truth_attachment())
        failure: StudioError | None = recording.writer.failure
        try:
            return await asyncio.wrap_future(recording.writer.stop())
        except StudioError as error:
            failure = error
            raise
        finally:
            self.events.put(events.RecordingEnded(recording.writer.folder, failure))

    async def finished(self, recording: Recording) -> None:
        """Wait until a recording has its length, can keep nothing more, or its sources have ended."""
        waiting = {asyncio.create_task(e.wait()) for e in (recording.full, self._ended)}
        try:
            await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in waiting:
                task.cancel()

    def mark(self, label: str) -> Mark:
        """Set a marker now."""
        mark = Mark(self._newest, "marker", label)
        self._set(mark)
        return mark

    def held(self, pose: Mark) -> None:
        """Note that a pose was held (times on the clock of ``Sample.time``) and align the body by it."""
        self._set(pose)
        self._poses.append(pose)
        self._align()

    def _align(self) -> None:
        assignment = self.setup.assignment
        if not assignment.sensors or not self._poses:
            return
        try:
            alignment = align(self._solver.tracks(), assignment, self._poses, self.setup.mounting, HISTORY)
            require_headings(alignment)
        except AlignmentError as error:
            self.events.put(events.AlignmentRefused(error))
            return
        self._solver.use(alignment)
        self.events.put(events.Aligned(alignment))

    def _follow(self, mark: Mark) -> None:
        if mark.kind == "pose":
            self.held(mark)
        else:
            self._set(mark)

    def _set(self, mark: Mark) -> None:
        if self.recording is not None:
            self.recording.mark(mark)
        self.events.put(events.MarkSet(mark))

    async def _read(self, source: str, link: Link) -> None:
        intake = self._intakes[source]
        error: StudioError | None = None
        try:
            async for batch in link.arrivals():
                self._take_in(intake, batch)
                await intake.ask(self._newest)
                await self._give_way(link)
        except LinkError as refusal:
            error = refusal
        self.events.put(events.LinkEnded(source, error))
        if all(task.done() or task is asyncio.current_task() for task in self._tasks.values()):
            self._ended.set()

    async def _give_way(self, link: Link) -> None:
        """Let others run; a source without a pace waits for the disk."""
        if link.paced:
            return
        await asyncio.sleep(0)
        # The take-writer is a thread without an event loop: it is looked at, not waited for.
        while self.recording is not None and self.recording.writer.fill > BUSY_QUEUE:  # noqa: ASYNC110
            await asyncio.sleep(0.005)

    def _take_in(self, intake: LinkIntake, batch: Sequence[Arrival | Known | Cue]) -> None:
        for piece in batch:
            if isinstance(piece, Cue):
                self._follow(piece.mark)
                continue
            if isinstance(piece, Arrival):
                self._keep_raw(intake.link.name, piece)
            for sample in intake.samples(piece):
                self._take_sample(intake, sample)
        if self.recording is not None and self._newest - self._health_noted >= HEALTH_EVERY:
            self._note_health(self.recording)
        for kind, facts in intake.notes():
            self.events.put(events.LinkNoted(kind, facts))
            if self.recording is not None:
                self.recording.note(kind, facts, self._newest)

    def _note_health(self, recording: Recording) -> None:
        """Keep the counts and clocks of all sensors; what the samples alone do not tell."""
        self._health_noted = self._newest
        for intake in self._intakes.values():
            for sensor, health in intake.health().items():
                told = health.snapshot(self._newest)
                facts = {name: getattr(told, name) for name in HEALTH_KEPT}
                recording.writer.event("health", {"sensor": sensor, **facts}, self._newest)

    def _take_sample(self, intake: LinkIntake, sample: Sample) -> None:
        info = intake.infos[sample.sensor]
        if self.infos.get(sample.sensor) is not info:
            self._meet(info, sample)
        self._newest = max(self._newest, sample.time)
        if self._newest - self._newest_sensor >= SETTLED:
            self._settled.set()
        if self.recording is not None:
            self.recording.sample(sample, info)
        else:
            self._pre_roll.append(Kept(intake.link.name, sample))
            self._forget()
        self.buffer.add(sample)
        for frame in self._solver.push(sample):
            self.buffer.show(frame.attitudes, self._solver.pose(frame))

    def _meet(self, info: SensorInfo, sample: Sample) -> None:
        if info.sensor not in self.infos:
            self._newest_sensor = sample.time
            self.events.put(events.SensorFound(info.sensor))
        self.infos[info.sensor] = info
        self._solver.add_sensor(info)

    def _keep_raw(self, link: str, piece: Arrival) -> None:
        if self.recording is not None:
            self.recording.raw(link, piece.received, piece.data)
        else:
            self._pre_roll.append(Kept(link, piece))

    def _forget(self) -> None:
        while self._pre_roll and self._pre_roll[0].piece.received < self._newest - self._pre_roll_s:
            self._pre_roll.popleft()
