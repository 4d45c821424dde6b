"""A choice of a few words in a row, one of which is chosen."""

from collections.abc import Mapping

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QPushButton, QWidget

from studio.ui.theme import GRID


class Segments(QWidget):
    """Tab reaches the chosen one, arrows the others."""

    chosen = Signal(str)
    """Key of the word that was clicked."""

    def __init__(self, words: Mapping[str, str], said: str, parent: QWidget | None = None) -> None:
        """``words`` are shown by key; ``said`` names a choice to a screen reader and holds ``{word}``."""
        super().__init__(parent)
        self._group = QButtonGroup(self)
        self.buttons: dict[str, QPushButton] = {}
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID)
        for key, word in words.items():
            button = QPushButton(word, self)
            button.setProperty("kind", "segment")
            button.setProperty("key", key)
            button.setCheckable(True)
            button.setAccessibleName(said.format(word=word))
            button.clicked.connect(self._on_clicked)
            self._group.addButton(button)
            self.buttons[key] = button
            row.addWidget(button)

    def choose(self, key: str) -> None:
        """Show a choice; nothing is told."""
        self.buttons[key].setChecked(True)
        for other, button in self.buttons.items():
            # Qt gives Tab to the one that was focused last, chosen or not.
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus if other == key else Qt.FocusPolicy.ClickFocus)

    def _on_clicked(self) -> None:
        key = self.sender().property("key")
        self.choose(key)
        self.chosen.emit(key)
