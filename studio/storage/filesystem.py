"""The few things the studio asks of a file system, in one place, so that tests can let each of them fail."""

import contextlib
import os
import shutil
import sys
import threading
from pathlib import Path

from studio.storage.longest_file import longest_file

FILE_MODE = 0o600  # a recording of a person is for its owner
FOLDER_MODE = 0o700

if sys.platform == "win32":
    import msvcrt

    _LOCKED_BYTE = 1 << 40  # beyond any take: Windows locks bytes, and others must be able to read

    def lock(descriptor: int, *, wait: bool) -> bool:
        """Lock an open file against other processes; False when another holds it."""
        position = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _LOCKED_BYTE, os.SEEK_SET)
        try:
            msvcrt.locking(descriptor, msvcrt.LK_LOCK if wait else msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        finally:
            os.lseek(descriptor, position, os.SEEK_SET)
        return True
else:
    import fcntl

    def lock(descriptor: int, *, wait: bool) -> bool:
        """Lock an open file against other processes; False when another holds it."""
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            return False
        return True


class FileSystem:
    """The real one. Every method raises OSError when the system does."""

    def make_folder(self, folder: Path) -> None:
        """Make one new folder; FileExistsError when it is there."""
        folder.mkdir(mode=FOLDER_MODE)

    def create(self, file: Path) -> int:
        """Create a file that must not exist, locked, and return its descriptor."""
        flags = os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
        descriptor = os.open(file, flags, FILE_MODE)
        lock(descriptor, wait=True)
        return descriptor

    def write(self, descriptor: int, data: bytes) -> None:
        """Write all of ``data``, with one call where the system takes it whole."""
        written = os.write(descriptor, data)
        view = memoryview(data)
        while written < len(data):
            written += os.write(descriptor, view[written:])

    def truncate(self, descriptor: int, size: int) -> None:
        """Cut a file and go to its end."""
        os.ftruncate(descriptor, size)
        os.lseek(descriptor, size, os.SEEK_SET)

    def sync(self, descriptor: int) -> None:
        """Wait until the bytes of a file are safe."""
        if hasattr(os, "fdatasync"):
            os.fdatasync(descriptor)
        else:
            os.fsync(descriptor)

    def sync_whole(self, descriptor: int) -> None:
        """Wait until the bytes of a file and what the system knows about it are safe."""
        os.fsync(descriptor)

    def sync_folder(self, folder: Path) -> None:
        """Wait until the names in a folder are safe."""
        if sys.platform == "win32":
            return  # Windows cannot open a folder; NTFS journals names
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

    def close(self, descriptor: int) -> None:
        """Close a file; its lock ends."""
        os.close(descriptor)

    def close_as(self, descriptor: int, file: Path, target: Path) -> None:
        """Close a file and give it the name of another, which it replaces."""
        if sys.platform == "win32":  # an open file cannot be renamed there
            self.close(descriptor)
            self.replace(file, target)
            return
        self.replace(file, target)
        self.close(descriptor)

    def replace(self, file: Path, target: Path) -> None:
        """Give a file the name of another, which it replaces."""
        os.replace(file, target)

    def free_space(self, folder: Path) -> int:
        """Return how many bytes this user may still write."""
        return shutil.disk_usage(folder).free

    def longest_file(self, folder: Path) -> int:
        """Return how long a file in this folder may become, bytes."""
        return longest_file(folder)

    def reserve(self, file: Path, size: int) -> None:
        """Make a file that really occupies ``size`` bytes."""
        descriptor = os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0), FILE_MODE)
        try:
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(descriptor, 0, size)
            else:
                self.write(descriptor, bytes(size))
        finally:
            os.close(descriptor)

    def remove(self, file: Path) -> None:
        """Remove a file, if it is there."""
        with contextlib.suppress(FileNotFoundError):
            os.unlink(file)


FILES = FileSystem()


def is_held(file: Path) -> bool:
    """Return whether a running process still writes this file."""
    try:
        descriptor = os.open(file, os.O_RDWR | getattr(os, "O_BINARY", 0))
    except PermissionError:
        return sys.platform == "win32"  # another user's or a read-only folder: nobody of ours writes it
    try:
        return not lock(descriptor, wait=False)
    finally:
        os.close(descriptor)


def write_atomically(file: Path, data: bytes, filesystem: FileSystem = FILES) -> None:
    """Write a small file so that it is either the old or the new one, whatever happens meanwhile."""
    temporary = file.with_name(f".{file.name}.{os.getpid()}-{threading.get_ident()}.tmp")
    filesystem.remove(temporary)
    descriptor = filesystem.create(temporary)
    try:
        try:
            filesystem.write(descriptor, data)
            filesystem.sync_whole(descriptor)
        finally:
            filesystem.close(descriptor)
        filesystem.replace(temporary, file)
    except OSError:
        with contextlib.suppress(OSError):
            filesystem.remove(temporary)
        raise
    filesystem.sync_folder(file.parent)
