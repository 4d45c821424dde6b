"""A question inside the window: it covers little, stops nothing, and its safe answer has the focus."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QLabel, QLineEdit, QPushButton, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, Theme
from studio.ui.views.flow import FlowLayout
from studio.ui.views.focus import give_back

WIDTH = 440  # px at 100 %


class Sheet(QFrame):
    """Two answers, and one line to fill in where it is asked for."""

    accepted = Signal(str, str)
    """Id of the question, and the line."""
    refused = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme
        self._host = parent
        self._question = ""
        self._before: QWidget | None = None
        self.setProperty("ground", "floating")
        self._title, self._text = QLabel(self), QLabel(self)
        self.line = QLineEdit(self)
        self.yes, self.no = QPushButton(self), QPushButton(self)
        self._build()
        self.hide()

    @property
    def question(self) -> str:
        """Id of the question that is open, or an empty word."""
        return self._question

    def ask(self, question: str, title: str, text: str, yes: str, no: str, *, line: str = "") -> None:
        """Ask; ``line`` is the name of the line to fill in, empty for none. Asking again changes nothing."""
        if question == self._question:
            return
        self._question = question
        self._before = self.window().focusWidget()
        self.setAccessibleName(title)
        self.setAccessibleDescription(text)
        self._title.setText(title)
        self._text.setText(text)
        for button, words in ((self.yes, yes), (self.no, no)):
            button.setText(words)
            button.setAccessibleName(words)
        self.line.clear()
        self.line.setVisible(bool(line))
        self.line.setAccessibleName(line)
        self.line.setPlaceholderText(line)
        self.yes.setEnabled(not line)
        self.restyle()
        self.show()
        self.raise_()
        (self.line if line else self.no).setFocus(Qt.FocusReason.PopupFocusReason)

    def withdraw(self) -> None:
        """Close without an answer: the question is over."""
        if self._question:
            self._question = ""
            give_back(self._before, self.window())
            self.hide()

    def place(self) -> None:
        """Stand in the upper third of the parent."""
        room = self._host.rect().adjusted(GAP_PAGE, GAP_PAGE, -GAP_PAGE, -GAP_PAGE)
        width = min(round(WIDTH * max(self._theme.text_scale, 1.0)), room.width())
        layout = self.layout()
        wanted = layout.totalHeightForWidth(width) if layout is not None else 0
        height = min(max(wanted, self.minimumSizeHint().height()), room.height())
        self.setGeometry(
            room.left() + (room.width() - width) // 2, room.top() + (room.height() - height) // 3, width, height
        )

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.ensurePolished()
        self.place()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Esc is the safe answer."""
        if event.key() == Qt.Key.Key_Escape:
            self.refuse()
        else:
            super().keyPressEvent(event)

    def _build(self) -> None:
        self._title.setProperty("role", "section")
        for label in (self._title, self._text):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
        self.yes.setProperty("kind", "primary")
        for button in (self.yes, self.no):
            button.setAutoDefault(True)
        answers = QWidget(self)
        flow = FlowLayout(answers, gap=GAP, line_gap=GAP)
        flow.addWidget(self.yes)
        flow.addWidget(self.no)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_PAGE, GAP_PAGE, GAP_PAGE, GAP_PAGE)
        column.setSpacing(GAP_WIDE)
        for part in (self._title, self._text, self.line, answers):
            column.addWidget(part)
        self.yes.clicked.connect(self._on_yes)
        self.no.clicked.connect(self.refuse)
        self.line.textChanged.connect(self._on_typed)
        self.line.returnPressed.connect(self._on_yes)

    def _on_typed(self, text: str) -> None:
        self.yes.setEnabled(bool(text.strip()) or self.line.isHidden())

    def _on_yes(self) -> None:
        question = self._question
        if question and self.yes.isEnabled():
            self.withdraw()
            self.accepted.emit(question, self.line.text().strip())

    def refuse(self) -> None:
        """Give the safe answer."""
        question = self._question
        if question:
            self.withdraw()
            self.refused.emit(question)
