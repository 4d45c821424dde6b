"""What a user chose once and expects to find again."""

from dataclasses import dataclass, field
from typing import Literal

from studio.ui.models.vocabulary import VocabularyName

SchemeName = Literal["dark", "light", "system"]
SeenFrom = Literal["front", "behind"]
Keys = dict[str, tuple[str, ...]]
"""Key sequences of an action, in Qt's portable words; only the changed ones."""


@dataclass(frozen=True, slots=True)
class Preferences:
    """All settings with their defaults."""

    scheme: SchemeName = "system"
    text_scale: float = 1.0
    """0.8…2.0"""
    reduced_motion: bool = False
    vocabulary: VocabularyName = "clinic"
    library: str = ""
    """Folder of the takes; empty for the studio's own."""
    delay: int = 0
    """s between the press and the recording."""
    sound: bool = True
    volume: float = 0.7
    """0…1"""
    seen_from: SeenFrom = "front"
    """From where body maps show the person: the left hand is then on the right, or on the left."""
    last_source: str = ""
    last_person: str = ""
    last_preset: str = ""
    """What was exported last, in the words of ``ExportChoice.preset``."""
    export_folder: str = ""
    """Where exported files go; empty for the studio's own place."""
    take_name: str = ""
    """Name of the next take, as it was typed."""
    geometry: bytes = b""
    """Of the window, as Qt saves it."""
    clicker: bool = False
    """Whether a presenter's clicker starts and stops recordings."""
    keys: Keys = field(default_factory=dict)
    angles: tuple[str, ...] = ()
    """The large joint angles of the capture page."""
    coach_marks_done: bool = False
    """Whether the hints of the first start were dismissed."""
