"""The strip at the bottom of every mode: one word, the facts behind it, and the record button."""

import math
from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QFrame, QHBoxLayout, QPushButton, QSizePolicy, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.models.readiness import ReadinessState, StripPhase, clock
from studio.ui.style_sheet import set_look
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.fact import Fact
from studio.ui.views.flow import FlowLayout
from studio.ui.views.problem_list import ProblemList

LOSS_WARN = 0.05  # share; with a twentieth gone the filter bridges gaps every second
DISK_WARN = 600.0  # s
BUFFER_WARN = 0.5  # of the queue
NAME_WIDTH = 160  # px at 100 %
ANSWERABLE = (StripPhase.CHECK, StripPhase.PROBLEM)

_SHAPES = {
    StripPhase.READY: "ready",
    StripPhase.CHECK: "warning",
    StripPhase.COUNTDOWN: "record",
    StripPhase.RECORDING: "record",
    StripPhase.SAVING: "saving",
    StripPhase.SAVED: "ready",
    StripPhase.PROBLEM: "problem",
}


class ReadinessStrip(QFrame):
    """Renders a ReadinessState. Its parts keep their width while numbers change."""

    record_requested = Signal()
    fix_requested = Signal(str)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._state = ReadinessState()
        self._look: tuple[object, ...] = ()
        self.state = QPushButton(self)
        self.items = QPushButton(self)
        self.sensors = Fact(self.tr("sensors"), (self.tr("▲ {n}/{m}").format(n=88, m=88),), self)
        self.calibrated = Fact(self.tr("calibrated"), self._widest_ages(), self)
        self.loss = Fact(self.tr("loss"), (f"▲ {_percent(0.888)}",), self)
        self.disk = Fact(self.tr("disk"), (self.tr("▲ {minutes} min").format(minutes=88),), self)
        self.buffer = Fact(self.tr("buffer"), (f"▲ {_percent(1)}",), self)
        self.next_take = Fact(self.tr("next take"), (), self)
        self.record = QPushButton(self)
        self.problems = ProblemList(theme, self)
        self._build()
        self.restyle()

    def show_state(self, state: ReadinessState) -> None:
        """Show a state; cheap when nothing of it can be seen to differ."""
        self._state = state
        self._show_word()
        self._show_facts()
        self.problems.show_problems(state.problems)

    def restyle(self) -> None:
        """Take over colours and text size."""
        theme = self._theme
        scale = max(theme.text_scale, 1.0)
        for button in (self.state, self.items, self.record):
            button.setIconSize(QSize(round(SIZE * scale), round(SIZE * scale)))
        for fact in self._facts:
            fact.restyle()
        self.next_take.setMaximumWidth(round(NAME_WIDTH * scale))
        self.problems.restyle()
        self._look = ()
        self._reserve()
        self.show_state(self._state)

    def _build(self) -> None:
        self._facts = (self.sensors, self.calibrated, self.loss, self.disk, self.buffer, self.next_take)
        self.setProperty("ground", "panel")
        self.setAccessibleName(self.tr("Readiness"))
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.state.setProperty("kind", "state")
        self.items.setProperty("kind", "state")
        self.items.setProperty("state", "check")
        self.items.hide()
        middle = QWidget(self)
        flow = FlowLayout(middle, gap=GAP_PAGE, line_gap=GRID)
        for part in (*self._facts, self.items):
            flow.addWidget(part)
        policy = middle.sizePolicy()
        policy.setHorizontalPolicy(policy.Policy.Ignored)
        policy.setHeightForWidth(True)
        middle.setSizePolicy(policy)
        row = QHBoxLayout(self)
        row.setContentsMargins(GAP, GAP, GAP, GAP)
        row.setSpacing(GAP_WIDE)
        row.addWidget(self.state)
        row.addWidget(middle, 1, Qt.AlignmentFlag.AlignVCenter)
        row.addWidget(self.record)
        self.state.clicked.connect(self._on_asked)
        self.items.clicked.connect(self._on_asked)
        self.record.clicked.connect(self.record_requested)
        self.problems.fix_requested.connect(self.fix_requested)

    def _reserve(self) -> None:
        """Make room for the widest word now, so that nothing moves when it comes."""
        words = [self._word(ReadinessState(phase, elapsed=59.8)) for phase in StripPhase]
        metrics = QFontMetrics(self._theme.font("body", bold=True))
        widest = max(metrics.horizontalAdvance(word) for word in words)
        self.state.setMinimumWidth(widest + self.state.iconSize().width() + 5 * GAP)
        labels = [self._action(phase) for phase in StripPhase]
        widest = max(metrics.horizontalAdvance(label) for label in labels)
        self.record.setMinimumWidth(widest + self.record.iconSize().width() + 5 * GAP)

    def _show_word(self) -> None:
        state = self._state
        self.state.setText(self._word(state))
        look = (state.phase, len(state.problems))
        if look == self._look:
            return
        self._look = look
        tokens = self._theme.tokens
        live = state.is_recording
        colours = {
            StripPhase.READY: tokens.good,
            StripPhase.CHECK: tokens.warn,
            StripPhase.COUNTDOWN: tokens.warn,
            StripPhase.RECORDING: tokens.on_accent,
            StripPhase.SAVING: tokens.accent,
            StripPhase.SAVED: tokens.good,
            StripPhase.PROBLEM: tokens.bad,
        }
        self.state.setIcon(icon(_SHAPES[state.phase], colours[state.phase], self.state.iconSize().width()))
        set_look(self.state, state=state.phase.value)
        # Without the clock: a name that changes ten times a second cannot be heard.
        self.state.setAccessibleName(self._name(state.phase))
        asks = bool(state.problems) and state.phase in ANSWERABLE
        self.state.setFocusPolicy(Qt.FocusPolicy.StrongFocus if asks else Qt.FocusPolicy.NoFocus)
        self.state.setAccessibleDescription(self.tr("Press to see what to do.") if asks else "")
        self.state.setToolTip(self.tr("What to do") if asks else "")
        count = len(state.problems)
        self.items.setVisible(count > 0 and state.phase not in ANSWERABLE)
        self.items.setText(self._items_in_words(count))
        self.items.setIcon(icon("warning", tokens.warn, self.items.iconSize().width()))
        self.items.setAccessibleName(self.tr("{items} to check").format(items=self._items_in_words(count)))
        self._show_record(live)

    def _show_record(self, live: bool) -> None:
        tokens, phase = self._theme.tokens, self._state.phase
        filled = live or phase is StripPhase.COUNTDOWN
        self.record.setText(self._action(phase))
        self.record.setAccessibleName(self._action(phase).partition("  ")[0])
        self.record.setAccessibleDescription(self.tr("Key R"))
        self.record.setEnabled(phase is not StripPhase.SAVING)
        shape, colour = ("stop", tokens.on_accent) if filled else ("record", tokens.rec)
        self.record.setIcon(icon(shape, colour, self.record.iconSize().width()))
        set_look(self.record, kind="record" if filled else "recorder")

    def _show_facts(self) -> None:
        s = self._state
        whole = s.sensors >= s.sensors_expected > 0
        self.sensors.show_value(f"{s.sensors}/{s.sensors_expected}", "good" if whole else "warn")
        if s.calibrated_for is None:
            self.calibrated.show_value(self.tr("no"), "warn")
        else:
            self.calibrated.show_value(self._age(s.calibrated_for), "good")
        self.loss.show_value("–" if s.loss is None else _percent(s.loss), _warns((s.loss or 0.0) >= LOSS_WARN))
        low = s.disk_left is not None and s.disk_left < DISK_WARN
        self.disk.show_value("–" if s.disk_left is None else self._span(s.disk_left), _warns(low))
        self.buffer.show_value(_percent(s.buffer_fill), _warns(s.buffer_fill >= BUFFER_WARN))
        self.next_take.show_value(s.next_take or "–", "")
        self.sensors.setToolTip(self.tr("Sensors heard now, of those in use"))
        self.buffer.setToolTip(self.tr("How full the queue to the disk is"))

    def _word(self, state: ReadinessState) -> str:
        if state.phase is StripPhase.RECORDING:
            return self.tr("REC {clock}").format(clock=clock(state.elapsed))
        if state.phase is StripPhase.COUNTDOWN:
            return self.tr("STARTS IN {seconds}").format(seconds=math.ceil(state.elapsed))
        words = {
            StripPhase.READY: self.tr("READY"),
            StripPhase.CHECK: self.tr("CHECK {items}").format(items=self._items_in_words(max(len(state.problems), 1))),
            StripPhase.SAVING: self.tr("SAVING…"),
            StripPhase.SAVED: self.tr("SAVED ✓ verified"),
            StripPhase.PROBLEM: self.tr("PROBLEM"),
        }
        return words[state.phase]

    def _name(self, phase: StripPhase) -> str:
        if phase is StripPhase.RECORDING:
            return self.tr("Recording")
        return self.tr("Countdown") if phase is StripPhase.COUNTDOWN else self._word(self._state)

    def _items_in_words(self, count: int) -> str:
        return self.tr("1 item") if count == 1 else self.tr("{count} items").format(count=count)

    def _action(self, phase: StripPhase) -> str:
        if phase is StripPhase.RECORDING:
            return self.tr("Stop  R")
        return self.tr("Call off  Esc") if phase is StripPhase.COUNTDOWN else self.tr("Record  R")

    def _age(self, seconds: float) -> str:
        minutes = int(seconds // 60)
        if minutes < 1:
            return self.tr("just now")
        if minutes < 60:
            return self.tr("{minutes} min ago").format(minutes=minutes)
        return self.tr("{hours} h ago").format(hours=min(minutes // 60, 99))

    def _widest_ages(self) -> Sequence[str]:
        return [f"✔ {self._age(age)}" for age in (0.0, 88 * 38.0, 88 * 3600.0)]

    def _span(self, seconds: float) -> str:
        if seconds < 60:
            return self.tr("{seconds} s").format(seconds=int(seconds))
        if seconds < 5400:
            return self.tr("{minutes} min").format(minutes=int(seconds // 60))
        hours = int(seconds // 3600)
        return self.tr("{hours} h").format(hours=hours) if hours < 99 else self.tr("> 99 h")

    def _on_asked(self) -> None:
        if self._state.problems:
            self.problems.toggle(above=self)


def _percent(share: float) -> str:
    percent = share * 100
    return f"{percent:.1f} %" if percent < 99.95 else "100 %"


def _warns(wrong: bool) -> str:
    return "warn" if wrong else ""
