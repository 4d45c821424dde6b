"""The take's small facts as JSON: setup, sensors, marks and events."""

import math
import unicodedata
from collections.abc import Mapping
from dataclasses import replace
from itertools import islice
from typing import Any, TypeVar

import msgspec
import numpy as np

from studio.core.sample import SensorInfo, is_plausible_correction
from studio.core.take import Mark, Setup
from studio.storage.limits import LONGEST_LABEL, plausible_utc

T = TypeVar("T")

TEXT_LIMIT = 64  # characters of a text that came from a sensor
FACTS_LIMIT = 64  # of a sensor, and versions of a take

NOT_JSON = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""What reading damaged or hostile JSON raises."""


class Anchor(msgspec.Struct, frozen=True):
    """One instant on both clocks of the recording computer."""

    utc: str
    """ISO 8601, UTC; empty when nobody knows (foreign recordings)."""
    monotonic: float
    """s, the clock of ``Sample.received``."""


class Event(msgspec.Struct, frozen=True):
    """Something that happened while recording."""

    kind: str
    received: float
    """s, the clock of ``Sample.received``; in take time where a take is read."""
    facts: dict[str, Any]


class Identity(msgspec.Struct, frozen=True):
    """What a take file says about itself in its first block."""

    name: str
    person: str
    source: str
    setup: Setup
    versions: dict[str, str]
    anchor: Anchor


class SensorRecord(msgspec.Struct, frozen=True):
    """What the channel of a sensor says."""

    zero_s: float
    """Take time 0 on the clock of ``Sample.time``."""
    info: SensorInfo


def identity(
    name: str, person: str, source: str, setup: Setup, versions: Mapping[str, str], anchor: Anchor
) -> Identity:
    """Return the identity of a take; ``versions`` are copied."""
    return Identity(name, person, source, setup, dict(versions), anchor)


def to_json(value: object) -> bytes:
    """Return a dataclass as JSON without its unknown numbers: JSON has no NaN, and NaN is their default."""
    return msgspec.json.encode(_without_nan(msgspec.to_builtins(value)))


def from_json(text: bytes | str, kind: type[T]) -> T:
    """Read what ``to_json`` wrote; one of ``NOT_JSON`` when it is something else."""
    return msgspec.json.decode(text, type=kind)


def event_json(event: Event) -> bytes:
    """Return one event as the body of a message."""
    received = event.received if math.isfinite(event.received) else 0.0
    return msgspec.json.encode({"kind": event.kind, "received": received, "facts": event.facts}, enc_hook=_spelled)


def mark_event(mark: Mark) -> Event:
    """Return the event that keeps a mark; its time and end are on the clock of ``Sample.received``."""
    return Event("mark", mark.time, _without_nan(msgspec.to_builtins(mark)))


def sensor_event(info: SensorInfo, received: float) -> Event:
    """Return the event that tells what became known of a sensor."""
    return Event("sensor", received, _without_nan(msgspec.to_builtins(info)))


def event_mark(event: Event, zero: float) -> Mark:
    """Return the mark an event keeps, in take time."""
    mark = msgspec.convert(event.facts, Mark)
    kind, label = harmless(mark.kind), harmless(mark.label)
    return replace(mark, time=mark.time - zero, end=mark.end - zero, kind=kind, label=label)


def event_sensor(event: Event) -> SensorInfo:
    """Return what an event tells of a sensor."""
    return cleaned(msgspec.convert(event.facts, SensorInfo))


def cleaned(info: SensorInfo) -> SensorInfo:
    """Return what is known of a sensor with harmless texts, and without a correction that cannot be."""
    facts = {
        clean(key)[:TEXT_LIMIT]: clean(value)[:TEXT_LIMIT] if isinstance(value, str) else value
        for key, value in islice(info.facts.items(), FACTS_LIMIT)
    }
    correction = info.correction
    if correction is not None and not is_plausible_correction(correction):
        correction = None  # as of a tag that did not tell
    return replace(info, label=clean(info.label)[:TEXT_LIMIT], correction=correction, facts=facts)


def cleaned_identity(identity: Identity) -> Identity:
    """Return what a take says about itself with harmless texts."""
    return msgspec.structs.replace(
        identity,
        name=harmless(identity.name),
        person=harmless(identity.person),
        source=harmless(identity.source),
        versions={harmless(key): harmless(value) for key, value in islice(identity.versions.items(), FACTS_LIMIT)},
        anchor=msgspec.structs.replace(identity.anchor, utc=plausible_utc(identity.anchor.utc)),
    )


def harmless(text: str) -> str:
    """Return a stranger's text without control characters, and not longer than a line."""
    return clean(text)[:LONGEST_LABEL]


def clean(text: str) -> str:
    """Return a stranger's text without control and direction characters."""
    return "".join(c for c in text if unicodedata.category(c) not in {"Cc", "Cf", "Cs", "Zl", "Zp"})


def _spelled(value: object) -> object:
    """Return what msgspec does not know as something it knows: a fact is never a reason to lose a recording."""
    return value.item() if isinstance(value, np.generic) else str(value)


def _without_nan(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items() if not _unknown(item)}
    if isinstance(value, (list, tuple)):
        return [_without_nan(item) for item in value]
    return value


def _unknown(value: Any) -> bool:
    if isinstance(value, float):
        return not math.isfinite(value)
    return isinstance(value, (list, tuple)) and any(_unknown(item) for item in value)
