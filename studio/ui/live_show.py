"""What is running now, brought to the pages: the figure, the angles, the strip. Called by the tick."""

from collections.abc import Mapping
from datetime import UTC, datetime

from PySide6.QtCore import QObject

from studio.core.body import PLACES, Place, Skeleton
from studio.core.live_frames import Pose
from studio.ui.models.live_angles import LiveAngles
from studio.ui.models.readiness import Problem, ReadinessState, StripPhase
from studio.ui.models.recorder import Phase, Recorder
from studio.ui.models.stage_pose import StagePose
from studio.ui.models.studio_model import StudioModel

SILENT_AFTER = 0.5  # s; 25 frames: a limb whose sensor says nothing turns hollow
BUSY_FOR = 5.0  # s; a source that says nothing for longer is gone
ANGLES_EVERY = 0.04  # s; 25 numbers a second are more than an eye reads
LOSS_WORTH_SAYING = 0.05

_PHASES = {
    Phase.COUNTDOWN: StripPhase.COUNTDOWN,
    Phase.STARTING: StripPhase.RECORDING,
    Phase.RECORDING: StripPhase.RECORDING,
    Phase.SAVING: StripPhase.SAVING,
    Phase.SAVED: StripPhase.SAVED,
}


class LiveShow(QObject):
    """Turns the studio's state into what the views take."""

    def __init__(self, model: StudioModel, recorder: Recorder, angles: LiveAngles, words: Mapping[Place, str]) -> None:
        super().__init__(model)
        self._model = model
        self._recorder = recorder
        self._angles = angles
        self._words = words
        self._skeleton = Skeleton.from_stature(model.setup.stature)
        self._newest: Pose | None = None
        self._angles_at = 0.0

    def skeleton(self) -> Skeleton:
        """Return the skeleton of the setup in force; the same object while the stature stays."""
        if self._skeleton.stature != self._model.setup.stature:
            self._skeleton = Skeleton.from_stature(self._model.setup.stature)
        return self._skeleton

    def next_pose(self, now: float, *, with_angles: bool) -> StagePose | None:
        """Return the newest pose when it is another one, and keep the angles up to date where they are seen."""
        _, pose = self._model.buffer.newest()
        alignment = self._model.alignment
        if pose is None or pose is self._newest or alignment is None:
            return None
        self._newest = pose
        skeleton = self.skeleton()
        if with_angles and now - self._angles_at >= ANGLES_EVERY:
            self._angles_at = now
            self._angles.add(pose, alignment, skeleton)
        joints = skeleton.joint_positions(pose.world_from_segment, pose.hips)
        silent = self.silent()
        known = frozenset(p for p, limb in alignment.limbs.items() if limb.source != "unknown") - frozenset(silent)
        caption = self.tr("Simulated performer") if self._model.is_simulated else ""
        return StagePose(pose.world_from_segment, joints, known, silent, caption)

    def forget_newest(self) -> None:
        """Bring the newest pose once more: another figure shows it."""
        self._newest = None

    def has_body(self) -> bool:
        """Whether there is a body to show."""
        return self._model.alignment is not None and bool(self._model.source)

    def silent(self) -> dict[Place, str]:
        """Return the places whose sensor has stopped sending, with their names."""
        if self._is_behind():
            return {}
        health, worn = self._model.health, self._model.setup.assignment.sensors
        return {
            place: self._words[place]
            for place in PLACES
            if place in worn and worn[place] in health and health[worn[place]].silent_for > SILENT_AFTER
        }

    def _is_behind(self) -> bool:
        """Whether all sensors fell silent at once: that is this computer, not fifteen batteries."""
        silences = [told.silent_for for told in self._model.health.values()]
        return len(silences) > 1 and min(silences) > SILENT_AFTER and max(silences) < BUSY_FOR

    def readiness(self, next_take: str, disk_left: float | None) -> ReadinessState:
        """Return what the strip shows."""
        model = self._model
        worn = model.setup.assignment.sensors
        heard = [told for sensor, told in model.health.items() if told.silent_for <= SILENT_AFTER]
        lost = sum(told.lost for told in heard)
        received = sum(told.received for told in heard)
        problems = self._problems()
        idle = StripPhase.CHECK if problems else StripPhase.READY
        left = model.seconds_left if model.seconds_left is not None else disk_left
        return ReadinessState(
            phase=_PHASES.get(self._recorder.phase, idle),
            sensors=len(heard),
            sensors_expected=len(worn) or len(model.infos),
            calibrated_for=self._age(),
            loss=lost / (lost + received) if received else None,
            disk_left=left,
            buffer_fill=model.queue_fill,
            next_take=next_take,
            elapsed=self._recorder.left or self._recorder.elapsed,
            problems=problems,
        )

    def _age(self) -> float | None:
        at = self._model.aligned_at
        if self._model.alignment is None or at is None:
            return None
        return (datetime.now(UTC) - at).total_seconds()

    def _problems(self) -> tuple[Problem, ...]:
        model = self._model
        if not model.source:
            return (Problem(self.tr("No sensors are connected."), self.tr("Connect"), "connect"),)
        if model.connecting:
            return (Problem(self.tr("The source is being opened…"), self.tr("Connect"), "connect"),)
        if self._is_behind():
            return (Problem(self.tr("This computer is busy: samples are read late, none is lost."), "", ""),)
        stopped = self.tr("{place} has stopped sending.")
        connect = self.tr("Connect")
        problems = [Problem(stopped.format(place=words), connect, "connect") for words in self.silent().values()]
        if not model.connecting and not model.setup.assignment.sensors:
            problems.append(Problem(self.tr("No sensor has a place on the body."), self.tr("Assign"), "assign"))
        elif model.alignment is None:
            problems.append(Problem(self.tr("The body is not calibrated."), self.tr("Calibrate"), "calibrate"))
        elif unknown := sum(limb.source == "unknown" for limb in model.alignment.limbs.values()):
            words = self.tr("{n} of {all} limbs face an unknown way: the bow is missing.")
            said = words.format(n=unknown, all=len(model.alignment.limbs))
            problems.append(Problem(said, self.tr("Calibrate"), "calibrate"))
        heard = [told for told in model.health.values() if told.received]
        if heard and max(told.loss for told in heard) > LOSS_WORTH_SAYING:
            problems.append(Problem(self.tr("More than 5 % of the packets are lost."), connect, "connect"))
        return tuple(problems)
