"""How long a file may become where a take is kept: FAT32, which USB sticks come with, ends files at 4 GiB.

Asked before, because a file that has reached the limit cannot be given its end any more.
"""

import os
import sys
from pathlib import Path

FAT_LIMIT = (1 << 32) - 1  # bytes; the directory entry has 32 bits for a length
FAT_NAMES = {"vfat", "msdos", "FAT", "FAT32"}
NO_LIMIT = sys.maxsize

if sys.platform == "win32":
    import ctypes

    _LONGEST_NAME = 261  # characters, MAX_PATH and the closing zero

    def longest_file(folder: Path) -> int:
        """Return how long a file in this folder may become, bytes; ``NO_LIMIT`` when nothing tells."""
        volume = ctypes.create_unicode_buffer(_LONGEST_NAME)
        kind = ctypes.create_unicode_buffer(_LONGEST_NAME)
        kernel = ctypes.windll.kernel32
        if not kernel.GetVolumePathNameW(str(folder), volume, _LONGEST_NAME):
            return NO_LIMIT
        if not kernel.GetVolumeInformationW(volume.value, None, 0, None, None, None, kind, _LONGEST_NAME):
            return NO_LIMIT
        return FAT_LIMIT if kind.value in FAT_NAMES else NO_LIMIT
else:
    import resource

    MOUNTS = Path("/proc/self/mountinfo")  # Linux

    def longest_file(folder: Path) -> int:
        """Return how long a file in this folder may become, bytes; ``NO_LIMIT`` when nothing tells (macOS)."""
        allowed, _ = resource.getrlimit(resource.RLIMIT_FSIZE)
        limit = NO_LIMIT if allowed == resource.RLIM_INFINITY else allowed
        try:
            device = folder.stat().st_dev
            mounts = MOUNTS.read_text(encoding="utf-8", errors="replace")
        except OSError:
            return limit
        kind = kind_of_mount(mounts, os.major(device), os.minor(device))
        return min(limit, FAT_LIMIT) if kind in FAT_NAMES else limit


def kind_of_mount(mounts: str, major: int, minor: int) -> str:
    """Return the name of a device's file system in the text of Linux's mountinfo, empty when it is not there."""
    for line in mounts.splitlines():
        fields, _, rest = line.partition(" - ")
        if fields.split()[2:3] == [f"{major}:{minor}"]:
            return rest.split()[0] if rest else ""
    return ""
