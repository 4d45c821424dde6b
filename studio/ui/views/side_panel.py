"""The column beside a page: it scrolls where large text needs more height than the window has."""

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QFrame, QScrollArea, QVBoxLayout, QWidget

from studio.ui.theme import GAP, Theme


class SidePanel(QScrollArea):
    """A panel with one column, never wider than a share of its page."""

    def __init__(self, theme: Theme, width: int, share: float, margin: int, parent: QWidget) -> None:
        """``width`` in px at 100 % text; ``share`` of the page it may take; ``margin`` in px around the column."""
        super().__init__(parent)
        self._theme, self._wanted, self._share = theme, width, share
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        inside = QFrame(self)
        inside.setProperty("ground", "panel")
        self.column = QVBoxLayout(inside)
        self.column.setContentsMargins(margin, margin, margin, margin)
        self.column.setSpacing(GAP)
        self.setWidget(inside)

    def fit(self, page_width: int) -> None:
        """Take the width the text needs, on a page of ``page_width`` px."""
        wanted = round(self._wanted * max(self._theme.text_scale, 1.0))
        self.setFixedWidth(min(wanted, round(page_width * self._share)))
