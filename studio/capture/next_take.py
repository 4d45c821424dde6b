"""What the next take will be called, before it is begun."""

import re
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple

from studio.storage.names import person_folder

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
