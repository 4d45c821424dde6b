"""The last minute for display: rings that the acquisition thread fills and the window copies from."""

import threading
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.live_frames import Pose
from studio.core.sample import Flag, Quaternion, Sample, SensorId

KEPT = 60.0  # s
FASTEST = 100.0  # Hz; a faster sensor shows less than a minute

COLUMNS = 13
"""time, orientation (w x y z), rate (x y z), acceleration (x y z), frame, flags."""


class Window(NamedTuple):
    """A copy of the newest samples of one sensor, oldest first."""

    time: NDArray[np.float64]
    """(n,), s, clock of ``Sample.time``."""
    orientation: NDArray[np.float64]
    """(n, 4)."""
    rate: NDArray[np.float64]
    """(n, 3), rad/s."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s²."""
    lost_before: NDArray[np.int64]
    """(n,), frames that are missing just before each sample."""
    clipped: NDArray[np.bool_]
    """(n,), readings at the end of the chip's range."""
    flags: NDArray[np.int64]
    """(n,), ``Flag`` of each sample."""


class LiveBuffer:
    """Written by one thread, copied by another, with one lock."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._rings: dict[SensorId, _Ring] = {}
        self._pose: Pose | None = None
        self._attitudes: dict[SensorId, Quaternion] = {}

    def clear(self) -> None:
        """Forget everything."""
        with self._lock:
            self._rings.clear()
            self._pose = None
            self._attitudes = {}

    def add(self, sample: Sample) -> None:
        """Keep a sample."""
        with self._lock:
            ring = self._rings.get(sample.sensor)
            if ring is None:
                ring = self._rings[sample.sensor] = _Ring()
            ring.add(sample)

    def show(self, attitudes: dict[SensorId, Quaternion], pose: Pose | None) -> None:
        """Keep the newest attitudes and the newest pose."""
        with self._lock:
            self._attitudes = attitudes
            self._pose = pose

    def newest(self) -> tuple[dict[SensorId, Quaternion], Pose | None]:
        """Return the newest attitudes (world_from_sensor) and pose."""
        with self._lock:
            return dict(self._attitudes), self._pose

    def snapshot(self, sensors: Sequence[SensorId], seconds: float) -> dict[SensorId, Window]:
        """Return copies of the last ``seconds`` of the sensors asked for, and of no others."""
        with self._lock:
            rows = {sensor: self._rings[sensor].newest(seconds) for sensor in sensors if sensor in self._rings}
        return {sensor: _window(table) for sensor, table in rows.items()}


class _Ring:
    def __init__(self) -> None:
        self._rows = np.empty((int(KEPT * FASTEST), COLUMNS))
        self._next = 0
        self._count = 0

    def add(self, sample: Sample) -> None:
        self._rows[self._next] = (
            sample.time,
            *sample.orientation,
            *sample.rate,
            *sample.acceleration,
            sample.frame,
            sample.flags,
        )
        self._next = (self._next + 1) % len(self._rows)
        self._count = min(self._count + 1, len(self._rows))

    def newest(self, seconds: float) -> NDArray[np.float64]:
        order = (self._next - self._count + np.arange(self._count)) % len(self._rows)
        time = self._rows[order, 0]
        if len(time) == 0:
            return np.empty((0, COLUMNS))
        first = int(np.searchsorted(time, time[-1] - seconds))
        return self._rows[order[first:]]


def _window(rows: NDArray[np.float64]) -> Window:
    frames = rows[:, 11].astype(np.int64)
    lost = np.zeros(len(rows), np.int64)
    lost[1:] = np.maximum(np.diff(frames) - 1, 0)
    flags = rows[:, 12].astype(np.int64)
    return Window(rows[:, 0], rows[:, 1:5], rows[:, 5:8], rows[:, 8:11], lost, flags & int(Flag.CLIPPED) > 0, flags)
