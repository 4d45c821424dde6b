"""The take-writer: the one thread that touches the disk while recording."""

import threading
from collections.abc import Mapping
from concurrent.futures import Future
from pathlib import Path
from typing import NamedTuple

from studio.core.errors import RecordingError
from studio.core.sample import Sample, SensorInfo
from studio.core.take import Mark, Setup
from studio.storage.encoder import RawBytes, TakeEncoder
from studio.storage.facts import Anchor, Event, identity, mark_event
from studio.storage.filesystem import FILES, FileSystem
from studio.storage.profile import MAX_EVENTS, MAX_SAMPLES
from studio.storage.take_file import Saved, TakeFile

BLOCK_S = 0.05  # s between writes; half of what the profile allows, so that a busy computer still keeps to it
SYNC_EVERY = 20  # blocks, 1 s
CAPACITY = 60_000  # samples; 40 s of 15 tags at 100 Hz, for disks that stall
RAW_CAPACITY = 32 << 20  # bytes; 40 s of eight receivers at 1 Mbaud
EVENT_CAPACITY = 100_000
MOST_SAMPLES = MAX_SAMPLES - CAPACITY  # in one take: a full queue still fits into what readers accept
MOST_EVENTS = MAX_EVENTS - 2 * EVENT_CAPACITY  # likewise; sensors and overflows are events, too
WARN_S = 600.0  # s; 10 min: time to finish a session and to make room
_MEASURABLE_S = 1.0  # s of recording before its data rate means anything


class _Pending(NamedTuple):
    """What arrived since the writer looked."""

    infos: list[SensorInfo]
    samples: list[Sample]
    raw: list[RawBytes]
    events: list[Event]


class TakeWriter:
    """Keeps one take. Every method but the constructor returns at once and never raises.

    Samples that find the queue full (the disk stalled for longer than 40 s) are counted, and an event
    ``overflow`` in the take says how many are missing.
    """

    def __init__(
        self,
        session: Path,
        name: str,
        *,
        person: str,
        source: str,
        setup: Setup,
        versions: Mapping[str, str],
        anchor: Anchor,
        filesystem: FileSystem = FILES,
    ) -> None:
        """Make the take's folder and file, and start the thread.

        Parameters
        ----------
        session : folder from ``session_folder.open_session``
        anchor : now, on both clocks

        Raises
        ------
        DiskFull, FolderNotWritable
        """
        self._encoder = TakeEncoder(identity(name, person, source, setup, versions, anchor))
        self._file = TakeFile(session, name, self._encoder, filesystem)
        self._lock = threading.Lock()
        self._pending = _Pending([], [], [], [])
        self._raw_bytes = 0
        self._overflow = 0
        self._attachments: list[tuple[str, str, bytes]] = []
        self._stopping = threading.Event()
        self._saved: Future[Saved] = Future()
        self._seconds_left: float | None = None
        self._thread = threading.Thread(target=self._run, name="take-writer", daemon=True)
        self._thread.start()

    @property
    def folder(self) -> Path:
        """The take's folder."""
        return self._file.folder

    @property
    def fill(self) -> float:
        """How full the queue is, 0…1."""
        pending = self._pending
        return min(
            1.0,
            max(
                len(pending.samples) / CAPACITY,
                self._raw_bytes / RAW_CAPACITY,
                len(pending.events) / EVENT_CAPACITY,
            ),
        )

    @property
    def failure(self) -> RecordingError | None:
        """Why nothing more is kept; None while all is well. What was kept until then is safe."""
        return self._file.failure

    @property
    def seconds_left(self) -> float | None:
        """How long the disk will last at the data rate of this take, s; None until that is known."""
        return self._seconds_left

    def add_sensor(self, info: SensorInfo) -> None:
        """Tell what is known of a sensor, before its first sample."""
        with self._lock:
            self._pending.infos.append(info)

    update_info = add_sensor
    """Tell what became known of a sensor since."""

    def sample(self, sample: Sample) -> None:
        """Keep a sample."""
        with self._lock:
            if len(self._pending.samples) < CAPACITY:
                self._pending.samples.append(sample)
            else:
                self._overflow += 1

    def raw(self, link: str, received: float, data: bytes) -> None:
        """Keep bytes as one read of a link gave them."""
        with self._lock:
            if self._raw_bytes < RAW_CAPACITY:
                self._pending.raw.append(RawBytes(link, received, data))
                self._raw_bytes += len(data) + 64  # 64: what keeping a read costs besides its bytes
            else:
                self._overflow += 1

    def event(self, kind: str, facts: Mapping[str, object], received: float) -> None:
        """Keep something that happened: a loss, a gap, a reboot, a clock."""
        with self._lock:
            if len(self._pending.events) < EVENT_CAPACITY:
                self._pending.events.append(Event(kind, received, dict(facts)))
            else:
                self._overflow += 1

    def mark(self, mark: Mark) -> None:
        """Keep a mark; its time and end are on the clock of ``Sample.received``."""
        with self._lock:
            self._pending.events.append(mark_event(mark))

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Put a file into the take; it is written when recording stops."""
        with self._lock:
            self._attachments.append((name, media_type, data))

    def stop(self) -> Future[Saved]:
        """Finish the take; the future tells when it has been read back.

        It raises DiskFull or FolderNotWritable when the file could not be ended (it is listed as one
        that was cut off), VerificationFailed when it reads back differently.
        """
        self._stopping.set()
        return self._saved

    def _run(self) -> None:
        try:
            self._record()
            saved = self._finish()
        except BaseException as error:  # noqa: BLE001 (outermost place of this thread; the future re-raises it)
            self._saved.set_exception(error)
        else:
            self._saved.set_result(saved)

    def _record(self) -> None:
        blocks = 0
        stopping = False
        while not stopping:
            stopping = self._stopping.wait(BLOCK_S)
            pending, overflow = self._swap()
            if self.failure is not None:
                continue
            if overflow:
                pending.events.append(Event("overflow", self._latest(pending), {"missing": overflow}))
            self._write(pending)
            self._file.stop_beyond(MOST_SAMPLES, MOST_EVENTS)
            blocks += 1
            if blocks % SYNC_EVERY == 0:
                self._file.sync()
                self._look_for_room()

    def _swap(self) -> tuple[_Pending, int]:
        with self._lock:
            pending, self._pending = self._pending, _Pending([], [], [], [])
            overflow, self._overflow = self._overflow, 0
            self._raw_bytes = 0
        return pending, overflow

    def _write(self, pending: _Pending) -> None:
        for info in pending.infos:
            self._encoder.add_sensor(info)
        for block in self._encoder.blocks(pending.samples, pending.raw, pending.events):
            self._file.append(block)
            if self.failure is not None:
                return

    def _finish(self) -> Saved:
        for name, media_type, data in self._attachments:
            for block in self._encoder.attachment(name, media_type, data):
                self._file.append(block)
        return self._file.finish()

    def _look_for_room(self) -> None:
        """Compare the room on the disk with this take's own rate: other programs fill disks, too, but not steadily."""
        room = self._file.room()
        kept = self._file.kept()
        if room < 0:
            self._file.stop_for_lack_of_room()
        if kept < _MEASURABLE_S:
            return
        warned = self._seconds_left is not None and self._seconds_left < WARN_S
        self._seconds_left = max(room, 0) * kept / self._file.ledger.size
        if self._seconds_left < WARN_S and not warned:
            self.event("disk", {"seconds_left": self._seconds_left}, self._encoder.latest)

    def _latest(self, pending: _Pending) -> float:
        return pending.samples[-1].received if pending.samples else self._encoder.latest
