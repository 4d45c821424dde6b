"""Text size and theme, wherever they are offered."""

from PySide6.QtCore import QSize, Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QPushButton, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.theme import GRID, LARGEST_TEXT, SMALLEST_TEXT, Theme
from studio.ui.views.segments import Segments

SIZES = (SMALLEST_TEXT, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, LARGEST_TEXT)


def next_size(scale: float, step: int) -> float:
    """Return the size ``step`` places further in SIZES; 0 is the normal one."""
    if step == 0:
        return 1.0
    if step > 0:
        return min((size for size in SIZES if size > scale + 1e-9), default=LARGEST_TEXT)
    return max((size for size in SIZES if size < scale - 1e-9), default=SMALLEST_TEXT)


class TextSize(QWidget):
    """Smaller, the size in percent, larger, normal."""

    chosen = Signal(float)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.smaller, self.larger, self.normal = QPushButton(self), QPushButton(self), QPushButton(self)
        self._shown = QLabel(self)
        self._shown.setAccessibleName(self.tr("Text size"))
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID)
        for button, words in (
            (self.smaller, self.tr("Smaller text")),
            (self.larger, self.tr("Larger text")),
            (self.normal, self.tr("Normal text size")),
        ):
            button.setAccessibleName(words)
            button.setToolTip(words)
            button.setProperty("kind", "quiet")
        self.normal.setText(self.tr("100 %"))
        for part in (self.smaller, self._shown, self.larger, self.normal):
            row.addWidget(part)
        row.addStretch(1)
        self.smaller.clicked.connect(self._on_smaller)
        self.larger.clicked.connect(self._on_larger)
        self.normal.clicked.connect(self._on_normal)
        self.restyle()

    def restyle(self) -> None:
        """Take over colours and text size."""
        scale = self._theme.text_scale
        size = round(SIZE * max(scale, 1.0))
        for button, name in ((self.smaller, "minus"), (self.larger, "plus")):
            button.setIconSize(QSize(size, size))
            button.setIcon(icon(name, self._theme.tokens.text, size))
        self._shown.setText(self.tr("{percent} %").format(percent=round(scale * 100)))
        self.smaller.setEnabled(scale > SMALLEST_TEXT)
        self.larger.setEnabled(scale < LARGEST_TEXT)
        self.normal.setVisible(abs(scale - 1) > 1e-9)

    def _on_smaller(self) -> None:
        self.chosen.emit(next_size(self._theme.text_scale, -1))

    def _on_larger(self) -> None:
        self.chosen.emit(next_size(self._theme.text_scale, 1))

    def _on_normal(self) -> None:
        self.chosen.emit(1.0)


class SchemeChoice(QWidget):
    """As the system, light, dark."""

    chosen = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        words = {"system": self.tr("System"), "light": self.tr("Light"), "dark": self.tr("Dark")}
        self.segments = Segments(words, self.tr("Theme: {word}"), self)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.segments)
        row.addStretch(1)
        self.segments.chosen.connect(self.chosen)
        self.restyle()

    def restyle(self) -> None:
        """Show the choice in force."""
        self.segments.choose(self._theme.scheme)
