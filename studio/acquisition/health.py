"""How well a sensor is heard: counts, pace and state, shown and never computed with."""

import math
from collections import deque
from dataclasses import dataclass, field

from studio.core.sample import NAN, SensorId

RATE_WINDOW = 2.0  # s over which the rate is counted
ARRIVALS = 512  # kept for the rate: more than 2 s at 200 Hz
JITTER_SHARE = 1 / 16  # of a new difference in the mean (RFC 3550, 6.4.1)


@dataclass(frozen=True, slots=True)
class HealthSnapshot:
    """The health of one sensor at one moment."""

    sensor: SensorId
    received: int
    """Samples kept."""
    lost: int
    """Frames the sensor counted and nobody heard."""
    malformed: int
    """Packets of this sensor that made no sense."""
    duplicates: int
    late: int
    """Kept though a newer sample had come before."""
    clipped: int
    reboots: int
    rate: float
    """Hz, over the last two seconds."""
    jitter: float
    """s, mean change of the transport's delay from sample to sample."""
    battery: float
    """0…1; NaN when unknown."""
    temperature: float
    """°C; NaN when unknown."""
    rssi: float
    """dBm; NaN when unknown."""
    silent_for: float
    """s since the last packet."""
    offset: float
    """s, this computer's clock minus the sensor's; NaN before the first sample."""
    skew: float
    """ppm the sensor's clock runs faster than this computer's."""

    @property
    def loss(self) -> float:
        """Lost frames as a share of all, 0…1."""
        return self.lost / max(self.lost + self.received, 1)


@dataclass(slots=True)
class SensorHealth:
    """The running counts of one sensor."""

    sensor: SensorId
    received: int = 0
    lost: int = 0
    refused: int = 0
    """Packets the dialect could not read."""
    inconsistent: int = 0
    """Packets whose counter and clock belong to no line."""
    duplicates: int = 0
    late: int = 0
    clipped: int = 0
    reboots: int = 0
    battery: float = NAN
    temperature: float = NAN
    rssi: float = NAN
    jitter: float = 0.0
    offset: float = NAN
    skew: float = 0.0
    heard: float = NAN
    """s, when the last packet of any kind arrived."""

    _delay: float = NAN
    _arrivals: deque[float] = field(default_factory=lambda: deque(maxlen=ARRIVALS))

    def count(self, time: float, received: float) -> None:
        """Count a kept sample that was measured at ``time`` and arrived at ``received``, both s."""
        self.received += 1
        delay = received - time
        if self._arrivals:
            self.jitter += (abs(delay - self._delay) - self.jitter) * JITTER_SHARE
        self._delay = delay
        self._arrivals.append(received)

    def silent_for(self, now: float) -> float:
        """Return the time since the last packet, s; infinite before the first."""
        return math.inf if math.isnan(self.heard) else max(now - self.heard, 0.0)

    def rate(self, now: float) -> float:
        """Return the samples per second over the last two seconds, Hz."""
        arrivals = [at for at in self._arrivals if at > now - RATE_WINDOW]
        if len(arrivals) < 2:
            return 0.0
        # From the first arrival when the sensor is younger than the window, and down to now when it fell silent.
        if self.received == len(arrivals):
            return (len(arrivals) - 1) / max(now - arrivals[0], 1e-9)
        return len(arrivals) / RATE_WINDOW

    def snapshot(self, now: float) -> HealthSnapshot:
        """Return what to show at ``now`` (s, monotonic clock of this computer)."""
        return HealthSnapshot(
            sensor=self.sensor,
            received=self.received,
            lost=self.lost,
            malformed=self.refused + self.inconsistent,
            duplicates=self.duplicates,
            late=self.late,
            clipped=self.clipped,
            reboots=self.reboots,
            rate=self.rate(now),
            jitter=self.jitter,
            battery=self.battery,
            temperature=self.temperature,
            rssi=self.rssi,
            silent_for=self.silent_for(now),
            offset=self.offset,
            skew=self.skew,
        )
