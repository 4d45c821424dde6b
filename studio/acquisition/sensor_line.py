"""Where each packet of one sensor belongs: frame number, device time and time, though counter and clock wrap.

A sensor's packets lie on a line: so many frames on the counter are so many ticks on the clock and about
so many seconds here. A packet off the line is a stepped clock when the counter still fits, and otherwise
is doubted; three doubted packets that make a line of their own, with nothing of the old one between, are
a sensor that started anew.
"""

from collections import deque
from enum import Enum
from typing import NamedTuple

from studio.acquisition.dialects.dialect import Reading, Traits
from studio.core.timeline import ClockMap, SharedClock, nearest

TIME_SYNCED = 64  # Flag.TIME_SYNCED; members of an IntFlag cost a microsecond each time

REORDER_TIME = 0.05  # s a late packet may be behind the newest
REORDER_FRAMES = 8  # and at least so many frames

FRAMES_UNIT = 10_000  # Hz; frame lengths are multiples of 100 µs (PROTOCOL.md, SYNC)
FRAME_SHORTEST = 1e-3  # s
FRAME_LONGEST = 0.0255  # s; one byte in SYNC
FRAME_SPAN = 1.0  # s between two packets that may tell the frame length: the counter cannot have wrapped
FRAME_COUNTS = 64  # frames between them at most

LOOSE_FIT = 1.0  # frames between counter and clock: synchronising shifts the grid by less than one
OFF_GRID = 3 * 64e-6  # s between them, packet after packet: the frame is another; stamps are good to a tick of 64 µs
TIGHT_FIT = 0.1  # frames, of a clock nobody touched: 64 µs ticks are 0.006 frames of 10 ms
FIT_SKEW = 2e-4  # of the frames passed: a grid that is not quite the clock's
HOST_FIT = 0.25  # s between counter and arrivals: delays of a radio and a busy USB port
EARLIEST = -0.5  # s before it can have been measured: the first packets were held up
LATEST = 1.0  # s behind the line, unless it goes on where the line was

CONFIRMATIONS = 3  # doubted packets in a row that make a line of their own

SLOWEST = 0.5  # of a step on the device's clock is kept when the map learns of less delay: time never turns


class Verdict(Enum):
    """What a packet turned out to be."""

    NEXT = "next"
    LATE = "late"
    DUPLICATE = "duplicate"
    DOUBTED = "doubted"
    RESTARTED = "restarted"
    """The sensor started anew: another epoch."""
    REFRAMED = "reframed"
    """The sensor goes on with another frame length: another epoch too, as the grid is another."""


class Spot(NamedTuple):
    """Where a packet belongs."""

    verdict: Verdict
    frame: int = 0
    device_time: float = 0.0
    """s."""
    time: float = 0.0
    """s, this computer's monotonic clock."""
    missing: int = 0
    """Frames skipped just before."""
    redeemed: int = 0
    """Packets doubted before that are explained now."""
    stepped: bool = False
    """The sensor's clock was set, or this computer's arrivals jumped, while the counter went on."""


class _Point(NamedTuple):
    frame: int
    ticks: int
    time: float


class _Doubt(NamedTuple):
    """The newest packet of a line that may become the sensor's."""

    sequence: int
    clock: int
    received: float
    frame_s: float
    packets: int


DUPLICATE = Spot(Verdict.DUPLICATE)
DOUBTED = Spot(Verdict.DOUBTED)


class SensorLine:
    """The line of one sensor; ``shared`` is the clock that synchronised sensors of this link follow."""

    def __init__(self, traits: Traits, shared: SharedClock) -> None:
        self.frame_s = traits.frame_s
        self.epoch = 0
        self.first_frame = 0
        """Of the epoch: what came before it was never counted as lost."""
        self._traits = traits
        self._shared = shared
        self._own: ClockMap | None = None
        self._frame_known = False
        self._sequence = 0
        self._clock = 0
        self._received = 0.0
        self._is_synced = False
        self._newest = _Point(0, 0, 0.0)
        self._history: deque[_Point] = deque()
        self._seen = 0  # bit k: the frame k before the newest has come
        self._doubt: _Doubt | None = None
        self._off_grid = 0  # packets in a row

    @property
    def clock_map(self) -> ClockMap:
        """The map in force: the shared clock's for a synchronised sensor."""
        return self._shared.map if self._own is None else self._own

    def place(self, reading: Reading, received: float) -> Spot:
        """Return where a packet belongs that arrived at ``received`` (s)."""
        if not self._history:
            return self._start(reading, received, Verdict.NEXT)
        ticks = self._ticks_since(reading, received)
        if not self._frame_known:
            self._learn_frame(reading.sequence - self._sequence, ticks)
        tick, frame_s = self._traits.clock_tick, self.frame_s
        frames = ticks * tick / frame_s
        steps = nearest(reading.sequence - self._sequence, self._traits.sequence_modulus, round(frames))
        misfit = abs(steps - frames) - FIT_SKEW * abs(frames)
        lag = received - self._newest.time - ticks * tick
        is_timely = EARLIEST <= lag <= LATEST
        if misfit <= LOOSE_FIT and (is_timely or (lag > LATEST and ticks * tick <= LATEST)):
            if steps <= 0:
                return self._look_back(reading, received, steps, ticks)
            self._off_grid = self._off_grid + 1 if misfit * frame_s > OFF_GRID else 0
            if self._off_grid >= CONFIRMATIONS:
                other = self._frame_between(reading.sequence - self._sequence, ticks)
                if other not in (0.0, frame_s):
                    return self._begin_epoch(reading, received, other, Verdict.REFRAMED)
            return self._go_on(reading, received, steps, ticks)
        if misfit <= TIGHT_FIT and steps > 0:
            # The arrivals jumped, not the sensor: a suspended computer, or a backlog of minutes.
            return self._step(reading, received, steps, ticks)
        if reading.flags & TIME_SYNCED and not (is_timely and self._is_synced):
            # Its clock was set: it has just heard a receiver, or its receiver started anew.
            steps = self._steps_by_arrival(reading, received)
            if steps > 0:
                return self._step(reading, received, steps, round(steps * frame_s / tick))
        return self._doubted(reading, received)

    def _ticks_since(self, reading: Reading, received: float) -> int:
        expected = round((received - self._received) / self._traits.clock_tick)
        return nearest(reading.clock - self._clock, self._traits.clock_modulus, expected)

    def _steps_by_arrival(self, reading: Reading, received: float) -> int:
        """Return the frames passed by counter and arrival, 0 when these two do not fit."""
        passed = received - self._received
        expected = round(passed / self.frame_s)
        steps = nearest(reading.sequence - self._sequence, self._traits.sequence_modulus, expected)
        fits = abs(steps * self.frame_s - passed) <= HOST_FIT + FIT_SKEW * passed
        return steps if fits else 0

    def _learn_frame(self, counts: int, ticks: int) -> None:
        frame_s = self._frame_between(counts, ticks)
        if frame_s:
            self.frame_s = frame_s
            self._frame_known = True

    def _frame_between(self, counts: int, ticks: int) -> float:
        """Return the frame length that two packets tell, s; 0 when they tell none."""
        counts %= self._traits.sequence_modulus
        passed = ticks * self._traits.clock_tick
        if not (0 < counts <= FRAME_COUNTS and 0 < passed <= FRAME_SPAN):
            return 0.0
        frame_s = round(passed / counts * FRAMES_UNIT) / FRAMES_UNIT
        is_told = abs(frame_s * counts - passed) <= 1.5 * self._traits.clock_tick
        return frame_s if is_told and FRAME_SHORTEST <= frame_s <= FRAME_LONGEST else 0.0

    def _start(self, reading: Reading, received: float, verdict: Verdict) -> Spot:
        """Begin the line, or a further epoch of it, whose frames and times go on from the newest."""
        before = self._newest if self._history else None
        self._own = None
        if before is None:
            ticks, frame = reading.clock, reading.sequence
            time = self._time_of(reading, received, ticks)
        else:
            passed = max(received - self._received, self.frame_s)
            ticks = before.ticks + round(passed / self._traits.clock_tick)
            time = max(self._time_of(reading, received, ticks), before.time + SLOWEST * self.frame_s)
            frame = before.frame + max(round((time - before.time) / self.frame_s), 1)
        self._history.clear()
        self.first_frame = frame
        self._off_grid = 0
        return self._accept(reading, received, _Point(frame, ticks, time), verdict, 0)

    def _time_of(self, reading: Reading, received: float, ticks: int) -> float:
        """Return when a packet was measured by the shared clock where it follows it, else by its own."""
        if reading.flags & TIME_SYNCED:
            time = self._shared.time_of(reading.clock, received)
            if time is not None:
                self._own = None
                return time
        if self._own is None:
            self._own = ClockMap()
        device_time = ticks * self._traits.clock_tick
        self._own.observe(device_time, received)
        return self._own.host(device_time)

    def _go_on(self, reading: Reading, received: float, steps: int, ticks: int) -> Spot:
        newest = self._newest
        time = self._time_of(reading, received, newest.ticks + ticks)
        least = newest.time + SLOWEST * self.frame_s * steps
        point = _Point(newest.frame + steps, newest.ticks + ticks, max(time, least))
        return self._accept(reading, received, point, Verdict.NEXT, steps)

    def _step(self, reading: Reading, received: float, steps: int, ticks: int) -> Spot:
        """Go on by the counter though clock or arrivals jumped: the map so far no longer holds."""
        newest = self._newest
        self._own = None
        time = self._time_of(reading, received, newest.ticks + ticks)
        point = _Point(newest.frame + steps, newest.ticks + ticks, max(time, newest.time + SLOWEST * self.frame_s))
        return self._accept(reading, received, point, Verdict.NEXT, steps)._replace(stepped=True)

    def _accept(self, reading: Reading, received: float, point: _Point, verdict: Verdict, steps: int) -> Spot:
        window = self._window()
        self._seen = (self._seen << steps | 1) & ((2 << window) - 1) if 0 < steps <= window else 1
        self._sequence, self._clock, self._received = reading.sequence, reading.clock, received
        self._is_synced = bool(reading.flags & TIME_SYNCED)
        self._newest = point
        self._history.append(point)
        while len(self._history) > window + 2:
            self._history.popleft()
        self._doubt = None
        missing = max(steps - 1, 0)
        return Spot(verdict, point.frame, point.ticks * self._traits.clock_tick, point.time, missing)

    def _window(self) -> int:
        """Return how many frames behind the newest a late packet is still taken."""
        return max(REORDER_FRAMES, round(REORDER_TIME / self.frame_s))

    def _look_back(self, reading: Reading, received: float, steps: int, ticks: int) -> Spot:
        back = -steps
        if back > self._window():
            # Soon after newer ones it is a repeat, or too late to be kept; after a silence perhaps a new start.
            is_stale = received - self._received < HOST_FIT
            return DUPLICATE if is_stale else self._doubted(reading, received)
        if self._seen >> back & 1:
            return DUPLICATE
        self._seen |= 1 << back
        frame = self._newest.frame + steps
        at = next(i for i, point in enumerate(self._history) if point.frame > frame)
        after = self._history[at]
        if at:
            before = self._history[at - 1]
            share = (frame - before.frame) / (after.frame - before.frame)
            time = before.time + share * (after.time - before.time)
        else:
            time = after.time - (after.frame - frame) * self.frame_s
        point = _Point(frame, self._newest.ticks + ticks, time)
        self._history.insert(at, point)
        return Spot(Verdict.LATE, frame, point.ticks * self._traits.clock_tick, time)

    def _doubted(self, reading: Reading, received: float) -> Spot:
        doubt = self._doubt
        frame_s = 0.0 if doubt is None else self._continues(doubt, reading, received)
        if doubt is None or not frame_s:
            doubt = _Doubt(reading.sequence, reading.clock, received, 0.0, 1)
        else:
            doubt = _Doubt(reading.sequence, reading.clock, received, frame_s, doubt.packets + 1)
        self._doubt = doubt
        if doubt.packets < CONFIRMATIONS:
            return DOUBTED
        return self._restart(reading, received, doubt.frame_s)

    def _continues(self, doubt: _Doubt, reading: Reading, received: float) -> float:
        """Return the frame length on which ``reading`` follows the doubted line, 0 when it does not."""
        passed = received - doubt.received
        expected = round(passed / self._traits.clock_tick)
        ticks = nearest(reading.clock - doubt.clock, self._traits.clock_modulus, expected)
        elapsed = ticks * self._traits.clock_tick
        if elapsed <= 0 or abs(passed - elapsed) > -EARLIEST:
            return 0.0
        told = self._frame_between(reading.sequence - doubt.sequence, ticks)
        if told:
            return told if doubt.frame_s in (0.0, told) else 0.0
        # Too far apart to tell it: they must fit the length known.
        frame_s = doubt.frame_s or self.frame_s
        frames = elapsed / frame_s
        steps = nearest(reading.sequence - doubt.sequence, self._traits.sequence_modulus, round(frames))
        return frame_s if abs(steps - frames) <= LOOSE_FIT + FIT_SKEW * frames else 0.0

    def _restart(self, reading: Reading, received: float, frame_s: float) -> Spot:
        passed = received - self._received
        elapsed = self._ticks_since(reading, received) * self._traits.clock_tick
        goes_on = abs(elapsed - passed) <= HOST_FIT and passed <= FRAME_SPAN
        verdict = Verdict.REFRAMED if goes_on and frame_s != self.frame_s else Verdict.RESTARTED
        spot = self._begin_epoch(reading, received, frame_s, verdict)
        return spot._replace(redeemed=CONFIRMATIONS - 1)

    def _begin_epoch(self, reading: Reading, received: float, frame_s: float, verdict: Verdict) -> Spot:
        self.epoch += 1
        spot = self._start(reading, received, verdict)
        self.frame_s = frame_s
        return spot
