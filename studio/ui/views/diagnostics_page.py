"""Diagnostics: what to send along when something is strange, as text that can be read before it is sent."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtGui import QFontDatabase, QGuiApplication
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, Theme


class DiagnosticsPage(QFrame):
    """Shows rows of names and values, and copies them."""

    copied = Signal()
    crash_folder_requested = Signal()
    """Show where crash reports are kept."""

    inspector: QWidget | None = None

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.report = QPlainTextEdit(self)
        self.copy = QPushButton(self.tr("Copy report"), self)
        self.folder = QPushButton(self.tr("Show crash reports"), self)
        self._told = QLabel(self)
        self._build()
        self.restyle()

    def show_rows(self, rows: Sequence[tuple[str, str]]) -> None:
        """Show these; a row with an empty value is a heading. Reading is not disturbed when nothing changed."""
        width = max((len(name) for name, value in rows if value), default=0)
        lines = [f"{name:<{width}}  {value}" if value else f"\n{name}" for name, value in rows]
        text = "\n".join(lines).strip("\n")
        if text == self.report.toPlainText():
            return
        at = self.report.verticalScrollBar().value()
        self.report.setPlainText(text)
        self.report.verticalScrollBar().setValue(at)
        self._told.clear()

    def restyle(self) -> None:
        """Take over colours and text size."""
        font = QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont)
        font.setPixelSize(self._theme.pixels("body"))
        self.report.setFont(font)

    def _build(self) -> None:
        self.setProperty("ground", "window")
        self.setAccessibleName(self.tr("Diagnostics"))
        title = QLabel(self.tr("Diagnostics"), self)
        title.setProperty("role", "page")
        about = QLabel(self.tr("Nothing of this leaves the computer unless you copy and send it."), self)
        about.setProperty("role", "muted")
        about.setWordWrap(True)
        self.report.setReadOnly(True)
        self.report.setTabChangesFocus(True)
        self.report.setAccessibleName(self.tr("Report"))
        self.copy.setProperty("kind", "primary")
        self.copy.setAccessibleName(self.tr("Copy report"))
        self.folder.setAccessibleName(self.tr("Show crash reports"))
        self._told.setProperty("tone", "good")
        row = QHBoxLayout()
        row.setSpacing(GAP)
        row.addWidget(self.copy)
        row.addWidget(self.folder)
        row.addWidget(self._told)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_PAGE, GAP_PAGE, GAP_PAGE, GAP_PAGE)
        column.setSpacing(GAP_WIDE)
        column.addWidget(title)
        column.addWidget(about)
        column.addWidget(self.report, 1)
        column.addLayout(row)
        self.copy.clicked.connect(self._on_copy)
        self.folder.clicked.connect(self.crash_folder_requested)

    def _on_copy(self) -> None:
        QGuiApplication.clipboard().setText(self.report.toPlainText())
        self._told.setText(self.tr("✔ Copied"))
        self.copied.emit()
