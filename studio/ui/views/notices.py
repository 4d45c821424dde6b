"""What the studio has to say: short notices that leave by themselves, and a banner that stays until it is answered."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

from PySide6.QtCore import QEvent, QObject, QPoint, QRect, QSize, Qt, Signal
from PySide6.QtWidgets import QBoxLayout, QFrame, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, icon, pixmap
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.announcement import announce
from studio.ui.views.flow import FlowLayout
from studio.ui.views.focus import give_back

Tone = Literal["good", "warn", "bad"]

SHOWN_FOR = 2.0  # s
TOAST_WIDTH = 720  # px at 100 %
_SHAPES: dict[Tone, str] = {"good": "ready", "warn": "warning", "bad": "problem"}


class Action(NamedTuple):
    """A button of a notice."""

    id: str
    label: str


class Toast(QFrame):
    """One short notice. It stays while it is pointed at or has the focus, and never lies on the record button."""

    acted = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme
        self._host = parent
        self._tone: Tone = "good"
        self._since: float | None = None
        self._clear_of: list[QWidget] = []
        self._buttons: list[QPushButton] = []
        self.setProperty("ground", "floating")
        self._mark = QLabel(self)
        self._text = QLabel(self)
        self._text.setTextFormat(Qt.TextFormat.PlainText)
        self._text.setWordWrap(True)
        self._text.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self._actions = QHBoxLayout()
        self._actions.setSpacing(GAP)
        words = QHBoxLayout()
        words.setSpacing(GAP)
        words.addWidget(self._mark)
        words.addWidget(self._text, 1)
        self._box = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._box.setContentsMargins(GAP_WIDE, GAP, GAP_WIDE, GAP)
        self._box.setSpacing(GAP_WIDE)
        self._box.addLayout(words, 1)
        self._box.addLayout(self._actions)
        parent.installEventFilter(self)
        self.hide()

    def keep_clear_of(self, widget: QWidget) -> None:
        """Never cover this widget."""
        self._clear_of.append(widget)

    def say(self, text: str, actions: Sequence[Action] = (), tone: Tone = "good") -> None:
        """Show a notice instead of the one that is shown."""
        self._tone, self._since = tone, None
        self._text.setText(text)
        self.setAccessibleName(text)
        for button in self._buttons:
            self._actions.removeWidget(button)
            button.hide()
            button.deleteLater()
        self._buttons = [_button(action, self, self._on_clicked) for action in actions]
        for button in self._buttons:
            self._actions.addWidget(button)
        self.show()  # before its size is asked for: a layout that is hidden keeps the old one
        self.restyle()
        self.raise_()
        announce(self, text)

    def tick(self, now: float) -> None:
        """Let time pass: the notice leaves after two seconds in which nobody attended to it."""
        if self.isHidden():
            return
        focused = self.focusWidget()
        attended = self.underMouse() or (focused is not None and focused.hasFocus())
        if self._since is None or attended:
            self._since = now
        elif now - self._since >= SHOWN_FOR:
            self.hide()

    def place(self) -> None:
        """Take the lower left corner of the parent, or the upper one when the record button is there."""
        room = self._host.rect().adjusted(GAP_PAGE, GAP_PAGE, -GAP_PAGE, -GAP_PAGE)
        most = min(round(TOAST_WIDTH * max(self._theme.text_scale, 1.0)), room.width())
        size = self._size_within(most)
        lower = QRect(QPoint(room.left(), room.bottom() - size.height()), size)
        upper = QRect(room.topLeft(), size)
        self.setGeometry(upper if self._covers(lower) else lower)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 (Qt's name)
        """Move with the corner it stands in."""
        if event.type() == QEvent.Type.Resize and self.isVisible():
            self.place()
        return super().eventFilter(watched, event)

    def restyle(self) -> None:
        """Take over colours and text size."""
        colour = getattr(self._theme.tokens, self._tone)
        self._mark.setPixmap(pixmap(_SHAPES[self._tone], colour, _icon_size(self._theme)))
        self.place()

    def _size_within(self, most: int) -> QSize:
        """Lay words and actions side by side, below each other, or with broken lines, and return the size."""
        margins = self._box.contentsMargins()
        around = margins.left() + margins.right() + 2 * self.frameWidth()
        words = self._mark.sizeHint().width() + GAP + self._text.fontMetrics().horizontalAdvance(self._text.text()) + 1
        actions = self._actions.sizeHint()
        beside = words + GAP_WIDE + actions.width() if self._buttons else words
        is_beside = beside + around <= most
        wide = (beside if is_beside else max(words, actions.width())) + around
        self._box.setDirection(QBoxLayout.Direction.LeftToRight if is_beside else QBoxLayout.Direction.TopToBottom)
        self._text.setWordWrap(wide > most)
        width = min(wide, most)
        line = width - around - self._mark.sizeHint().width() - GAP
        height = self._text.heightForWidth(line) if wide > most else self._text.fontMetrics().height()
        height = max(height, self._mark.sizeHint().height())
        if self._buttons:
            height = max(height, actions.height()) if is_beside else height + GAP_WIDE + actions.height()
        return QSize(width, height + margins.top() + margins.bottom() + 2 * self.frameWidth())

    def _covers(self, area: QRect) -> bool:
        for widget in self._clear_of:
            if widget.isVisible():
                corner = self._host.mapFromGlobal(widget.mapToGlobal(QPoint(0, 0)))
                if area.intersects(QRect(corner, widget.size())):
                    return True
        return False

    def _on_clicked(self) -> None:
        action = self.sender().property("action")
        give_back(None, self.window())
        self.hide()
        self.acted.emit(action)


class Banner(QFrame):
    """A message that stays: what happened, why, what to do. The newest is shown, the others wait behind it."""

    acted = Signal(str)
    closed = Signal(str)
    """Id of the message that was put away."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._messages: dict[str, tuple[str, str, str, tuple[Action, ...], Tone]] = {}
        self._buttons: list[QPushButton] = []
        self.setProperty("ground", "raised")
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self._mark = QLabel(self)
        self._what, self._why, self._do = QLabel(self), QLabel(self), QLabel(self)
        self._waiting = QLabel(self)
        self.close_button = QPushButton(self)
        self._build()

    @property
    def shown(self) -> str:
        """Id of the message that is shown, or an empty word."""
        return next(reversed(self._messages), "")

    def put(
        self, message: str, what: str, why: str, do: str, actions: Sequence[Action] = (), tone: Tone = "warn"
    ) -> None:
        """Show a message with at most two actions; one with the same id is replaced."""
        assert len(actions) <= 2, "more than two choices are a page"
        self._messages.pop(message, None)
        self._messages[message] = (what, why, do, tuple(actions), tone)
        self._fill()
        announce(self, " ".join(part for part in (what, why, do) if part))

    def take_away(self, message: str) -> None:
        """Remove a message, if it is there: what it told is over."""
        if self._messages.pop(message, None) is not None:
            self._fill()

    def restyle(self) -> None:
        """Take over colours and text size."""
        size = _icon_size(self._theme)
        self.close_button.setIconSize(QSize(size, size))
        self.close_button.setIcon(icon("close", self._theme.tokens.muted, size))
        self._fill()

    def _build(self) -> None:
        self._what.setProperty("role", "strong")
        self._waiting.setProperty("role", "caption")
        for label in (self._what, self._why, self._do):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
        self._why.setProperty("role", "muted")
        self.close_button.setProperty("kind", "quiet")
        self.close_button.setAccessibleName(self.tr("Put this message away"))
        self.close_button.setToolTip(self.tr("Put this message away"))
        self.close_button.clicked.connect(self._on_closed)
        words = QVBoxLayout()
        words.setSpacing(GRID)
        for label in (self._what, self._why, self._do):
            words.addWidget(label)
        choices = QWidget(self)
        self._choices = FlowLayout(choices, gap=GAP, line_gap=GRID)
        words.addWidget(choices)
        row = QHBoxLayout(self)
        row.setContentsMargins(GAP_WIDE, GAP, GAP, GAP)
        row.setSpacing(GAP_WIDE)
        row.addWidget(self._mark, 0, Qt.AlignmentFlag.AlignTop)
        row.addLayout(words, 1)
        row.addWidget(self._waiting, 0, Qt.AlignmentFlag.AlignTop)
        row.addWidget(self.close_button, 0, Qt.AlignmentFlag.AlignTop)
        self.restyle()

    def _fill(self) -> None:
        for button in self._buttons:
            self._choices.removeWidget(button)
            button.hide()
            button.deleteLater()
        self._buttons = []
        self.setVisible(bool(self._messages))
        if not self._messages:
            return
        what, why, do, actions, tone = self._messages[self.shown]
        theme = self._theme
        self._mark.setPixmap(pixmap(_SHAPES[tone], getattr(theme.tokens, tone), _icon_size(theme)))
        for label, text in ((self._what, what), (self._why, why), (self._do, do)):
            label.setText(text)
            label.setVisible(bool(text))
        self.setAccessibleName(what)
        self.setAccessibleDescription(f"{why} {do}".strip())
        waiting = len(self._messages) - 1
        self._waiting.setText(self.tr("{count} more").format(count=waiting) if waiting else "")
        self._buttons = [_button(action, self, self._on_clicked) for action in actions]
        for button in self._buttons:
            self._choices.addWidget(button)
        parent = self._choices.parentWidget()
        if parent is not None:
            parent.setVisible(bool(self._buttons))

    def _on_clicked(self) -> None:
        action = self.sender().property("action")
        self.take_away(self.shown)
        self.acted.emit(action)

    def _on_closed(self) -> None:
        message = self.shown
        self.take_away(message)
        self.closed.emit(message)


def _button(action: Action, parent: QFrame, clicked: object) -> QPushButton:
    button = QPushButton(action.label, parent)
    button.setProperty("action", action.id)
    button.setAccessibleName(action.label)
    button.clicked.connect(clicked)
    button.ensurePolished()  # or its size is asked for before the style sheet has its say
    return button


def _icon_size(theme: Theme) -> int:
    return round(SIZE * max(theme.text_scale, 1.0))
