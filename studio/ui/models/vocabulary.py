"""Clinic and studio: the same functions under two sets of words."""

from dataclasses import dataclass
from typing import Literal

from PySide6.QtCore import QCoreApplication

VocabularyName = Literal["clinic", "studio"]


@dataclass(frozen=True, slots=True)
class Vocabulary:
    """What the switch changes: words, how takes are named, and what exporting offers first."""

    name: VocabularyName
    person: str
    new_person: str
    session: str
    take: str
    take_name: str
    """Name of a take nobody named."""
    preset: str
    """Key of the exporter that is offered first."""


def vocabulary(name: VocabularyName) -> Vocabulary:
    """Return the words of the clinic or of the studio, translated."""
    translate = QCoreApplication.translate
    if name == "clinic":
        return Vocabulary(
            name,
            person=translate("Vocabulary", "Person"),
            new_person=translate("Vocabulary", "New person…"),
            session=translate("Vocabulary", "Session"),
            take=translate("Vocabulary", "Take"),
            take_name="trial",
            preset="joints",
        )
    return Vocabulary(
        name,
        person=translate("Vocabulary", "Performer"),
        new_person=translate("Vocabulary", "New performer…"),
        session=translate("Vocabulary", "Session"),
        take=translate("Vocabulary", "Take"),
        take_name="motion",
        preset="bvh",
    )
