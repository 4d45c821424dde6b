"""Capture: the figure, up to four large angles, traces, and the record button."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from studio.ui.models.live_angles import MOST_SHOWN, Shown
from studio.ui.models.recorder import DELAYS, Phase
from studio.ui.theme import CONTROL, GAP, GAP_WIDE, RECORD, Theme
from studio.ui.views.angle_number import AngleNumber
from studio.ui.views.side_panel import SidePanel

SIDE_WIDTH = 280  # px at 100 % text
SHARE = 0.5  # of the page that the panel may take when text is large
LAST_TAKES = 5
NO_ANGLE = ""


class TakenTake(NamedTuple):
    """A line of the list of last takes."""

    name: str
    length: str
    """Words, e.g. ``00:42``."""
    loss: str
    """Words, e.g. ``0.1 % lost``."""
    folder: str


class CapturePage(QWidget):
    """Renders recorder, angles and takes; says what the operator wants."""

    record_requested = Signal()
    delay_changed = Signal(int)
    name_changed = Signal(str)
    marker_requested = Signal()
    angles_chosen = Signal(object)
    """Names of the angles to show, a tuple of at most four."""
    target_changed = Signal(object)
    """(least, most) in degrees of the first angle, or None."""
    angles_reset = Signal()
    take_opened = Signal(str)
    """The folder of one of the last takes."""

    def __init__(self, theme: Theme, stage: QWidget, traces: QWidget, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._words: Mapping[str, str] = {}
        self._numbers = [AngleNumber(theme, self) for _ in range(MOST_SHOWN)]
        self._choices = [QComboBox(self) for _ in range(MOST_SHOWN)]
        self._countdown = QLabel(stage)
        self._shown = (stage, traces)
        self._build(stage, traces)
        self.restyle()

    def show_phase(self, phase: Phase, elapsed: float, count: int) -> None:
        """Show what the record button does, how long it has been recording, and the seconds left to count."""
        recording = phase in (Phase.STARTING, Phase.RECORDING)
        texts = {
            Phase.IDLE: self.tr("Record  (R)"),
            Phase.SAVED: self.tr("Record  (R)"),
            Phase.COUNTDOWN: self.tr("Call off  (Esc)"),
            Phase.STARTING: self.tr("Stop  (R)"),
            Phase.RECORDING: self.tr("Stop  (R)"),
            Phase.SAVING: self.tr("Saving…"),
        }
        self.record.setText(texts[phase])
        self.record.setAccessibleName(texts[phase])
        self.record.setEnabled(phase is not Phase.SAVING)
        self.record.setProperty("active", recording)
        self.name.setEnabled(not recording)
        self.marker.setEnabled(phase is Phase.RECORDING)
        self.clock.setText(clock(elapsed))
        self._countdown.setVisible(phase is Phase.COUNTDOWN)
        self._countdown.setText(str(count))
        self._place_countdown()

    def show_elapsed(self, elapsed: float) -> None:
        """Show how long it has been recording, s."""
        self.clock.setText(clock(elapsed))

    def show_angles(self, shown: Sequence[Shown], words: Mapping[str, str]) -> None:
        """Show the chosen angles; ``words`` are their names for people."""
        self._words = words
        for number, angle in zip(self._numbers, shown, strict=False):
            number.show_angle(words.get(angle.name, angle.name), angle)
        for row, number in enumerate(self._numbers):
            number.setVisible(row < len(shown))

    def offer_angles(self, names: Sequence[str], chosen: Sequence[str], words: Mapping[str, str]) -> None:
        """Offer these angles for choice."""
        for row, box in enumerate(self._choices):
            box.blockSignals(True)
            box.clear()
            box.addItem(self.tr("none"), NO_ANGLE)
            for name in names:
                box.addItem(words.get(name, name), name)
            box.setCurrentIndex(max(box.findData(chosen[row] if row < len(chosen) else NO_ANGLE), 0))
            box.blockSignals(False)

    def show_takes(self, takes: Sequence[TakenTake]) -> None:
        """Show the last takes, newest first."""
        while self._takes.count():
            item = self._takes.takeAt(0)
            widget = item.widget() if item is not None else None
            if widget is not None:
                widget.deleteLater()
        for take in takes[:LAST_TAKES]:
            row = QPushButton(self.tr("{name}   {length}   {loss}").format(**take._asdict()), self)
            row.setProperty("kind", "line")
            row.setProperty("folder", take.folder)
            row.setToolTip(self.tr("Review this take"))
            row.setAccessibleName(self.tr("Review take {name}, {length}, {loss}").format(**take._asdict()))
            row.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
            row.clicked.connect(self._open_take)
            self._takes.addWidget(row)
        self._no_takes.setVisible(not takes)

    def set_delay(self, seconds: int) -> None:
        """Show the remembered countdown."""
        self.delay.setCurrentIndex(max(self.delay.findData(seconds), 0))

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        theme = self._theme
        self.clock.setFont(theme.font("figure"))
        self._side.fit(self.width())
        font = theme.font("figure", bold=True)
        font.setPixelSize(4 * theme.pixels("figure"))
        self._countdown.setFont(font)
        self._countdown.setStyleSheet(f"color: {theme.tokens.text}; background: transparent;")
        for number in self._numbers:
            number.restyle()
        for part in self._shown:
            restyle = getattr(part, "restyle", None)
            if restyle is not None:
                restyle()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Share the width anew."""
        self._side.fit(self.width())

    def _build(self, stage: QWidget, traces: QWidget) -> None:
        stage.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self._countdown.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._countdown.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._countdown.hide()
        numbers = QHBoxLayout()
        numbers.setSpacing(GAP_WIDE)
        for number in self._numbers:
            numbers.addWidget(number)
        left = QVBoxLayout()
        left.setSpacing(GAP)
        left.addWidget(stage, 5)
        left.addLayout(numbers)
        left.addWidget(traces, 3)
        page = QHBoxLayout(self)
        page.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        page.setSpacing(GAP_WIDE)
        page.addLayout(left, 1)
        page.addWidget(self._build_side())

    def _build_side(self) -> SidePanel:
        self._side = SidePanel(self._theme, SIDE_WIDTH, SHARE, GAP_WIDE, self)
        column = self._side.column
        self._build_recording(column)
        column.addSpacing(GAP_WIDE)
        self._build_choices(column)
        column.addSpacing(GAP_WIDE)
        column.addWidget(self._section(self.tr("Last takes")))
        self._no_takes = QLabel(self.tr("None yet. Press R."), self)
        self._no_takes.setProperty("role", "muted")
        column.addWidget(self._no_takes)
        self._takes = QVBoxLayout()
        self._takes.setSpacing(0)
        column.addLayout(self._takes)
        column.addStretch(1)
        return self._side

    def _build_recording(self, column: QVBoxLayout) -> None:
        self.name = QLineEdit(self)
        self.name.setPlaceholderText(self.tr("Name of the take"))
        self.name.setAccessibleName(self.tr("Name of the take"))
        self.name.setMaxLength(64)
        self.name.textChanged.connect(self.name_changed)
        self.name.returnPressed.connect(self.name.clearFocus)  # R records again
        self.clock = QLabel(clock(0.0), self)
        self.clock.setAccessibleName(self.tr("Recording time"))
        self.record = QPushButton(self)
        self.record.setProperty("kind", "record")
        self.record.setMinimumHeight(RECORD)
        self.record.clicked.connect(self.record_requested)
        self.delay = QComboBox(self)
        self.delay.setAccessibleName(self.tr("Countdown before recording"))
        for seconds in DELAYS:
            words = self.tr("at once") if seconds == 0 else self.tr("after {n} s").format(n=seconds)
            self.delay.addItem(words, seconds)
        self.delay.currentIndexChanged.connect(self._tell_delay)
        self.marker = QPushButton(self.tr("Marker  (M)"), self)
        self.marker.setAccessibleName(self.tr("Set a marker"))
        self.marker.setMinimumHeight(CONTROL)
        self.marker.clicked.connect(self.marker_requested)
        column.addWidget(self._section(self.tr("Take")))
        column.addWidget(self.name)
        column.addWidget(self.clock)
        column.addWidget(self.record)
        row = QHBoxLayout()
        row.setSpacing(GAP)
        row.addWidget(self.delay, 1)
        row.addWidget(self.marker, 1)
        column.addLayout(row)

    def _build_choices(self, column: QVBoxLayout) -> None:
        column.addWidget(self._section(self.tr("Large numbers")))
        for row, box in enumerate(self._choices):
            box.setAccessibleName(self.tr("Angle {n}").format(n=row + 1))
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(8)
            box.currentIndexChanged.connect(self._tell_angles)
            column.addWidget(box)
        self.least, self.most = QDoubleSpinBox(self), QDoubleSpinBox(self)
        form = QFormLayout()
        form.setSpacing(GAP)
        for words, end in ((self.tr("Target from"), self.least), (self.tr("to"), self.most)):
            end.setRange(-180.0, 360.0)
            end.setDecimals(0)
            end.setSuffix("°")
            end.setAccessibleName(self.tr("Target band of the first angle, {end}").format(end=words))
            end.valueChanged.connect(self._tell_target)
            form.addRow(words, end)
        column.addLayout(form)
        self.reset = QPushButton(self.tr("Range anew"), self)
        self.reset.setAccessibleName(self.tr("Begin least and most anew"))
        self.reset.setProperty("kind", "quiet")
        self.reset.clicked.connect(self.angles_reset)
        column.addWidget(self.reset)

    def _section(self, words: str) -> QLabel:
        label = QLabel(words, self)
        label.setProperty("role", "section")
        return label

    def _tell_delay(self) -> None:
        self.delay_changed.emit(int(self.delay.currentData()))

    def _tell_angles(self) -> None:
        names = [str(box.currentData()) for box in self._choices]
        self.angles_chosen.emit(tuple(dict.fromkeys(name for name in names if name != NO_ANGLE)))

    def _tell_target(self) -> None:
        least, most = self.least.value(), self.most.value()
        band = (least, most) if most > least else None
        self._numbers[0].set_target(band)
        self.target_changed.emit(band)

    def _open_take(self) -> None:
        self.take_opened.emit(str(self.sender().property("folder")))

    def _place_countdown(self) -> None:
        stage = self._countdown.parentWidget()
        if stage is not None:
            self._countdown.setGeometry(stage.rect())


def clock(seconds: float) -> str:
    """Return a length of time as minutes, seconds and tenths: ``00:12.4``."""
    tenths = int(seconds * 10)
    return f"{tenths // 600:02d}:{tenths // 10 % 60:02d}.{tenths % 10}"
