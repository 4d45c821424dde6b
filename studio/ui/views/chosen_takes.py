"""The takes that are to be exported, each with a way out."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from studio.storage.take_summary import TakeSummary
from studio.ui.icons import icon
from studio.ui.models.take_list_model import length
from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.take_row import numbered

CROSS = 16  # px
MOST_ROWS = 100  # more are counted: nobody reads them one by one


class ChosenTakes(QFrame):
    """A short list; choosing more happens where takes are looked at."""

    remove_requested = Signal(object)
    """Folder."""
    add_requested = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._takes: tuple[TakeSummary, ...] | None = None
        self._crosses: list[QPushButton] = []
        self._count, self._nothing = QLabel(self), QLabel(self)
        self._rows = QVBoxLayout()
        self.add = QPushButton(self.tr("Choose takes…"), self)
        self._build()

    def show_takes(self, takes: Sequence[TakeSummary]) -> None:
        """Show these."""
        if self._takes == tuple(takes):
            return
        self._takes = tuple(takes)
        self._crosses = []
        while (item := self._rows.takeAt(0)) is not None:
            widget = item.widget()
            if widget is not None:
                widget.hide()
                widget.deleteLater()
        for take in takes[:MOST_ROWS]:
            self._rows.addWidget(self._row(take))
        self._nothing.setVisible(not takes)
        seconds = sum(take.duration_s for take in takes)
        self._count.setVisible(len(takes) > 1)
        self._count.setText(self.tr("{n} takes, {time}").format(n=len(takes), time=length(seconds)))
        self.restyle()

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        size = round(CROSS * max(self._theme.text_scale, 1.0))
        for cross in self._crosses:
            cross.setIcon(icon("close", self._theme.tokens.muted, size))
            cross.setIconSize(QSize(size, size))

    def _build(self) -> None:
        self.setProperty("ground", "panel")
        title = QLabel(self.tr("Takes"), self)
        title.setProperty("role", "section")
        self._count.setProperty("role", "caption")
        self._nothing.setText(self.tr("None yet. Choose one or several in Review."))
        self._nothing.setWordWrap(True)
        self._nothing.setProperty("role", "muted")
        self.add.setAccessibleName(self.tr("Choose takes in Review"))
        self.add.clicked.connect(self.add_requested)
        inside = QWidget(self)
        rows = QVBoxLayout(inside)
        rows.setContentsMargins(0, 0, 0, 0)
        self._rows.setSpacing(GAP)
        rows.addLayout(self._rows)
        rows.addWidget(self._nothing)
        rows.addStretch(1)
        area = QScrollArea(self)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inside)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.setSpacing(GAP_WIDE)
        column.addWidget(title)
        column.addWidget(area, 1)
        column.addWidget(self._count)
        column.addWidget(self.add)

    def _row(self, take: TakeSummary) -> QWidget:
        row = QWidget(self)
        name = ElidedLabel(row)
        name.set_words(numbered(take))
        name.setProperty("role", "strong")
        facts = ElidedLabel(row)
        bad = self.tr("✖ bad take") if take.verdict == "bad" else ""
        parts = (bad, length(take.duration_s), take.person, take.session)
        facts.set_words(" · ".join(part for part in parts if part))
        facts.setProperty("role", "caption")
        cross = QPushButton(row)
        cross.setProperty("kind", "quiet")
        cross.setProperty("folder", str(take.folder))
        words = self.tr("Do not export {name}").format(name=take.name)
        cross.setAccessibleName(words)
        cross.setToolTip(words)
        cross.clicked.connect(self._on_remove)
        self._crosses.append(cross)
        texts = QVBoxLayout()
        texts.setSpacing(0)
        texts.addWidget(name)
        texts.addWidget(facts)
        across = QHBoxLayout(row)
        across.setContentsMargins(0, 0, 0, 0)
        across.setSpacing(GAP)
        across.addLayout(texts, 1)
        across.addWidget(cross, 0, Qt.AlignmentFlag.AlignVCenter)
        return row

    def _on_remove(self) -> None:
        self.remove_requested.emit(Path(self.sender().property("folder")))
