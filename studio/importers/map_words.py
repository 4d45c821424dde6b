"""What is wrong in a map, in words: the reader of JSON speaks of types, people of what is allowed."""

import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

_STEP = re.compile(r"\.(\w+)|\[(\d+)\]")
_BYTE = re.compile(r"JSON is malformed: (.*) \(byte (\d+)\)")

_KINDS = {
    "array": "a list",
    "object": "entries in braces",
    "str": "a text",
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "null": "nothing",
}

Schema = Mapping[str, Any]


def in_words(message: str, where: str, text: bytes, schema: Schema) -> str:
    """Return a message of msgspec as one clause.

    Parameters
    ----------
    where : str
        JSON path of the place, ``$.sensors[0].gyroscope.unit``.
    text : bytes
        The map, to find lines in.
    schema
        JSON Schema of the map, to find what is allowed.
    """
    if "truncated" in message:
        return "it ends too early: a bracket or a quotation mark is not closed"
    if malformed := _BYTE.fullmatch(message):
        line = text[: int(malformed[2])].count(b"\n") + 1
        return f"line {line} is no JSON: {malformed[1]}"
    for pattern, clause in _CLAUSES:
        if found := pattern.fullmatch(message):
            return clause(found, _allowed(where, schema))
    return message[:1].lower() + message[1:]


def _kinds(words: str) -> str:
    kinds = [_KINDS.get(word, word) for word in words.split(" | ") if word != "null"]
    return " or ".join(kinds) or _KINDS["null"]


_Clause = Callable[[re.Match[str], str], str]

_CLAUSES: tuple[tuple[re.Pattern[str], _Clause], ...] = (
    (re.compile(r"Invalid enum value (.*)"), lambda found, allowed: f"{found[1]} is none of {allowed}"),
    (
        re.compile(r"Object contains unknown field `(.*)`"),
        lambda found, allowed: f"there is no entry {found[1]!r}, only {allowed}",
    ),
    (re.compile(r"Object missing required field `(.*)`"), lambda found, _: f"the entry {found[1]!r} is missing"),
    (
        re.compile(r"Expected `(.*)` of length >= (\d+)"),
        lambda found, _: f"it must be {_kinds(found[1])} that is not empty",
    ),
    (re.compile(r"Expected `array` of length (\d+).*"), lambda found, _: f"it must be a list of {found[1]}"),
    (
        re.compile(r"Expected `(.*)` (>=|>|<=|<) (.*)"),
        lambda found, _: f"it must be {_kinds(found[1])} {found[2]} {float(found[3]):g}",
    ),
    (
        re.compile(r"Expected `(.*)`, got `(.*)`"),
        lambda found, _: f"it must be {_kinds(found[1])}, not {_kinds(found[2])}",
    ),
)


def _allowed(where: str, schema: Schema) -> str:
    """Return the words or the entries that may stand at a place."""
    nodes = list(_opened(schema, schema))
    for name, number in _STEP.findall(where):
        inner = [_inside(node, name, number) for node in nodes]
        nodes = [node for outer in inner if outer is not None for node in _opened(outer, schema)]
    words = [word for node in nodes for word in (*node.get("enum", ()), *node.get("properties", ())) if word]
    return ", ".join(map(str, words))


def _inside(node: Schema, name: str, number: str) -> Schema | None:
    if name:
        found = node.get("properties", {}).get(name)
    else:
        listed = node.get("prefixItems", ())
        found = listed[int(number)] if int(number) < len(listed) else node.get("items")
    return found if isinstance(found, Mapping) else None


def _opened(node: Schema, schema: Schema) -> Iterator[Schema]:
    """Yield what a node may be: references and alternatives are followed."""
    if "$ref" in node:
        yield from _opened(schema["$defs"][node["$ref"].rpartition("/")[2]], schema)
    elif "anyOf" in node:
        for choice in node["anyOf"]:
            yield from _opened(choice, schema)
    else:
        yield node
