"""A take file being written: blocks go in, and what is safe stays safe whatever the disk does."""

import contextlib
import errno
from pathlib import Path
from typing import NamedTuple

from studio.core.errors import DiskFull, FileAtLimit, FolderNotWritable, RecordingError, TakeAtLimit
from studio.storage.blocks import Block
from studio.storage.encoder import TakeEncoder
from studio.storage.filesystem import FileSystem
from studio.storage.ledger import Ledger
from studio.storage.profile import BALLAST_FILE, EVENT_TOPIC, IMU_TOPIC, PART_FILE, TAKE_FILE
from studio.storage.session_folder import make_take_folder
from studio.storage.take_json import TakeDocument, save_document
from studio.storage.verification import verify

BALLAST = 8 << 20  # bytes held back, so that a full disk still takes the last block, the end and take.json
RESERVE = 64 << 20  # bytes free below which nothing is recorded: the system itself needs room
END_RESERVE = 64 << 20  # bytes; the whole queue of the take-writer, last words and a closing without index
NO_ROOM = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}


class Saved(NamedTuple):
    """A take that is on disk and was read back."""

    folder: Path
    samples: int
    duration: float
    """s, from the first to the last kept sample"""


class TakeFile:
    """One take on its way to disk. Used by one thread."""

    def __init__(self, session: Path, name: str, encoder: TakeEncoder, filesystem: FileSystem) -> None:
        """Make the folder and the file; DiskFull or FolderNotWritable when there can be no recording."""
        self.failure: RecordingError | None = None
        self.ledger = Ledger()
        self._encoder = encoder
        self._filesystem = filesystem
        self._torn = False
        self.folder = session
        try:
            session.mkdir(parents=True, exist_ok=True)
            if filesystem.free_space(session) < RESERVE + BALLAST:
                raise OSError(errno.ENOSPC, "less than the reserve")
            self.folder = make_take_folder(session, name, filesystem)
        except OSError as error:
            raise self._failed(error) from error
        self._part = self.folder / PART_FILE
        self._ballast = self.folder / BALLAST_FILE
        self._descriptor = self._begin()
        self._longest = filesystem.longest_file(self.folder)

    def append(self, block: Block) -> None:
        """Write one block. When the disk refuses it, ``failure`` is set and the room kept back takes it."""
        try:
            self._put(block.data)
        except OSError as error:
            self.failure = self.failure or self._failed(error)
            try:
                self._filesystem.remove(self._ballast)
                self._put(block.data)
            except OSError:
                self._encoder.forget_block()
                return
        self.ledger.add(block)

    def sync(self) -> None:
        """Wait until what was written is safe from a power cut."""
        try:
            self._filesystem.sync(self._descriptor)
        except OSError as error:
            self.failure = self.failure or self._failed(error)

    def free_space(self) -> int:
        """Return the bytes left on this disk; as much as needed when the system does not tell."""
        try:
            return self._filesystem.free_space(self.folder)
        except OSError:
            return RESERVE

    def room(self) -> int:
        """Return how many bytes can still be added; 0 or less: recording has to stop."""
        return min(self.free_space() - RESERVE, self._room_in_file())

    def stop_for_lack_of_room(self) -> None:
        """Set ``failure`` before the disk refuses."""
        if self._room_in_file() <= 0:
            self.failure = self.failure or FileAtLimit(str(self.folder), self.kept())
        self.failure = self.failure or self._failed(OSError(errno.ENOSPC, "less than the reserve"))

    def stop_beyond(self, samples: int, events: int) -> None:
        """Set ``failure`` when that many are kept: a take no reader accepts is no take."""
        if self._samples() >= samples or self.ledger.counts[self._encoder.channels[EVENT_TOPIC].id] >= events:
            self.failure = self.failure or TakeAtLimit(str(self.folder), self.kept())

    def _samples(self) -> int:
        channels = self._encoder.channels
        return sum(self.ledger.counts[channel.id] for topic, channel in channels.items() if topic.startswith(IMU_TOPIC))

    def _room_in_file(self) -> int:
        return self._longest - self.ledger.size - END_RESERVE

    def kept(self) -> float:
        """Return how much of the recording is on disk, s."""
        return 0.0 if self.ledger.until is None else self.ledger.until - self._encoder.zero

    def finish(self) -> Saved:
        """End the file, give it its name, read it back.

        Raises
        ------
        DiskFull, FolderNotWritable
            The end could not be written: the take stays as one that was cut off.
        VerificationFailed
        """
        try:
            self._filesystem.remove(self._ballast)
            self._end()
        except OSError as error:
            failure = self.failure or self._failed(error)
            with contextlib.suppress(OSError):
                self._filesystem.close(self._descriptor)
            raise failure from error
        with contextlib.suppress(OSError):  # read_take makes a lost take.json again
            save_document(self.folder, TakeDocument(name=self._encoder.identity.name), self._filesystem)
        channels = self._encoder.channels
        imu = {channel.id for topic, channel in channels.items() if topic.startswith(IMU_TOPIC)}
        latest = verify(self.folder / TAKE_FILE, self.ledger, imu)
        samples = self._samples()
        return Saved(self.folder, samples, max(latest - self._encoder.zero, 0.0) if samples else 0.0)

    def _begin(self) -> int:
        filesystem, descriptor = self._filesystem, None
        try:
            filesystem.reserve(self._ballast, BALLAST)
            descriptor = filesystem.create(self._part)
            opening = self._encoder.opening()
            filesystem.write(descriptor, opening.data)
            filesystem.sync_whole(descriptor)
            filesystem.sync_folder(self.folder)
            filesystem.sync_folder(self.folder.parent)
        except OSError as error:
            with contextlib.suppress(OSError):
                if descriptor is not None:
                    filesystem.close(descriptor)
            for file in (self._ballast, self._part):
                with contextlib.suppress(OSError):
                    filesystem.remove(file)
            with contextlib.suppress(OSError):
                self.folder.rmdir()
            raise self._failed(error) from error
        self.ledger.add(opening)
        return descriptor

    def _put(self, data: bytes) -> None:
        if self._torn:
            raise OSError(errno.EIO, "the end of the file is torn")
        try:
            self._filesystem.write(self._descriptor, data)
        except OSError:
            try:
                self._filesystem.truncate(self._descriptor, self.ledger.size)
            except OSError:
                self._torn = True
            raise

    def _end(self) -> None:
        filesystem = self._filesystem
        words = self._encoder.last_words()
        self._put(words.data)
        self.ledger.add(words)
        # On a full disk the index may be longer than the room kept back; readers do without.
        room = BALLAST // 2 if self.failure else self._longest - self.ledger.size
        indexed = self.ledger.index_size() < room
        self._put(self.ledger.closing(self._encoder.channels, indexed=indexed))
        filesystem.sync_whole(self._descriptor)
        filesystem.close_as(self._descriptor, self._part, self.folder / TAKE_FILE)
        filesystem.sync_folder(self.folder)

    def _failed(self, error: OSError) -> RecordingError:
        if error.errno == errno.EFBIG:
            return FileAtLimit(str(self.folder), self.kept())
        if error.errno in NO_ROOM:
            return DiskFull(str(self.folder), self.kept())
        return FolderNotWritable(str(self.folder))
