"""The keys: one table, the shortcuts made from it, and the rule that nobody's typing starts a recording."""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QObject, Qt, Signal
from PySide6.QtGui import QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QAbstractSpinBox,
    QApplication,
    QComboBox,
    QKeySequenceEdit,
    QLineEdit,
    QPlainTextEdit,
    QTabBar,
    QTextEdit,
    QWidget,
)


class Key(NamedTuple):
    """An action and the keys it has when nobody changed them."""

    action: str
    keys: tuple[str, ...]
    text: object
    section: object

    @property
    def words(self) -> str:
        """What the key does, translated."""
        return QCoreApplication.translate("Keys", str(self.text))

    @property
    def group(self) -> str:
        """Heading it stands under, translated."""
        return QCoreApplication.translate("Keys", str(self.section))


GENERAL = QT_TRANSLATE_NOOP("Keys", "Everywhere")
CAPTURE = QT_TRANSLATE_NOOP("Keys", "Calibrate and capture")
REVIEW = QT_TRANSLATE_NOOP("Keys", "Review and export")
FIGURE = QT_TRANSLATE_NOOP("Keys", "Figure and window")

TABLE = (
    Key("connect", ("1",), QT_TRANSLATE_NOOP("Keys", "Connect"), GENERAL),
    Key("assign", ("2",), QT_TRANSLATE_NOOP("Keys", "Assign"), GENERAL),
    Key("calibrate", ("3",), QT_TRANSLATE_NOOP("Keys", "Calibrate"), GENERAL),
    Key("capture", ("4",), QT_TRANSLATE_NOOP("Keys", "Capture"), GENERAL),
    Key("review", ("5",), QT_TRANSLATE_NOOP("Keys", "Review"), GENERAL),
    Key("export", ("6", "Ctrl+E"), QT_TRANSLATE_NOOP("Keys", "Export"), GENERAL),
    Key("help", ("F1", "?"), QT_TRANSLATE_NOOP("Keys", "Show these keys"), GENERAL),
    Key("undo", ("Ctrl+Z",), QT_TRANSLATE_NOOP("Keys", "Undo"), GENERAL),
    Key("redo", ("Ctrl+Y", "Ctrl+Shift+Z"), QT_TRANSLATE_NOOP("Keys", "Redo"), GENERAL),
    Key("record", ("R",), QT_TRANSLATE_NOOP("Keys", "Start or stop recording"), CAPTURE),
    Key("cancel", ("Esc",), QT_TRANSLATE_NOOP("Keys", "Call off the countdown (never stops a recording)"), CAPTURE),
    Key("marker", ("M",), QT_TRANSLATE_NOOP("Keys", "Set a marker"), CAPTURE),
    Key("yaw_reset", ("Y",), QT_TRANSLATE_NOOP("Keys", "Turn the figure to face forward"), CAPTURE),
    Key("go", ("Space",), QT_TRANSLATE_NOOP("Keys", "Play or pause; start a calibration step"), REVIEW),
    Key("frame_back", ("Left",), QT_TRANSLATE_NOOP("Keys", "1 frame back"), REVIEW),
    Key("frame_forward", ("Right",), QT_TRANSLATE_NOOP("Keys", "1 frame forward"), REVIEW),
    Key("frames_back", ("Shift+Left",), QT_TRANSLATE_NOOP("Keys", "10 frames back"), REVIEW),
    Key("frames_forward", ("Shift+Right",), QT_TRANSLATE_NOOP("Keys", "10 frames forward"), REVIEW),
    Key("to_start", ("Home",), QT_TRANSLATE_NOOP("Keys", "To the start"), REVIEW),
    Key("to_end", ("End",), QT_TRANSLATE_NOOP("Keys", "To the end"), REVIEW),
    Key("loop", ("L",), QT_TRANSLATE_NOOP("Keys", "Loop on or off"), REVIEW),
    Key("slower", ("J",), QT_TRANSLATE_NOOP("Keys", "Slower"), REVIEW),
    Key("faster", ("K",), QT_TRANSLATE_NOOP("Keys", "Faster"), REVIEW),
    Key("trim_in", ("I",), QT_TRANSLATE_NOOP("Keys", "Play from here"), REVIEW),
    Key("trim_out", ("O",), QT_TRANSLATE_NOOP("Keys", "Play up to here"), REVIEW),
    Key("origin", ("Shift+O",), QT_TRANSLATE_NOOP("Keys", "Time origin here"), REVIEW),
    Key("compare", ("C",), QT_TRANSLATE_NOOP("Keys", "Compare on or off"), REVIEW),
    Key("star", ("S",), QT_TRANSLATE_NOOP("Keys", "Star the take"), REVIEW),
    Key("bad", ("X",), QT_TRANSLATE_NOOP("Keys", "Bad take"), REVIEW),
    Key("note", ("N",), QT_TRANSLATE_NOOP("Keys", "Edit the note"), REVIEW),
    Key("rename", ("F2",), QT_TRANSLATE_NOOP("Keys", "Rename the take"), REVIEW),
    Key("export_again", ("E",), QT_TRANSLATE_NOOP("Keys", "Export with the last preset"), REVIEW),
    Key("follow", ("F",), QT_TRANSLATE_NOOP("Keys", "Follow the figure"), FIGURE),
    Key("views", ("V",), QT_TRANSLATE_NOOP("Keys", "Next view"), FIGURE),
    Key("full_screen", ("F11",), QT_TRANSLATE_NOOP("Keys", "Full screen"), FIGURE),
    Key("text_larger", ("Ctrl++", "Ctrl+="), QT_TRANSLATE_NOOP("Keys", "Larger text"), FIGURE),
    Key("text_smaller", ("Ctrl+-",), QT_TRANSLATE_NOOP("Keys", "Smaller text"), FIGURE),
    Key("text_normal", ("Ctrl+0",), QT_TRANSLATE_NOOP("Keys", "Normal text size"), FIGURE),
    Key("safe_restart", ("Ctrl+Shift+S",), QT_TRANSLATE_NOOP("Keys", "Restart without the last source"), FIGURE),
)
"""Every key of the studio. What no part of the window offers, is neither bound nor shown."""

CLICKER = ("PgDown", "B", "F5")
"""What a presenter's clicker sends; bound to ``record`` when the preference ``clicker`` is on."""

_TEXT_FIELDS = (QLineEdit, QTextEdit, QPlainTextEdit, QAbstractSpinBox, QKeySequenceEdit)
_ARROWS = {"Left", "Right", "Up", "Down", "Home", "End", "PgUp", "PgDown", "Shift+Left", "Shift+Right"}
_OWN_KEYS: tuple[tuple[type | tuple[type, ...], set[str]], ...] = (
    (QAbstractButton, {"Space"}),
    ((QAbstractSlider, QAbstractItemView, QComboBox, QTabBar), {"Space", *_ARROWS}),
)
"""Keys by which a control is worked: while it has the focus, they belong to it."""

_PLAYING = {"Space", "Left", "Right", "Shift+Left", "Shift+Right"}
"""Keys that a list with the property ``gives_way`` leaves to the page."""


def keeps(widget: QWidget | None, key: str) -> bool:
    """Return whether the focused ``widget`` needs this key for itself."""
    if isinstance(widget, _TEXT_FIELDS) or (isinstance(widget, QComboBox) and widget.isEditable()):
        return True
    if widget is not None and widget.property("gives_way") and key in _PLAYING:
        return False
    return any(isinstance(widget, kind) and key in own for kind, own in _OWN_KEYS)


def conflict(wanted: str, action: str, keys: Mapping[str, tuple[str, ...]]) -> str:
    """Return the other action that has the key ``wanted``, or an empty word."""
    plain = QKeySequence(wanted).toString(QKeySequence.SequenceFormat.PortableText)
    return next((other for other, has in keys.items() if other != action and plain in has), "")


def keys_in_force(changed: Mapping[str, tuple[str, ...]], *, clicker: bool = False) -> dict[str, tuple[str, ...]]:
    """Return the keys of every action of the table, with the user's changes."""
    keys = {key.action: changed.get(key.action, key.keys) for key in TABLE}
    if clicker:
        taken = {sequence for action, has in keys.items() if action != "record" for sequence in has}
        keys["record"] = (*keys["record"], *(k for k in CLICKER if k not in taken and k not in keys["record"]))
    return keys


def in_words(keys: Iterable[str]) -> str:
    """Return keys as this system writes them."""
    shown = (QKeySequence(key).toString(QKeySequence.SequenceFormat.NativeText) for key in keys)
    return " · ".join(shown)


class Keys(QObject):
    """The shortcuts of one window."""

    triggered = Signal(str)
    """The action of a key that was pressed."""

    def __init__(self, window: QWidget) -> None:
        super().__init__(window)
        self._window = window
        self._offered: tuple[str, ...] = ()
        self.in_force = keys_in_force({})
        self._shortcuts: list[QShortcut] = []
        application = QApplication.instance()
        assert isinstance(application, QApplication)
        application.focusChanged.connect(self._on_focus_changed)

    @property
    def offered(self) -> tuple[Key, ...]:
        """The rows of the table whose functions exist."""
        return tuple(key for key in TABLE if key.action in self._offered)

    def offer(self, actions: Iterable[str]) -> None:
        """Bind these actions too: their functions exist."""
        known = {key.action for key in TABLE}
        wanted = {*self._offered, *actions}
        assert wanted <= known, wanted - known
        self._offered = tuple(key.action for key in TABLE if key.action in wanted)
        self._bind()

    def use(self, changed: Mapping[str, tuple[str, ...]], *, clicker: bool) -> None:
        """Take over the user's keys."""
        self.in_force = keys_in_force(changed, clicker=clicker)
        self._bind()

    def _bind(self) -> None:
        for shortcut in self._shortcuts:
            shortcut.setEnabled(False)
            shortcut.deleteLater()
        self._shortcuts = []
        for action in self._offered:
            for sequence in self.in_force[action]:
                shortcut = QShortcut(QKeySequence(sequence), self._window)
                shortcut.setContext(Qt.ShortcutContext.WindowShortcut)
                # A recording is not started and stopped again by a key that is held down.
                shortcut.setAutoRepeat(action in ("frame_back", "frame_forward", "frames_back", "frames_forward"))
                shortcut.setProperty("action", action)
                shortcut.activated.connect(self._on_activated)
                self._shortcuts.append(shortcut)
        self._on_focus_changed(None, QApplication.focusWidget())

    def _on_activated(self) -> None:
        self.triggered.emit(self.sender().property("action"))

    def _on_focus_changed(self, _: QWidget | None, focused: QWidget | None) -> None:
        for shortcut in self._shortcuts:
            key = shortcut.key().toString(QKeySequence.SequenceFormat.PortableText)
            shortcut.setEnabled(not keeps(focused, key))
