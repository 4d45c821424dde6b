"""Who wears which sensor, as it is being decided: choosing, exchanging, undoing.

Two ways lead to an assignment: a place and a sensor are chosen, in either order; or places wait in turn and the
sensor that is moved goes there. A place has one sensor at most and a sensor one place, whatever is pressed.
"""

from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Literal, NamedTuple

from PySide6.QtCore import QObject, Signal

from studio.core.body import PLACES, PRESETS, Place
from studio.core.sample import SensorId
from studio.core.take import Assignment

Preset = Literal["full", "upper", "lower", "custom"]
PRESET_NAMES: tuple[Preset, ...] = ("full", "upper", "lower", "custom")
UNDONE = 100  # steps that can be taken back

# Paper 003, Table 1 calls rows 12 to 15 all "ankle": whoever took 14/15 for the shanks exchanges both pairs.
CROSSED = ((Place.LEFT_SHANK, Place.LEFT_FOOT), (Place.RIGHT_SHANK, Place.RIGHT_FOOT))


class SensorState(Enum):
    """How a sensor is doing."""

    GOOD = "good"
    WEAK = "weak"
    """It sends, with losses or a low battery."""
    SILENT = "silent"


class KnownSensor(NamedTuple):
    """A sensor that can be assigned."""

    sensor: SensorId
    number: int
    """1…15; 0 when it has none."""
    name: str
    state: SensorState


class PlaceState(Enum):
    """What a place looks like."""

    EMPTY = "empty"
    """No tag, and none is wanted."""
    MISSING = "missing"
    """No tag, and the preset wants one."""
    ASSIGNED = "assigned"
    WARNING = "warning"
    """Assigned, and its sensor is weak or silent."""


class PlaceLook(NamedTuple):
    """Everything that is shown of one place."""

    state: PlaceState
    sensor: KnownSensor | None = None
    is_selected: bool = False
    is_pulsing: bool = False
    """It waits for the sensor that is moved."""


class _Step(NamedTuple):
    sensors: tuple[tuple[Place, SensorId], ...]
    preset: Preset


class AssignmentModel(QObject):
    """The assignment, what is selected, and what was before."""

    assignment_changed = Signal(object)
    """An Assignment that somebody decided here; not told when it was adopted from elsewhere."""
    changed = Signal()
    """Anything that is shown."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.preset: Preset = "full"
        self.place: Place | None = None
        """The selected place."""
        self.sensor: SensorId | None = None
        """The selected sensor."""
        self.waiting: Place | None = None
        """The place that waits for the sensor that is moved."""
        self.is_exchanging = False
        """The next place exchanges its sensor with the selected place."""
        self._worn: dict[Place, SensorId] = {}
        self._known: dict[SensorId, KnownSensor] = {}
        self._before: list[_Step] = []
        self._after: list[_Step] = []

    @property
    def assignment(self) -> Assignment:
        """What is decided so far."""
        return Assignment(dict(self._worn))

    @property
    def wanted(self) -> tuple[Place, ...]:
        """The places of the preset; those in use when the choice is one's own."""
        return self.assignment.places() if self.preset == "custom" else PRESETS[self.preset]

    @property
    def unassigned(self) -> tuple[KnownSensor, ...]:
        """The sensors without a place, by number."""
        worn = set(self._worn.values())
        free = (known for known in self._known.values() if known.sensor not in worn)
        return tuple(sorted(free, key=_by_number))

    @property
    def missing(self) -> tuple[Place, ...]:
        """The wanted places without a sensor."""
        return tuple(place for place in self.wanted if place not in self._worn)

    @property
    def can_undo(self) -> bool:
        """Whether there is a step to take back."""
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether there is a step to do again."""
        return bool(self._after)

    def worn_at(self, place: Place) -> KnownSensor | None:
        """Return the sensor at a place; one that has never been heard is silent."""
        sensor = self._worn.get(place)
        if sensor is None:
            return None
        return self._known.get(sensor, KnownSensor(sensor, 0, str(sensor), SensorState.SILENT))

    def look(self, place: Place) -> PlaceLook:
        """Return what is shown of a place."""
        worn = self.worn_at(place)
        if worn is None:
            state = PlaceState.MISSING if place in self.wanted else PlaceState.EMPTY
        else:
            state = PlaceState.ASSIGNED if worn.state is SensorState.GOOD else PlaceState.WARNING
        return PlaceLook(state, worn, place is self.place, place is self.waiting)

    def set_sensors(self, sensors: Sequence[KnownSensor]) -> None:
        """Take over what is known of the sensors."""
        known = {sensor.sensor: sensor for sensor in sensors}
        if known == self._known:
            return
        self._known = known
        if self.sensor is not None and self.sensor not in known:
            self.sensor = None
        self.changed.emit()

    def adopt(self, assignment: Assignment) -> None:
        """Take over an assignment that was decided elsewhere; there is nothing to undo then."""
        if dict(assignment.sensors) == self._worn:
            return
        self._worn = dict(assignment.sensors)
        self._before.clear()
        self._after.clear()
        exact = [name for name in PRESET_NAMES[:-1] if set(PRESETS[name]) == set(self._worn)]
        if exact:
            self.preset = exact[0]
        elif self.preset != "custom" and not set(self._worn) <= set(PRESETS[self.preset]):
            self.preset = "full"
        self._unselect()
        self._wait_for_next()
        self.changed.emit()

    def choose_preset(self, preset: Preset) -> None:
        """Want the places of a preset; tags on other places come off."""
        if preset == self.preset:
            return
        wanted = self._worn if preset == "custom" else PRESETS[preset]
        self._do({place: sensor for place, sensor in self._worn.items() if place in wanted}, preset)

    def choose_place(self, place: Place) -> None:
        """A place was clicked: it takes the selected sensor, exchanges, or is selected itself."""
        if self.is_exchanging and self.place is not None and self.place is not place:
            self.exchange(self.place, place)
        elif self.sensor is not None:
            self.assign(place, self.sensor)
        else:
            self.place = None if place is self.place else place
            self.is_exchanging = False
            if self.waiting is not None and place not in self._worn:
                self.waiting = place
            self.changed.emit()

    def choose_sensor(self, sensor: SensorId) -> None:
        """A sensor was clicked: it goes to the selected place, or is selected itself."""
        if self.place is not None:
            self.assign(self.place, sensor)
        else:
            self.sensor = None if sensor == self.sensor else sensor
            self.changed.emit()

    def assign(self, place: Place, sensor: SensorId) -> None:
        """Put a sensor on a place; whoever sat there has no place any more."""
        worn = {where: who for where, who in self._worn.items() if who != sensor}
        worn[place] = sensor
        self._do(worn)

    def exchange(self, one: Place, other: Place) -> None:
        """Let two places exchange their sensors; an empty one receives."""
        self._do(_exchanged(self._worn, [(one, other)]))

    def exchange_shanks_and_feet(self) -> None:
        """Exchange 12/13 and 14/15 in one step."""
        self._do(_exchanged(self._worn, CROSSED))

    def begin_exchange(self) -> None:
        """Exchange the selected place with the one that is clicked next; the second press calls it off."""
        self.is_exchanging = self.place is not None and not self.is_exchanging
        self.changed.emit()

    def assign_by_number(self) -> None:
        """Put tag k on place k of Table 1 where place and tag are free and only one tag has this number."""
        numbers = [known.number for known in self._known.values()]
        free = {known.number: known.sensor for known in self.unassigned if numbers.count(known.number) == 1}
        found = {place: free[place.number] for place in self.missing if place.number in free}
        self._do(self._worn | found)

    def clear_place(self) -> None:
        """Take the sensor off the selected place."""
        self._do({place: sensor for place, sensor in self._worn.items() if place is not self.place})

    def clear(self) -> None:
        """Take all sensors off."""
        self._do({})

    def begin_moving(self) -> None:
        """Let places wait for the sensor that is moved, the selected one or the first missing one first."""
        self.waiting = None
        self.sensor = None
        self._wait_for_next(self.place if self.place not in self._worn else None, begin=True)
        self.place = None
        self.changed.emit()

    def end_moving(self) -> None:
        """Let no place wait any more."""
        self.waiting = None
        self.changed.emit()

    def moved(self, sensor: SensorId) -> None:
        """A sensor is being moved: it goes to the place that waits, unless it sits somewhere already."""
        if self.waiting is not None and sensor in self._known and sensor not in self._worn.values():
            self.assign(self.waiting, sensor)

    def undo(self) -> None:
        """Take back the last step."""
        if self._before:
            self._after.append(self._now())
            self._return_to(self._before.pop())

    def redo(self) -> None:
        """Do again what was taken back."""
        if self._after:
            self._before.append(self._now())
            self._return_to(self._after.pop())

    def _now(self) -> _Step:
        return _Step(tuple(self._worn.items()), self.preset)

    def _do(self, worn: Mapping[Place, SensorId], preset: Preset | None = None) -> None:
        before = self._now()
        is_other = dict(worn) != self._worn
        self._worn = {place: worn[place] for place in PLACES if place in worn}
        self.preset = preset or self.preset
        if self.preset != "custom" and not set(self._worn) <= set(PRESETS[self.preset]):
            self.preset = "custom"
        if is_other or self.preset != before.preset:
            self._before = [*self._before[-UNDONE + 1 :], before]
            self._after.clear()
        self._settle(is_other)

    def _return_to(self, step: _Step) -> None:
        is_other = dict(step.sensors) != self._worn
        self._worn, self.preset = dict(step.sensors), step.preset
        self._settle(is_other)

    def _settle(self, is_other: bool) -> None:
        self._unselect()
        self._wait_for_next()
        if is_other:
            self.assignment_changed.emit(self.assignment)
        self.changed.emit()

    def _unselect(self) -> None:
        self.place = self.sensor = None
        self.is_exchanging = False

    def _wait_for_next(self, first: Place | None = None, *, begin: bool = False) -> None:
        """Let the next place wait while places wait at all, in the order of Table 1."""
        if begin or self.waiting is not None:
            missing = self.missing
            self.waiting = first or (missing[0] if missing else None)


def _by_number(known: KnownSensor) -> tuple[int, str]:
    return (known.number or len(PLACES) + 1, known.name)


def _exchanged(worn: Mapping[Place, SensorId], pairs: Sequence[tuple[Place, Place]]) -> dict[Place, SensorId]:
    other = dict(pairs) | {two: one for one, two in pairs}
    return {other.get(place, place): sensor for place, sensor in worn.items()}
