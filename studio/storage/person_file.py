"""``person.json``: what is known of a person under a code. No name, no date of birth, no address."""

from pathlib import Path
from typing import Any, Final

import msgspec

from studio.core.take import Assignment, Mounting
from studio.storage import documents
from studio.storage.filesystem import FOLDER_MODE
from studio.storage.limits import STATURES
from studio.storage.names import person_folder
from studio.storage.session_folder import refusal_of

PERSON_JSON: Final = "person.json"
SCHEMA: Final = 1


class Person(msgspec.Struct, frozen=True):
    """The content of ``person.json`` (resources/person.schema.json)."""

    schema: int = SCHEMA
    stature: float | None = None
    """m; null or absent: nobody entered it."""
    assignment: Assignment = Assignment()
    """The last one used: offered for the next recording."""
    mounting: Mounting = "unknown"


def load_person(library: Path, code: str) -> Person:
    """Return what is known of a person; nothing when there is no file or it is damaged (kept as ``….bad``).

    Raises
    ------
    PersonCodeInvalid, WrittenByNewerStudio
    """
    file = library / person_folder(code) / PERSON_JSON
    person = documents.load_own(file, Person, SCHEMA, PERSON_JSON, _is_plausible)
    return Person() if person is None else person


def save_person(library: Path, code: str, person: Person) -> None:
    """Write what is known of a person.

    Raises
    ------
    PersonCodeInvalid, WrittenByNewerStudio, FolderNotWritable, FolderIsFile
    """
    load_person(library, code)
    folder = library / person_folder(code)
    try:
        library.mkdir(parents=True, exist_ok=True)
        folder.mkdir(mode=FOLDER_MODE, exist_ok=True)
        documents.save(folder / PERSON_JSON, person)
    except OSError as error:
        raise refusal_of(folder) from error


def _is_plausible(person: Person) -> bool:
    return person.stature is None or STATURES[0] <= person.stature <= STATURES[1]


def person_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``person.json``."""
    return documents.schema_of(Person, "person.json of Kinetag Studio")
