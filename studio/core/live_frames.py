"""What the live solver gives out, and its compact memory: half an hour of 15 sensors is 90,000 frames."""

from array import array
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core.body import Place
from studio.core.sample import Quaternion, SensorId

_ABSENT = (float("nan"),) * 5


class Frame(NamedTuple):
    """All worn sensors at one moment: one step of the solver."""

    time: float
    """s, of the newest sample; increasing from frame to frame."""
    attitudes: dict[SensorId, Quaternion]
    """world_from_sensor as far as each sensor got."""
    heard: dict[SensorId, float]
    """s, when each sensor was heard last; a packet that tells of the tag and not of its turning counts too."""
    groups: dict[SensorId, int]
    """Heading group of each sensor."""


class Pose(NamedTuple):
    """The body at one moment."""

    time: float
    world_from_segment: NDArray[np.float64]
    """(23, 4)."""
    hips: NDArray[np.float64]
    """(3,), m, world."""
    measured: frozenset[Place]
    """Places whose sensor was heard within the longest gap that is bridged, and whose heading is known."""


class FrameBlock(NamedTuple):
    """Some consecutive frames as arrays, a column for each sensor."""

    time: NDArray[np.float64]
    """(n,), s."""
    attitude: NDArray[np.float64]
    """(n, sensors, 4), world_from_sensor; NaN before its first sample."""
    heard: NDArray[np.float64]
    """(n, sensors), s; NaN before its first sample."""
    group: NDArray[np.int16]
    """(n, sensors); -1 before its first sample."""


class FrameLog:
    """Frames in the order in which they came, 42 bytes a sensor."""

    def __init__(self, sensors: Iterable[SensorId]) -> None:
        """Begin without frames; ``sensors`` gives the order of the columns."""
        self._sensors = tuple(sensors)
        self._values = array("d")
        self._groups = array("h")

    def __len__(self) -> int:
        return len(self._values) // (1 + 5 * len(self._sensors))

    def extend(self, frames: Sequence[Frame]) -> None:
        """Add frames."""
        for frame in frames:
            self._values.append(frame.time)
            for sensor in self._sensors:
                known = frame.attitudes.get(sensor)
                self._values.extend(_ABSENT if known is None else (*known, frame.heard[sensor]))
                self._groups.append(frame.groups.get(sensor, -1))

    def blocks(self, sensors: Sequence[SensorId], size: int) -> Iterator[FrameBlock]:
        """Yield all frames, ``size`` at a time, with these sensors as columns; nothing may be added meanwhile."""
        columns = [self._sensors.index(sensor) for sensor in sensors]
        values = np.frombuffer(self._values, np.float64).reshape(len(self), 1 + 5 * len(self._sensors))
        groups = np.frombuffer(self._groups, np.int16).reshape(len(self), len(self._sensors))
        for start in range(0, len(self), size):
            part = slice(start, start + size)
            told = values[part, 1:].reshape(-1, len(self._sensors), 5)[:, columns]
            yield FrameBlock(values[part, 0].copy(), told[..., :4], told[..., 4], groups[part][:, columns])


class Rows:
    """Rows of numbers that come one by one, the first of them a time, and are read as one array."""

    def __init__(self, width: int) -> None:
        """Begin without rows of ``width`` numbers."""
        self._width = width
        self._old: NDArray[np.float64] = np.empty((0, width))
        self._new = array("d")

    def __len__(self) -> int:
        return len(self._old) + len(self._new) // self._width

    def append(self, *values: float) -> None:
        """Add a row."""
        self._new.extend(values)

    def values(self) -> NDArray[np.float64]:
        """Return all rows (n, width); what was returned stays as it is when more come."""
        if self._new:
            new = np.frombuffer(self._new, np.float64).reshape(-1, self._width)
            self._old = np.concatenate([self._old, new]) if len(self._old) else new
            self._new = array("d")
        return self._old

    def forget(self, time: float, at_once: int) -> None:
        """Drop the rows from before ``time``, once ``at_once`` new ones have come."""
        if len(self._new) >= at_once * self._width and time > float("-inf"):
            values = self.values()
            self._old = values[int(np.searchsorted(values[:, 0], time)) :].copy()
