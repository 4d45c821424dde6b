"""Where a take is played: the time, its speed, and the stretch that is played over and over."""

import math

from PySide6.QtCore import QObject, Signal

SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0)
"""On offer; 1 is as it was."""
SLOWEST, FASTEST = SPEEDS[0], SPEEDS[-1]
LONG_STEP = 10  # frames


class Playhead(QObject):
    """A time that runs when it is told the time."""

    moved = Signal(float)
    """The time, s."""
    changed = Signal()
    """Playing, speed, loop, range or take are others now."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.time = 0.0
        """s of take time."""
        self.duration = 0.0
        """s"""
        self.frame_s = 0.01
        """s"""
        self.speed = 1.0
        self.is_playing = False
        self.loops = False
        self.range_from: float | None = None
        """s; None: from the start."""
        self.range_to: float | None = None
        """s; None: to the end."""
        self._now: float | None = None

    @property
    def begin(self) -> float:
        """Where playing begins, s."""
        return 0.0 if self.range_from is None else self.range_from

    @property
    def end(self) -> float:
        """Where playing ends, s."""
        return self.duration if self.range_to is None else self.range_to

    @property
    def frame(self) -> int:
        """The frame that is shown, from 0."""
        return round(self.time / self.frame_s)

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return round(self.duration / self.frame_s) + 1

    def open(self, duration: float, frame_s: float) -> None:
        """Stand at the start of another take, of ``duration`` s with a frame each ``frame_s`` s."""
        if not (math.isfinite(duration) and duration >= 0.0 and frame_s > 0.0):
            raise ValueError(f"{duration} s in frames of {frame_s} s is no take")
        self.duration, self.frame_s = duration, frame_s
        self.range_from = self.range_to = None
        self.is_playing, self.time = False, 0.0
        self.changed.emit()
        self.moved.emit(self.time)

    def tick(self, now: float) -> None:
        """Let time pass; ``now`` in s."""
        since = 0.0 if self._now is None else max(now - self._now, 0.0)
        self._now = now
        if not self.is_playing or since == 0.0:
            return
        time = self.time + since * self.speed
        if time >= self.end:
            span = self.end - self.begin
            if self.loops and span > self.frame_s:
                time = self.begin + (time - self.begin) % span
            else:
                self._go(self.end)
                self.pause()
                return
        self._go(time)

    def toggle(self) -> None:
        """Play or pause."""
        if self.is_playing:
            self.pause()
        else:
            self.play()

    def play(self) -> None:
        """Play; from the beginning when the end, or what lies outside the range, is shown."""
        if self.duration <= 0.0:
            return
        if not self.begin <= self.time < self.end - self.frame_s / 2:
            self._go(self.begin)
        self._set_playing(True)

    def pause(self) -> None:
        """Stand still."""
        self._set_playing(False)

    def seek(self, time: float) -> None:
        """Go to a time, s; what plays goes on from there."""
        self._go(time)

    def step(self, frames: int) -> None:
        """Stand still some frames on, or back when negative."""
        self.pause()
        self._go((self.frame + frames) * self.frame_s)

    def home(self) -> None:
        """Go to where playing begins; once there, to the start of the take."""
        self._go(self.begin if self.time > self.begin else 0.0)

    def to_end(self) -> None:
        """Stand where playing ends; once there, at the end of the take."""
        self.pause()
        self._go(self.end if self.time < self.end else self.duration)

    def set_speed(self, speed: float) -> None:
        """Play at this speed, within what is on offer."""
        self.speed = min(max(speed, SLOWEST), FASTEST)
        self.changed.emit()

    def faster(self) -> None:
        """Take the next speed on offer."""
        self.set_speed(next((speed for speed in SPEEDS if speed > self.speed), FASTEST))

    def slower(self) -> None:
        """Take the speed on offer before."""
        self.set_speed(next((speed for speed in reversed(SPEEDS) if speed < self.speed), SLOWEST))

    def set_loop(self, on: bool) -> None:
        """Play over and over, or once."""
        if on != self.loops:
            self.loops = on
            self.changed.emit()

    def range_starts_here(self) -> None:
        """Play from here on; an end that lies before is forgotten."""
        self.range_from = self.time
        if self.range_to is not None and self.range_to <= self.time:
            self.range_to = None
        self.changed.emit()

    def range_ends_here(self) -> None:
        """Play up to here; a start that lies behind is forgotten."""
        self.range_to = self.time
        if self.range_from is not None and self.range_from >= self.time:
            self.range_from = None
        self.changed.emit()

    def whole_take(self) -> None:
        """Forget the range."""
        self.range_from = self.range_to = None
        self.changed.emit()

    def _go(self, time: float) -> None:
        time = min(max(time, 0.0), self.duration)
        if time != self.time:
            self.time = time
            self.moved.emit(time)

    def _set_playing(self, on: bool) -> None:
        if on != self.is_playing:
            self.is_playing = on
            self.changed.emit()


def clock(seconds: float) -> str:
    """Return a take time as it is read on the screen: ``00:07.42``, ``1:02:07.42`` from an hour on."""
    hundredths = round(max(seconds, 0.0) * 100)
    minutes, rest = divmod(hundredths, 6000)
    hours, minutes = divmod(minutes, 60)
    lead = f"{hours}:" if hours else ""
    return f"{lead}{minutes:02d}:{rest // 100:02d}.{rest % 100:02d}"
