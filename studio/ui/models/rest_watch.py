"""Tags that lie on a table are found by themselves, and their gyroscope's offset is measured (paper 003, §2.5).

A tag that is worn is never taken for one on a table: a person who stands still sways at 0.5 to 1.5 °/s, five times
and more what counts as rest here, and all of ten seconds in a row have to be quiet.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QObject, Signal

from studio.capture.live_buffer import Window
from studio.core.rest import BLOCK, RATE_SPREAD_TABLE, WINDOW, Rest, find_rest
from studio.core.sample import SensorId, SensorInfo

NEEDED = 10.0  # s without a movement
LATEST = (WINDOW + 1) * BLOCK  # s looked at for a movement just now; one block more for those that fall between
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

    def feed(self, windows: Mapping[SensorId, Window], infos: Mapping[SensorId, SensorInfo]) -> None:
        """Look at the newest samples; ``windows`` reach back at least eleven seconds."""
        for gone in self._sensors.keys() - windows.keys():
            del self._sensors[gone]
        for sensor, window in windows.items():
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
        latest = _rest(window, known.newest - LATEST, frame_s)
        known.is_still = latest is not None
        if not known.is_still:
            known.since = math.inf
            return
        if math.isinf(known.since):
            known.since = known.newest - LATEST
        known.since = max(known.since, _unbroken_since(window))
        if known.rest is not None or known.newest - known.since < NEEDED:
            return
        rest = _rest(window, known.newest - NEEDED, frame_s)
        if rest is None:
            known.since = known.newest - LATEST
            return
        known.rest = rest
        self.rested.emit(sensor, rest)


def _unbroken_since(window: Window) -> float:
    """Return when the newest samples began that came without a pause."""
    pauses = np.flatnonzero(np.diff(window.time) > PAUSE)
    return float(window.time[pauses[-1] + 1]) if len(pauses) else -math.inf


def _rest(window: Window, since: float, frame_s: float) -> Rest | None:
    """Return the rest of all samples since a moment; None when there was a movement among them."""
    rows = (window.time >= since) & np.isfinite(window.rate).all(axis=1)
    rest = find_rest(window.rate[rows], window.acceleration[rows], frame_s)
    block = round(BLOCK / frame_s)
    if rest is None or rest.first > 0 or rest.last <= int(rows.sum()) - block:
        return None
    # ``find_rest`` asks each two seconds to be quiet; here all together have to be.
    spread = float(rest.sigma.max()) * math.sqrt((rest.last - rest.first) / block)
    return rest if spread < RATE_SPREAD_TABLE else None
