"""What the strip at the bottom tells at one glance: may I record now, and what would be lost."""

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple


class StripPhase(Enum):
    """The one word of the strip."""

    READY = "ready"
    CHECK = "check"
    COUNTDOWN = "countdown"
    RECORDING = "recording"
    SAVING = "saving"
    SAVED = "saved"
    PROBLEM = "problem"


class Problem(NamedTuple):
    """Something to look at before, or while, recording."""

    text: str
    """A sentence."""
    fix: str
    """Label of the button that mends it; empty when only the person can."""
    fix_id: str


@dataclass(frozen=True, slots=True)
class ReadinessState:
    """All that the strip shows."""

    phase: StripPhase = StripPhase.READY
    sensors: int = 0
    """Heard now."""
    sensors_expected: int = 0
    """Assigned, or all that were ever heard."""
    calibrated_for: float | None = None
    """s since the body was calibrated; None when it is not."""
    loss: float | None = None
    """Share of packets lost, 0…1; None when nothing was heard."""
    disk_left: float | None = None
    """s of recording that fit on the disk; None when it is not known."""
    buffer_fill: float = 0.0
    """Of the queue to the disk, 0…1."""
    next_take: str = ""
    elapsed: float = 0.0
    """s of the recording, or seconds left of the countdown."""
    problems: tuple[Problem, ...] = ()

    @property
    def is_recording(self) -> bool:
        """Whether samples are being kept."""
        return self.phase is StripPhase.RECORDING


def clock(seconds: float) -> str:
    """Return ``00:12.4``, with hours when there are some."""
    tenths = int(max(seconds, 0.0) * 10 + 1e-6)
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    short = f"{minutes:02d}:{rest // 10:02d}.{rest % 10}"
    return f"{hours}:{short}" if hours else short


def clock_seconds(seconds: float) -> str:
    """Return ``00:12``, with hours when there are some."""
    return clock(seconds).partition(".")[0]
