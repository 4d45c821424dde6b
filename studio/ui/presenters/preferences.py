"""Settings: each choice is kept and in force at once."""

from pathlib import Path

import platformdirs
from PySide6.QtCore import QObject, Signal

from studio.ui.fact_words import folder_in_words
from studio.ui.presenters.folders import choose_folder, show_folder
from studio.ui.settings import Settings
from studio.ui.sound import Sound, Tone
from studio.ui.views.main_window import MainWindow
from studio.ui.views.settings_page import SettingsPage

ELSEWHERE = frozenset({"take_name", "angles", "geometry", "last_source", "last_person", "last_preset"})
"""Preferences that no part of the page shows: they change while somebody types."""


def library_folder(settings: Settings) -> Path:
    """Return where takes are kept."""
    chosen = settings.values.library
    return Path(chosen) if chosen else Path(platformdirs.user_documents_dir()) / "Kinetag takes"


class PreferencesPresenter(QObject):
    """Joins the page, the file and what preferences change."""

    library_changed = Signal()

    def __init__(self, settings: Settings, page: SettingsPage, window: MainWindow, sound: Sound) -> None:
        super().__init__(page)
        self._settings, self._page, self._window, self._sound = settings, page, window, sound
        page.changed.connect(settings.set)
        page.library_wanted.connect(self._on_library)
        page.library_shown.connect(self._on_shown)
        page.sound_test_wanted.connect(self._on_test)
        settings.changed.connect(self._on_changed)
        self.show()

    def show(self) -> None:
        """Show what is in force, and bring it into force where this is the only place."""
        values = self._settings.values
        self._sound.volume = values.volume if values.sound else 0.0
        self._window.keys.use(values.keys, clicker=values.clicker)
        self._page.show_preferences(values, folder_in_words(library_folder(self._settings)))
        self._page.show_keys(self._window.keys.offered, values)
        self._window.show_vocabulary(values.vocabulary)

    def _on_changed(self, name: str) -> None:
        if name not in ELSEWHERE:
            self.show()
        if name == "library":
            self.library_changed.emit()

    def _on_library(self) -> None:
        folder = choose_folder(self._page, self.tr("Folder for takes"), library_folder(self._settings))
        if folder is not None:
            self._settings.set("library", str(folder))

    def _on_shown(self) -> None:
        show_folder(library_folder(self._settings))

    def _on_test(self) -> None:
        self._sound.play(Tone.SUCCESS)
