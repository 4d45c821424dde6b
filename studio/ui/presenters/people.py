"""Who is captured: the persons of the library by their codes, and the session of today."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QObject

from studio.core.errors import StudioError
from studio.storage.names import NOBODY, person_folder
from studio.ui.models.studio_model import StudioModel
from studio.ui.presenters.home import SAMPLE_PERSON
from studio.ui.presenters.notices import Notices
from studio.ui.settings import Settings
from studio.ui.views.main_window import MainWindow


class PeoplePresenter(QObject):
    """Fills the header and keeps the choice."""

    def __init__(self, model: StudioModel, window: MainWindow, settings: Settings, notices: Notices) -> None:
        super().__init__(window)
        self._model, self._window, self._settings, self._notices = model, window, settings, notices
        self._codes: tuple[str, ...] = ()
        window.person_chosen.connect(self.choose)
        window.person_created.connect(self._on_created)
        model.next_take_changed.connect(self._show)

    def read_library(self) -> None:
        """List the persons anew."""
        library = self._model.library
        self._model.work(lambda: _codes(library), self._on_codes)
        self._model.look_for_next_take()

    def choose(self, code: str) -> None:
        """Capture this person from now on."""
        self._settings.set("last_person", code)
        self._model.choose_person(code)
        self._model.look_for_next_take()
        self._show()

    def _on_created(self, code: str) -> None:
        try:
            folder = person_folder(code.strip())
        except StudioError as refusal:
            self._notices.refuse(refusal)
            return
        if folder != NOBODY:
            self._notices.withdraw("set.person")
            self._codes = tuple(sorted({*self._codes, folder}))
            self.choose(folder)

    def _on_codes(self, codes: Sequence[str]) -> None:
        chosen = self._model.person
        self._codes = tuple(sorted({*codes, chosen} - {""}))
        self._show()

    def _show(self) -> None:
        self._window.show_people(self._codes, self._model.person)
        self._window.show_session(self._model.next_take.session)


def _codes(library: Path) -> tuple[str, ...]:
    try:
        found = [entry.name for entry in library.iterdir() if entry.is_dir()]
    except OSError:
        return ()
    return tuple(name for name in found if _is_code(name) and name not in (NOBODY, SAMPLE_PERSON))


def _is_code(name: str) -> bool:
    try:
        return person_folder(name) == name
    except StudioError:
        return False
