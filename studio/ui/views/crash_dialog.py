"""Our own mistake: what it means for the recording, and where the report is."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QFontDatabase, QGuiApplication
from PySide6.QtWidgets import QDialog, QHBoxLayout, QLabel, QPlainTextEdit, QPushButton, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, pixmap
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, Theme

WIDTH, HEIGHT = 640, 440  # px at 100 %


class CrashDialog(QDialog):
    """Shown beside the window, which goes on as far as it can; it blocks nothing."""

    folder_requested = Signal()

    def __init__(self, theme: Theme, file: str, report: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.report = QPlainTextEdit(report, self)
        self.copy = QPushButton(self.tr("Copy report"), self)
        self.folder = QPushButton(self.tr("Open folder"), self)
        self.close_button = QPushButton(self.tr("Close"), self)
        self._file = QLabel(file, self)
        self._told = QLabel(self)
        self._mark = QLabel(self)
        self._build()
        self.restyle()

    def restyle(self) -> None:
        """Take over colours and text size."""
        size = round(SIZE * 1.5 * max(self._theme.text_scale, 1.0))
        self._mark.setPixmap(pixmap("problem", self._theme.tokens.bad, size))
        font = QFontDatabase.systemFont(QFontDatabase.SystemFont.FixedFont)
        font.setPixelSize(self._theme.pixels("caption"))
        self.report.setFont(font)

    def _build(self) -> None:
        self.setModal(False)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle(self.tr("Something went wrong"))
        title = QLabel(self.tr("Something went wrong in the studio."), self)
        title.setProperty("role", "section")
        text = QLabel(
            self.tr(
                "This is our mistake, not yours. What was recorded so far is on the disk: if the studio has to close, "
                "the take is recovered at the next start. The report below stays on this computer. It holds no take "
                "and no person; sending it to us helps to mend this."
            ),
            self,
        )
        for label in (title, text, self._file):
            label.setWordWrap(True)
        self._file.setProperty("role", "caption")
        self._file.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.report.setReadOnly(True)
        self.report.setTabChangesFocus(True)
        self.report.setAccessibleName(self.tr("Report"))
        self._told.setProperty("tone", "good")
        self.copy.setProperty("kind", "primary")
        for button in (self.copy, self.folder, self.close_button):
            button.setAccessibleName(button.text())
        head = QHBoxLayout()
        head.setSpacing(GAP_WIDE)
        head.addWidget(self._mark)
        head.addWidget(title, 1)
        row = QHBoxLayout()
        row.setSpacing(GAP)
        for part in (self.copy, self.folder, self._told):
            row.addWidget(part)
        row.addStretch(1)
        row.addWidget(self.close_button)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_PAGE, GAP_PAGE, GAP_PAGE, GAP_PAGE)
        column.setSpacing(GAP_WIDE)
        column.addLayout(head)
        column.addWidget(text)
        column.addWidget(self.report, 1)
        column.addWidget(self._file)
        column.addLayout(row)
        self.resize(round(WIDTH * max(self._theme.text_scale, 1.0)), round(HEIGHT * max(self._theme.text_scale, 1.0)))
        self.copy.setFocus()
        self.copy.clicked.connect(self._on_copy)
        self.folder.clicked.connect(self.folder_requested)
        self.close_button.clicked.connect(self.close)

    def _on_copy(self) -> None:
        QGuiApplication.clipboard().setText(self.report.toPlainText())
        self._told.setText(self.tr("✔ Copied"))
