"""The user's own keys: one field for each action that exists."""

from collections.abc import Iterable, Mapping

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QGridLayout, QLabel, QPushButton, QWidget

from studio.ui.keys import TABLE, Key, conflict, in_words
from studio.ui.style_sheet import set_look
from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.key_field import KeyField

FIELD_WIDTH = 176  # px at 100 %


class KeySettings(QWidget):
    """Changes keys, and refuses one that means something else already."""

    changed = Signal(object)
    """All keys that differ from the table: action → sequences."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._in_force: dict[str, tuple[str, ...]] = {}
        self._fields: dict[str, KeyField] = {}
        self._resets: dict[str, QPushButton] = {}
        self._words: dict[str, str] = {}
        self._told = QLabel(self)
        self._told.setProperty("role", "muted")
        self._told.setWordWrap(True)
        self._grid = QGridLayout(self)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setHorizontalSpacing(GAP_WIDE)
        self._grid.setVerticalSpacing(GAP)
        self._grid.setColumnStretch(0, 1)
        self._grid.addWidget(self._told, 0, 0, 1, 3)
        self._tell("")

    @property
    def fields(self) -> Mapping[str, KeyField]:
        """The field of each action."""
        return self._fields

    @property
    def told(self) -> str:
        """What is said above the fields."""
        return self._told.text()

    def show_keys(self, offered: Iterable[Key], changed: Mapping[str, tuple[str, ...]]) -> None:
        """Show the keys of these actions."""
        self._in_force = {key.action: changed.get(key.action, key.keys) for key in TABLE}
        for key in offered:
            if key.action not in self._fields:
                self._add(key)
            self._show(key.action)

    def restyle(self) -> None:
        """Take over the text size."""
        for field in self._fields.values():
            field.setFixedWidth(round(FIELD_WIDTH * max(self._theme.text_scale, 1.0)))

    def _add(self, key: Key) -> None:
        row = self._grid.rowCount()
        words, field = QLabel(key.words, self), KeyField(self)
        words.setWordWrap(True)
        field.setProperty("action", key.action)
        field.setAccessibleName(self.tr("Key for: {words}").format(words=key.words))
        field.setAccessibleDescription(self.tr("Press a key to change it, Backspace to take it away"))
        reset = QPushButton(self.tr("Default"), self)
        reset.setProperty("kind", "quiet")
        reset.setProperty("action", key.action)
        reset.setAccessibleName(self.tr("Default key for: {words}").format(words=key.words))
        self._grid.addWidget(words, row, 0)
        self._grid.addWidget(field, row, 1, Qt.AlignmentFlag.AlignRight)
        self._grid.addWidget(reset, row, 2)
        policy = reset.sizePolicy()
        policy.setRetainSizeWhenHidden(True)  # or the columns would move
        reset.setSizePolicy(policy)
        self._fields[key.action], self._resets[key.action] = field, reset
        self._words[key.action] = key.words
        field.pressed.connect(self._on_pressed)
        reset.clicked.connect(self._on_reset)
        self.restyle()

    def _show(self, action: str) -> None:
        self._fields[action].setText(in_words(self._in_force[action]))
        default = next(key.keys for key in TABLE if key.action == action)
        self._resets[action].setVisible(self._in_force[action] != default)

    def _tell(self, words: str) -> None:
        set_look(self._told, tone="warn" if words else "")
        self._told.setText(
            words or self.tr("Press a key in a field to change it. Keys never act while you type in a text field.")
        )

    def _on_pressed(self, sequence: str) -> None:
        action = self.sender().property("action")
        other = conflict(sequence, action, self._in_force) if sequence else ""
        if other:
            told = self.tr("▲ {key} already means “{words}”. Take it away there first.")
            self._tell(told.format(key=in_words((sequence,)), words=self._words.get(other, other)))
            return
        self._set(action, (sequence,) if sequence else ())

    def _on_reset(self) -> None:
        action = self.sender().property("action")
        default = next(key.keys for key in TABLE if key.action == action)
        other = next((found for key in default if (found := conflict(key, action, self._in_force))), "")
        if other:
            told = self.tr("▲ The default key means “{words}” now. Take it away there first.")
            self._tell(told.format(words=self._words.get(other, other)))
            return
        self._set(action, default)

    def _set(self, action: str, sequences: tuple[str, ...]) -> None:
        self._tell("")
        self._in_force[action] = sequences
        self._show(action)
        self.changed.emit({key.action: has for key in TABLE if (has := self._in_force[key.action]) != key.keys})
