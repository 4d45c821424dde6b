"""Small JSON documents with a schema number: read with suspicion, written so that they are never half."""

import contextlib
import inspect
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from studio.core.errors import SetupError, WrittenByNewerStudio
from studio.storage.facts import NOT_JSON, from_json, to_json
from studio.storage.filesystem import FILES, FileSystem, write_atomically

T = TypeVar("T", bound=msgspec.Struct)

SIZE_LIMIT = 16 << 20  # bytes; a thousand markers need 0.1 MB

State = Literal["kept", "missing", "damaged", "newer"]


class _Number(msgspec.Struct):
    schema: int


def load(file: Path, kind: type[T], schema: int) -> tuple[T | None, State]:
    """Read a document; None when it is missing, damaged, or of a newer studio."""
    try:
        with file.open("rb") as stream:
            text = stream.read(SIZE_LIMIT + 1)
        if len(text) > SIZE_LIMIT:
            return None, "damaged"
        if from_json(text, _Number).schema > schema:
            return None, "newer"
        return from_json(text, kind), "kept"
    except FileNotFoundError:
        return None, "missing"
    except (*NOT_JSON, SetupError, OSError):  # SetupError: two sensors on one place
        return None, "damaged"


def load_own(file: Path, kind: type[T], schema: int, what: str, is_sound: Callable[[T], bool]) -> T | None:
    """Read a document of this computer; None when there is none or it is damaged, which is then kept aside.

    Parameters
    ----------
    what : the document's name for people
    is_sound : tells whether what it says can be; what cannot counts as damage

    Raises
    ------
    WrittenByNewerStudio
    """
    document, state = load(file, kind, schema)
    if state == "newer":
        raise WrittenByNewerStudio(str(file), what, f"schema {schema}")
    if state == "damaged" or (document is not None and not is_sound(document)):
        set_aside(file)
        return None
    return document


def set_aside(file: Path) -> None:
    """Keep a damaged document as ``….bad``, where it can be: a read-only disk is no reason to refuse a take."""
    with contextlib.suppress(OSError):
        FILES.replace(file, file.with_name(file.name + ".bad"))


def save(file: Path, document: msgspec.Struct, filesystem: FileSystem = FILES) -> None:
    """Write a document: afterwards the file is either the old or the new one. OSError when it cannot be."""
    write_atomically(file, msgspec.json.format(to_json(document), indent=2) + b"\n", filesystem)


def schema_of(kind: type[msgspec.Struct], title: str) -> dict[str, Any]:
    """Return the JSON Schema of a document; unknown numbers are left out of documents, so their defaults go."""
    schema = msgspec.json.schema(kind)
    text = json.dumps({"$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, **schema})
    return json.loads(text, object_hook=_published)  # type: ignore[no-any-return]


def _published(node: dict[str, Any]) -> dict[str, Any]:
    published = {key: value for key, value in node.items() if key != "default" or "NaN" not in json.dumps(value)}
    described = published.get("description")
    if isinstance(described, str):  # a docstring, which Python before 3.13 leaves indented
        published["description"] = inspect.cleandoc(described)
    return published
