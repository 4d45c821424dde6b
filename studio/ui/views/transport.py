"""Play, step, speed, loop, and where we are: what a hand needs while the eyes are on the figure."""

from PySide6.QtCore import QSignalBlocker, QSize
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.models.playhead import LONG_STEP, SPEEDS, Playhead, clock
from studio.ui.theme import CONTROL, GAP, GAP_WIDE, GRID, RECORD, Theme
from studio.ui.views.flow import FlowLayout

PLAY_ICON = 24  # px


class Transport(QWidget):
    """Works a playhead and shows it."""

    def __init__(self, theme: Theme, playhead: Playhead, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._playhead = playhead
        self.to_start, self.frames_back, self.frame_back = (QPushButton(self) for _ in range(3))
        self.play = QPushButton(self)
        self.frame_forward, self.frames_forward, self.to_end = (QPushButton(self) for _ in range(3))
        self.speed = QComboBox(self)
        self.loop = QPushButton(self.tr("Loop"), self)
        self.range_in = QPushButton(self.tr("Start here"), self)
        self.range_out = QPushButton(self.tr("End here"), self)
        self.whole = QPushButton(self.tr("Whole take"), self)
        self.time, self.frame = QLabel(self), QLabel(self)
        self._icons = {
            self.to_start: "to-start",
            self.frames_back: "frames-back",
            self.frame_back: "frame-back",
            self.frame_forward: "frame-forward",
            self.frames_forward: "frames-forward",
            self.to_end: "to-end",
            self.loop: "loop",
        }
        self._build()
        self._wire()
        self.restyle()
        self._show_state()

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        size = round(SIZE * max(self._theme.text_scale, 1.0))
        for button, name in self._icons.items():
            button.setIcon(icon(name, self._theme.tokens.text, size))
            button.setIconSize(QSize(size, size))
        self.ensurePolished()
        self.time.setFont(self._theme.font("section"))
        self._show_state()
        self._show_time()

    def _build(self) -> None:
        self.time.setProperty("role", "section")
        self.frame.setProperty("role", "caption")
        self.play.setProperty("kind", "primary")
        steps = QWidget(self)
        row = QHBoxLayout(steps)
        row.setContentsMargins(0, 0, 0, 0)
        row.setSpacing(GRID)
        order = (self.to_start, self.frames_back, self.frame_back, self.play)
        for button in (*order, self.frame_forward, self.frames_forward, self.to_end):
            row.addWidget(button)
        self.speed.setAccessibleName(self.tr("Speed"))
        self.speed.setToolTip(self.tr("Speed (J slower, K faster)"))
        for speed in SPEEDS:
            self.speed.addItem(self.tr("{n:g}×").format(n=speed), speed)
        self.loop.setCheckable(True)
        for button in (*self._icons, self.range_in, self.range_out, self.whole):
            button.setProperty("kind", "quiet")
        clocks = QWidget(self)
        column = QVBoxLayout(clocks)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(self.time)
        column.addWidget(self.frame)
        ranges = QWidget(self)
        line = QHBoxLayout(ranges)
        line.setContentsMargins(0, 0, 0, 0)
        line.setSpacing(GRID)
        for widget in (self.speed, self.loop, self.range_in, self.range_out, self.whole):
            line.addWidget(widget)
        flow = FlowLayout(self, gap=GAP_WIDE, line_gap=GAP)
        for part in (steps, clocks, ranges):
            flow.addWidget(part)
        self._name_controls()

    def _name_controls(self) -> None:
        long = LONG_STEP
        names = {
            self.to_start: self.tr("To the start (Home)"),
            self.frames_back: self.tr("{n} frames back (Shift+Left)").format(n=long),
            self.frame_back: self.tr("One frame back (Left)"),
            self.frame_forward: self.tr("One frame forward (Right)"),
            self.frames_forward: self.tr("{n} frames forward (Shift+Right)").format(n=long),
            self.to_end: self.tr("To the end (End)"),
            self.loop: self.tr("Play over and over (L)"),
            self.range_in: self.tr("Play from here on (I)"),
            self.range_out: self.tr("Play up to here (O)"),
            self.whole: self.tr("Play the whole take"),
        }
        for button, words in names.items():
            button.setAccessibleName(words)
            button.setToolTip(words)
        for button in (self.frames_back, self.frame_back, self.frame_forward, self.frames_forward):
            button.setAutoRepeat(True)

    def _wire(self) -> None:
        head = self._playhead
        head.changed.connect(self._show_state)
        head.moved.connect(self._show_time)
        self.play.clicked.connect(head.toggle)
        self.to_start.clicked.connect(head.home)
        self.to_end.clicked.connect(head.to_end)
        self.frames_back.clicked.connect(self._long_step_back)
        self.frame_back.clicked.connect(self._step_back)
        self.frame_forward.clicked.connect(self._step_forward)
        self.frames_forward.clicked.connect(self._long_step_forward)
        self.speed.currentIndexChanged.connect(self._on_speed)
        self.loop.toggled.connect(head.set_loop)
        self.range_in.clicked.connect(head.range_starts_here)
        self.range_out.clicked.connect(head.range_ends_here)
        self.whole.clicked.connect(head.whole_take)

    def _show_state(self) -> None:
        head, tokens = self._playhead, self._theme.tokens
        size = round(PLAY_ICON * max(self._theme.text_scale, 1.0))
        self.play.setIcon(icon("pause" if head.is_playing else "play", tokens.on_accent, size))
        self.play.setIconSize(QSize(size, size))
        self.play.setFixedSize(max(round(1.6 * size), RECORD), max(round(1.4 * size), CONTROL))
        words = self.tr("Pause (Space)") if head.is_playing else self.tr("Play (Space)")
        self.play.setAccessibleName(words)
        self.play.setToolTip(words)
        with QSignalBlocker(self.speed), QSignalBlocker(self.loop):
            self.speed.setCurrentIndex(min(range(len(SPEEDS)), key=self._farness))
            self.loop.setChecked(head.loops)
        self.whole.setEnabled(head.range_from is not None or head.range_to is not None)
        self._show_time()

    def _show_time(self) -> None:
        head = self._playhead
        self.time.setText(self.tr("{now} / {end}").format(now=clock(head.time), end=clock(head.duration)))
        self.frame.setText(self.tr("frame {n} of {total}").format(n=f"{head.frame + 1:,}", total=f"{head.frames:,}"))

    def _farness(self, row: int) -> float:
        return abs(SPEEDS[row] - self._playhead.speed)

    def _on_speed(self, row: int) -> None:
        self._playhead.set_speed(SPEEDS[row])

    def _step_back(self) -> None:
        self._playhead.step(-1)

    def _step_forward(self) -> None:
        self._playhead.step(1)

    def _long_step_back(self) -> None:
        self._playhead.step(-LONG_STEP)

    def _long_step_forward(self) -> None:
        self._playhead.step(LONG_STEP)
