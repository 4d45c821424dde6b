"""Three hints for the first start, one after the other, and never again once they were dismissed."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.flow import FlowLayout


class CoachMarks(QFrame):
    """Says one thing about the figure, the strip and the record key; the arrow points to it."""

    dismissed = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._at = 0
        self._hints = (
            self.tr("▲  Drag the figure to turn it, scroll to come closer."),
            self.tr("▼  The strip below always tells whether you can record, and what to do if not."),
            self.tr("▼  Press R to record, and R again to stop. It works with the simulated performer too."),
        )
        self.text = QLabel(self)
        self.next = QPushButton(self.tr("Next"), self)
        self.done = QPushButton(self.tr("Got it, don't show again"), self)
        self._count = QLabel(self)
        self.setProperty("ground", "raised")
        self.setAccessibleName(self.tr("Hints"))
        self.text.setWordWrap(True)
        self._count.setProperty("role", "caption")
        self.done.setProperty("kind", "quiet")
        self.next.setAccessibleName(self.tr("Next hint"))
        self.done.setAccessibleName(self.tr("Don't show hints again"))
        answers = QWidget(self)
        flow = FlowLayout(answers, gap=GAP, line_gap=GAP)
        for part in (self._count, self.next, self.done):
            flow.addWidget(part)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP, GAP_WIDE, GAP)
        column.setSpacing(GAP)
        column.addWidget(self.text)
        column.addWidget(answers)
        self.next.clicked.connect(self._on_next)
        self.done.clicked.connect(self._on_done)
        self._show()

    def _show(self) -> None:
        last = self._at == len(self._hints) - 1
        self.text.setText(self._hints[self._at])
        self._count.setText(self.tr("{n} of {m}").format(n=self._at + 1, m=len(self._hints)))
        self.next.setVisible(not last)

    def _on_next(self) -> None:
        self._at += 1
        self._show()
        if self.next.isHidden():
            self.done.setFocus()

    def _on_done(self) -> None:
        self.hide()
        self.dismissed.emit()
