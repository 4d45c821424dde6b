"""Holding a pose: counting down, holding still, and what came of it, limb by limb.

No clock, no window and no session: times come in, cues and marks go out. All times are on the clock of
``Sample.time``, so that the mark of a hold can be handed to ``LiveSession.held`` as it is.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

from studio.capture.procedures.judged_hold import Judged, LimbResult, limb_results
from studio.core.body import Place
from studio.core.errors import AlignmentError, HeadingsUnknown, PoseNotHeld, PoseTooShort
from studio.core.take import Alignment, Mark, PoseName

DELAYS = (3, 5, 10)  # s on offer: at hand, across the room, alone
HOLDS: Mapping[PoseName, float] = {"n": 3.0, "t": 3.0, "sit": 3.0, "bow": 2.0}  # s, contracts §3
COUNTED = 3  # the last seconds that are heard
SETTLE = 0.25  # s after the hold until its last samples have arrived
PATIENCE = 5.0  # s of waiting for an answer; aligning 15 sensors takes less than 0.1 s


class Phase(Enum):
    """Where the procedure stands."""

    IDLE = "idle"
    COUNTDOWN = "countdown"
    HOLDING = "holding"
    JUDGING = "judging"
    JUDGED = "judged"


class Kind(Enum):
    """What is to be heard and seen."""

    COUNT = "count"
    HOLD = "hold"
    DONE = "done"
    FAILED = "failed"


class Cue(NamedTuple):
    """Something for the person who cannot look at the screen."""

    kind: Kind
    seconds: int = 0
    """Seconds left, for ``COUNT``."""


class Wish(NamedTuple):
    """A pose was held: to be judged by the session."""

    mark: Mark
    only: frozenset[Place]
    """The limbs that were to be repeated; empty for the whole body."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """The end of one hold."""

    pose: PoseName
    limbs: tuple[LimbResult, ...]
    """In the order of Table 1; empty when nothing could be judged."""
    error: AlignmentError | None = None
    answered: bool = True
    """False: nobody judged the hold in time."""

    @property
    def moved(self) -> tuple[Place, ...]:
        """The limbs to repeat."""
        return tuple(limb.place for limb in self.limbs if limb.grade == "moved")

    @property
    def worst(self) -> float:
        """The largest movement, degrees; NaN without any limb."""
        return max((limb.degrees for limb in self.limbs if limb.grade != "silent"), default=math.nan)


Told = tuple[Cue | Wish, ...]
"""What a step gives out, in the order in which it is to be done."""


class HeldPose:
    """A sequence of poses, each counted down, held and judged; one of them at a time."""

    def __init__(self, sequence: Sequence[PoseName] = ("n", "bow")) -> None:
        self.sequence: tuple[PoseName, ...] = tuple(sequence)
        self.phase = Phase.IDLE
        self.pose: PoseName = self.sequence[0]
        self.only: frozenset[Place] = frozenset()
        self.alignment: Alignment | None = None
        """The last answer that can be used."""
        self.outcome: Outcome | None = None
        self.done: tuple[PoseName, ...] = ()
        self._before: tuple[PoseName, ...] = ()
        """What was done when the reference was begun anew."""
        """The poses of the sequence that were held well enough."""
        self._delay = 0
        self._since = 0.0
        self._told = 0
        self._asked = False

    @property
    def next_pose(self) -> PoseName | None:
        """The first pose of the sequence that is still to be held."""
        return next((pose for pose in self.sequence if pose not in self.done), None)

    @property
    def is_running(self) -> bool:
        """Whether somebody is standing still for us."""
        return self.phase in (Phase.COUNTDOWN, Phase.HOLDING, Phase.JUDGING)

    def choose(self, sequence: Sequence[PoseName]) -> None:
        """Hold other poses, from the beginning; not while one is being held."""
        if not sequence or self.is_running:
            return
        self.sequence = tuple(sequence)
        self.reset()

    def reset(self) -> None:
        """Begin anew: other sensors, another person."""
        self.phase = Phase.IDLE
        self.pose = self.sequence[0]
        self.only, self.done, self._before = frozenset(), (), ()
        self.alignment = self.outcome = None

    def start(self, now: float, delay: int, pose: PoseName | None = None, only: Collection[Place] = ()) -> Told:
        """Count down to a pose: the next of the sequence unless ``pose`` says which.

        Parameters
        ----------
        delay : int, s
            One of ``DELAYS``.
        only : places
            Repeat these limbs and keep the others as they are; needs a hold of the whole body before.
        """
        if self.is_running:
            return ()
        wanted = pose or self.next_pose or self.sequence[0]
        if not only and wanted in self.done:
            # A new reference makes what followed it meaningless, unless the session finds otherwise (``answer``).
            self._before = self.done
            kept = self.sequence.index(wanted) if wanted in self.sequence else 0
            self.done = self.done[:kept]
        self.pose, self.only = wanted, frozenset(only) if self.alignment is not None else frozenset()
        self.outcome = None
        self.phase = Phase.COUNTDOWN
        self._delay, self._since, self._told = delay, now, delay + 1
        return self.tick(now)

    def tick(self, now: float) -> Told:
        """Let time pass."""
        if self.phase is Phase.COUNTDOWN:
            return self._count(now)
        if self.phase is Phase.HOLDING and now >= self._since + HOLDS[self.pose]:
            self.phase, self._asked = Phase.JUDGING, False
        if self.phase is Phase.JUDGING:
            return self._judge(now)
        return ()

    def cancel(self) -> None:
        """Esc: whoever was counted down to or holds a pose may move again."""
        if self.phase in (Phase.COUNTDOWN, Phase.HOLDING):
            self.phase = Phase.IDLE
            self.only = frozenset()

    def seconds_left(self, now: float) -> int:
        """Return the number to show while counting down, and while holding."""
        end = self._delay if self.phase is Phase.COUNTDOWN else HOLDS[self.pose]
        return max(0, math.ceil(self._since + end - now - 1e-9)) if self.is_running else 0

    def progress(self, now: float) -> float:
        """Return how much of the countdown or of the hold has passed, 0…1."""
        if self.phase in (Phase.COUNTDOWN, Phase.HOLDING):
            length = float(self._delay) if self.phase is Phase.COUNTDOWN else HOLDS[self.pose]
            return min(1.0, max(0.0, (now - self._since) / length)) if length else 1.0
        return 1.0 if self.phase is Phase.JUDGING else 0.0

    def answer(self, judged: Judged) -> Told:
        """Take the session's answer to the wish; one that nobody waits for any more counts for nothing."""
        if self.phase is not Phase.JUDGING or not self._asked:
            return ()
        alignment, error = judged
        shown = alignment or (self.alignment if self.only else None)
        if alignment is not None:
            self.alignment = alignment
        self.outcome = Outcome(self.pose, limb_results(shown, error), error)
        if isinstance(error, PoseNotHeld | PoseTooShort) and error.pose != self.pose:
            self.done = ()  # the reference lies too far back, or was none: it must be held again
        if self._is_enough(alignment, error):
            self.done = (*(pose for pose in self.done if pose != self.pose), self.pose)
            if "bow" in self._before and alignment is not None and _all_bowed(alignment):
                self.done = tuple(pose for pose in self.sequence if pose in (*self.done, *self._before))
            return self._end(Kind.DONE)
        return self._end(Kind.FAILED)

    def _is_enough(self, alignment: Alignment | None, error: AlignmentError | None) -> bool:
        if isinstance(error, HeadingsUnknown):
            # The next pose is there to tell the headings; without one, nothing is known.
            return any(pose not in (*self.done, self.pose) for pose in self.sequence)
        return alignment is not None and error is None

    def _count(self, now: float) -> Told:
        left = self.seconds_left(now)
        told = tuple(Cue(Kind.COUNT, n) for n in range(self._told - 1, left - 1, -1) if 0 < n <= COUNTED)
        self._told = min(self._told, max(left, 1))
        if left > 0:
            return told[-1:]  # after a stall one beep, not three at once
        self.phase, self._since = Phase.HOLDING, max(now, self._since + self._delay)
        return (Cue(Kind.HOLD),)

    def _judge(self, now: float) -> Told:
        end = self._since + HOLDS[self.pose]
        if not self._asked and now >= end + SETTLE:
            self._asked = True
            return (Wish(Mark(self._since, "pose", self.pose, end), self.only),)
        if now >= end + SETTLE + PATIENCE:
            self.outcome = Outcome(self.pose, (), answered=False)
            return self._end(Kind.FAILED)
        return ()

    def _end(self, kind: Kind) -> Told:
        self.phase, self.only = Phase.JUDGED, frozenset()
        return (Cue(kind),)


def _all_bowed(alignment: Alignment) -> bool:
    """Return whether a bow, however long ago, still tells how every tag sits."""
    return all(limb.source == "bow" for limb in alignment.limbs.values())
