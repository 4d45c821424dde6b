"""The gyroscopes' offset of tags that are worn already: asked only when missing, then 5 s of sitting still.

A tag that lay still on a table knows its offset to 0.03 °/s. Sitting still gives the same with a larger
uncertainty, because whoever sits still sways; it is kept with what it is worth.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import replace
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.rest import RATE_SPREAD_WORN, RESOLUTION, Rest, find_rest
from studio.core.sample import SensorId, SensorInfo
from studio.core.take import Calibration
from studio.core.track import prior_offset_sigma

SITTING = 5.0  # s
SETTLE = 0.25  # s until the last samples have arrived
PATIENCE = 5.0  # s of waiting for the readings
KNOWN = math.radians(0.5)  # rad/s; a stored offset counts 0.05 °/s, a raw one 11.5, sitting gives 0.05 to 0.3
FEWEST = 0.8  # of the readings of 5 s; with fewer the rest is not what it says


class Phase(Enum):
    """Where the procedure stands."""

    IDLE = "idle"
    SITTING = "sitting"
    READING = "reading"
    JUDGED = "judged"


class Readings(NamedTuple):
    """What one sensor said in the last seconds, as the chip read it."""

    rate: NDArray[np.float64]
    """(n, 3), rad/s, sensor axes."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s², sensor axes."""


def is_missing(info: SensorInfo, flags: int, calibration: Calibration | None) -> bool:
    """Return whether nobody knows this gyroscope's offset well enough to start with."""
    return info.has_rate and prior_offset_sigma(info, flags, calibration) > KNOWN


class SittingRest:
    """Five seconds of sitting still, judged sensor by sensor; whoever moved is asked again, and only they."""

    def __init__(self) -> None:
        self.phase = Phase.IDLE
        self.wanted: Mapping[SensorId, float] = {}
        """Sensors that are asked, with their frame time in s."""
        self.found: dict[SensorId, Rest] = {}
        self.moved: tuple[SensorId, ...] = ()
        """Those of the last time whose wearer did not sit still, or who sent too little."""
        self._since = 0.0

    @property
    def is_running(self) -> bool:
        """Whether somebody is sitting still for us."""
        return self.phase in (Phase.SITTING, Phase.READING)

    def start(self, now: float, sensors: Mapping[SensorId, float]) -> None:
        """Ask these sensors (with their frame time, s) for a rest."""
        if self.is_running or not sensors:
            return
        self.wanted, self.found, self.moved = dict(sensors), {}, ()
        self._begin(now)

    def again(self, now: float) -> None:
        """Ask those once more who moved; what the others gave stays."""
        if self.phase is Phase.JUDGED and self.moved:
            self.wanted = {sensor: self.wanted[sensor] for sensor in self.moved}
            self._begin(now)

    def cancel(self) -> None:
        """Esc: nobody needs to sit still any more."""
        if self.is_running:
            self.phase = Phase.IDLE

    def tick(self, now: float) -> bool:
        """Let time pass; return True once, when the readings of the last ``SITTING`` seconds are wanted."""
        if self.phase is Phase.SITTING and now >= self._since + SITTING + SETTLE:
            self.phase = Phase.READING
            return True
        if self.phase is Phase.READING and now >= self._since + SITTING + SETTLE + PATIENCE:
            self._judged(self.wanted)
        return False

    def progress(self, now: float) -> float:
        """Return how much of the sitting has passed, 0…1."""
        if self.phase is Phase.SITTING:
            return min(1.0, max(0.0, (now - self._since) / SITTING))
        return 0.0 if self.phase is Phase.IDLE else 1.0

    def judge(self, readings: Mapping[SensorId, Readings]) -> Mapping[SensorId, Rest]:
        """Return the rests found in the readings of the sensors that were asked."""
        if self.phase is not Phase.READING:
            return {}
        fresh: dict[SensorId, Rest] = {}
        for sensor, frame_s in self.wanted.items():
            rest = _rest(readings[sensor], frame_s) if sensor in readings else None
            if rest is not None:
                fresh[sensor] = rest
        self.found |= fresh
        self._judged([sensor for sensor in self.wanted if sensor not in fresh])
        return fresh

    def _begin(self, now: float) -> None:
        self.phase, self._since = Phase.SITTING, now

    def _judged(self, moved: Collection[SensorId]) -> None:
        self.phase, self.moved = Phase.JUDGED, tuple(moved)


def _rest(readings: Readings, frame_s: float) -> Rest | None:
    kept = np.isfinite(readings.rate).all(axis=1)
    if kept.sum() * frame_s < FEWEST * SITTING:
        return None
    rest = find_rest(readings.rate[kept], readings.acceleration[kept], frame_s, RATE_SPREAD_WORN)
    if rest is None or float(rest.sigma.max()) > KNOWN:
        return None
    return replace(rest, sigma=np.maximum(rest.sigma, RESOLUTION))
