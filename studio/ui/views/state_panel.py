"""What stands where a take would be: nothing chosen, being computed, or why it cannot be shown."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QProgressBar, QPushButton, QScrollArea, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, Theme
from studio.ui.views.announcement import announce
from studio.ui.wording import Message

WIDTH = 480  # px at 100 % text


class StatePanel(QScrollArea):
    """A few sentences in the middle, a bar while something is under way, at most one button."""

    acted = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._what, self._why, self._do = QLabel(self), QLabel(self), QLabel(self)
        self._bar = QProgressBar(self)
        self.button = QPushButton(self)
        self._build()
        self.restyle()

    def show_words(self, what: str, why: str = "", do: str = "", action: str = "") -> None:
        """Say something; ``action`` is the word on the button."""
        self._fill(what, why, do, action)
        self._what.setProperty("tone", "")
        self._bar.hide()

    def show_refusal(self, message: Message, action: str = "") -> None:
        """Say why something was refused and what helps."""
        self.show_words(f"▲ {message.what}", message.why, message.do, action)
        announce(self, message.what)

    def show_progress(self, what: str, share: float) -> None:
        """Say what is being done; ``share`` is 0…1, and below 0 nobody knows."""
        if what != self._what.text():
            self._fill(what, "", "", "")
        self._bar.setRange(0, 0 if share < 0.0 else 100)
        self._bar.setValue(round(100 * max(share, 0.0)))
        self._bar.show()

    def text(self) -> str:
        """Return what is said."""
        return " ".join(label.text() for label in (self._what, self._why, self._do) if label.text())

    def restyle(self) -> None:
        """Take over text sizes."""
        self._column.setMaximumWidth(round(WIDTH * max(self._theme.text_scale, 1.0)))

    def _build(self) -> None:
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._what.setProperty("role", "section")
        self._why.setProperty("role", "muted")
        self._bar.setTextVisible(False)
        self._bar.setFixedHeight(GAP)
        self._bar.setAccessibleName(self.tr("Progress"))
        self._column = QWidget(self)
        column = QVBoxLayout(self._column)
        column.setContentsMargins(GAP_PAGE, GAP_PAGE, GAP_PAGE, GAP_PAGE)
        column.setSpacing(GAP)
        for label in (self._what, self._why, self._do):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            column.addWidget(label)
        column.addWidget(self._bar)
        column.addSpacing(GAP_WIDE - GAP)
        column.addWidget(self.button, 0, Qt.AlignmentFlag.AlignLeft)
        page = QWidget(self)
        middle = QVBoxLayout(page)
        middle.setContentsMargins(0, 0, 0, 0)
        across = QHBoxLayout()
        across.addStretch(1)
        across.addWidget(self._column, WIDTH)
        across.addStretch(1)
        middle.addStretch(2)
        middle.addLayout(across)
        middle.addStretch(3)
        self.setWidget(page)
        self.button.setProperty("kind", "primary")
        self.button.clicked.connect(self.acted)

    def _fill(self, what: str, why: str, do: str, action: str) -> None:
        for label, words in ((self._what, what), (self._why, why), (self._do, do)):
            label.setText(words)
            label.setVisible(bool(words))
        self.button.setText(action)
        self.button.setAccessibleName(action)
        self.button.setVisible(bool(action))
        self.setAccessibleName(what)
        self.setAccessibleDescription(f"{why} {do}".strip())
