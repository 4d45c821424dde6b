"""The record button: every state it can be in, and what each press, tick and answer does.

No widget, no clock of its own and no session: times come in, wishes go out as signals.
"""

from enum import Enum

from PySide6.QtCore import QObject, Signal

SHORTEST = 0.5  # s of recording before a stop is passed on: no take is empty
SAVED_SHOWN = 2.0  # s that "Saved" stands
DELAYS = (0, 3, 5, 10)  # s on offer


class Phase(Enum):
    """What the record button is doing."""

    IDLE = "idle"
    COUNTDOWN = "countdown"
    STARTING = "starting"
    RECORDING = "recording"
    SAVING = "saving"
    SAVED = "saved"


class Recorder(QObject):
    """One recording at a time, from the press to the take that was read back."""

    phase_changed = Signal(Phase)
    start_wanted = Signal()
    """Start recording now."""
    stop_wanted = Signal()
    """Stop and save now."""
    second_counted = Signal(int)
    """Seconds left of the countdown, for voice and tones."""
    close_asked = Signal()
    """The window was to be closed while recording: ask once."""
    close_ready = Signal()
    """Nothing is being recorded or saved any more, and the window was to be closed."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.phase = Phase.IDLE
        self.elapsed = 0.0
        """s since recording began; stays after the end."""
        self._delay = 0
        self._since = 0.0
        self._told = 0
        self._stopping = False
        self._closing = False

    @property
    def left(self) -> float:
        """s left of the countdown as counted last; 0 when there is none."""
        return float(self._told) if self.phase is Phase.COUNTDOWN else 0.0

    @property
    def is_busy(self) -> bool:
        """Whether something would be lost if everything ended now."""
        return self.phase in (Phase.STARTING, Phase.RECORDING, Phase.SAVING)

    def press(self, now: float, delay: int) -> None:
        """R: start (after ``delay`` s), stop, or call off the countdown."""
        if self.phase in (Phase.IDLE, Phase.SAVED):
            self._stopping = False
            if delay > 0:
                self._delay, self._since, self._told = delay, now, delay
                self._go(Phase.COUNTDOWN)
                self.second_counted.emit(delay)
            else:
                self._start()
        elif self.phase is Phase.COUNTDOWN:
            self._go(Phase.IDLE)
        elif self.phase in (Phase.STARTING, Phase.RECORDING):
            self._stopping = True
            self.tick(now)

    def cancel(self) -> None:
        """Esc: calls off a countdown, and never stops a recording."""
        if self.phase is Phase.COUNTDOWN:
            self._go(Phase.IDLE)

    def started(self, now: float) -> None:
        """The session keeps samples from now on."""
        if self.phase is Phase.STARTING:
            self._since, self.elapsed = now, 0.0
            self._go(Phase.RECORDING)

    def ended(self, now: float) -> None:
        """The session can keep nothing more: what there is, is being saved."""
        if self.phase is Phase.RECORDING:
            self.elapsed = now - self._since
            self._stop()

    def saved(self, now: float) -> None:
        """The take was read back."""
        if self.phase is Phase.SAVING:
            self._since = now
            self._go(Phase.SAVED)
            self._perhaps_close()

    def failed(self) -> None:
        """Starting or saving was refused; the reason is told elsewhere."""
        if self.phase in (Phase.STARTING, Phase.RECORDING, Phase.SAVING):
            self._closing = False  # who was to close the window must read first what became of the take
            self._go(Phase.IDLE)

    def close(self, now: float) -> bool:
        """The window is to be closed: return whether it may, else ask once."""
        if self.phase is Phase.COUNTDOWN:
            self._go(Phase.IDLE)
        if not self.is_busy:
            return True
        if self.phase is Phase.SAVING:
            self._closing = True
        else:
            self.close_asked.emit()
        return False

    def stop_and_close(self, now: float) -> None:
        """The answer was "Stop and save"."""
        self._closing = True
        if self.phase in (Phase.STARTING, Phase.RECORDING):
            self._stopping = True
            self.tick(now)
        self._perhaps_close()

    def tick(self, now: float) -> None:
        """Let time pass."""
        if self.phase is Phase.COUNTDOWN:
            left = self._delay - (now - self._since)
            if left <= 0:
                self._start()
            elif int(-(-left // 1)) < self._told:
                self._told = int(-(-left // 1))
                self.second_counted.emit(self._told)
        elif self.phase is Phase.RECORDING:
            self.elapsed = now - self._since
            if self._stopping and self.elapsed >= SHORTEST:
                self._stop()
        elif self.phase is Phase.SAVED and now - self._since >= SAVED_SHOWN:
            self._go(Phase.IDLE)

    def _start(self) -> None:
        self._go(Phase.STARTING)
        self.start_wanted.emit()

    def _stop(self) -> None:
        self._stopping = False
        self._go(Phase.SAVING)
        self.stop_wanted.emit()

    def _perhaps_close(self) -> None:
        if self._closing and not self.is_busy:
            self._closing = False
            self.close_ready.emit()

    def _go(self, phase: Phase) -> None:
        self.phase = phase
        self.phase_changed.emit(phase)
