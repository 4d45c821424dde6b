"""The library on disk: ``<library>/<person>/<session>/<take>/``. Nothing is ever overwritten or deleted."""

import contextlib
import re
from datetime import date
from pathlib import Path
from typing import NamedTuple

from studio.core.errors import FolderIsFile, FolderNotWritable, RecordingError
from studio.storage.filesystem import FILES, FOLDER_MODE, FileSystem, is_held
from studio.storage.names import person_folder, slug
from studio.storage.profile import PART_FILE, TAKE_FILE

_SESSION = re.compile(r"(\d{4}-\d\d-\d\d)([a-z]+)")
_TAKE = re.compile(r"take-(\d{3,})(_.*)?")
ATTEMPTS = 1000  # other programs may make the same folders at the same time


class ListedTake(NamedTuple):
    """A take that is in the library."""

    folder: Path
    recovered: bool
    """Its recording was cut off; it can be read as it is, and ``recovery.recover`` finishes it."""


def open_session(library: Path, person: str, day: date) -> Path:
    """Return the latest session of a person on this day, a new one when there is none.

    Raises
    ------
    PersonCodeInvalid, FolderNotWritable, FolderIsFile
    """
    sessions = _sessions(library / person_folder(person), day)
    if sessions:
        return sessions[-1]
    return new_session(library, person, day)


def new_session(library: Path, person: str, day: date) -> Path:
    """Make and return the next session of a person on this day: a, b … z, aa …

    Raises
    ------
    PersonCodeInvalid, FolderNotWritable, FolderIsFile
    """
    folder = library / person_folder(person)
    try:
        library.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=FOLDER_MODE, exist_ok=True)
        number = len(_sessions(folder, day))
        for attempt in range(number, number + ATTEMPTS):
            session = folder / f"{day.isoformat()}{_letters(attempt)}"
            with contextlib.suppress(FileExistsError):
                session.mkdir(mode=FOLDER_MODE)
                return session
    except OSError as error:
        raise refusal_of(library) from error
    raise FolderNotWritable(str(folder))


def refusal_of(folder: Path) -> RecordingError:
    """Return why a folder could not be made or written."""
    for part in (folder, *folder.parents):
        if part.exists():
            return FolderNotWritable(str(folder)) if part.is_dir() else FolderIsFile(str(part))
    return FolderNotWritable(str(folder))


def make_take_folder(session: Path, name: str, filesystem: FileSystem = FILES) -> Path:
    """Make and return the folder of the next take: ``take-001_walk``. OSError when it cannot be made."""
    numbers = [int(found[1]) for entry in session.iterdir() if (found := _TAKE.fullmatch(entry.name))]
    number = max(numbers, default=0) + 1
    title = slug(name)
    for attempt in range(number, number + ATTEMPTS):
        folder = session / (f"take-{attempt:03d}" + (f"_{title}" if title else ""))
        with contextlib.suppress(FileExistsError):
            filesystem.make_folder(folder)
            return folder
    raise FileExistsError(str(session))


def list_takes(library: Path) -> list[ListedTake]:
    """Return the takes of all persons, in the order of their folders; a take being recorded is not among them."""
    takes = []
    for finished in (False, True):
        for file in library.glob(f"*/*/*/{TAKE_FILE if finished else PART_FILE}"):
            folder = file.parent
            if finished:
                takes.append(ListedTake(folder, recovered=False))
            elif not (folder / TAKE_FILE).exists() and _is_orphan(file):
                takes.append(ListedTake(folder, recovered=True))
    return sorted(takes)


def _is_orphan(file: Path) -> bool:
    try:
        return not is_held(file)
    except FileNotFoundError:
        return False  # finished meanwhile


def _sessions(folder: Path, day: date) -> list[Path]:
    if not folder.is_dir():
        return []
    found = [
        (len(match[2]), entry)
        for entry in folder.iterdir()
        if (match := _SESSION.fullmatch(entry.name)) and match[1] == day.isoformat() and entry.is_dir()
    ]
    return [entry for _, entry in sorted(found)]


def _letters(number: int) -> str:
    letters = ""
    number += 1
    while number:
        number, letter = divmod(number - 1, 26)
        letters = chr(ord("a") + letter) + letters
    return letters
