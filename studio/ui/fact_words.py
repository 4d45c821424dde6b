"""Facts as people read them: times, angles, names of limbs, and words that anybody may have written."""

import math
import unicodedata
from pathlib import Path
from typing import Any

LONGEST_FACT = 240  # characters, the names of all places; a longer text is cut in the middle, so that its end is seen
LONGEST_LIST = 6  # names; the rest is counted

POSES = {"n": "N-pose", "t": "T-pose", "bow": "bow", "sit": "sitting pose"}


def in_words(name: str, fact: Any) -> str:
    """Return a fact of an error as text; its name tells places, poses and angles from other words and numbers."""
    if isinstance(fact, tuple):
        return _listed([in_words(name, part) for part in fact])
    if isinstance(fact, float):
        return _number_in_words(name, fact)
    if isinstance(fact, int):
        return f"{fact:,}"
    text = readable(str(fact))
    if name in ("place", "places"):
        return text.replace("_", " ")
    return POSES.get(text, text) if name in ("pose", "held") else text


def _number_in_words(name: str, value: float) -> str:
    if name == "degrees":
        return f"{value:.1f}°" if math.isfinite(value) else "an unknown angle"
    return duration(value)


def duration(seconds: float) -> str:
    """Return a time span as people say it: ``0.4 s``, ``12 min 04.3 s``."""
    if not math.isfinite(seconds):
        return "an unknown time"
    tenths = round(abs(seconds) * 10)
    minutes, rest = divmod(tenths, 600)
    sign = "-" if seconds < 0 and tenths else ""
    return f"{sign}{minutes} min {rest / 10:04.1f} s" if minutes else f"{sign}{rest / 10:.1f} s"


def folder_in_words(folder: Path) -> str:
    """Return a folder as people write it: what is theirs begins with ``~``."""
    try:
        return str(Path("~") / folder.relative_to(Path.home()))
    except (ValueError, RuntimeError):  # elsewhere, or nobody knows whose home this is
        return str(folder)


def readable(text: str) -> str:
    """Return text of a stranger in one line that can neither colour nor reverse what stands around it."""
    # Category C holds control, format (also the marks that turn the reading direction) and unassigned characters.
    kept = "".join(" " if character.isspace() else character for character in text)
    kept = "".join(character for character in kept if unicodedata.category(character)[0] != "C").strip()
    if len(kept) > LONGEST_FACT:
        half = LONGEST_FACT // 2
        kept = f"{kept[:half]}…{kept[-half:]}"
    return kept or "(nothing)"


def _listed(names: list[str]) -> str:
    if not names:
        return "(nothing)"
    if len(names) > LONGEST_LIST:
        return f"{', '.join(names[:LONGEST_LIST])} and {len(names) - LONGEST_LIST} more"
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]
