"""Home: the figure that walks at once, the sample take, and takes that a crash had cut off."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from studio.capture.library import import_into
from studio.core.errors import StudioError
from studio.storage.take_summary import TakeSummary
from studio.ui.fact_words import duration
from studio.ui.models.studio_model import StudioModel
from studio.ui.presenters.folders import choose_folder, show_folder
from studio.ui.presenters.notices import Notices
from studio.ui.settings import Settings
from studio.ui.views.home_page import HomePage, Recovered

SAMPLE = Path(__file__).resolve().parents[3] / "resources" / "samples" / "xio-lower-body"
SAMPLE_PERSON = "SAMPLE1"
MOST_RECOVERED = 5


class HomePresenter(QObject):
    """Says where to go on."""

    connect_wanted = Signal()
    review_wanted = Signal(object)
    """Folder of a take."""
    library_changed = Signal()
    """A take was added."""

    def __init__(self, model: StudioModel, page: HomePage, settings: Settings, notices: Notices) -> None:
        super().__init__(page)
        self._model, self._page, self._settings, self._notices = model, page, settings, notices
        self._sample: Path | None = None
        self._is_importing = False
        page.show_coach_marks(not settings.values.coach_marks_done)
        page.sensors_requested.connect(self.connect_wanted)
        page.sample_requested.connect(self._on_sample)
        page.take_requested.connect(self._on_take)
        page.take_opened.connect(self._on_opened)
        page.folder_requested.connect(self._on_folder)
        page.coach_marks_dismissed.connect(self._on_dismissed)
        page.text_scale_chosen.connect(self._on_text)
        page.scheme_chosen.connect(self._on_scheme)
        model.source_changed.connect(self._on_source)
        self._on_source()

    def show_library(self, takes: Sequence[TakeSummary]) -> None:
        """Offer takes that were cut off, and remember the sample take when it is there."""
        self._sample = next((t.folder for t in takes if t.person == SAMPLE_PERSON and t.refusal is None), None)
        cut = [take for take in takes if take.recovered and take.refusal is None][:MOST_RECOVERED]
        facts = self.tr("{length} · {day} · ended by a crash")
        self._page.show_recovered(
            [
                Recovered(
                    str(take.folder), take.name, facts.format(length=duration(take.duration_s), day=take.started[:10])
                )
                for take in cut
            ]
        )

    def _on_sample(self) -> None:
        if self._sample is not None:
            self.review_wanted.emit(self._sample)
        elif not self._is_importing:
            self._is_importing = True
            library = self._model.library
            self._notices.say(self.tr("The sample take is being put into the library…"))
            self._model.work(
                lambda: import_into(library, [SAMPLE], "xio", None, SAMPLE_PERSON, None),
                self._on_imported,
                self._on_failed,
            )

    def _on_imported(self, folder: Path) -> None:
        self._is_importing = False
        self._sample = folder
        self.library_changed.emit()
        self.review_wanted.emit(folder)

    def _on_failed(self, error: StudioError) -> None:
        self._is_importing = False
        self._notices.refuse(error)

    def _on_take(self) -> None:
        folder = choose_folder(self._page, self.tr("Open a take"), self._model.library)
        if folder is not None:
            self.review_wanted.emit(folder)

    def _on_opened(self, folder: str) -> None:
        self.review_wanted.emit(Path(folder))

    def _on_folder(self, folder: str) -> None:
        show_folder(Path(folder))

    def _on_dismissed(self) -> None:
        self._settings.set("coach_marks_done", True)

    def _on_text(self, scale: float) -> None:
        self._settings.set("text_scale", scale)

    def _on_scheme(self, scheme: str) -> None:
        self._settings.set("scheme", scheme)

    def _on_source(self) -> None:
        self._page.show_simulated(self._model.source.startswith("synthetic"))
