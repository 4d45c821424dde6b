"""What stands between now and a good recording, each with the button that mends it."""

from collections.abc import Sequence

from PySide6.QtCore import QPoint, Qt, Signal
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, pixmap
from studio.ui.models.readiness import Problem
from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.focus import give_back

WIDTH = 520  # px at 100 %


class ProblemList(QFrame):
    """Opens above the strip, inside the window; Esc or a second click closes it."""

    fix_requested = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme
        self._problems: tuple[Problem, ...] = ()
        self._opener: QWidget | None = None
        self._before: QWidget | None = None
        self.buttons: list[QPushButton] = []
        self.setProperty("ground", "floating")
        self.setAccessibleName(self.tr("What to do"))
        self._area = QScrollArea(self)
        self._area.setWidgetResizable(True)
        self._area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.addWidget(self._area)
        self.hide()

    def show_problems(self, problems: Sequence[Problem]) -> None:
        """Show these; nothing happens when they are the same as before."""
        if tuple(problems) == self._problems:
            return
        self._problems = tuple(problems)
        if self.isVisible():
            if not problems:
                self.close_list()
                return
            self._fill()
            self._place()

    def toggle(self, above: QWidget) -> None:
        """Open above a widget, or close."""
        if self.isVisible():
            self.close_list()
            return
        self._opener, self._before = above, above.window().focusWidget()
        self.setParent(above.window())
        self._fill()
        self._place()
        self.show()
        self.raise_()
        if self.buttons:
            self.buttons[0].setFocus(Qt.FocusReason.PopupFocusReason)

    def close_list(self) -> None:
        """Close."""
        if self.isHidden():
            return
        if self.isAncestorOf(self.window().focusWidget() or self.window()):
            give_back(self._before, self.window())
        self.hide()

    def restyle(self) -> None:
        """Take over colours and text size."""
        if self.isVisible():
            self._fill()
            self._place()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Esc closes the list."""
        if event.key() == Qt.Key.Key_Escape:
            self.close_list()
        else:
            super().keyPressEvent(event)

    def _fill(self) -> None:
        sheet = QWidget(self._area)
        grid = QGridLayout(sheet)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setSpacing(GAP)
        grid.setColumnStretch(1, 1)
        self.buttons = []
        for row, problem in enumerate(self._problems):
            mark = QLabel(sheet)
            mark.setPixmap(pixmap("warning", self._theme.tokens.warn, round(SIZE * max(self._theme.text_scale, 1.0))))
            text = QLabel(problem.text, sheet)
            text.setWordWrap(True)
            grid.addWidget(mark, row, 0)
            grid.addWidget(text, row, 1)
            if problem.fix:
                button = QPushButton(problem.fix, sheet)
                button.setProperty("fix", problem.fix_id)
                button.setAccessibleName(problem.fix)
                button.setAccessibleDescription(problem.text)
                button.clicked.connect(self._on_fix)
                grid.addWidget(button, row, 2)
                self.buttons.append(button)
        grid.setRowStretch(len(self._problems), 1)
        self._area.setWidget(sheet)

    def _place(self) -> None:
        opener, sheet, window = self._opener, self._area.widget(), self.window()
        layout = sheet.layout() if sheet is not None else None
        if opener is None or sheet is None or layout is None:
            return
        corner = opener.mapTo(window, QPoint(0, 0))
        width = min(round(WIDTH * max(self._theme.text_scale, 1.0)), window.width() - 2 * GAP_WIDE)
        sheet.ensurePolished()
        wanted = (
            layout.heightForWidth(width - 2 * GAP_WIDE) if layout.hasHeightForWidth() else sheet.sizeHint().height()
        )
        height = min(wanted + 2 * GAP_WIDE + GAP, corner.y() - 2 * GAP)
        self.setGeometry(corner.x() + GAP, corner.y() - height - GAP, width, height)

    def _on_fix(self) -> None:
        fix = self.sender().property("fix")
        self.close_list()
        self.fix_requested.emit(fix)
