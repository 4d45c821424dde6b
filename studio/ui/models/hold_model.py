"""Body calibration as the window sees it: the rest, the poses, and what is to be shown of them.

Wraps the procedures of ``capture``; times come in with each tick, wishes go out as signals.
"""

from collections.abc import Collection, Mapping, Sequence

from PySide6.QtCore import QObject, Signal

from studio.capture.procedures import sitting_rest
from studio.capture.procedures.held_pose import DELAYS, Cue, HeldPose, Outcome, Told
from studio.capture.procedures.judged_hold import Judged
from studio.capture.procedures.sitting_rest import Readings, SittingRest
from studio.core.body import Place
from studio.core.errors import AlignmentError
from studio.core.sample import SensorId
from studio.core.take import Alignment, PoseName

SEQUENCES: Mapping[PoseName, tuple[PoseName, ...]] = {"n": ("n", "bow"), "t": ("t", "bow"), "sit": ("sit", "bow")}
"""Reference pose to the poses that are held."""


class HoldModel(QObject):
    """One body calibration after the other."""

    changed = Signal()
    """Something else than the passing of time."""
    cued = Signal(object)
    """A ``Cue``: to be heard and seen."""
    hold_ended = Signal(object, object)
    """Mark and frozenset of Place (the limbs to repeat, empty for all): to be judged by the session."""
    readings_wanted = Signal(object, float)
    """Sensors (tuple) and seconds: what they said last, for ``judge_rest``."""
    rest_found = Signal(object, object)
    """SensorId and Rest: to be kept."""
    accepted = Signal(object)
    """The Alignment that the operator accepted."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.hold = HeldPose()
        self.rest = SittingRest()
        self.delay = DELAYS[0]
        self.now = 0.0
        """s, of the last tick."""
        self.assigned: tuple[Place, ...] = ()
        self.silent: tuple[Place, ...] = ()
        """Assigned places whose sensor does not send."""
        self.rest_missing: dict[SensorId, float] = {}
        """Sensors whose offset nobody knows, with their frame time in s."""

    @property
    def is_running(self) -> bool:
        """Whether the wearer is asked to keep still, now or in some seconds."""
        return self.hold.is_running or self.rest.is_running

    @property
    def outcome(self) -> Outcome | None:
        """What came of the last hold."""
        return self.hold.outcome

    def set_assigned(self, places: Collection[Place], silent: Collection[Place] = ()) -> None:
        """Tell which places have a sensor, and which of them do not send."""
        before = (self.assigned, self.silent)
        self.assigned, self.silent = tuple(places), tuple(silent)
        if before[0] != self.assigned and not self.hold.is_running:
            self.hold.reset()
        if before != (self.assigned, self.silent):
            self.changed.emit()

    def set_rest_missing(self, sensors: Mapping[SensorId, float]) -> None:
        """Tell which sensors' offsets are unknown, with their frame time in s."""
        if dict(sensors) != self.rest_missing:
            self.rest_missing = dict(sensors)
            self.changed.emit()

    def choose_reference(self, pose: PoseName) -> None:
        """Begin with another pose."""
        if SEQUENCES[pose] != self.hold.sequence:
            self.hold.choose(SEQUENCES[pose])
            self.changed.emit()

    def set_delay(self, seconds: int) -> None:
        """Remember how long to count down."""
        if seconds in DELAYS:
            self.delay = seconds

    def start(self, pose: PoseName | None = None) -> None:
        """Count down to a pose, the next one unless named."""
        if self.assigned and not self.is_running:
            self._tell(self.hold.start(self.now, self.delay, pose))
            self.changed.emit()

    def repeat(self, places: Collection[Place] = ()) -> None:
        """Hold the last pose again, for some limbs only or for all."""
        if self.assigned and not self.is_running:
            self._tell(self.hold.start(self.now, self.delay, self.hold.pose, places))
            self.changed.emit()

    def start_rest(self) -> None:
        """Let the wearer sit still; those who sat still already are not asked again."""
        if self.is_running:
            return
        if self.rest.moved and self.rest.phase is sitting_rest.Phase.JUDGED:
            self.rest.again(self.now)
        else:
            self.rest.start(self.now, self.rest_missing)
        self.changed.emit()

    def cancel(self) -> None:
        """Esc: nobody needs to keep still any more."""
        self.hold.cancel()
        self.rest.cancel()
        self.changed.emit()

    def accept(self) -> None:
        """The operator is content with what came of it."""
        if self.hold.alignment is not None and not self.is_running:
            self.accepted.emit(self.hold.alignment)

    def tick(self, now: float) -> None:
        """Let time pass."""
        self.now = now
        before = (self.hold.phase, self.rest.phase)
        self._tell(self.hold.tick(now))
        if self.rest.tick(now):
            self.readings_wanted.emit(tuple(self.rest.wanted), sitting_rest.SITTING)
        if before != (self.hold.phase, self.rest.phase):
            self.changed.emit()

    def aligned(self, alignment: Alignment) -> None:
        """The session's answer: the body is aligned."""
        self.answer(Judged(alignment, None))

    def refused(self, error: AlignmentError) -> None:
        """The session's answer: the hold could not be used."""
        self.answer(Judged(None, error))

    def answer(self, judged: Judged) -> None:
        """The session's answer, limb by limb."""
        self._tell(self.hold.answer(judged))
        self.changed.emit()

    def judge_rest(self, readings: Mapping[SensorId, Readings]) -> None:
        """Take what the sensors said while the wearer sat still."""
        for sensor, rest in self.rest.judge(readings).items():
            self.rest_missing.pop(sensor, None)
            self.rest_found.emit(sensor, rest)
        self.changed.emit()

    def steps(self) -> Sequence[tuple[str, str]]:
        """Return the steps in order, each with ``done``, ``now`` or ``todo``: ``rest``, the poses, ``check``."""
        done = {"rest"} if not self.rest_missing else set()
        done |= set(self.hold.done)
        names = ("rest", *self.hold.sequence, "check")
        now = next((name for name in names if name not in done), "check")
        if self.hold.is_running:
            now = self.hold.pose
        elif self.outcome is not None and self.outcome.pose not in done:
            now = self.outcome.pose
        return [(name, "now" if name == now else "done" if name in done else "todo") for name in names]

    def _tell(self, told: Told) -> None:
        for step in told:
            if isinstance(step, Cue):
                self.cued.emit(step)
            else:
                self.hold_ended.emit(step.mark, step.only)
        if told:
            self.changed.emit()
