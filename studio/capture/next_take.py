"""What the next take will be called, and how long it may be, before it is begun."""

import re
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from studio.storage.filesystem import FILES
from studio.storage.names import person_folder
from studio.storage.take_file import RESERVE

BYTES_OF_SAMPLE = 244.0  # in a take, raw and decoded: measured over 2 min of 15 tags at 50 and at 100 Hz
_SESSION = re.compile(r"\d{4}-\d\d-\d\d[a-z]+")
_TAKE = re.compile(r"take-(\d{3,})(_.*)?")


class NextTake(NamedTuple):
    """Where the next take will go, as far as that can be told now."""

    session: str
    """Name of the session's folder; empty when a new one will be made."""
    number: int


def next_take(library: Path, person: str) -> NextTake:
    """Return session and number of the next take of a person; nothing is made.

    Raises
    ------
    PersonCodeInvalid
    """
    folder = library / person_folder(person)
    day = datetime.now(UTC).astimezone().date().isoformat()
    try:
        sessions = [e.name for e in folder.iterdir() if _SESSION.fullmatch(e.name) and e.name.startswith(day)]
        if not sessions:
            return NextTake("", 1)
        session = max(sessions, key=lambda name: (len(name), name))
        numbers = [int(found[1]) for e in (folder / session).iterdir() if (found := _TAKE.fullmatch(e.name))]
    except OSError:
        return NextTake("", 1)
    return NextTake(session, max(numbers, default=0) + 1)


def seconds_that_fit(library: Path, rate: float) -> float | None:
    """Return how long a take with ``rate`` samples a second may be, s; None when the disk does not tell."""
    folder = library
    while not folder.exists() and folder != folder.parent:  # the library is made with the first take
        folder = folder.parent
    try:
        free = FILES.free_space(folder)
    except OSError:
        return None
    return max(free - RESERVE, 0) / (BYTES_OF_SAMPLE * rate)
