"""One file format to choose: what it is called, and what it is for."""

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme

WIDTH = 232  # px at 100 % text


class FormatCard(QPushButton):
    """A button of two texts; one of its group is chosen."""

    def __init__(self, theme: Theme, key: str, title: str, text: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._words = title
        self.key = key
        self.setCheckable(True)
        self.setAutoExclusive(True)
        self.setAccessibleName(title)
        self.setAccessibleDescription(text)
        self.setSizePolicy(QSizePolicy.Policy.Fixed, QSizePolicy.Policy.Fixed)
        self._title, self._text = QLabel(self), QLabel(text, self)
        self._title.setProperty("role", "strong")
        self._text.setProperty("role", "caption")
        self._text.setAlignment(Qt.AlignmentFlag.AlignTop | Qt.AlignmentFlag.AlignLeft)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP + GRID, GAP_WIDE, GAP + GRID)
        column.setSpacing(GRID)
        for label in (self._title, self._text):
            label.setWordWrap(True)
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            column.addWidget(label)
        column.addStretch(1)
        self.toggled.connect(self._show_chosen)
        self._show_chosen(on=False)

    def lines_height(self) -> int:
        """Return the height this card needs by itself, px."""
        self.ensurePolished()
        layout = self.layout()
        assert layout is not None
        return layout.totalHeightForWidth(self.wanted_width())

    def wanted_width(self) -> int:
        """Return the width of every card, px."""
        return round(WIDTH * max(self._theme.text_scale, 1.0))

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the size all cards have."""
        return QSize(self.wanted_width(), max(self.minimumHeight(), self.lines_height()))

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the same."""
        return self.sizeHint()

    def _show_chosen(self, on: bool) -> None:
        self._title.setText(f"✔ {self._words}" if on else self._words)
