"""Home: a figure that walks already, and the three ways to go on."""

from collections.abc import Sequence
from typing import NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.coach_marks import CoachMarks
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.flow import FlowLayout
from studio.ui.views.look_controls import SchemeChoice, TextSize

SIDE_WIDTH = 360  # px at 100 %


class Recovered(NamedTuple):
    """A take that a crash had left open."""

    folder: str
    name: str
    facts: str
    """Words, e.g. ``12 min 04 s · ended by a crash``."""


class HomePage(QFrame):
    """The figure at the left, what to do at the right."""

    sensors_requested = Signal()
    sample_requested = Signal()
    take_requested = Signal()
    """Choose a take to open."""
    take_opened = Signal(str)
    """Review the take in this folder."""
    folder_requested = Signal(str)
    """Show this folder."""
    coach_marks_dismissed = Signal()
    text_scale_chosen = Signal(float)
    scheme_chosen = Signal(str)

    inspector: QWidget | None = None

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._stage: QWidget | None = None
        self.caption = QLabel(self.tr("This is a simulated performer"), self)
        self.coach = CoachMarks(theme, self)
        self.sensors = QPushButton(self.tr("Use my sensors  →"), self)
        self.sample = QPushButton(self.tr("Open the sample take"), self)
        self.open_take = QPushButton(self.tr("Open a take…"), self)
        self._recovered = QWidget(self)
        self.scheme = SchemeChoice(theme, self)
        self.text_size = TextSize(theme, self)
        self._recovered_list = QVBoxLayout()
        self._stage_place = QVBoxLayout()
        self._side = QScrollArea(self)
        self._build()
        self.show_recovered(())
        self.restyle()

    def set_stage(self, stage: QWidget) -> None:
        """Put the figure in its place."""
        self._stage = stage
        self._stage_place.insertWidget(0, stage, 1)

    def show_coach_marks(self, shown: bool) -> None:
        """Show the hints of the first start, or not."""
        self.coach.setVisible(shown)

    def show_simulated(self, simulated: bool) -> None:
        """Say under the figure that nobody wears it."""
        self.caption.setVisible(simulated)

    def show_recovered(self, takes: Sequence[Recovered]) -> None:
        """List recovered takes."""
        while (item := self._recovered_list.takeAt(0)) is not None:
            row = item.widget()
            if row is not None:
                row.hide()
                row.deleteLater()
        for take in takes:
            self._recovered_list.addWidget(self._row(take))
        self._recovered.setVisible(bool(takes))

    def restyle(self) -> None:
        """Take over colours and text size."""
        self._side.setFixedWidth(round(SIDE_WIDTH * (1 + max(self._theme.text_scale - 1, 0) / 2)))
        self.text_size.restyle()
        self.scheme.restyle()
        restyle = getattr(self._stage, "restyle", None)
        if restyle is not None:
            restyle()

    def _build(self) -> None:
        self.setProperty("ground", "window")
        self.setAccessibleName(self.tr("Home"))
        self.caption.setProperty("role", "muted")
        self.caption.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self.caption.setWordWrap(True)
        left = QVBoxLayout()
        left.setSpacing(GAP)
        left.addLayout(self._stage_place, 1)
        left.addWidget(self.caption)
        left.addWidget(self.coach)
        self._side.setWidgetResizable(True)
        self._side.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._side.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._side.setWidget(self._build_side())
        row = QHBoxLayout(self)
        row.setContentsMargins(GAP_PAGE, GAP_PAGE, GAP_WIDE, GAP_PAGE)
        row.setSpacing(GAP_PAGE)
        row.addLayout(left, 1)
        row.addWidget(self._side)
        self.coach.dismissed.connect(self.coach_marks_dismissed)
        self.sensors.clicked.connect(self.sensors_requested)
        self.sample.clicked.connect(self.sample_requested)
        self.open_take.clicked.connect(self.take_requested)
        self.text_size.chosen.connect(self.text_scale_chosen)
        self.scheme.chosen.connect(self.scheme_chosen)

    def _build_side(self) -> QWidget:
        side = QWidget(self._side)
        title = QLabel(self.tr("Start"), side)
        title.setProperty("role", "page")
        self.sensors.setProperty("kind", "primary")
        self.sensors.setAccessibleName(self.tr("Use my sensors"))
        self.sample.setAccessibleName(self.tr("Open the sample take"))
        self.open_take.setAccessibleName(self.tr("Open a take"))
        heading = QLabel(self.tr("Recovered"), self._recovered)
        heading.setProperty("role", "section")
        found = QVBoxLayout(self._recovered)
        found.setContentsMargins(0, GAP_WIDE, 0, 0)
        found.setSpacing(GAP)
        found.addWidget(heading)
        found.addLayout(self._recovered_list)
        self._recovered_list.setSpacing(GAP_WIDE)
        notice = QLabel(self.tr("For research, education and animation. Not a medical device."), side)
        notice.setProperty("role", "caption")
        notice.setWordWrap(True)
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, GAP, 0)
        column.setSpacing(GAP)
        for part in (title, self.sensors, self.sample, self.open_take, self._recovered):
            column.addWidget(part)
        column.addStretch(1)
        column.addSpacing(GAP_PAGE)
        for words, control in ((self.tr("Theme"), self.scheme), (self.tr("Text size"), self.text_size)):
            label = QLabel(words, side)
            label.setProperty("role", "caption")
            column.addWidget(label)
            column.addWidget(control)
        column.addSpacing(GAP)
        column.addWidget(notice)
        return side

    def _row(self, take: Recovered) -> QWidget:
        row = QWidget(self._recovered)
        name, facts = ElidedLabel(row), QLabel(take.facts, row)
        name.set_words(take.name)
        facts.setProperty("role", "caption")
        facts.setWordWrap(True)
        buttons = QWidget(row)
        flow = FlowLayout(buttons, gap=GAP, line_gap=GRID)
        for words, said, slot in (
            (self.tr("Review"), self.tr("Review {name}"), self._on_review),
            (self.tr("Show folder"), self.tr("Show folder of {name}"), self._on_folder),
        ):
            button = QPushButton(words, buttons)
            button.setProperty("folder", take.folder)
            button.setAccessibleName(said.format(name=take.name))
            button.clicked.connect(slot)
            flow.addWidget(button)
        column = QVBoxLayout(row)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GRID)
        for part in (name, facts, buttons):
            column.addWidget(part)
        return row

    def _on_review(self) -> None:
        self.take_opened.emit(self.sender().property("folder"))

    def _on_folder(self) -> None:
        self.folder_requested.emit(self.sender().property("folder"))
