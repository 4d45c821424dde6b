"""The window and everything behind it, made once and joined: start reading the window here."""

import json
from pathlib import Path
from typing import Protocol

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication, QWidget

from studio.capture.next_take import seconds_that_fit
from studio.core.body import Place
from studio.export.file_target import is_taken
from studio.storage.take_summary import TakeSummary
from studio.ui.display_tick import DisplayTick
from studio.ui.live_show import LiveShow
from studio.ui.models.assignment_model import AssignmentModel
from studio.ui.models.export_choice import ExportChoice
from studio.ui.models.hold_model import HoldModel
from studio.ui.models.live_angles import LiveAngles
from studio.ui.models.place_words import PlaceWords, place_words
from studio.ui.models.playhead import Playhead
from studio.ui.models.recorder import Phase, Recorder
from studio.ui.models.studio_model import StudioModel
from studio.ui.presenters.assign import AssignPresenter
from studio.ui.presenters.calibrate import CalibratePresenter
from studio.ui.presenters.capture import CapturePresenter
from studio.ui.presenters.connect import ConnectPresenter
from studio.ui.presenters.diagnostics import DiagnosticsPresenter
from studio.ui.presenters.export import ExportPresenter
from studio.ui.presenters.home import HomePresenter
from studio.ui.presenters.look import LookPresenter
from studio.ui.presenters.notices import Notices
from studio.ui.presenters.people import PeoplePresenter
from studio.ui.presenters.preferences import PreferencesPresenter, library_folder
from studio.ui.presenters.review import ReviewPresenter
from studio.ui.presenters.stages import Stages
from studio.ui.settings import Settings
from studio.ui.sound import Sound
from studio.ui.theme import Theme
from studio.ui.views.assign_page import AssignPage
from studio.ui.views.calibration_page import CalibrationPage
from studio.ui.views.capture_page import CapturePage
from studio.ui.views.connect_page import ConnectPage
from studio.ui.views.diagnostics_page import DiagnosticsPage
from studio.ui.views.export_page import ExportPage
from studio.ui.views.home_page import HomePage
from studio.ui.views.main_window import MainWindow
from studio.ui.views.plots.angle_plot import AnglePlot
from studio.ui.views.review_page import ReviewPage
from studio.ui.views.settings_page import SettingsPage
from studio.ui.views.stage.stage import Stage
from studio.ui.views.traces import Traces

PLACES_FILE = Path(__file__).resolve().parents[2] / "resources" / "places.json"
FIRST_SOURCE = "synthetic:walk?calibrated=1&ahead=9"
"""What the first start shows: somebody who has held the poses already, and walks."""
STRIP_EVERY = 0.1  # s
DISK_EVERY = 5.0  # s
FULL_SUIT = 750.0  # samples a second of 15 tags at 50 Hz: what is expected before any was heard


class Keyed(Protocol):
    """A presenter whose page has keys of its own."""

    @property
    def keys(self) -> tuple[str, ...]:
        """Actions of the table in ``ui.keys``."""
        ...

    def act(self, action: str) -> bool:
        """Do what a key asks for; return whether it was done here."""
        ...


class StudioWindow(QObject):
    """Owns the models, the pages and the presenters; no page knows another."""

    def __init__(self, application: QApplication, theme: Theme, settings: Settings) -> None:
        super().__init__()
        self.theme, self.settings = theme, settings
        self._application = application
        self.model = StudioModel(library_folder(settings), self)
        self.model.person = settings.values.last_person
        self.recorder = Recorder(self)
        self.angles = LiveAngles(self)
        self.holds = HoldModel(self)
        self.sound = Sound(self)
        self.tick = DisplayTick(self)
        self._at = self._disk_at = float("-inf")
        self._disk_left: float | None = None
        self._offered = ""
        self._is_seen = False
        words = self._words()
        self._names = {place: said.name for place, said in words.items()}
        self.show = LiveShow(self.model, self.recorder, self.angles, self._names)
        self._build_pages(words)
        self.notices = Notices(self.window)
        self._build_presenters()
        self._wire()

    def start(self, source: str) -> None:
        """Show the window, begin to tick, and open a source."""
        window = self.window
        window.restore_geometry_state(self.settings.values.geometry)
        self.go_to("home")
        window.show()
        self.review.read_library()
        self.people.read_library()
        if source:
            self.model.open(source)
        self.tick.start()

    def offer_last(self, source: str) -> None:
        """Tell that the last starts did not end well, and offer to open ``source`` all the same."""
        self._offered = source
        self.window.show_safe_start()

    def go_to(self, name: str) -> None:
        """Show a page."""
        if name not in self.pages:
            return
        self.window.show_page(name)
        self.stages.show_page(name)
        if name == "connect":
            self.connect_.shown()
        elif name == "review" and not self.review.is_current:
            self.review.read_library()
        elif name == "review":
            self.review.open_newest()

    def shut_down(self) -> None:
        """Stop everything in order; what is being recorded is saved first."""
        self.tick.stop()
        self.review_page.measures.keep_note()
        self.settings.set("geometry", self.window.geometry_state())
        self.settings.set("last_source", self.model.source)
        self.settings.flush()
        self.model.shut_down()

    def _words(self) -> dict[Place, PlaceWords]:
        parsed = json.loads(PLACES_FILE.read_text(encoding="utf-8"))
        return place_words(parsed, "clinic" if self.settings.values.vocabulary == "clinic" else "plain")

    def _build_pages(self, words: dict[Place, PlaceWords]) -> None:
        theme = self.theme
        self.assignment = AssignmentModel(self)
        self.choice = ExportChoice(is_taken, self)
        self.traces = Traces(theme)
        live = Stage(theme)
        self.home_page = HomePage(theme)
        self.connect_page = ConnectPage(theme)
        self.assign_page = AssignPage(theme, self.assignment, words)
        self.calibration_page = CalibrationPage(theme, self.holds, words)
        self.capture_page = CapturePage(theme, live, self.traces)
        self.review_page = ReviewPage(theme, Playhead(self), AnglePlot(theme))
        self.export_page = ExportPage(theme, self.choice)
        self.settings_page = SettingsPage(theme)
        self.diagnostics_page = DiagnosticsPage(theme)
        self.pages = {
            "connect": self.connect_page, "assign": self.assign_page, "calibrate": self.calibration_page,
            "capture": self.capture_page, "review": self.review_page, "export": self.export_page,
            "home": self.home_page, "settings": self.settings_page, "diagnostics": self.diagnostics_page,
        }  # fmt: skip
        self.window = MainWindow(theme, self.pages)
        self.window.toast.keep_clear_of(self.capture_page.record)
        self.window.toast.keep_clear_of(self.review_page.transport)
        first, looked_at = Stage(theme), Stage(theme)
        self.home_page.set_stage(first)
        self.review_page.set_stage(looked_at)
        self.stages = Stages({"home": first, "capture": live, "review": looked_at}, self.show, self.settings)
        self.connect_page.set_place_words(self._names)

    def _build_presenters(self) -> None:
        model, settings, notices, window = self.model, self.settings, self.notices, self.window
        self.look = LookPresenter(self._application, self.theme, settings, window)
        self.connect_ = ConnectPresenter(model, self.connect_page, model.library)
        self.assign = AssignPresenter(model, self.assignment, self.assign_page, settings)
        self.calibrate = CalibratePresenter(model, self.holds, self.calibration_page, self.sound, self.show)
        self.capture = CapturePresenter(
            model, self.recorder, self.show, self.angles, self.capture_page, self.traces, settings, self.sound, notices
        )
        self.review = ReviewPresenter(model, self.review_page, self._names, settings, notices)
        self.export = ExportPresenter(model, self.choice, self.export_page, settings)
        self.home = HomePresenter(model, self.home_page, settings, notices)
        self.people = PeoplePresenter(model, window, settings, notices)
        self.diagnostics = DiagnosticsPresenter(model, self.diagnostics_page)
        self._keys: dict[str, Keyed] = {
            "connect": self.connect_, "assign": self.assign, "calibrate": self.calibrate, "capture": self.capture,
            "review": self.review,
        }  # fmt: skip
        for presenter in self._keys.values():
            window.keys.offer(presenter.keys)
        window.keys.offer((*self.look.keys, *self.stages.keys, "export_again"))
        self.preferences = PreferencesPresenter(settings, self.settings_page, window, self.sound)

    def _wire(self) -> None:
        window, model, recorder = self.window, self.model, self.recorder
        window.page_requested.connect(self.go_to)
        window.fix_requested.connect(self.go_to)
        window.record_requested.connect(self.capture.press)
        window.key_pressed.connect(self._on_key)
        window.notice_acted.connect(self._on_acted)
        window.vocabulary_changed.connect(self._on_vocabulary)
        window.close_requested.connect(self._on_close)
        window.close_confirmed.connect(self._on_close_confirmed)
        window.export_end_confirmed.connect(self._on_export_ended)
        recorder.phase_changed.connect(self._on_phase)
        recorder.close_asked.connect(window.ask_before_close)
        recorder.close_ready.connect(window.close_now)
        model.refused.connect(self.notices.refuse)
        model.person_changed.connect(self._on_person)
        model.source_refused.connect(self._on_source_refused)
        model.sensors_changed.connect(self._show_sensors)
        model.setup_changed.connect(self._show_sensors)
        self.capture.take_saved.connect(self._on_saved)
        self.capture.review_wanted.connect(self.review_take)
        self.capture.connect_wanted.connect(self._connect)
        self.capture.bad_wanted.connect(self._on_bad)
        self.home.connect_wanted.connect(self._on_own_sensors)
        self.home.review_wanted.connect(self.review_take)
        self.home.library_changed.connect(self.review.read_library)
        self.review.library_read.connect(self._on_library)
        self.review.export_wanted.connect(self._on_export)
        self.export.takes_wanted.connect(self._on_takes_wanted)
        self.preferences.library_changed.connect(self._on_library_moved)
        self.holds.accepted.connect(self._on_calibrated)
        self.settings.changed.connect(self._on_setting)
        self.tick.ticked.connect(self.on_tick)

    def on_tick(self, now: float) -> None:
        """Let everything that shows something look at what there is; ``now`` is the clock of the samples, s."""
        page = self.window.shown_page
        self.model.tick(now)
        self.stages.tick(now)
        if not self._is_seen and self.show.has_body():
            self._is_seen = True
            self.diagnostics.note(self.tr("the figure moves"))
        self.connect_.tick(now, shown=page == "connect")
        self.assign.tick(now, shown=page == "assign")
        self.calibrate.tick(now, shown=page == "calibrate")
        self.capture.tick(now, shown=page == "capture")
        self.review.tick(now, shown=page == "review")
        self.diagnostics.tick(now, shown=page == "diagnostics")
        self.window.tick(now)
        if now - self._disk_at >= DISK_EVERY:
            self._disk_at = now
            library, rates = self.model.library, [1 / info.frame_s for info in self.model.infos.values()]
            self.model.work(lambda: seconds_that_fit(library, sum(rates) or FULL_SUIT), self._on_disk)
        if now - self._at >= STRIP_EVERY:
            self._at = now
            self.window.show_state(self.show.readiness(self.capture.take_title(), self._disk_left))

    def _on_disk(self, left: float | None) -> None:
        self._disk_left = left

    def _on_key(self, action: str) -> None:
        page = self.window.shown_page
        presenter = self._keys.get(page)
        if presenter is not None and action in presenter.keys and presenter.act(action):
            return
        if self.look.act(action) or self.stages.act(action, page):
            return
        if action == "cancel":
            self.calibrate.act(action)
            self.recorder.cancel()
        elif action == "marker":
            self.capture.act(action)
        elif action == "export_again":
            self._export_again()

    def _export_again(self) -> None:
        takes = self.review_page.takes
        current = takes.current()
        chosen = [takes.model.summary(folder) for folder in takes.selected()] or [current]
        known = [take for take in chosen if take is not None]
        if self.window.shown_page == "review" and known:
            self.go_to("export")
            self.export.again(known)

    def _on_acted(self, action: str) -> None:
        if action == "open_last" and self._offered and not self.recorder.is_busy:
            self.model.open(self._offered)

    def _on_vocabulary(self, name: str) -> None:
        self.settings.set("vocabulary", name)

    def _on_setting(self, name: str) -> None:
        if name == "vocabulary":
            words = self._words()
            self._names.update({place: said.name for place, said in words.items()})
            self.assign_page.set_words(words)
            self.calibration_page.set_words(words)
            self.connect_page.set_place_words(self._names)

    def _on_phase(self, _: object) -> None:
        """While a take is being recorded, what would change whose it is or what is in it waits."""
        may = self.recorder.phase in (Phase.IDLE, Phase.SAVED)
        reason = "" if may else self.tr("A take is being recorded: this can be changed after it.")
        parts: tuple[QWidget, ...] = (
            self.window.header.person, self.connect_page.choice, self.assign_page,
            self.settings_page.choose_library,
        )  # fmt: skip
        for part in parts:
            part.setEnabled(may)
            part.setToolTip(reason)
        self.assign.is_allowed = may

    def _on_close(self) -> None:
        if self.export.is_running:
            self.window.ask_before_ending_export()
        elif self.recorder.close(self.model.now()):
            self.window.close_now()

    def _on_export_ended(self) -> None:
        if self.recorder.close(self.model.now()):
            self.window.close_now()

    def _on_close_confirmed(self) -> None:
        self.recorder.stop_and_close(self.model.now())

    def _on_source_refused(self, error: object) -> None:
        if self.window.shown_page != "connect":
            self.notices.refuse(error)  # type: ignore[arg-type]  # Signal(object)

    def _show_sensors(self) -> None:
        infos = self.model.infos
        worn = self.model.setup.assignment.sensors
        names = {sensor: self._names[place] for place, sensor in worn.items() if sensor in infos}
        names |= {s: info.label or str(s) for s, info in infos.items() if s not in names}
        self.traces.set_sensors(names)

    def _on_saved(self, summary: TakeSummary) -> None:
        self.review.put(summary)
        self._show_last_takes()
        self.people.read_library()

    def _show_last_takes(self) -> None:
        model = self.review_page.takes.model
        self.capture.show_takes(model.newest())
        self.connect_.show_takes(model.newest())

    def _on_library(self, takes: tuple[TakeSummary, ...]) -> None:
        self.home.show_library(takes)
        self._show_last_takes()

    def _on_library_moved(self) -> None:
        self.model.library = library_folder(self.settings)
        self.review.read_library()
        self.people.read_library()

    def review_take(self, folder: Path) -> None:
        """Look at a take."""
        self.review.open_take(folder)
        self.go_to("review")

    def _on_bad(self, folder: Path) -> None:
        self.review.judge(folder, "bad")

    def _on_person(self) -> None:
        self.holds.hold.reset()
        self.holds.changed.emit()
        self.angles.reset()
        self.assignment.adopt(self.model.setup.assignment)

    def _connect(self) -> None:
        self.go_to("connect")

    def _on_own_sensors(self) -> None:
        self.go_to("connect")
        if self.recorder.phase not in (Phase.IDLE, Phase.SAVED):
            return  # the page says why nothing can be changed now
        if self.model.is_simulated:
            self.model.close_source()
        self.connect_page.choice.set_kind("serial")

    def _on_export(self, takes: tuple[TakeSummary, ...]) -> None:
        self.export.choose(takes)
        self.go_to("export")

    def _on_takes_wanted(self) -> None:
        self.go_to("review")

    def _on_calibrated(self, _: object) -> None:
        self.angles.reset()
        self.go_to("capture")
