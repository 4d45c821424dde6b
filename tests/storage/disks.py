"""Disks that fail or stall when they are told to; everything else goes to the real one."""

import errno
import os
import threading
from pathlib import Path

from studio.storage.filesystem import FileSystem


class FullDisk(FileSystem):
    """Refuses one write, counted from 0, and everything that grows until the ballast is gone."""

    def __init__(self, refused: int, code: int = errno.ENOSPC, *, torn: int = 0, for_good: bool = False) -> None:
        self.writes = 0
        self._refused = refused
        self._code = code
        self._torn = torn
        self._for_good = for_good
        self._full = False

    def write(self, descriptor: int, data: bytes) -> None:
        number, self.writes = self.writes, self.writes + 1
        if number == self._refused:
            self._full = True
        if self._full:
            os.write(descriptor, data[: self._torn])
            raise OSError(self._code, "full")
        super().write(descriptor, data)

    def remove(self, file: Path) -> None:
        super().remove(file)
        if file.name == ".ballast" and not self._for_good:
            self._full = False


class StallingDisk(FileSystem):
    """Lets the opening through; every later write waits until it is told to go on."""

    def __init__(self) -> None:
        self.writes = 0
        self.stalled = threading.Event()
        self.go_on = threading.Event()

    def write(self, descriptor: int, data: bytes) -> None:
        self.writes += 1
        if self.writes > 1:
            self.stalled.set()
            self.go_on.wait()
        super().write(descriptor, data)


class ShortFiles(FileSystem):
    """Allows files of so many bytes, as FAT32 does."""

    def __init__(self, longest: int) -> None:
        self.longest = longest
        self._sizes: dict[int, int] = {}

    def longest_file(self, folder: Path) -> int:
        return self.longest

    def write(self, descriptor: int, data: bytes) -> None:
        size = self._sizes.get(descriptor, 0) + len(data)
        if size > self.longest:
            raise OSError(errno.EFBIG, "too long")
        super().write(descriptor, data)
        self._sizes[descriptor] = size

    def close(self, descriptor: int) -> None:
        self._sizes.pop(descriptor, None)
        super().close(descriptor)


class SmallDisk(FileSystem):
    """Tells how much room is left; each look takes the next number, the last one stays."""

    def __init__(self, *free: int) -> None:
        self._free = list(free)

    def free_space(self, folder: Path) -> int:
        return self._free.pop(0) if len(self._free) > 1 else self._free[0]
