"""Tags that lie on a table are found by themselves, and their gyroscope's offset is measured (paper 003, §2.5).

A tag that is worn is never taken for one on a table: a person who stands still sways at 0.5 to 1.5 °/s, five times
and more what counts as rest here, and all of ten seconds in a row have to be quiet.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from studio.capture.live_buffer import Window
from studio.core.rest import BLOCK, RATE_SPREAD_TABLE, WINDOW, Rest, find_rest
from studio.core.sample import SensorId, SensorInfo

NEEDED = 10.0  # s without a movement
QUIET = RATE_SPREAD_TABLE / 2  # rad/s; nobody confirms what is measured here, so that it asks for more than the solver
MOST_LOOKS = 16  # sensors each time: 6 ms of the window's thread
PAUSE = 0.5  # s without a sample: what happened meanwhile is not known


class RestProgress(NamedTuple):
    """How far one sensor is."""

    held: float
    """s it has not moved, 0…10."""
    rest: Rest | None
    """What was measured, once it was."""

    @property
    def share(self) -> float:
        """Of the ten seconds, 0…1."""
        return 1.0 if self.rest is not None else min(self.held / NEEDED, 1.0)


@dataclass
class _Sensor:
    since: float = math.inf
    """s, clock of ``Sample.time``: still from here on; infinite while it moves."""
    newest: float = -math.inf
    is_still: bool = False
    rest: Rest | None = None


class RestWatch(QObject):
    """Fed four times a second with the last seconds of the sensors that can be seen."""

    rested = Signal(str, object)
    """A sensor and its Rest; once, until ``repeat``."""
    changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._sensors: dict[SensorId, _Sensor] = {}
        self._turn = 0

    def feed(self, windows: Mapping[SensorId, Window], infos: Mapping[SensorId, SensorInfo]) -> None:
        """Look at the newest samples; ``windows`` reach back at least eleven seconds."""
        for gone in self._sensors.keys() - windows.keys():
            del self._sensors[gone]
        self._turn += MOST_LOOKS
        for sensor, window in _in_turn(windows, self._turn):
            info = infos.get(sensor)
            if info is not None and info.has_rate and len(window.time):
                self._look(sensor, window, info.frame_s)
        self.changed.emit()

    def progress(self, sensor: SensorId) -> RestProgress:
        """Return how far a sensor is."""
        known = self._sensors.get(sensor)
        if known is None:
            return RestProgress(0.0, None)
        held = known.newest - known.since if math.isfinite(known.since) else 0.0
        return RestProgress(min(held, NEEDED), known.rest)

    def is_still(self, sensor: SensorId) -> bool | None:
        """Return whether a sensor lies as still as on a table; None before that can be told."""
        known = self._sensors.get(sensor)
        return None if known is None else known.is_still

    def done(self) -> int:
        """Return how many sensors have been measured."""
        return sum(known.rest is not None for known in self._sensors.values())

    def repeat(self, sensor: SensorId) -> None:
        """Measure a sensor again."""
        known = self._sensors.get(sensor)
        if known is not None:
            known.rest, known.since = None, math.inf
            self.changed.emit()

    def forget(self) -> None:
        """Begin anew: another source."""
        self._sensors.clear()
        self.changed.emit()

    def _look(self, sensor: SensorId, window: Window, frame_s: float) -> None:
        known = self._sensors.setdefault(sensor, _Sensor())
        known.newest = float(window.time[-1])
        latest = _latest(window, frame_s)
        known.is_still = _rest(latest, frame_s) is not None
        if not known.is_still:
            known.since = math.inf
            return
        if math.isinf(known.since):
            known.since = float(latest.time[0])
        known.since = max(known.since, _unbroken_since(window))
        if known.rest is not None or known.newest - known.since < NEEDED:
            return
        first = int(np.searchsorted(window.time, known.newest - NEEDED))
        rest = _rest(_Readings(window.time[first:], window.rate[first:], window.acceleration[first:]), frame_s)
        if rest is None:
            known.since = float(latest.time[0])
            return
        known.rest = rest
        self.rested.emit(sensor, rest)


def _in_turn(windows: Mapping[SensorId, Window], turn: int) -> list[tuple[SensorId, Window]]:
    """Return the windows to look at now: with many sensors not all of them each time."""
    both = [*windows.items()]
    if len(both) <= MOST_LOOKS:
        return both
    return [both[(turn + row) % len(both)] for row in range(MOST_LOOKS)]


class _Readings(NamedTuple):
    time: NDArray[np.float64]
    rate: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def _latest(window: Window, frame_s: float) -> _Readings:
    """Return the newest readings, as many as tell of a movement: two seconds of them, more where some are lost."""
    count = (WINDOW + 1) * round(BLOCK / frame_s)
    return _Readings(window.time[-count:], window.rate[-count:], window.acceleration[-count:])


def _unbroken_since(window: Window) -> float:
    """Return when the newest samples began that came without a pause."""
    pauses = np.flatnonzero(np.diff(window.time) > PAUSE)
    return float(window.time[pauses[-1] + 1]) if len(pauses) else -math.inf


def _rest(readings: _Readings, frame_s: float) -> Rest | None:
    """Return the rest of all readings; None when there was a movement among them, or too few to tell."""
    known = np.isfinite(readings.rate).all(axis=1)
    rest = find_rest(readings.rate[known], readings.acceleration[known], frame_s, QUIET)
    block = round(BLOCK / frame_s)
    if rest is None or rest.first > 0 or rest.last <= int(known.sum()) - block:
        return None
    # ``find_rest`` asks each two seconds to be quiet; here all together have to be.
    spread = float(rest.sigma.max()) * math.sqrt((rest.last - rest.first) / block)
    return rest if spread < QUIET else None
