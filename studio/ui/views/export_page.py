"""Export: which takes, as what, how large, where to; and afterwards that the file is right."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QButtonGroup,
    QCheckBox,
    QComboBox,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from studio.core.errors import StudioError
from studio.export.bvh import RATES, rate_name
from studio.ui.fact_words import folder_in_words
from studio.ui.models.export_choice import FORMATS, ExportChoice
from studio.ui.models.take_list_model import length
from studio.ui.theme import FORM_WIDTH, GAP, GAP_PAGE, GAP_WIDE, GRID, RECORD, Theme
from studio.ui.views.chosen_takes import ChosenTakes
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.export_result import ExportResult
from studio.ui.views.flow import FlowLayout
from studio.ui.views.format_card import FormatCard

TAKES_WIDTH = 248  # px at 100 % text
WIDEST_TEXT = 1.3  # of the text scale up to which that column grows


class ExportPage(QWidget):
    """Renders an ``ExportChoice``; writing is a wish."""

    export_requested = Signal(object)
    """``ExportValues``."""
    folder_requested = Signal()
    """Let the folder be chosen."""
    takes_requested = Signal()
    """Go where takes are chosen."""
    show_requested = Signal(object)
    """Show a file in its folder."""

    def __init__(self, theme: Theme, choice: ExportChoice, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._busy = False
        self.choice = choice
        self.takes = ChosenTakes(theme, self)
        self.cards = {key: FormatCard(theme, key, *words, self) for key, words in self._formats().items()}
        self.rate = QComboBox(self)
        self.excel = QCheckBox(self.tr("For Excel: semicolons and decimal commas"), self)
        self.name = QLineEdit(self)
        self.folder = ElidedLabel(self)
        self.choose_folder = QPushButton(self.tr("Choose…"), self)
        self.start = QPushButton(self.tr("Export"), self)
        self.result = ExportResult(theme, self)
        self._names, self._estimate, self._warning = QLabel(self), QLabel(self), QLabel(self)
        self._confirmed: tuple[Path, ...] = ()
        """What somebody was told will be replaced."""
        self._build()
        self._wire()
        self.restyle()
        self.refresh()

    def show_progress(self, stage: str, share: float, number: int = 1, total: int = 1) -> None:
        """Show how far it is; nothing can be changed meanwhile."""
        self._set_busy(on=True)
        self.result.show_progress(stage, share, number, total)

    def show_done(self, files: Sequence[Path], notes: Sequence[str] = ()) -> None:
        """Show the files that were written and checked."""
        self._confirmed = ()
        self._set_busy(on=False)
        self.refresh()
        self.result.show_done(files, notes)

    def show_refusal(self, error: StudioError) -> None:
        """Show why nothing was written."""
        self._confirmed = ()
        self._set_busy(on=False)
        self.result.show_refusal(error)

    def refresh(self) -> None:
        """Show the choice as it stands."""
        choice = self.choice
        self.takes.show_takes(choice.takes)
        for key, card in self.cards.items():
            card.setChecked(key == choice.format.key)
        is_bvh = choice.format.family == "bvh"
        for part in (self.rate, self._rate_label):
            part.setVisible(is_bvh)
        self.excel.setVisible(not is_bvh)
        with QSignalBlocker(self.rate), QSignalBlocker(self.excel):
            self.rate.setCurrentIndex(max(self.rate.findData(choice.rate or 0), 0))
            self.excel.setChecked(choice.for_excel)
        self._show_target()
        self._show_estimate()
        self._set_busy(on=self._busy)

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        scale = self._theme.text_scale
        self.takes.setFixedWidth(round(TAKES_WIDTH * min(max(scale, 1.0), WIDEST_TEXT)))
        for part in (self._form, self.result):
            part.setMaximumWidth(round(FORM_WIDTH * max(scale, 1.0)))
        self._level_cards()
        for part in (self.takes, self.result):
            part.restyle()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 (Qt's name)
        """Make the cards as high as the fonts need, which are known now."""
        super().showEvent(event)
        self._level_cards()

    def _level_cards(self) -> None:
        tallest = max(card.lines_height() for card in self.cards.values())
        for card in self.cards.values():
            card.setMinimumHeight(tallest)
            card.updateGeometry()

    def _formats(self) -> dict[str, tuple[str, str]]:
        """Return title and text of each card."""
        words = {
            "blender": (self.tr("Blender (m)"), self.tr("Motion as BVH in metres, for Blender and three.js.")),
            "motionbuilder": (
                self.tr("MotionBuilder / iClone (cm)"),
                self.tr("Motion as BVH in centimetres."),
            ),
            "joints": (self.tr("Joint angles (CSV)"), self.tr("One row a frame, one column an angle, in degrees.")),
            "orientations": (
                self.tr("Orientations (CSV)"),
                self.tr("Each sensor as quaternion and roll, pitch, yaw. No calibration of the body is needed."),
            ),
            "raw": (self.tr("Raw samples (CSV)"), self.tr("What the sensors sent, a row each, nothing filled in.")),
        }
        return {kind.key: words[kind.key] for kind in FORMATS}

    def _build(self) -> None:
        self._form = QWidget(self)
        column = QVBoxLayout(self._form)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GAP_WIDE)
        title = QLabel(self.tr("Export"), self)
        title.setProperty("role", "page")
        column.addWidget(title)
        column.addWidget(self._section(self.tr("Format")))
        column.addWidget(self._build_cards())
        column.addWidget(self._build_options())
        column.addSpacing(GAP)
        column.addWidget(self._section(self.tr("Where to")))
        column.addWidget(self._build_target())
        column.addWidget(self._warning)
        column.addStretch(1)
        inside = QWidget(self)
        across = QHBoxLayout(inside)
        across.setContentsMargins(0, 0, GAP, 0)
        across.addWidget(self._form, FORM_WIDTH)
        across.addStretch(1)
        area = QScrollArea(self)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(inside)
        right = QVBoxLayout()
        right.setSpacing(GAP_WIDE)
        right.addWidget(area, 1)
        right.addWidget(self.result)
        right.addWidget(self._build_foot())
        page = QHBoxLayout(self)
        page.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        page.setSpacing(GAP_PAGE)
        page.addWidget(self.takes)
        page.addLayout(right, 1)

    def _build_cards(self) -> QWidget:
        place = QWidget(self)
        place.setAccessibleName(self.tr("Format"))
        flow = FlowLayout(place, gap=GAP, line_gap=GAP)
        self._group = QButtonGroup(self)
        for card in self.cards.values():
            flow.addWidget(card)
            self._group.addButton(card)
        return place

    def _build_options(self) -> QWidget:
        self.rate.setAccessibleName(self.tr("Frames a second"))
        self.rate.addItem(self.tr("as recorded"), 0)
        for rate in RATES:
            self.rate.addItem(self.tr("{n} frames a second").format(n=rate_name(rate)), rate)
        self._rate_label = QLabel(self.tr("Frame rate"), self)
        self._rate_label.setBuddy(self.rate)
        self.excel.setAccessibleName(self.excel.text())
        place = QWidget(self)
        flow = FlowLayout(place, gap=GAP_WIDE, line_gap=GAP)
        for part in (self._rate_label, self.rate, self.excel):
            flow.addWidget(part)
        return place

    def _build_target(self) -> QWidget:
        self.name.setAccessibleName(self.tr("Name of the file"))
        self._names.setWordWrap(True)
        self._names.setTextFormat(Qt.TextFormat.PlainText)
        self._warning.setWordWrap(True)
        self._warning.setProperty("tone", "warn")
        self.folder.setAccessibleName(self.tr("Folder"))
        self.choose_folder.setAccessibleName(self.tr("Choose the folder"))
        place = QWidget(self)
        column = QVBoxLayout(place)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID)
        caption = QLabel(self.tr("Name"), self)
        caption.setProperty("role", "caption")
        below = QLabel(self.tr("Folder"), self)
        below.setProperty("role", "caption")
        row = QHBoxLayout()
        row.setSpacing(GAP)
        row.addWidget(self.folder, 1)
        row.addWidget(self.choose_folder)
        column.addWidget(caption)
        column.addWidget(self.name)
        column.addWidget(self._names)
        column.addSpacing(GAP)
        column.addWidget(below)
        column.addLayout(row)
        return place

    def _build_foot(self) -> QWidget:
        self._estimate.setProperty("role", "muted")
        self._estimate.setWordWrap(True)
        self.start.setProperty("kind", "primary")
        self.start.setMinimumHeight(RECORD - 2 * GRID)
        foot = QWidget(self)
        row = QHBoxLayout(foot)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GAP_WIDE)
        row.addWidget(self.start)
        row.addWidget(self._estimate, 1)
        return foot

    def _section(self, words: str) -> QLabel:
        label = QLabel(words, self)
        label.setProperty("role", "section")
        return label

    def _wire(self) -> None:
        choice = self.choice
        choice.changed.connect(self.refresh)
        self._group.buttonClicked.connect(self._on_card)
        self.rate.currentIndexChanged.connect(self._on_rate)
        self.excel.toggled.connect(choice.set_for_excel)
        self.name.editingFinished.connect(self._on_name)
        self.name.textEdited.connect(self._on_typed)
        self.choose_folder.clicked.connect(self.folder_requested)
        self.takes.remove_requested.connect(choice.remove_take)
        self.takes.add_requested.connect(self.takes_requested)
        self.start.clicked.connect(self._on_start)
        self.result.show_requested.connect(self.show_requested)

    def _show_target(self) -> None:
        choice = self.choice
        items = choice.items()
        self.name.setVisible(len(items) <= 1)
        self._names.setVisible(len(items) > 1)
        if self.name.text() != choice.name:
            self.name.setText(choice.name)
        if len(items) > 1:
            words = self.tr("{first} and {n} more, named after their takes")
            self._names.setText(words.format(first=items[0].target.name, n=len(items) - 1))
        self.folder.set_words(folder_in_words(choice.folder))
        replaced = choice.replaced()
        words = self.tr("▲ {name} is there already and will be replaced.")
        self._warning.setText(words.format(name=replaced[0].name) if replaced else "")
        self._warning.setVisible(bool(replaced))

    def _show_estimate(self) -> None:
        found = self.choice.estimates()
        rows, size = sum(one.rows for one in found), sum(one.size for one in found)
        seconds = sum(take.duration_s for take in self.choice.takes)
        is_bvh = self.choice.format.family == "bvh"
        words = self.tr("{rows} frames, about {size}") if is_bvh else self.tr("{rows} rows, about {size}")
        said = words.format(rows=f"{rows:,}", size=self._size(size))
        if len(found) > 1:
            said = self.tr("{n} files from {time}: {what}").format(n=len(found), time=length(seconds), what=said)
        if found:
            said = self.tr("{what}: the whole take, also what came before R").format(what=said)
        self._estimate.setText(said if found else self.tr("Choose a take first."))

    def _size(self, size: float) -> str:
        if size < 1e6:
            return self.tr("{n:.0f} kB").format(n=max(size / 1e3, 1.0))
        if size < 1e9:
            return self.tr("{n:.1f} MB").format(n=size / 1e6)
        return self.tr("{n:.1f} GB").format(n=size / 1e9)

    def _set_busy(self, *, on: bool) -> None:
        was, self._busy = self._busy, on
        if on and not was:
            self.setFocus()  # or Qt hands the keyboard to what comes next: the record button
        elif was and not on and self.hasFocus():
            self.start.setFocus()
        self.start.setEnabled(not on and bool(self.choice.takes))
        count = len(self.choice.takes)
        self.start.setText(self.tr("Export") if count <= 1 else self.tr("Export {n} takes").format(n=count))
        self.start.setAccessibleName(self.start.text())
        for part in (*self.cards.values(), self.rate, self.excel, self.name, self.choose_folder, self.takes):
            part.setEnabled(not on)

    def _on_card(self, card: FormatCard) -> None:
        self._forget_answer()
        self.choice.set_format(card.key)

    def _on_rate(self) -> None:
        self._forget_answer()
        self.choice.set_rate(self.rate.currentData() or None)

    def _on_typed(self) -> None:
        self._forget_answer()

    def _forget_answer(self) -> None:
        """Something else is to be exported: what came of the last order, and what was agreed to, is over."""
        self.result.hide()
        self._confirmed = ()

    def _on_name(self) -> None:
        typed = self.name.text().strip()
        if typed != self.choice.name:
            self.choice.set_name(typed)

    def _on_start(self) -> None:
        self._on_name()
        self.refresh()
        replaced = self.choice.replaced()
        if replaced != self._confirmed:  # said beside the button; the next press means it
            self._confirmed = replaced
            if replaced:
                self.result.hide()
                self.start.setText(self.tr("Replace and export"))
                self.start.setAccessibleName(self.start.text())
                return
        self.export_requested.emit(self.choice.values())
