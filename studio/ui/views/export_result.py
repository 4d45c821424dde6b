"""What becomes of an export: how far it is, where the file lies, or why there is none."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QFrame, QLabel, QProgressBar, QPushButton, QVBoxLayout, QWidget

from studio.core.errors import StudioError
from studio.ui.fact_words import folder_in_words
from studio.ui.icons import SIZE, icon
from studio.ui.style_sheet import set_look
from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.announcement import announce
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.flow import FlowLayout
from studio.ui.wording import sentences


class ExportResult(QFrame):
    """Hidden until something was asked for."""

    show_requested = Signal(object)
    """A file to be shown in its folder."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._files: tuple[Path, ...] = ()
        self._title, self._text = QLabel(self), QLabel(self)
        self._path = ElidedLabel(self)
        self._bar = QProgressBar(self)
        self.show_file = QPushButton(self.tr("Show in folder"), self)
        self.copy = QPushButton(self.tr("Copy path"), self)
        self._build()
        self.restyle()
        self.hide()

    def show_progress(self, stage: str, share: float, number: int, total: int) -> None:
        """Show how far file ``number`` of ``total`` is; ``stage`` as the worker calls it, ``share`` of it 0…1."""
        words = {
            "read": self.tr("Reading the take…"),
            "solve": self.tr("Computing the motion…"),
            "write": self.tr("Writing, and reading it again to check…"),
        }.get(stage, self.tr("Starting…"))
        if total > 1:
            words = self.tr("File {n} of {total}. {stage}").format(n=number, total=total, stage=words)
        self._say("", words, "")
        self._bar.setValue(round(100 * (number - 1 + share) / max(total, 1)))
        self._show_parts(bar=True, files=())

    def show_done(self, files: Sequence[Path], notes: Sequence[str]) -> None:
        """Show that these files were written, read again and found right; ``notes`` are the solver's."""
        title = self.tr("✔ Done, checked.")
        if len(files) > 1:
            title = self.tr("✔ Done, checked: {n} files.").format(n=len(files))
        checked = self.tr("Each file was read again and compared with what was meant.")
        if len(files) == 1:
            checked = self.tr("The file was read again and compared with what was meant.")
        self._say("good", title, "\n".join([checked, *notes]))
        self._show_parts(bar=False, files=files)
        announce(self, title)

    def show_refusal(self, error: StudioError) -> None:
        """Show why there is no file."""
        message = sentences(error)
        title = self.tr("▲ {what}").format(what=message.what)
        self._say("bad", title, f"{message.why} {message.do}".strip())
        self._show_parts(bar=False, files=())
        announce(self, message.what)

    def text(self) -> str:
        """Return what is said."""
        return f"{self._title.text()} {self._text.text()}".strip()

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        size = round(SIZE * max(self._theme.text_scale, 1.0))
        for button, name in ((self.show_file, "folder"), (self.copy, "copy")):
            button.setIcon(icon(name, self._theme.tokens.text, size))
            button.setIconSize(QSize(size, size))

    def _build(self) -> None:
        self.setProperty("ground", "raised")
        self._title.setProperty("role", "strong")
        self._bar.setTextVisible(False)
        self._bar.setFixedHeight(GAP)
        self._bar.setAccessibleName(self.tr("Progress of the export"))
        self._path.setProperty("role", "muted")
        buttons = QWidget(self)
        flow = FlowLayout(buttons, gap=GAP, line_gap=GAP)
        for button in (self.show_file, self.copy):
            button.setAccessibleName(button.text())
            flow.addWidget(button)
        self._buttons = buttons
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.setSpacing(GAP)
        for label in (self._title, self._text):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
        for part in (self._title, self._bar, self._path, self._text, buttons):
            column.addWidget(part)
        self.show_file.clicked.connect(self._on_show)
        self.copy.clicked.connect(self._on_copy)

    def _say(self, tone: str, title: str, text: str) -> None:
        if self._title.property("tone") != tone:
            set_look(self._title, tone=tone)
        self._title.setText(title)
        self._text.setText(text)
        self._text.setVisible(bool(text))
        self.setAccessibleName(title)
        self.setAccessibleDescription(text)

    def _show_parts(self, *, bar: bool, files: Sequence[Path]) -> None:
        self._files = tuple(files)
        self._bar.setVisible(bar)
        self._buttons.setVisible(bool(files))
        self._path.setVisible(bool(files))
        self._path.set_words(folder_in_words(files[0] if len(files) == 1 else files[0].parent) if files else "")
        self.copy.setText(self.tr("Copy path") if len(files) <= 1 else self.tr("Copy paths"))
        self.copy.setAccessibleName(self.copy.text())
        self.show()

    def _on_show(self) -> None:
        if self._files:
            self.show_requested.emit(self._files[0])

    def _on_copy(self) -> None:
        QGuiApplication.clipboard().setText("\n".join(map(str, self._files)))
        self.copy.setText(self.tr("Copied"))
        announce(self, self.tr("Copied"))
