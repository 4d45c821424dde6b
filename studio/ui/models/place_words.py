"""The 15 places in words, out of ``resources/places.json``."""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

from studio.core.body import Place

Vocabulary = Literal["clinic", "plain"]


class PlaceWords(NamedTuple):
    """What is said about one place."""

    name: str
    measurand: str
    """What its sensor measures: paper 003, Table 1."""
    strap: str
    """Where the tag goes."""


def place_words(parsed: Mapping[str, Any], vocabulary: Vocabulary = "clinic") -> dict[Place, PlaceWords]:
    """Return the words for each place; ``parsed`` is the content of ``resources/places.json``."""
    return {
        Place(entry["key"]): PlaceWords(
            entry["names"][vocabulary], entry["table_1"]["measurand"], entry["strap"]["band"]
        )
        for entry in parsed["places"]
    }
