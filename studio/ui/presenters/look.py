"""Colours, text size, motion and words: preferences brought into force everywhere at once."""

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication

from studio.ui.settings import Settings
from studio.ui.style_sheet import dress
from studio.ui.theme import Theme
from studio.ui.views.look_controls import next_size
from studio.ui.views.main_window import MainWindow

LOOKS = frozenset({"scheme", "text_scale", "reduced_motion"})
STEPS = {"text_larger": 1, "text_smaller": -1, "text_normal": 0}


class LookPresenter(QObject):
    """Dresses the application anew when a preference of its look changes."""

    keys = tuple(STEPS)

    def __init__(self, application: QApplication, theme: Theme, settings: Settings, window: MainWindow) -> None:
        super().__init__(window)
        self._application, self._theme, self._settings, self._window = application, theme, settings, window
        settings.changed.connect(self._on_changed)
        application.styleHints().colorSchemeChanged.connect(self._on_system)

    def act(self, action: str) -> bool:
        """Do what a key asks for."""
        step = STEPS.get(action)
        if step is not None:
            self._settings.set("text_scale", next_size(self._theme.text_scale, step))
        return step is not None

    def _on_changed(self, name: str) -> None:
        if name in LOOKS:
            setattr(self._theme, name, getattr(self._settings.values, name))
            self._dress()

    def _on_system(self) -> None:
        if self._theme.scheme == "system":
            self._dress()

    def _dress(self) -> None:
        dress(self._application, self._theme)
        self._window.restyle()
