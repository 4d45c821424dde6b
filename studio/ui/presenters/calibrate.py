"""Body calibration: holds are judged by the session, cues are heard, and offsets that nobody knows are asked for."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import QObject

from studio.capture.procedures.sitting_rest import Readings, is_missing
from studio.core.rest import Rest
from studio.core.sample import SensorId
from studio.ui.live_show import LiveShow
from studio.ui.models.hold_model import HoldModel
from studio.ui.models.studio_model import StudioModel
from studio.ui.sound import Sound
from studio.ui.views.calibration_page import CalibrationPage


class CalibratePresenter(QObject):
    """Joins the procedure to the session."""

    keys = ("go", "cancel")

    def __init__(
        self, model: StudioModel, holds: HoldModel, page: CalibrationPage, sound: Sound, show: LiveShow
    ) -> None:
        super().__init__(page)
        self._model, self._holds, self._page, self._show = model, holds, page, show
        self._rests: dict[SensorId, Rest] = {}
        holds.cued.connect(sound.cue)
        holds.hold_ended.connect(model.hold)
        holds.readings_wanted.connect(self._on_readings)
        holds.rest_found.connect(self._on_rest)
        model.hold_judged.connect(holds.answer)
        model.setup_changed.connect(self._on_setup)
        model.source_changed.connect(self._on_setup)
        model.health_changed.connect(self._on_health)

    def act(self, action: str) -> bool:
        """Do what a key asks for."""
        if action == "cancel" and self._holds.is_running:
            self._holds.cancel()
            return True
        if action == "go" and not self._holds.is_running:
            if self._holds.hold.next_pose is not None:  # a calibration that is complete is not begun anew by a key
                self._holds.start()
            return True
        return False

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass: a hold goes on while another page is looked at."""
        self._holds.tick(now)
        if self._rests:
            rests, self._rests = self._rests, {}
            self._model.keep_rests(rests)
        if shown:
            self._page.tick(now)

    def _on_setup(self) -> None:
        model, worn = self._model, self._model.setup.assignment.sensors
        self._holds.set_assigned(model.setup.assignment.places(), tuple(self._show.silent()))
        calibrations = {calibration.sensor: calibration for calibration in model.setup.calibrations}
        infos = model.infos
        missing: Mapping[SensorId, float] = {
            sensor: infos[sensor].frame_s
            for sensor in worn.values()
            if sensor in infos and is_missing(infos[sensor], model.flags(sensor), calibrations.get(sensor))
        }
        self._holds.set_rest_missing(missing)

    def _on_health(self) -> None:
        if not self._holds.is_running:
            self._on_setup()

    def _on_readings(self, sensors: Sequence[SensorId], seconds: float) -> None:
        windows = self._model.buffer.snapshot(sensors, seconds)
        self._holds.judge_rest({s: Readings(window.rate, window.acceleration) for s, window in windows.items()})

    def _on_rest(self, sensor: str, rest: Rest) -> None:
        self._rests[SensorId(sensor)] = rest
