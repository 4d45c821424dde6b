"""The numbers of a take, and what they are worth, beside the figure."""

import math
from collections.abc import Sequence

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import (
    QComboBox,
    QFrame,
    QGridLayout,
    QLabel,
    QPlainTextEdit,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from studio.ui.models.live_angles import MOST_SHOWN
from studio.ui.models.take_review import Measure, TakeReview, in_words, measure, side_of, value_at
from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme
from studio.ui.views.take_facts import facts_of

NOTE_LINES = 3
NO_ANGLE = ""
FOUR_BESIDE = 1.3  # of the text scale up to which four numbers have room on one line


class MeasureRow(QWidget):
    """One angle: its choice, and least, most and range below."""

    chosen = Signal()

    def __init__(self, number: int, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.choice = QComboBox(self)
        self.choice.setAccessibleName(self.tr("Angle {n}").format(n=number))
        self.choice.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.choice.setMinimumContentsLength(8)
        self.choice.currentIndexChanged.connect(self.chosen)
        self._numbers = [QLabel(self) for _ in range(4)]
        self._note = QLabel(self)
        self._note.setProperty("role", "caption")
        self._note.setWordWrap(True)
        self._figures = QWidget(self)
        self._grid = QGridLayout(self._figures)
        self._grid.setContentsMargins(GRID, 0, 0, 0)
        self._grid.setHorizontalSpacing(GAP)
        self._grid.setVerticalSpacing(0)
        titles = (self.tr("now"), self.tr("least"), self.tr("most"), self.tr("range"))
        self._titles = [QLabel(title, self._figures) for title in titles]
        for title, number_label in zip(self._titles, self._numbers, strict=True):
            title.setProperty("role", "caption")
            title.setAlignment(Qt.AlignmentFlag.AlignRight)
            number_label.setProperty("role", "strong")
            number_label.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.spread(wide=True)
        page = QVBoxLayout(self)
        page.setContentsMargins(0, 0, 0, 0)
        page.setSpacing(GRID)
        page.addWidget(self.choice)
        page.addWidget(self._figures)
        page.addWidget(self._note)

    def spread(self, *, wide: bool) -> None:
        """Put the four numbers beside each other, or two by two where text is large."""
        columns = 4 if wide else 2
        for at, (title, number) in enumerate(zip(self._titles, self._numbers, strict=True)):
            row, column = divmod(at, columns)
            self._grid.addWidget(number, 2 * row, column)
            self._grid.addWidget(title, 2 * row + 1, column)
        for column in range(4):
            self._grid.setColumnStretch(column, int(column < columns))

    @property
    def name(self) -> str:
        """The chosen angle; empty for none."""
        return str(self.choice.currentData() or NO_ANGLE)

    def offer(self, names: Sequence[str], chosen: str) -> None:
        """Offer angles, with one chosen."""
        marks = {"left": "● ", "right": "■ ", "": ""}
        with QSignalBlocker(self.choice):
            self.choice.clear()
            self.choice.addItem(self.tr("Add an angle…") if not chosen else self.tr("None"), NO_ANGLE)
            for name in names:
                self.choice.addItem(marks[side_of(name)] + in_words(name), name)
            self.choice.setCurrentIndex(max(self.choice.findData(chosen), 0))
        self.choice.setToolTip(self.choice.currentText())
        self._figures.setVisible(bool(chosen))
        self._note.setVisible(False)

    def show_measure(self, found: Measure, positive: str, *, low_confidence: bool) -> None:
        """Show what the angle did."""
        for label, value in zip(self._numbers[1:], (found.least, found.most, found.range), strict=True):
            label.setText(_degrees(value))
        notes = []
        if low_confidence:
            notes.append(self.tr("▲ Below what body-worn sensors can tell: read it as a hint."))
        if found.missing >= 0.001:
            notes.append(self.tr("Not measured for {n:.1f} % of this time.").format(n=100 * found.missing))
        self._note.setText(" ".join(notes))
        self._note.setVisible(bool(notes))
        said = self.tr("least {least}, most {most}, range {range}. Positive: {positive}.")
        said = said.format(
            least=_degrees(found.least), most=_degrees(found.most), range=_degrees(found.range), positive=positive
        )
        self._figures.setAccessibleName(said)
        self._figures.setToolTip(self.tr("Positive: {positive}").format(positive=positive))

    def show_now(self, value: float) -> None:
        """Show the angle under the playhead."""
        self._numbers[0].setText(_degrees(value))


class NoteField(QPlainTextEdit):
    """A few lines, told when they are left."""

    left = Signal()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Esc leaves the field: the keys of the page work again."""
        if event.key() == Qt.Key.Key_Escape:
            self.clearFocus()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:  # noqa: N802 (Qt's name)
        """Tell."""
        super().focusOutEvent(event)
        self.left.emit()


class MeasuresPanel(QFrame):
    """Chosen angles, their worth, and the note of a take."""

    angles_chosen = Signal(object)
    """Names, a tuple of at most four."""
    note_changed = Signal(str)
    export_requested = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._review: TakeReview | None = None
        self._chosen: tuple[str, ...] = ()
        self.rows = [MeasureRow(number + 1, self) for number in range(MOST_SHOWN)]
        self._stretch = QLabel(self)
        self._facts = QLabel(self)
        self.note = NoteField(self)
        self.export = QPushButton(self.tr("Export…"), self)
        self._build()
        self.restyle()

    def show_take(self, review: TakeReview, chosen: Sequence[str]) -> None:
        """Show a take with these angles."""
        self._review = review
        self._facts.setText("\n\n".join(facts_of(review)))
        if self.note.toPlainText() != review.summary.notes:
            self.note.setPlainText(review.summary.notes)
            self.note.document().setModified(False)
        self.choose(chosen)

    def choose(self, chosen: Sequence[str]) -> None:
        """Show these angles."""
        review = self._review
        if review is None:
            return
        self._chosen = tuple(chosen)
        for number, row in enumerate(self.rows):
            name = self._chosen[number] if number < len(self._chosen) else NO_ANGLE
            row.offer(tuple(review.degrees), name)
            row.setVisible(number <= len(self._chosen))

    def show_range(self, from_s: float, to_s: float, words: str) -> None:
        """Show what the angles did between two times, s."""
        review = self._review
        if review is None:
            return
        self._stretch.setText(words)
        for row, name in zip(self.rows, self._chosen, strict=False):
            angle = review.angles[name]
            row.show_measure(measure(review, name, from_s, to_s), angle.positive, low_confidence=angle.low_confidence)

    def show_time(self, time: float) -> None:
        """Show the angles under the playhead."""
        if self._review is not None:
            for row, name in zip(self.rows, self._chosen, strict=False):
                row.show_now(value_at(self._review, name, time))

    def keep_note(self) -> None:
        """Tell of a note that was written."""
        if self._review is not None and self.note.document().isModified():
            self.note.document().setModified(False)
            self.note_changed.emit(self.note.toPlainText().strip())

    def restyle(self) -> None:
        """Take over text sizes."""
        self.ensurePolished()
        for row in self.rows:
            row.spread(wide=self._theme.text_scale <= FOUR_BESIDE)
        self.note.setFixedHeight(NOTE_LINES * self.note.fontMetrics().lineSpacing() + 2 * GAP + 4)

    def _build(self) -> None:
        self.setProperty("ground", "panel")
        page = QWidget(self)
        column = QVBoxLayout(page)
        column.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.setSpacing(GAP)
        column.addWidget(_label(self.tr("Joint angles"), "section", self))
        self._stretch.setProperty("role", "caption")
        self._stretch.setWordWrap(True)
        column.addWidget(self._stretch)
        for row in self.rows:
            row.chosen.connect(self._on_chosen)
            column.addWidget(row)
            column.addSpacing(GRID)
        column.addSpacing(GAP)
        self._build_worth(column)
        column.addStretch(1)
        area = QScrollArea(self)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        area.setWidget(page)
        self.export.setProperty("kind", "primary")
        self.export.setAccessibleName(self.tr("Export this take"))
        self.export.clicked.connect(self.export_requested)
        foot = QVBoxLayout()
        foot.setContentsMargins(GAP_WIDE, GAP, GAP_WIDE, GAP_WIDE)
        foot.addWidget(self.export)
        outer = QVBoxLayout(self)
        outer.setContentsMargins(0, 0, 0, 0)
        outer.setSpacing(0)
        outer.addWidget(area, 1)
        outer.addLayout(foot)

    def _build_worth(self, column: QVBoxLayout) -> None:
        column.addWidget(_label(self.tr("What they are worth"), "section", self))
        self._facts.setWordWrap(True)
        self._facts.setTextFormat(Qt.TextFormat.PlainText)
        self._facts.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._facts.setAccessibleName(self.tr("What the angles are worth"))
        column.addWidget(self._facts)
        column.addSpacing(GAP)
        column.addWidget(_label(self.tr("Note"), "section", self))
        self.note.setAccessibleName(self.tr("Note about the take"))
        self.note.setPlaceholderText(self.tr("What should be remembered of this take"))
        self.note.setTabChangesFocus(True)
        self.note.left.connect(self.keep_note)
        column.addWidget(self.note)

    def _on_chosen(self) -> None:
        self.angles_chosen.emit(tuple(dict.fromkeys(row.name for row in self.rows if row.name != NO_ANGLE)))


def _label(words: str, role: str, parent: QWidget) -> QLabel:
    label = QLabel(words, parent)
    label.setProperty("role", role)
    label.setWordWrap(True)
    return label


def _degrees(value: float) -> str:
    return "–" if math.isnan(value) else f"{value + 0.0:.1f}°".replace("-", "−")
