"""``take.json``: what people say about a take after it was recorded. The recording itself never changes."""

import contextlib
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from studio.core.errors import WrittenByNewerStudio
from studio.core.take import Mark, Setup, Take
from studio.storage import documents
from studio.storage.facts import harmless
from studio.storage.filesystem import FILES, FileSystem
from studio.storage.limits import LONGEST_LABEL, LONGEST_NOTES, is_plausible_mark, setup_fault

TAKE_JSON: Final = "take.json"
SCHEMA: Final = 1

Verdict = Literal["none", "star", "bad"]
"""What the operator thinks of a take."""


class Edit(msgspec.Struct, frozen=True):
    """One change a person made to what is seen of a take."""

    kind: str
    facts: dict[str, Any]


class TakeDocument(msgspec.Struct, frozen=True):
    """The content of ``take.json`` (resources/take.schema.json)."""

    schema: int = SCHEMA
    name: str = ""
    notes: str = ""
    marks: tuple[Mark, ...] = ()
    """Added after recording, s of take time."""
    edits: tuple[Edit, ...] = ()
    verdict: Verdict = "none"
    setup: Setup | None = None
    """The facts in force now; null or absent: as recorded."""

    def applied(self, take: Take) -> Take:
        """Return the take as this document has it."""
        return replace(
            take,
            name=self.name,
            marks=(*take.marks, *self.marks),
            setup=take.setup if self.setup is None else self.setup,
        )


def load_document(folder: Path, recorded_name: str, *, repair: bool) -> tuple[TakeDocument, documents.State]:
    """Read ``take.json``; a lost, damaged or newer one says "as recorded".

    Parameters
    ----------
    repair : write a lost or damaged one again and keep the damaged one as ``take.json.bad``; one of a
        newer studio is left alone
    """
    file = folder / TAKE_JSON
    document, state = _load(file)
    if document is not None:
        return document, state
    document = TakeDocument(name=recorded_name)
    if repair and state == "damaged":
        documents.set_aside(file)
    if repair and state != "newer":
        with contextlib.suppress(OSError):  # a take on a read-only disk is read all the same
            documents.save(file, document)
    return document, state


def save_document(folder: Path, document: TakeDocument, filesystem: FileSystem = FILES) -> None:
    """Write ``take.json``; WrittenByNewerStudio rather than lose what a newer studio wrote there."""
    file = folder / TAKE_JSON
    _, state = _load(file)
    if state == "newer":
        raise WrittenByNewerStudio(str(file), "take.json", f"schema {SCHEMA}")
    if state == "damaged":
        documents.set_aside(file)
    documents.save(file, document, filesystem)


def _load(file: Path) -> tuple[TakeDocument | None, documents.State]:
    """Read a document; one that says what cannot be counts as damaged, because it may come from a stranger."""
    document, state = documents.load(file, TakeDocument, SCHEMA)
    if document is None:
        return None, state
    if (
        len(document.notes) > LONGEST_NOTES
        or not all(is_plausible_mark(mark) and len(mark.label) <= LONGEST_LABEL for mark in document.marks)
        or (document.setup is not None and setup_fault(document.setup))
    ):
        return None, "damaged"
    return msgspec.structs.replace(document, name=harmless(document.name)), state


def document_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``take.json``."""
    return documents.schema_of(TakeDocument, "take.json of Kinetag Studio")
