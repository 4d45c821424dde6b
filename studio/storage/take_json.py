"""``take.json``: what people say about a take after it was recorded. The recording itself never changes."""

import contextlib
import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from studio.core.errors import WrittenByNewerStudio
from studio.core.take import Mark, Setup, Take
from studio.storage.facts import NOT_JSON, from_json, to_json
from studio.storage.filesystem import FILES, FileSystem, write_atomically

TAKE_JSON: Final = "take.json"
BAD: Final = "take.json.bad"
SCHEMA: Final = 1
SIZE_LIMIT: Final = 16 << 20  # bytes; a thousand markers need 0.1 MB


class Edit(msgspec.Struct, frozen=True):
    """One change a person made to what is seen of a take."""

    kind: str
    facts: dict[str, Any]


class TakeDocument(msgspec.Struct, frozen=True):
    """The content of ``take.json``."""

    schema: int = SCHEMA
    name: str = ""
    """Empty: as recorded."""
    notes: str = ""
    marks: tuple[Mark, ...] = ()
    """Added after recording, s of take time."""
    edits: tuple[Edit, ...] = ()
    setup: Setup | None = None
    """The facts in force now; absent: as recorded."""

    def applied(self, take: Take) -> Take:
        """Return the take as this document has it."""
        return replace(
            take,
            name=self.name or take.name,
            marks=(*take.marks, *self.marks),
            setup=take.setup if self.setup is None else self.setup,
        )


State = Literal["kept", "missing", "damaged", "newer"]


def load_document(folder: Path) -> tuple[TakeDocument, State]:
    """Read ``take.json``.

    A lost or damaged one is replaced by an empty document, which says "as recorded"; the damaged one is
    kept as ``take.json.bad``. One of a newer studio is left alone, and the take is seen as recorded.
    """
    file = folder / TAKE_JSON
    try:
        with file.open("rb") as stream:
            text = stream.read(SIZE_LIMIT + 1)
        if len(text) > SIZE_LIMIT:
            raise msgspec.DecodeError(f"longer than {SIZE_LIMIT} bytes")
        if _schema_of(text) > SCHEMA:
            return TakeDocument(), "newer"
        return from_json(text, TakeDocument), "kept"
    except FileNotFoundError:
        state: State = "missing"
    except NOT_JSON:
        state = "damaged"
    except OSError:
        return TakeDocument(), "damaged"
    with contextlib.suppress(OSError):  # a take on a read-only disk is read all the same
        if state == "damaged":
            FILES.replace(file, folder / BAD)
        _write(folder, TakeDocument(), FILES)
    return TakeDocument(), state


def save_document(folder: Path, document: TakeDocument, filesystem: FileSystem = FILES) -> None:
    """Write ``take.json``; WrittenByNewerStudio rather than lose what a newer studio wrote there."""
    _, state = load_document(folder)
    if state == "newer":
        raise WrittenByNewerStudio(str(folder / TAKE_JSON), "newer", str(SCHEMA))
    _write(folder, document, filesystem)


def document_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``take.json`` (resources/take.schema.json)."""
    return schema_of(TakeDocument, "A take of Kinetag Studio, as people see it")


def schema_of(kind: type[msgspec.Struct], title: str) -> dict[str, Any]:
    """Return the JSON Schema of a document; numbers that are unknown are left out, so their defaults go."""
    schema = msgspec.json.schema(kind)
    text = json.dumps({"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **schema})
    return json.loads(text, object_hook=_without_nan_default)  # type: ignore[no-any-return]


def _without_nan_default(node: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in node.items() if key != "default" or "NaN" not in json.dumps(value)}


def _schema_of(text: bytes) -> int:
    class Number(msgspec.Struct):
        schema: int

    return from_json(text, Number).schema


def _write(folder: Path, document: TakeDocument, filesystem: FileSystem) -> None:
    content = msgspec.json.format(to_json(document), indent=2)
    write_atomically(folder / TAKE_JSON, content + b"\n", filesystem)
