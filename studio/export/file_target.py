"""A file at its place only when it is whole and was read back: until then the old one stays.

What stands there already is replaced only when this studio wrote it from the same take and nobody has touched it
since, which the sidecar tells, or when a person said so: ``--overwrite``, or the warning on the export page.
"""

import contextlib
import hashlib
import json
import os
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

from studio.core.errors import CannotWrite, ReadBackDiffers, TargetTaken

PROGRAM = "Kinetag Studio"
"""Who made a file, as its sidecar says."""

READ_AT_ONCE = 1 << 20  # bytes

ReadBack = Callable[[Path], None]
"""Reads a written file by a way that shares nothing with its writer; raises ReadBackDiffers."""


class Written(NamedTuple):
    """What became of a file."""

    bytes: int
    sha256: str


def sidecar_of(path: Path) -> Path:
    """Return where the description of an exported file stands."""
    return path.with_name(path.name + ".json")


def is_taken(path: Path) -> bool:
    """Return whether anything stands where an exported file or its sidecar would go."""
    return path.exists() or sidecar_of(path).exists()


def check_target(path: Path, samples_sha256: str, exporter: str, *, overwrite: bool) -> None:
    """Refuse before any work is done.

    Parameters
    ----------
    samples_sha256 : str
        Of the take (``sidecar.digest_of``).
    exporter : str
        Key of ``registry.EXPORTERS``: another kind of file is never replaced unasked.
    overwrite : bool
        A person said that whatever stands there is to be replaced.

    Raises
    ------
    CannotWrite, TargetTaken
    """
    reason = _obstacle(path)
    if reason is not None:
        raise CannotWrite(str(path), reason)
    if overwrite or not is_taken(path):
        return
    told = _told(sidecar_of(path))
    if not path.exists():
        if told is None:
            raise TargetTaken(str(sidecar_of(path)))
        return
    if told is None or told.get("exporter") != exporter or told["take"].get("samples_sha256") != samples_sha256:
        raise TargetTaken(str(path))
    if told.get("file") != _seen(path):
        raise TargetTaken(str(path))


def write_file(path: Path, blocks: Iterable[bytes], read_back: ReadBack) -> Written:
    """Write ``blocks`` beside ``path``, read them back, then put them in its place.

    Raises
    ------
    CannotWrite
        The folder or the file at ``path`` refuses; nothing has changed.
    ReadBackDiffers
        What was written is not what was meant; nothing has changed.
    """
    reason = _obstacle(path)
    if reason is not None:
        raise CannotWrite(str(path), reason)
    # In the same folder, because a rename is atomic only within one file system. Always the same name, so
    # that what a killed export left is overwritten by the next.
    part = path.with_name(f".{path.name}.part")
    try:
        written = _write(part, blocks, path)
        try:
            read_back(part)
        except ReadBackDiffers as difference:
            raise ReadBackDiffers(str(path), difference.difference) from difference
        _replace(part, path)
    finally:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
    return written


def _obstacle(path: Path) -> str | None:
    if _is_in_a_take(path):
        return "it lies in the folder of a take, and nothing is ever written over a recording"
    if path.is_dir():
        return "it is a folder"
    if not path.parent.exists():
        return f"there is no folder {path.parent}"
    if not path.parent.is_dir():
        return f"{path.parent} is a file, not a folder"
    return None


def _told(beside: Path) -> dict[str, Any] | None:
    """Return what a sidecar of this studio says, None when it is none."""
    try:
        told = json.loads(beside.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return None
    made_by = told.get("made_by") if isinstance(told, dict) else None
    ours = isinstance(made_by, dict) and made_by.get("program") == PROGRAM and isinstance(told.get("take"), dict)
    return told if ours else None


def _seen(path: Path) -> dict[str, Any] | None:
    try:
        with path.open("rb") as file:
            size, digest = 0, hashlib.sha256()
            while block := file.read(READ_AT_ONCE):
                size += len(block)
                digest.update(block)
    except OSError:
        return None
    return Written(size, digest.hexdigest())._asdict()


def _is_in_a_take(path: Path) -> bool:
    """Return whether ``path`` lies in the folder of a take: what the radio said is never written over."""
    folders = path.absolute().parents
    return any((folder / name).exists() for folder in folders for name in ("take.mcap", "take.part.mcap"))


def _write(part: Path, blocks: Iterable[bytes], path: Path) -> Written:
    size, digest = 0, hashlib.sha256()
    try:
        # Readable by its owner only: what people did with their bodies is theirs.
        descriptor = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0), 0o600)
        # A full disk may show only when closing.
        with os.fdopen(descriptor, "wb") as file:
            for block in blocks:
                file.write(block)
                size += len(block)
                digest.update(block)
            file.flush()
            os.fsync(file.fileno())
    except OSError as refusal:
        raise CannotWrite(str(path), _reason(refusal)) from refusal
    return Written(size, digest.hexdigest())


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
        raise CannotWrite(str(path), _reason(refusal)) from refusal


def _reason(refusal: OSError) -> str:
    return (refusal.strerror or "the system refuses").lower()
