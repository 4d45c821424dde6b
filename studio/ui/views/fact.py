"""One number of the strip: its value above its name."""

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QVBoxLayout, QWidget

from studio.ui.style_sheet import set_look
from studio.ui.views.elided import ElidedLabel

_SHAPES = {"good": "✔ ", "warn": "▲ ", "": ""}


class Fact(QWidget):
    """A value with a mark beside it when it is good or amiss."""

    def __init__(self, name: str, widest: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._name = name
        self._widest = widest
        self._tone = ""
        self._value = ElidedLabel(self) if not widest else QLabel(self)
        self._caption = QLabel(name, self)
        self._caption.setProperty("role", "caption")
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self._value)
        column.addWidget(self._caption)

    @property
    def value(self) -> str:
        """What is shown."""
        return self._value.text()

    def show_value(self, value: str, tone: str) -> None:
        """Show a value; ``tone`` is good, warn or empty."""
        words = _SHAPES[tone] + value
        if words != self._value.text():
            self._value.setText(words)
            self.setAccessibleName(f"{self._name}: {value}")
            if isinstance(self._value, ElidedLabel):
                self.setToolTip(value)
        if tone != self._tone:
            self._tone = tone
            set_look(self._value, tone="warn" if tone == "warn" else "")

    def restyle(self) -> None:
        """Make room for the widest value, so that the strip never moves."""
        self._value.setAlignment(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft)
        self._value.ensurePolished()
        metrics = self._value.fontMetrics()
        self._value.setMinimumWidth(max((metrics.horizontalAdvance(text) for text in self._widest), default=0))
