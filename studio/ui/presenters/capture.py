"""Capture: record and stop, angles and traces, and what becomes of the take."""

import math
from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from studio.core.errors import StudioError
from studio.storage.take_file import Saved
from studio.storage.take_summary import TakeSummary, summarise
from studio.ui.live_show import LiveShow
from studio.ui.models.live_angles import LiveAngles
from studio.ui.models.recorder import Phase, Recorder
from studio.ui.models.studio_model import StudioModel
from studio.ui.models.take_list_model import length
from studio.ui.models.take_review import in_words, side_of
from studio.ui.models.vocabulary import vocabulary
from studio.ui.presenters.notices import Notices
from studio.ui.settings import Settings
from studio.ui.sound import Sound, Tone
from studio.ui.views.capture_page import CapturePage, TakenTake
from studio.ui.views.notices import Action
from studio.ui.views.plots.angle_plot import AngleCurve
from studio.ui.views.take_row import numbered
from studio.ui.views.traces import Traces

TRACES_EVERY = 0.04  # s
NUMBERS_EVERY = 0.1  # s; what changes faster cannot be read
TRACE_SECONDS = 10.5  # s
HEARD = 1.0  # s without any sample: there is nothing to record


class CapturePresenter(QObject):
    """Between the record button and the session."""

    take_saved = Signal(object)
    """TakeSummary of the take that was just read back."""
    review_wanted = Signal(object)
    """Folder of a take."""
    connect_wanted = Signal()
    bad_wanted = Signal(object)
    """Folder of a take that is to be marked as bad."""
    keys = ("marker", "cancel")

    def __init__(
        self, model: StudioModel, recorder: Recorder, show: LiveShow, angles: LiveAngles,
        page: CapturePage, traces: Traces, settings: Settings, sound: Sound, notices: Notices,
    ) -> None:  # fmt: skip
        super().__init__(page)
        self._model, self._recorder, self._show, self._angles = model, recorder, show, angles
        self._page, self._traces, self._settings, self._sound, self._notices = page, traces, settings, sound, notices
        self._count = 0
        self._folder = Path()
        self._saved_folder = Path()
        self._numbers_at = self._traces_at = -math.inf
        self._offered: tuple[str, ...] = ()
        page.set_delay(settings.values.delay)
        page.name.setText(settings.values.take_name)
        if settings.values.angles:
            angles.choose(settings.values.angles)
        self._wire()

    def _wire(self) -> None:
        model, recorder, page = self._model, self._recorder, self._page
        page.record_requested.connect(self.press)
        page.delay_changed.connect(self._on_delay)
        page.name_changed.connect(self._on_name)
        page.marker_requested.connect(self._on_marker)
        page.angles_chosen.connect(self._on_angles)
        page.angles_reset.connect(self._angles.reset)
        page.take_opened.connect(self._on_take)
        recorder.start_wanted.connect(self._on_start)
        recorder.stop_wanted.connect(model.stop_recording)
        recorder.second_counted.connect(self._on_second)
        recorder.phase_changed.connect(self._show_phase)
        model.recording_started.connect(self._on_started)
        model.recording_full.connect(self._on_full)
        model.recording_saved.connect(self._on_saved)
        model.recording_failed.connect(self._on_failed)
        model.next_take_changed.connect(self._show_phase)
        self._angles.names_changed.connect(self._offer_angles)
        self._offer_angles()
        self._show_phase()

    def press(self) -> None:
        """R: start, stop, or call off the countdown."""
        idle = self._recorder.phase in (Phase.IDLE, Phase.SAVED)
        if idle and not self._is_anything_heard():
            self._say_nothing_is_heard()
            return
        self._notices.withdraw("rec.nothing")
        self._recorder.press(self._model.now(), self._settings.values.delay)

    def act(self, action: str) -> bool:
        """Do what a key asks for; return whether there was anything to do."""
        if action == "marker" and self._recorder.phase is Phase.RECORDING:
            self._on_marker()
            return True
        if action == "cancel" and self._recorder.phase is Phase.COUNTDOWN:
            self._recorder.cancel()
            return True
        return False

    def take_name(self) -> str:
        """Return the name the next take will have."""
        return self._page.name.text().strip() or vocabulary(self._settings.values.vocabulary).take_name

    def take_title(self) -> str:
        """Return number and name of the next take, or of the one being recorded."""
        words = vocabulary(self._settings.values.vocabulary).take.lower()
        return f"{words} {self._model.next_take.number:03d} {self.take_name()}"

    def show_takes(self, takes: Sequence[TakeSummary]) -> None:
        """Show the last takes, newest first."""
        lost = self.tr("{percent} lost")
        rows = [
            TakenTake(numbered(t), length(t.duration_s), lost.format(percent=_percent(t.lost)), str(t.folder))
            for t in takes
            if t.refusal is None
        ]
        self._page.show_takes(rows[:5])

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass."""
        self._recorder.tick(now)
        if not shown:
            return
        if self._recorder.phase is Phase.RECORDING:
            self._page.show_elapsed(self._recorder.elapsed)
        if now - self._numbers_at >= NUMBERS_EVERY:
            self._numbers_at = now
            self._page.show_angles(self._angles.shown(), {name: in_words(name) for name in self._angles.chosen})
        if now - self._traces_at >= TRACES_EVERY:
            self._traces_at = now
            self._show_traces(now)

    def _show_traces(self, now: float) -> None:
        if self._traces.shows_sensors:
            sensors = self._traces.visible_sensors()
            self._traces.show_windows(self._model.buffer.snapshot(sensors, TRACE_SECONDS), now)
        else:
            names = self._angles.chosen
            windows = {name: self._angles.window(name, TRACE_SECONDS) for name in names}
            self._traces.show_angles([AngleCurve(in_words(n), side_of(n), *windows[n]) for n in names], now)

    def _say_nothing_is_heard(self) -> None:
        self._notices.warn(
            "rec.nothing",
            self.tr("There is nothing to record."),
            self.tr("No sensor is sending."),
            self.tr("Connect a source first, or use the simulator."),
            ((Action("connect", self.tr("Connect")), self.connect_wanted.emit),),
        )

    def _is_anything_heard(self) -> bool:
        return self._model.now() - self._model.heard_at <= HEARD

    def _show_phase(self, _: object = None) -> None:
        self._page.show_phase(self._recorder.phase, self._recorder.elapsed, self._count)

    def _on_second(self, count: int) -> None:
        self._count = count
        self._sound.play(Tone.COUNT)
        self._show_phase()

    def _on_start(self) -> None:
        if not self._is_anything_heard():  # the source went away while it was counted down
            self._recorder.failed()
            self._say_nothing_is_heard()
            return
        self._model.start_recording(self.take_name())

    def _on_started(self, folder: Path) -> None:
        self._folder = folder
        self._recorder.started(self._model.now())

    def _on_full(self) -> None:
        self._recorder.ended(self._model.now())

    def _on_failed(self, error: StudioError) -> None:
        self._recorder.failed()
        self._sound.play(Tone.FAILURE)
        self._notices.refuse(error)
        self._model.look_for_next_take()

    def _on_saved(self, saved: Saved) -> None:
        self._recorder.saved(self._model.now())
        self._sound.play(Tone.SUCCESS)
        self._saved_folder = saved.folder
        self._model.work(lambda: summarise(saved.folder), self._on_summary)
        self._model.look_for_next_take()

    def _on_summary(self, summary: TakeSummary) -> None:
        self.take_saved.emit(summary)
        number = summary.folder.name.split("_")[0].removeprefix("take-")
        said = self.tr("{take} {number} saved and verified · {length} · {lost} lost")
        word = vocabulary(self._settings.values.vocabulary).take
        self._notices.say(
            said.format(take=word, number=number, length=length(summary.duration_s), lost=_percent(summary.lost)),
            (
                (Action("review", self.tr("Review")), self._on_review),
                (Action("bad", self.tr("Bad take")), self._on_bad),
            ),
        )

    def _on_review(self) -> None:
        self.review_wanted.emit(self._saved_folder)

    def _on_bad(self) -> None:
        self.bad_wanted.emit(self._saved_folder)

    def _on_take(self, folder: str) -> None:
        self.review_wanted.emit(Path(folder))

    def _on_delay(self, seconds: int) -> None:
        self._settings.set("delay", seconds)

    def _on_name(self, name: str) -> None:
        self._settings.set("take_name", name)

    def _on_marker(self) -> None:
        self._model.mark("")

    def _on_angles(self, names: tuple[str, ...]) -> None:
        self._angles.choose(names)
        self._settings.set("angles", names)

    def _offer_angles(self) -> None:
        names = self._angles.names or self._angles.chosen
        self._page.offer_angles(names, self._angles.chosen, {name: in_words(name) for name in names})


def _percent(share: float) -> str:
    return f"{100 * share:.1f} %" if math.isfinite(share) else "–"
