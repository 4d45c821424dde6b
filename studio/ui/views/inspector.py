"""The panel at the right: what belongs to the selection of the page that is shown."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QScrollArea, QStackedWidget, QVBoxLayout, QWidget

from studio.ui.theme import Theme

WIDTH = 240  # px at 100 %: leaves 960 px to the page on a screen of 1280


class Inspector(QFrame):
    """Shows one page's panel at a time, and nothing when there is none."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._stack = QStackedWidget(self)
        self._areas: dict[QWidget, QScrollArea] = {}
        self.setProperty("ground", "panel")
        self.setAccessibleName(self.tr("Inspector"))
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self._stack)
        self.hide()
        self.restyle()

    def add_panel(self, panel: QWidget | None) -> None:
        """Take in a panel without showing it."""
        if panel is None or panel in self._areas:
            return
        area = QScrollArea(self._stack)
        area.setWidget(panel)
        area.setWidgetResizable(True)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._areas[panel] = area
        self._stack.addWidget(area)

    def show_panel(self, panel: QWidget | None) -> None:
        """Show a panel, or nothing."""
        self.add_panel(panel)
        self.setVisible(panel is not None)
        if panel is not None:
            self._stack.setCurrentWidget(self._areas[panel])

    def restyle(self) -> None:
        """Take over the text size; half of it, because the page needs the room more."""
        self.setFixedWidth(round(WIDTH * (1 + max(self._theme.text_scale - 1, 0) / 2)))
