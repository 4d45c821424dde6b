"""Settings: each acts at once, none needs a restart or an OK."""

from collections.abc import Iterable

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from studio.ui.keys import Key
from studio.ui.models.preferences import Preferences
from studio.ui.models.recorder import DELAYS
from studio.ui.theme import FORM_WIDTH, GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.key_settings import KeySettings
from studio.ui.views.look_controls import SchemeChoice, TextSize
from studio.ui.views.segments import Segments


class SettingsPage(QFrame):
    """Renders Preferences; what is changed goes out by name."""

    changed = Signal(str, object)
    """Name of a preference, and the value it shall have."""
    library_wanted = Signal()
    """Choose another folder for the takes."""
    library_shown = Signal()
    """Show the folder of the takes."""
    sound_test_wanted = Signal()

    inspector: QWidget | None = None

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.scheme = SchemeChoice(theme, self)
        self.text_size = TextSize(theme, self)
        self.reduced_motion = QCheckBox(self.tr("Reduce motion: no animations"), self)
        words = {"clinic": self.tr("Clinic"), "studio": self.tr("Studio")}
        self.vocabulary = Segments(words, self.tr("Words for: {word}"), self)
        self.library = ElidedLabel(self)
        self.choose_library = QPushButton(self.tr("Choose…"), self)
        self.show_library = QPushButton(self.tr("Show"), self)
        self.delay = QComboBox(self)
        self.clicker = QCheckBox(self.tr("A presenter's clicker records too (Page Down, B, F5)"), self)
        self.sound = QCheckBox(self.tr("Sounds: countdown, done, and trouble"), self)
        self.volume = QSlider(Qt.Orientation.Horizontal, self)
        self.test_sound = QPushButton(self.tr("Test"), self)
        words = {"front": self.tr("Face me"), "behind": self.tr("From behind")}
        self.seen_from = Segments(words, self.tr("Body map: {word}"), self)
        self.keys = KeySettings(theme, self)
        self._labels: list[QLabel] = []
        self._build()
        self._name()
        self._wire()
        self.show_preferences(Preferences(), "")
        self.restyle()

    def show_preferences(self, preferences: Preferences, library: str) -> None:
        """Show what is in force; ``library`` is the folder of the takes, also when it is the studio's own."""
        controls = (self.reduced_motion, self.delay, self.clicker, self.sound, self.volume)
        for control in controls:
            control.blockSignals(True)
        self.reduced_motion.setChecked(preferences.reduced_motion)
        self.vocabulary.choose(preferences.vocabulary)
        self.library.set_words(library)
        self.delay.setCurrentIndex(DELAYS.index(preferences.delay))
        self.clicker.setChecked(preferences.clicker)
        self.sound.setChecked(preferences.sound)
        self.volume.setValue(round(preferences.volume * 100))
        self.volume.setEnabled(preferences.sound)
        self.test_sound.setEnabled(preferences.sound)
        self.seen_from.choose(preferences.seen_from)
        for control in controls:
            control.blockSignals(False)
        self.scheme.restyle()
        self.text_size.restyle()

    def show_keys(self, offered: Iterable[Key], preferences: Preferences) -> None:
        """Show the keys of the actions that exist."""
        self.keys.show_keys(offered, preferences.keys)

    def restyle(self) -> None:
        """Take over colours and text size."""
        self._form.setMaximumWidth(round(FORM_WIDTH * max(self._theme.text_scale, 1.0)))
        for label in self._labels:
            label.setMinimumWidth(0)
            label.ensurePolished()
        widest = max(label.sizeHint().width() for label in self._labels)
        for label in self._labels:
            label.setMinimumWidth(widest)
        self.scheme.restyle()
        self.text_size.restyle()
        self.keys.restyle()

    def _build(self) -> None:
        self.setProperty("ground", "window")
        self.setAccessibleName(self.tr("Settings"))
        area = QScrollArea(self)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        around = QWidget(area)
        self._form = QWidget(around)
        column = QVBoxLayout(self._form)
        column.setContentsMargins(0, 0, GAP_WIDE, GAP_PAGE)
        column.setSpacing(GAP)
        column.addWidget(self._heading(self.tr("Settings"), "page"))
        self._build_look(column)
        self._build_recording(column)
        self._section(column, self.tr("Keys"))
        column.addWidget(self.keys)
        column.addStretch(1)
        row = QHBoxLayout(around)
        row.setContentsMargins(GAP_PAGE, GAP_PAGE, 0, 0)
        row.addWidget(self._form, 1)
        row.addStretch(0)
        area.setWidget(around)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.addWidget(area)

    def _build_look(self, column: QVBoxLayout) -> None:
        self._section(column, self.tr("Look"))
        self._line(column, self.tr("Theme"), self.scheme)
        self._line(column, self.tr("Text size"), self.text_size)
        column.addWidget(self.reduced_motion)
        self._section(column, self.tr("Words"))
        self._line(column, self.tr("Words for"), self.vocabulary)
        self._hint(column, self.tr("Changes words, names of takes and what is exported first. All functions stay."))
        self._line(column, self.tr("Body map"), self.seen_from)

    def _build_recording(self, column: QVBoxLayout) -> None:
        self._section(column, self.tr("Recording"))
        for delay in DELAYS:
            self.delay.addItem(self.tr("at once") if delay == 0 else self.tr("after {s} s").format(s=delay), delay)
        self._line(column, self.tr("R starts"), self.delay)
        column.addWidget(self.clicker)
        column.addWidget(self._heading(self.tr("Folder of the takes"), "caption"))
        column.addWidget(self.library)
        self._line(column, "", self.choose_library, self.show_library)
        self._section(column, self.tr("Sound"))
        column.addWidget(self.sound)
        self.volume.setRange(0, 100)
        self.volume.setPageStep(10)
        self._line(column, self.tr("Volume"), self.volume, self.test_sound)

    def _name(self) -> None:
        for choice in (self.reduced_motion, self.clicker, self.sound):
            choice.setAccessibleName(choice.text())
        self.choose_library.setAccessibleName(self.tr("Choose the folder of the takes"))
        self.show_library.setAccessibleName(self.tr("Show the folder of the takes"))
        self.delay.setAccessibleName(self.tr("Delay of the record key"))
        self.volume.setAccessibleName(self.tr("Volume"))
        self.test_sound.setAccessibleName(self.tr("Test the sound"))

    def _wire(self) -> None:
        self.scheme.chosen.connect(self._on_scheme)
        self.text_size.chosen.connect(self._on_text_scale)
        self.reduced_motion.toggled.connect(self._on_reduced_motion)
        self.vocabulary.chosen.connect(self._on_vocabulary)
        self.seen_from.chosen.connect(self._on_seen_from)
        self.choose_library.clicked.connect(self.library_wanted)
        self.show_library.clicked.connect(self.library_shown)
        self.delay.activated.connect(self._on_delay)
        self.clicker.toggled.connect(self._on_clicker)
        self.sound.toggled.connect(self._on_sound)
        self.volume.valueChanged.connect(self._on_volume)
        self.test_sound.clicked.connect(self.sound_test_wanted)
        self.keys.changed.connect(self._on_keys)

    def _section(self, column: QVBoxLayout, words: str) -> None:
        column.addSpacing(GAP_WIDE)
        column.addWidget(self._heading(words, "section"))

    def _heading(self, words: str, role: str) -> QLabel:
        label = QLabel(words, self)
        label.setProperty("role", role)
        return label

    def _hint(self, column: QVBoxLayout, words: str) -> None:
        hint = self._heading(words, "caption")
        hint.setWordWrap(True)
        column.addWidget(hint)

    def _line(self, column: QVBoxLayout, words: str, *controls: QWidget) -> None:
        row = QHBoxLayout()
        row.setSpacing(GRID)
        if words:
            label = self._heading(words, "muted")
            self._labels.append(label)
            row.addWidget(label)
            row.addSpacing(GAP_WIDE)
        for control in controls:
            row.addWidget(control, 1 if isinstance(control, QSlider) else 0)
        row.addStretch(1)
        column.addLayout(row)

    def _on_scheme(self, scheme: str) -> None:
        self.changed.emit("scheme", scheme)

    def _on_text_scale(self, scale: float) -> None:
        self.changed.emit("text_scale", scale)

    def _on_reduced_motion(self, on: bool) -> None:
        self.changed.emit("reduced_motion", on)

    def _on_vocabulary(self, name: str) -> None:
        self.changed.emit("vocabulary", name)

    def _on_seen_from(self, side: str) -> None:
        self.changed.emit("seen_from", side)

    def _on_delay(self, number: int) -> None:
        self.changed.emit("delay", DELAYS[number])

    def _on_clicker(self, on: bool) -> None:
        self.changed.emit("clicker", on)

    def _on_sound(self, on: bool) -> None:
        self.volume.setEnabled(on)
        self.test_sound.setEnabled(on)
        self.changed.emit("sound", on)

    def _on_volume(self, percent: int) -> None:
        self.changed.emit("volume", percent / 100)

    def _on_keys(self, keys: object) -> None:
        self.changed.emit("keys", keys)
