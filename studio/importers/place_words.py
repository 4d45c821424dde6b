"""Which place of the body a name in a file means."""

import re
from collections.abc import Mapping, Sequence

from studio.core.body import Place
from studio.core.sample import SensorId

_SIDES = {"left": "left", "l": "left", "right": "right", "r": "right"}

# Longer names first: "lower arm" before "arm", "lower leg" before "leg".
_PARTS: tuple[tuple[str, str], ...] = (
    ("upper leg", "thigh"),
    ("up leg", "thigh"),
    ("upperleg", "thigh"),
    ("thigh", "thigh"),
    ("femur", "thigh"),
    ("lower leg", "shank"),
    ("lowerleg", "shank"),
    ("shank", "shank"),
    ("shin", "shank"),
    ("calf", "shank"),
    ("tibia", "shank"),
    ("foot", "foot"),
    ("upper arm", "upper_arm"),
    ("upperarm", "upper_arm"),
    ("humerus", "upper_arm"),
    ("lower arm", "forearm"),
    ("lowerarm", "forearm"),
    ("fore arm", "forearm"),
    ("forearm", "forearm"),
    ("wrist", "forearm"),
    ("hand", "hand"),
    ("pelvis", "pelvis"),
    ("sacrum", "pelvis"),
    ("hips", "pelvis"),
    ("upper torso", "chest"),
    ("chest", "chest"),
    ("sternum", "chest"),
    ("thorax", "chest"),
    ("forehead", "head"),
    ("head", "head"),
)


def guess_place(name: str) -> Place | None:
    """Return the place a name such as ``Left Lower Leg 64F61CB3`` means, None when it does not tell."""
    words = re.findall(r"[a-z]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).lower())
    text = f" {' '.join(words)} "
    part = next((part for phrase, part in _PARTS if f" {phrase} " in text), None)
    sides = {_SIDES[word] for word in words if word in _SIDES}
    if part is None or len(sides) > 1:
        return None
    if part in {"pelvis", "chest", "head"}:
        return Place(part) if not sides else None
    return Place(f"{sides.pop()}_{part}") if sides else None


def guess_assignment(names: Sequence[tuple[SensorId, str]]) -> Mapping[Place, SensorId]:
    """Return the places that exactly one of the named sensors claims."""
    claims: dict[Place, list[SensorId]] = {}
    for sensor, name in names:
        place = guess_place(name)
        if place is not None:
            claims.setdefault(place, []).append(sensor)
    return {place: sensors[0] for place, sensors in claims.items() if len(sensors) == 1}
