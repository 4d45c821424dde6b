"""The rail: six steps from the sensor to the file, always in the same place."""

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QFrame, QToolButton, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.theme import GAP, GRID, Theme

PAGES = ("connect", "assign", "calibrate", "capture", "review", "export")


class Rail(QFrame):
    """One button for each page; the one that is shown is marked by a bar, its ground and its weight."""

    page_requested = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._shown = ""
        self.buttons: dict[str, QToolButton] = {}
        self.setProperty("ground", "panel")
        self.setAccessibleName(self.tr("Steps"))
        column = QVBoxLayout(self)
        column.setContentsMargins(GRID, GAP, GRID, GAP)
        column.setSpacing(GRID)
        for number, (name, words) in enumerate(self._words().items(), 1):
            button = QToolButton(self)
            button.setProperty("kind", "rail")
            button.setText(f"{number}  {words}")
            button.setAccessibleName(words)
            button.setAccessibleDescription(self.tr("Step {number} of 6").format(number=number))
            button.setCheckable(True)
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            button.setSizePolicy(button.sizePolicy().Policy.Expanding, button.sizePolicy().Policy.Fixed)
            button.setProperty("page", name)
            button.clicked.connect(self._on_clicked)
            self.buttons[name] = button
            column.addWidget(button)
        column.addStretch(1)
        self.restyle()

    def show_page(self, name: str) -> None:
        """Mark a page; none when it is not in the rail."""
        self._shown = name
        for page, button in self.buttons.items():
            button.setChecked(page == name)
        self.restyle()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Leave the icons out where there is no room for icon and word: the word tells more."""
        super().resizeEvent(event)
        self._make_room()

    def restyle(self) -> None:
        """Take over colours and text size."""
        tokens = self._theme.tokens
        size = round(SIZE * max(self._theme.text_scale, 1.0))
        for name, button in self.buttons.items():
            button.setIconSize(QSize(size, size))
            button.setIcon(icon(name, tokens.accent if name == self._shown else tokens.muted, size))
        self._make_room()

    def _make_room(self) -> None:
        style = Qt.ToolButtonStyle
        for shape in (style.ToolButtonTextUnderIcon, style.ToolButtonTextOnly):
            for button in self.buttons.values():
                button.setToolButtonStyle(shape)
            needed = sum(button.sizeHint().height() + GRID for button in self.buttons.values()) + 2 * GAP
            if needed <= self.height():
                return

    def _words(self) -> dict[str, str]:
        return {
            "connect": self.tr("Connect"),
            "assign": self.tr("Assign"),
            "calibrate": self.tr("Calibrate"),
            "capture": self.tr("Capture"),
            "review": self.tr("Review"),
            "export": self.tr("Export"),
        }

    def _on_clicked(self) -> None:
        # The click has marked the button already; only the page that is shown bears the mark.
        self.show_page(self._shown)
        self.page_requested.emit(self.sender().property("page"))
