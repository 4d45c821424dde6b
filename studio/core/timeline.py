"""Counters and clocks of devices, which wrap and run at their own pace, as one time of this computer."""

from collections import deque

BLOCK = 2.0  # s of device time of which only the quickest packet is kept
BLOCKS = 150  # kept: five minutes, long enough for 1 ppm, short enough to follow warming crystals
SKEW_SPAN = 20.0  # s; below it the jitter of a radio (ms) looks like more skew than any crystal has
SKEW_LIMIT = 500e-6  # crystals are within 50 ppm, calibrated RC oscillators within 250 ppm

EARLIEST = -0.5  # s before the line: the first packets after opening may have been kept waiting that long
LATEST = 1.0  # s behind the line
RESTART_READINGS = 3  # that agree with each other and not with the line
RESTART_SILENCE = 1.0  # s without a reading that agrees with the line: the line has ended


def nearest(raw: int, modulus: int, expected: int) -> int:
    """Return the number congruent to ``raw`` that is nearest to ``expected``."""
    half = modulus // 2
    return expected + (raw - expected + half) % modulus - half


class ClockMap:
    """The line from a device's clock to this computer's monotonic clock, from arrivals.

    Packets are late by a varying time and never early, so the line is the lower envelope of
    (device time, arrival - device time): of the blocks' quickest packets the edge of the lower convex
    hull that spans their middle, which is the line below all of them with the least sum of distances
    (Moon, Skelly, Towsley 1999, "Estimation and Removal of Clock Skew from Network Delay Measurements").
    """

    def __init__(self) -> None:
        self._origin: float | None = None
        self._height = 0.0  # of the line at the origin, s
        self._slope = 0.0
        self._latest = 0.0  # device time since the origin, s
        self._block_end = BLOCK
        self._quickest: tuple[float, float] | None = None
        self._quickest_excess = 0.0
        self._lows: deque[tuple[float, float]] = deque(maxlen=BLOCKS)

    def observe(self, device: float, received: float) -> None:
        """Take the arrival of something the device stamped with ``device``, both s."""
        if self._origin is None:
            self._origin = device
            self._height = received - device
        at = device - self._origin
        delay = received - device
        excess = delay - self._height - self._slope * at
        if excess < 0:
            self._height += excess
            self._quickest_excess -= excess
        if self._quickest is None or excess < self._quickest_excess:
            self._quickest = (at, delay)
            self._quickest_excess = max(excess, 0.0)
        if at > self._latest:
            self._latest = at
            if at >= self._block_end:
                self._lows.append(self._quickest)
                self._quickest = None
                self._block_end = at + BLOCK
                self._fit()

    def host(self, device: float) -> float:
        """Return when ``device`` (s) was, on this computer's monotonic clock."""
        if self._origin is None:
            raise ValueError("nothing observed")
        return device + self._height + self._slope * (device - self._origin)

    @property
    def offset(self) -> float:
        """This computer's clock minus the device's at the latest arrival, s."""
        return self._height + self._slope * self._latest

    @property
    def skew(self) -> float:
        """How much faster than this computer's the device's clock runs, ppm."""
        return -1e6 * self._slope

    def _fit(self) -> None:
        lows = self._lows
        if lows[-1][0] - lows[0][0] >= SKEW_SPAN:
            self._slope = min(max(_slope_below(lows), -SKEW_LIMIT), SKEW_LIMIT)
        self._height = min(delay - self._slope * at for at, delay in lows)


def _slope_below(points: deque[tuple[float, float]]) -> float:
    """Return the slope of the lower convex hull's edge that spans the mean abscissa; points in order."""
    hull: list[tuple[float, float]] = []
    for x, y in points:
        while len(hull) > 1:
            (x0, y0), (x1, y1) = hull[-2:]
            if (y1 - y0) * (x - x0) < (y - y0) * (x1 - x0):
                break
            hull.pop()
        hull.append((x, y))
    middle = sum(x for x, _ in points) / len(points)
    right = next(i for i, (x, _) in enumerate(hull) if i and x >= middle)
    (x0, y0), (x1, y1) = hull[right - 1], hull[right]
    return (y1 - y0) / (x1 - x0)


class SharedClock:
    """One wrapping clock that several sensors are synchronised to, e.g. their receiver's."""

    def __init__(self, modulus: int, tick: float) -> None:
        """Begin before anything was heard.

        Parameters
        ----------
        modulus : ticks after which the clock, as sent, starts at 0 again
        tick : s
        """
        self._modulus = modulus
        self._tick = tick  # s
        self._ticks: int | None = None
        self._received = 0.0
        self._agreed = 0.0
        self._strangers: list[tuple[int, float]] = []
        self.map = ClockMap()
        self.restarts = 0
        """How often the clock was found to have started anew."""

    def time_of(self, clock: int, received: float) -> float | None:
        """Return when ``clock`` (ticks as sent) was on this computer's clock, None when it is another clock's."""
        if self._ticks is None:
            return self._follow(clock, received)
        expected = self._ticks + round((received - self._received) / self._tick)
        ticks = nearest(clock, self._modulus, expected)
        lag = received - self.map.host(ticks * self._tick)
        # What was held up somewhere comes late, but goes on where the clock was.
        goes_on = 0 <= (ticks - self._ticks) * self._tick <= LATEST
        if lag >= EARLIEST and (lag <= LATEST or goes_on):
            return self._follow(ticks, received)
        return self._doubt(clock, received)

    def _follow(self, ticks: int, received: float) -> float:
        self._ticks = ticks if self._ticks is None else max(ticks, self._ticks)
        self._received = self._agreed = received
        self._strangers.clear()
        device = ticks * self._tick
        self.map.observe(device, received)
        return self.map.host(device)

    def _doubt(self, clock: int, received: float) -> float | None:
        if self._strangers:
            last_clock, last_received = self._strangers[-1]
            passed = nearest(clock - last_clock, self._modulus, 0) * self._tick
            if not EARLIEST <= received - last_received - passed <= LATEST:
                self._strangers.clear()
        self._strangers.append((clock, received))
        if len(self._strangers) < RESTART_READINGS or received - self._agreed < RESTART_SILENCE:
            self._strangers = self._strangers[-RESTART_READINGS:]
            return None
        self.map = ClockMap()
        self._ticks = None
        self.restarts += 1
        return self._follow(clock, received)
