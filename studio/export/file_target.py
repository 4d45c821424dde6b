"""A file at its place only when it is whole and was read back: until then the old one stays."""

import contextlib
import os
from collections.abc import Callable, Iterable
from pathlib import Path

from studio.core.errors import CannotWrite, ReadBackDiffers

ReadBack = Callable[[Path], None]
"""Reads a written file by a way that shares nothing with its writer; raises ReadBackDiffers."""


def write_file(path: Path, blocks: Iterable[bytes], read_back: ReadBack) -> None:
    """Write ``blocks`` beside ``path``, read them back, then put them in its place.

    Raises
    ------
    CannotWrite
        The folder or the file at ``path`` refuses; nothing has changed.
    ReadBackDiffers
        What was written is not what was meant; nothing has changed.
    """
    if _is_in_a_take(path):
        raise CannotWrite(str(path))
    # In the same folder, because a rename is atomic only within one file system. Always the same name, so
    # that what a killed export left is overwritten by the next.
    part = path.with_name(f".{path.name}.part")
    try:
        _write(part, blocks, path)
        try:
            read_back(part)
        except ReadBackDiffers as difference:
            raise ReadBackDiffers(str(path), difference.difference) from difference
        _replace(part, path)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


def _is_in_a_take(path: Path) -> bool:
    """Return whether ``path`` lies in the folder of a take: what the radio said is never written over."""
    folders = path.absolute().parents
    return any((folder / name).exists() for folder in folders for name in ("take.mcap", "take.part.mcap"))


def _write(part: Path, blocks: Iterable[bytes], path: Path) -> None:
    try:
        # Readable by its owner only: what people did with their bodies is theirs.
        descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0), 0o600)
        # A full disk may show only when closing.
        with os.fdopen(descriptor, "wb") as file:
            for block in blocks:
                file.write(block)
            file.flush()
            os.fsync(file.fileno())
    except OSError as refusal:
        raise CannotWrite(str(path)) from refusal


def _replace(part: Path, path: Path) -> None:
    try:
        os.replace(part, path)
        if os.name == "posix":  # Windows cannot open folders; NTFS keeps the rename in its journal
            folder = os.open(path.parent, os.O_RDONLY)
            try:
                os.fsync(folder)
            finally:
                os.close(folder)
    except OSError as refusal:
        raise CannotWrite(str(path)) from refusal
