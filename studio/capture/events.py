"""What the running studio tells whoever watches it. Frozen, and without any reference back."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from studio.core.errors import AlignmentError, StudioError
from studio.core.sample import SensorId
from studio.core.take import Alignment, Mark


@dataclass(frozen=True, slots=True)
class SensorFound:
    """A sensor sent for the first time."""

    sensor: SensorId


@dataclass(frozen=True, slots=True)
class LinkNoted:
    """Something happened on a link: a reboot, a gap, two tags with one number, a silent tag, a port that is gone…

    Kinds and facts stand with ``acquisition.tracker.LinkTracker`` and ``capture.link_watch.LinkWatch``.
    """

    kind: str
    facts: Mapping[str, object]


@dataclass(frozen=True, slots=True)
class LinkEnded:
    """A source has nothing more to give; ``error`` says why when it was not its end."""

    source: str
    error: StudioError | None


@dataclass(frozen=True, slots=True)
class MistakeMade:
    """Something of ours broke: to be raised where it ends in a crash report, once what was recorded is saved."""

    mistake: BaseException


@dataclass(frozen=True, slots=True)
class RecordingStarted:
    """Samples are being kept."""

    folder: Path


@dataclass(frozen=True, slots=True)
class RecordingEnded:
    """The take is closed; ``error`` says why when it could not be kept or read back whole."""

    folder: Path
    error: StudioError | None


@dataclass(frozen=True, slots=True)
class MarkSet:
    """A marker was set, or a pose was held."""

    mark: Mark


@dataclass(frozen=True, slots=True)
class Aligned:
    """The body follows the sensors from now on."""

    alignment: Alignment
    error: AlignmentError | None = None
    """Which limbs are to be repeated, when not all could be used."""


@dataclass(frozen=True, slots=True)
class AlignmentRefused:
    """A held pose could not be used; what was in force before stays."""

    error: AlignmentError
    alignment: Alignment | None = None
    """What was found all the same: the limbs, when only their headings are missing."""


Event = (
    SensorFound
    | LinkNoted
    | LinkEnded
    | MistakeMade
    | RecordingStarted
    | RecordingEnded
    | MarkSet
    | Aligned
    | AlignmentRefused
)
