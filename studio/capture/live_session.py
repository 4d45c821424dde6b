"""Connect, assign, align, record, stop: the verbs of the running studio. Start reading here.

Everything runs on the acquisition thread (``Runtime.call``); the window reads ``buffer`` and ``events``.
"""

import asyncio
import math
import time
from collections.abc import Collection, Iterable, Sequence
from functools import partial
from pathlib import Path
from queue import SimpleQueue

from studio.acquisition.dialects.tag_advert import VERSION as PROTOCOL_VERSION
from studio.acquisition.driver import Arrival, Cue, Known, Link
from studio.acquisition.health import SensorHealth
from studio.capture import events
from studio.capture.body_calibration import BodyCalibration
from studio.capture.link_intake import LinkIntake
from studio.capture.link_watch import Note
from studio.capture.live_buffer import LiveBuffer
from studio.capture.pre_roll import PreRoll
from studio.capture.procedures.judged_hold import Judged
from studio.capture.recorded_setup import calibrations_of, recorded_setup
from studio.capture.recording import Recording, TakeIdentity, anchor_now, open_take
from studio.capture.runtime import first_of
from studio.core.body import Place
from studio.core.errors import AlreadyRecording, LinkError, NoData, PortGone, StudioError, UnsupportedVersion
from studio.core.live_solver import Solver
from studio.core.sample import Sample, SensorId, SensorInfo
from studio.core.take import Mark, Setup
from studio.storage.take_file import Saved

PRE_ROLL = 2.0  # s kept from before R
SETTLED = 0.5  # s without a new sensor: all have been heard (25 frames)
PATIENCE = 10.0  # s of waiting for the first sample; an Arduino that resets on opening needs up to 8 s
HISTORY = 120.0  # s of attitudes kept for aligning
BUSY_QUEUE = 0.5  # of the take-writer's queue; a source without a pace waits then
LOOK_EVERY = 0.25  # s between two looks at what does not come
STALLED = 2 * LOOK_EVERY  # s; after such a pause what came meanwhile is still to be read, and nobody is silent


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
        self._body = BodyCalibration()
        self._intakes: dict[str, LinkIntake] = {}
        self._tasks: dict[str, asyncio.Task[None]] = {}
        self._ended_by: dict[str, LinkError | None] = {}
        self._mistake: BaseException | None = None
        self._watcher: asyncio.Task[None] | None = None
        self._pre_roll = PreRoll(pre_roll)
        self._newest_sensor = float("inf")
        self._first: float | None = None
        self._newest = float("-inf")
        self._heard = float("-inf")
        self._settled = asyncio.Event()
        self._ended = asyncio.Event()

    async def connect(self, source: str, link: Link) -> None:
        """Start reading an open link; it is called by its source from now on."""
        intake = self._intakes[source] = LinkIntake(link)
        self._ended.clear()
        self._ended_by.pop(source, None)
        task = self._tasks[source] = asyncio.create_task(self._read(intake), name=f"link {source}")
        task.add_done_callback(partial(self._link_ended, source))
        if self._watcher is None:
            self._watcher = asyncio.create_task(self._watch(), name="watch")
            self._watcher.add_done_callback(self._keep_mistake)

    async def disconnect(self) -> None:
        """Close all links."""
        for intake in self._intakes.values():
            await intake.link.close()
        tasks = [task for task in (*self._tasks.values(), self._watcher) if task is not None]
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        self._tasks.clear()
        self._intakes.clear()
        self._watcher = None

    def forget(self) -> None:
        """Forget the sensors of a source that was closed."""
        self.infos.clear()
        self.buffer.clear()
        self._pre_roll.clear()
        self._body.clear()
        self._settled.clear()
        self._ended_by.clear()
        self._first = None
        self._newest_sensor, self._newest, self._heard = math.inf, -math.inf, -math.inf
        self._solver = Solver(self.setup, self._attitude, calibrations_of(self.setup), HISTORY)

    def forget_body(self) -> None:
        """Forget the body calibration: somebody else wears the sensors."""
        self._body.clear()
        self._solver.forget_body()

    async def sensors_known(self, patience: float = PATIENCE) -> None:
        """Wait until sensors send and no new one has appeared for half a second.

        Raises
        ------
        LinkError, UnsupportedVersion
            Nothing usable came within ``patience`` seconds.
        """
        await first_of(self._settled, self._ended, timeout=patience)
        if not self.infos and (mistake := self.take_mistake()) is not None:
            raise mistake
        if not self.infos and (error := self.lost()) is not None:
            raise error
        foreign = [v for intake in self._intakes.values() if (v := intake.foreign_version()) is not None]
        if not self.infos and foreign:
            raise UnsupportedVersion(foreign[0], PROTOCOL_VERSION)
        if not self.infos:
            raise NoData(", ".join(self._intakes), sum(intake.malformed() for intake in self._intakes.values()))

    def health(self) -> dict[SensorId, SensorHealth]:
        """Return the counts of all sensors."""
        return {sensor: health for intake in self._intakes.values() for sensor, health in intake.health().items()}

    def lost(self) -> LinkError | None:
        """Return why nothing comes any more when every source ended with an error or is gone, else None."""
        errors: list[LinkError] = []
        for source, intake in self._intakes.items():
            error = self._ended_by.get(source)
            if error is None and intake.watch.lost is not None:
                error = PortGone(intake.watch.lost)
            if error is None:
                return None
            errors.append(error)
        return errors[0] if errors else None

    def take_mistake(self) -> BaseException | None:
        """Return, once, what broke on the way: a mistake of ours, to be raised where it ends in a crash report."""
        mistake, self._mistake = self._mistake, None
        return mistake

    def adopt(self, setup: Setup) -> None:
        """Put another setup in force; a new assignment needs a new alignment, by poses whose samples are still kept."""
        before, self.setup = self.setup, setup
        if setup.calibrations != before.calibrations:
            self._recalibrate(before, setup)
        self._solver.adopt(setup, self._pre_roll.samples() if setup.assignment != before.assignment else ())
        if setup.assignment != before.assignment:
            first = self._pre_roll.first()
            held = [one for one in self._body.marks if first is not None and one[0].time >= first]
            self._body.clear()
            for mark, only in held:
                self._judge(mark, only)

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
        if self.recording is not None:
            raise AlreadyRecording(str(self.recording.writer.folder))
        if self._pre_roll.is_frozen:
            raise AlreadyRecording(str(library))
        self._pre_roll.is_frozen = True
        try:
            recording = await self._begin(library, person, name, source, seconds)
        finally:
            self._pre_roll.is_frozen = False
        self._pre_roll.clear()
        self.recording = recording
        self.events.put(events.RecordingStarted(recording.writer.folder))
        return recording

    async def _begin(self, library: Path, person: str, name: str, source: str, seconds: float) -> Recording:
        first = self._pre_roll.first()
        carried = self._body.carried(first, self._solver, self.setup)
        if carried is None and first == self._first:  # a replayed take carries its own, from its first sample on
            carried = self.setup.carried
        newest = self._newest
        anchor = anchor_now()
        setup = recorded_setup(self.setup, carried, self._solver)
        identity = TakeIdentity(library, person, name, source, setup, anchor)
        recording = Recording(await asyncio.to_thread(open_take, identity), seconds, anchor.monotonic)
        for intake in self._intakes.values():
            for link, dialect in intake.dialects.items():
                recording.note("link", {"link": link, "dialect": dialect}, anchor.monotonic)
        for kept in self._pre_roll:
            if isinstance(kept.piece, Sample):
                recording.sample(kept.piece, self.infos[kept.piece.sensor])
            else:
                recording.raw(kept.link, kept.piece.received, kept.piece.data)
        for mark, _ in self._body.marks:
            if first is not None and self._body.is_within(first) and mark.time >= first:
                recording.mark(mark)
        recording.mark(Mark(anchor.monotonic if first is None else max(newest, first), "record"))
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
        recording.note_health(self.health().values(), self._newest)
        for intake in self._intakes.values():
            if (truth := intake.truth()) is not None:
                recording.writer.attach("truth", "application/octet-stream", truth)
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
        await first_of(recording.full, self._ended)

    def mark(self, label: str) -> Mark:
        """Set a marker now."""
        mark = Mark(self._newest, "marker", label)
        self._set(mark)
        return mark

    async def held(self, pose: Mark, only: Collection[Place] = ()) -> Judged:
        """Align the body by a pose that was held; return what came of it, limb by limb.

        Parameters
        ----------
        pose : Mark
            Times on the clock of ``Sample.time``.
        only : places
            Limbs that were repeated while the others stay as they are; empty for the whole body.
        """
        self._set(pose)
        return self._judge(pose, only)

    def look(self, now: float) -> None:
        """Notice what did not come; ``now`` is this computer's clock, s."""
        for source, intake in self._intakes.items():
            if intake.link.paced and not self._tasks[source].done():
                self._note(intake.watch.look(now), now)
        if self.recording is not None and all(intake.link.paced for intake in self._intakes.values()):
            self.recording.look(now, self._heard)

    def _judge(self, pose: Mark, only: Collection[Place]) -> Judged:
        before = self._body.alignment
        judged = self._body.add(pose, only, self._solver, self.setup)
        if self._body.alignment is not None and self._body.alignment is not before:
            self.events.put(events.Aligned(self._body.alignment, judged.error))
        elif judged.error is not None:
            self.events.put(events.AlignmentRefused(judged.error, judged.alignment))
        return judged

    def _recalibrate(self, before: Setup, setup: Setup) -> None:
        known, wanted = calibrations_of(before), calibrations_of(setup)
        for sensor in known.keys() | wanted.keys():
            calibration = wanted.get(sensor)
            if calibration == known.get(sensor):
                continue
            if calibration is not None and self._body.marks:
                self._solver.recalibrate(calibration)  # the body stays calibrated
            else:
                self._solver.restart(sensor, calibration, self._pre_roll.samples(sensor))

    def _follow(self, mark: Mark) -> None:
        self._set(mark)
        if mark.kind == "pose":
            self._judge(mark, ())

    def _set(self, mark: Mark) -> None:
        if self.recording is not None:
            self.recording.mark(mark)
        self.events.put(events.MarkSet(mark))

    async def _read(self, intake: LinkIntake) -> None:
        async for batch in intake.link.arrivals():
            self._take_in(intake, batch, time.perf_counter())
            await intake.ask(self._newest)
            await self._give_way(intake.link)

    def _link_ended(self, source: str, task: asyncio.Task[None]) -> None:
        if self._tasks.get(source) is not task or task.cancelled():
            return
        problem = task.exception()
        error = self._ended_by[source] = problem if isinstance(problem, LinkError) else None
        self._keep_mistake(task)
        self.events.put(events.LinkEnded(source, error))
        if all(task.done() for task in self._tasks.values()):
            self._ended.set()

    def _keep_mistake(self, task: asyncio.Task[None]) -> None:
        """Keep our own mistake until somebody who can end in a crash report asks for it; recordings end by it."""
        problem = None if task.cancelled() else task.exception()
        if problem is not None and not isinstance(problem, LinkError):
            self._mistake = self._mistake or problem
            self.events.put(events.MistakeMade(problem))
            self._ended.set()

    async def _watch(self) -> None:
        while True:
            began = time.perf_counter()
            await asyncio.sleep(LOOK_EVERY)
            now = time.perf_counter()
            if now - began < STALLED:
                self.look(now)

    async def _give_way(self, link: Link) -> None:
        """Let others run; a source without a pace waits for the disk."""
        if link.paced:
            return
        await asyncio.sleep(0)
        # The take-writer is a thread without an event loop: it is looked at, not waited for.
        while self.recording is not None and self.recording.writer.fill > BUSY_QUEUE:  # noqa: ASYNC110
            await asyncio.sleep(0.005)

    def _take_in(self, intake: LinkIntake, batch: Sequence[Arrival | Known | Cue], now: float) -> None:
        self._heard = now
        for piece in batch:
            if isinstance(piece, Cue):
                self._follow(piece.mark)
                continue
            if isinstance(piece, Arrival):
                self._keep_raw(intake.name_of(piece), piece)
            for sample in intake.samples(piece):
                heard = now if intake.link.paced else sample.received  # without a pace it has a clock of its own
                self._note(intake.watch.heard(sample.sensor, heard), sample.time)
                self._take_sample(intake, sample)
        if not intake.link.paced:
            self._note(intake.watch.look(self._newest), self._newest)
        if self.recording is not None and self.recording.health_is_due(self._newest):
            self.recording.note_health(self.health().values(), self._newest)
        self._note(intake.notes(), self._newest)

    def _note(self, notes: Iterable[Note], at: float) -> None:
        for kind, facts in notes:
            self.events.put(events.LinkNoted(kind, facts))
            if self.recording is not None:
                self.recording.note(kind, facts, at)

    def _take_sample(self, intake: LinkIntake, sample: Sample) -> None:
        info = intake.infos[sample.sensor]
        if self._first is None:
            self._first = sample.time
        if self.infos.get(sample.sensor) is not info:
            self._meet(info, sample)
        self._newest = max(self._newest, sample.time)
        if self._newest - self._newest_sensor >= SETTLED:
            self._settled.set()
        if self.recording is not None:
            self.recording.sample(sample, info)
        else:
            self._pre_roll.keep(intake.link.name, sample)
            self._pre_roll.forget(self._newest)
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
            self._pre_roll.keep(link, piece)
