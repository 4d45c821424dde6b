"""Assign: the sensors that are there, the setup in force, and the tag that is being moved."""

import math

from PySide6.QtCore import QObject

from studio.acquisition.health import HealthSnapshot
from studio.core.sample import SensorInfo
from studio.ui.live_show import SILENT_AFTER
from studio.ui.models.assignment_model import AssignmentModel, KnownSensor, SensorState
from studio.ui.models.sensor_motion import shaken, speed_of
from studio.ui.models.studio_model import StudioModel
from studio.ui.settings import Settings
from studio.ui.views.assign_page import AssignPage

EVERY = 0.25  # s
MOTION_SECONDS = 0.5  # s
WEAK_LOSS = 0.05  # share of lost packets
WEAK_BATTERY = 0.15  # 0…1


class AssignPresenter(QObject):
    """Keeps page and setup the same."""

    keys = ("undo", "redo")

    def __init__(self, model: StudioModel, assignment: AssignmentModel, page: AssignPage, settings: Settings) -> None:
        super().__init__(page)
        self._model, self._assignment, self._page, self._settings = model, assignment, page, settings
        self._at = -math.inf
        self.is_allowed = True
        """Whether places may be changed now."""
        assignment.assignment_changed.connect(model.assign)
        page.stature_chosen.connect(model.set_stature)
        page.map.facing_changed.connect(self._on_facing)
        settings.changed.connect(self._on_setting)
        self._on_setting("seen_from")
        model.setup_changed.connect(self._on_setup)
        model.source_changed.connect(self._on_setup)
        self._on_setup()

    def act(self, action: str) -> bool:
        """Do what a key asks for."""
        if not self.is_allowed:
            return False
        if action == "undo":
            self._assignment.undo()
        elif action == "redo":
            self._assignment.redo()
        return action in self.keys

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass."""
        if not shown:
            return
        self._page.tick(now)
        if now - self._at < EVERY:
            return
        self._at = now
        model = self._model
        infos, health = model.infos, model.health
        self._assignment.set_sensors([_known(info, health.get(sensor)) for sensor, info in infos.items()])
        if self._assignment.waiting is not None:
            windows = model.buffer.snapshot(tuple(infos), MOTION_SECONDS)
            moved = shaken({sensor: speed_of(window) for sensor, window in windows.items()})
            if moved is not None:
                self._page.moved(moved)

    def _on_facing(self, facing: bool) -> None:
        self._settings.set("seen_from", "front" if facing else "behind")

    def _on_setting(self, name: str) -> None:
        if name == "seen_from":
            self._page.map.set_facing(facing=self._settings.values.seen_from == "front")

    def _on_setup(self) -> None:
        setup = self._model.setup
        if setup.assignment != self._assignment.assignment:
            self._assignment.adopt(setup.assignment)
        self._page.show_stature(setup.stature, known=setup.stature_known)


def _known(info: SensorInfo, health: HealthSnapshot | None) -> KnownSensor:
    if health is None or health.silent_for > SILENT_AFTER:
        state = SensorState.SILENT
    elif health.loss > WEAK_LOSS or health.battery < WEAK_BATTERY:
        state = SensorState.WEAK
    else:
        state = SensorState.GOOD
    return KnownSensor(info.sensor, info.number, info.label or info.sensor, state)
