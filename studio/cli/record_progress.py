"""What a recording on the terminal says while it goes on: one short line for each thing that happens."""

from collections.abc import Iterator, Mapping

from studio.capture import events
from studio.core.errors import HeadingsUnknown
from studio.core.sample import SensorId
from studio.core.take import Assignment, Mark
from studio.ui.fact_words import POSES
from studio.ui.wording import one_line

Facts = Mapping[str, object]

NOTED = {
    "link lost": "The port is gone. Plug the receiver in again: recording goes on.",
    "link back": "The port is back after {after:.1f} s.",
    "dropped": "This computer was too busy: {bytes} bytes were thrown away.",
    "sensor silent": "{sensor} has stopped sending.",
    "sensor back": "{sensor} sends again after {after:.1f} s.",
    "reboot": "{sensor} started anew.",
    "duplicate number": "Two tags have the number {number}: {sensors}.",
}
"""Sentences for the notes of links that somebody at a terminal can do something about."""


class RecordProgress:
    """Turns the events of a session into lines."""

    def __init__(self) -> None:
        self._sensors: set[SensorId] = set()
        self._told = False

    def lines(self, event: events.Event, worn: Assignment) -> Iterator[str]:
        """Yield what to say of an event; ``worn`` names sensors by their places."""
        if isinstance(event, events.SensorFound):
            self._sensors.add(event.sensor)
            if self._told:
                yield f"{_named(event.sensor, worn)} is there, too."
        elif isinstance(event, events.RecordingStarted):
            self._told = True
            yield f"{counted(len(self._sensors))} found. Recording…"
        elif isinstance(event, events.MarkSet) and event.mark.kind == "pose":
            yield f"{_pose(event.mark)} held."
        elif isinstance(event, events.Aligned):
            source = f"The body is calibrated by the {POSES[event.alignment.pose]}."
            yield source if event.error is None else f"{source} {one_line(event.error)}"
        elif isinstance(event, events.AlignmentRefused):
            waits = isinstance(event.error, HeadingsUnknown)
            yield "Headings are not known yet: a bow tells them." if waits else one_line(event.error)
        elif isinstance(event, events.LinkNoted) and event.kind in NOTED:
            yield NOTED[event.kind].format_map(_in_words(event.facts, worn))


def summary(seconds: float, sensors: int, loss: float | None) -> str:
    """Return the last line; it is silent about what nobody counted."""
    lost = "" if loss is None else f", {loss:.2%} lost"
    return f"Saved: {seconds:.1f} s, {counted(sensors)}{lost}."


def counted(sensors: int) -> str:
    """Return a number of sensors in words."""
    return f"{sensors} sensor" if sensors == 1 else f"{sensors} sensors"


def _pose(mark: Mark) -> str:
    name = POSES.get(mark.label, mark.label)
    return name[:1].upper() + name[1:]


def _in_words(facts: Facts, worn: Assignment) -> Facts:
    words = dict(facts)
    if "sensor" in facts:
        words["sensor"] = _named(SensorId(str(facts["sensor"])), worn)
    if isinstance(sensors := facts.get("sensors"), list):
        words["sensors"] = " and ".join(_named(sensor, worn) for sensor in sensors)
    return words


def _named(sensor: SensorId, worn: Assignment) -> str:
    place = worn.place_of(sensor)
    return sensor if place is None else f"{place.value.replace('_', ' ').capitalize()} ({sensor})"
