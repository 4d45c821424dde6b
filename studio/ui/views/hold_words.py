"""Body calibration in words: what is said in each state, for operator and wearer."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from PySide6.QtCore import QObject

from studio.capture.procedures import sitting_rest
from studio.capture.procedures.held_pose import Outcome, Phase
from studio.capture.procedures.judged_hold import Grade, LimbResult
from studio.core.body import Place
from studio.core.errors import HeadingsUnknown
from studio.core.take import PoseName
from studio.ui.models.hold_model import HoldModel
from studio.ui.models.place_words import PlaceWords
from studio.ui.wording import sentences

NAMED = 3  # limbs that are named one by one


class Now(NamedTuple):
    """What is shown at this moment."""

    pose: PoseName
    big: str
    small: str
    headline: str
    tone: str = "text"


class HoldWords(QObject):
    """Knows the places' names."""

    def __init__(self, words: Mapping[Place, PlaceWords], parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._words = words

    def place(self, place: Place) -> str:
        """Return a place's name."""
        return self._words[place].name

    def places(self, places: Sequence[Place]) -> str:
        """Return up to three names, and how many more there are."""
        names = ", ".join(self.place(place) for place in places[:NAMED])
        more = len(places) - NAMED
        return self.tr("{names} and {n} more").format(names=names, n=more) if more > 0 else names

    def pose(self, pose: PoseName) -> str:
        """Return a pose's name."""
        names = {"n": self.tr("N-pose"), "t": self.tr("T-pose"), "sit": self.tr("Seated"), "bow": self.tr("Bow")}
        return names[pose]

    def start(self, pose: PoseName) -> str:
        """Return what the button says that begins a hold."""
        return self.tr("Start {pose}").format(pose=self.pose(pose))

    def sit(self, model: HoldModel) -> str:
        """Return what the button says that begins the rest."""
        again = model.rest.phase is sitting_rest.Phase.JUDGED and model.rest.moved
        return self.tr("Sit still again, 5 s") if again else self.tr("Sit still, 5 s")

    def repeat_only(self, places: Sequence[Place]) -> str:
        """Return what the button says that repeats some limbs."""
        return self.tr("Repeat only {limbs}").format(limbs=self.places(places))

    def step(self, number: int, name: str, state: str) -> str:
        """Return a step with its number, or a tick when it is done."""
        names = {"rest": self.tr("Rest"), "check": self.tr("Check")}
        text = names.get(name) or self.pose(_POSES[name])
        return self.tr("✔ {step}").format(step=text) if state == "done" else f"{number}  {text}"

    def grade(self, grade: Grade) -> str:
        """Return how well a limb was held."""
        words = {
            "good": self.tr("good"),
            "fair": self.tr("fair"),
            "moved": self.tr("▲ moved"),
            "silent": self.tr("▲ silent"),
        }
        return words[grade]

    def heading(self, limb: LimbResult) -> str:
        """Return where a limb's heading came from and what it is worth."""
        if limb.source == "unknown" or limb.grade in ("moved", "silent"):
            return self.tr("▲ unknown") if limb.grade not in ("moved", "silent") else "–"
        names = {
            "bow": self.tr("bow"),
            "two poses": self.tr("two poses"),
            "common world": self.tr("sensors"),
            "strap rule": self.tr("strap"),
        }
        return self.tr("{source} ±{n:.0f}°").format(source=names[limb.source], n=limb.heading_sigma)

    def how(self, pose: PoseName) -> str:
        """Return how a pose is held."""
        words = {
            "n": self.tr("Stand upright, arms hanging, palms to the thighs, look ahead."),
            "t": self.tr("Stand upright, arms straight out to the sides, palms down."),
            "sit": self.tr("Sit upright, thighs level, shanks upright, arms hanging."),
            "bow": self.tr("Lean forward, bend the knees, lift the heels, arms forward."),
        }
        return words[pose]

    def explanation(self, model: HoldModel) -> str:
        """Return the sentence beside the buttons."""
        if not model.assigned:
            return self.tr("The studio must know which tag sits where before it can relate them to the body.")
        if model.silent:
            text = self.tr("{limbs}: no data. They will not be calibrated until they send again.")
            return text.format(limbs=self.places(model.silent))
        outcome = model.outcome
        if outcome is not None and not model.is_running:
            return self._about(outcome, model)
        if model.rest_missing:
            text = self.tr("{n} tags never lay still, so their angles drift. Sit still for 5 s, or go on without.")
            return text.format(n=len(model.rest_missing))
        return self.tr("The person need not see the screen: three short tones, hold still, a long tone is the end.")

    def now(self, model: HoldModel) -> Now:
        """Return what is shown at this moment."""
        hold = model.hold
        pose = hold.pose if hold.phase is not Phase.JUDGED else hold.next_pose or hold.pose
        if model.rest.is_running:
            left = str(max(1, round(sitting_rest.SITTING * (1 - model.rest.progress(model.now)) + 0.49)))
            return Now("sit", left, self.tr("Sit still, arms hanging."), self.tr("Measuring the rest"))
        if not model.assigned:
            return Now("n", "–", self.tr("No tag has a place yet."), self.tr("Assign the tags first"), "muted")
        if hold.phase is Phase.COUNTDOWN:
            return Now(pose, str(hold.seconds_left(model.now)), self.how(pose), self.tr("Get into position"))
        if hold.phase is Phase.HOLDING:
            return Now(pose, self.tr("HOLD"), self.tr("Do not move."), self.tr("Hold still"), "accent")
        if hold.phase is Phase.JUDGING:
            return Now(pose, self.tr("…"), self.tr("You may move again."), self.tr("Looking at the hold"))
        if hold.phase is Phase.JUDGED and hold.outcome is not None:
            return self._judged(hold.outcome, model)
        if model.rest_missing and hold.outcome is None:
            small = self.tr("Sit still for 5 s, or start with the pose.")
            return Now("sit", self.tr("Rest"), small, self.tr("The rest is missing"))
        name = self.pose(pose)
        return Now(pose, name, self.how(pose), self.tr("Next: {pose}").format(pose=name))

    def _judged(self, outcome: Outcome, model: HoldModel) -> Now:
        upcoming = model.hold.next_pose
        if outcome.pose not in model.hold.done:
            moved = outcome.moved
            small = (
                self.tr("{limbs} moved.").format(limbs=self.places(moved)) if moved else self.tr("Once more, please.")
            )
            return Now(outcome.pose, self.tr("Again"), small, self._refusal(outcome), "bad")
        if upcoming is not None:
            name = self.pose(upcoming)
            small = self.tr("Next the {pose}: {how}").format(pose=name.lower(), how=self.how(upcoming))
            return Now(upcoming, "✔", small, self.tr("{pose} held").format(pose=self.pose(outcome.pose)), "good")
        small = self.tr("Move a little: does the figure follow?")
        return Now(model.hold.sequence[0], "✔", small, self.tr("Body calibrated"), "good")

    def _refusal(self, outcome: Outcome) -> str:
        if not outcome.answered:
            return self.tr("Nobody judged the hold")
        if outcome.moved:
            return self.tr("{pose} not held still").format(pose=self.pose(outcome.pose))
        return sentences(outcome.error).what if outcome.error is not None else self.tr("The hold cannot be used")

    def _about(self, outcome: Outcome, model: HoldModel) -> str:
        if not outcome.answered:
            return self.tr("The sensors sent nothing for some seconds. Look at Connect, then repeat.")
        if isinstance(outcome.error, HeadingsUnknown) and outcome.pose in model.hold.done:
            return self.tr("Which way the limbs face is not known yet; the next pose tells.")
        if outcome.error is not None:
            message = sentences(outcome.error)
            return message.do if outcome.moved else f"{message.why} {message.do}"
        unknown = tuple(limb.place for limb in outcome.limbs if limb.source == "unknown")
        if unknown:
            text = self.tr("Which way they face is not known: {limbs}. Repeat the bow to include them.")
            if model.hold.next_pose is not None:
                text = self.tr("Which way they face is not known yet: {limbs}. The bow tells; hold it next.")
            return text.format(limbs=self.places(unknown))
        text = self.tr("Held within {worst:.1f}°. Compare the figure with the person, then accept.")
        if model.hold.next_pose is not None:
            text = self.tr("Held within {worst:.1f}°.")
        return text.format(worst=outcome.worst)


_POSES: Mapping[str, PoseName] = {"n": "n", "t": "t", "sit": "sit", "bow": "bow"}
