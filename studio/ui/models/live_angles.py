"""The joint angles of the running figure: newest value, least, most and range, and the last seconds."""

from collections import deque
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QObject, Signal

from studio.analysis.joint_angles import JointAngle, joint_angles
from studio.core.body import PLACES, Skeleton
from studio.core.live_frames import Pose
from studio.core.pose import Motion
from studio.core.take import Alignment

KEPT = 60.0  # s
MOST_SHOWN = 4
BREAK = 0.15  # s; poses are shown 25 times a second


class Shown(NamedTuple):
    """One angle as it stands now, degrees; NaN where it is not measured."""

    name: str
    now: float
    least: float
    most: float
    positive: str
    """What a positive value means."""

    @property
    def range(self) -> float:
        """Most minus least."""
        return self.most - self.least


class LiveAngles(QObject):
    """Fed with poses, at most as often as they are shown."""

    changed = Signal()
    names_changed = Signal()
    """Other angles can be chosen: sensors came or went."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.names: tuple[str, ...] = ()
        """All that can be chosen now."""
        self.chosen: tuple[str, ...] = ("left_knee_flexion", "right_knee_flexion")
        self._least: dict[str, float] = {}
        self._most: dict[str, float] = {}
        self._newest: dict[str, JointAngle] = {}
        self._values: dict[str, float] = {}
        self._history: deque[tuple[float, dict[str, float]]] = deque()

    def choose(self, names: Sequence[str]) -> None:
        """Show these, at most four."""
        self.chosen = tuple(names)[:MOST_SHOWN]
        self.changed.emit()

    def reset(self) -> None:
        """Begin least and most anew."""
        self._least.clear()
        self._most.clear()
        self.changed.emit()

    def add(self, pose: Pose, alignment: Alignment, skeleton: Skeleton) -> None:
        """Take the newest pose."""
        angles = {angle.name: angle for angle in joint_angles(_moment(pose, alignment, skeleton))}
        if tuple(angles) != self.names:
            self.names = tuple(angles)
            self.names_changed.emit()
        self._newest = angles
        newest, before = self._history[-1] if self._history else (pose.time, {})
        if pose.time - newest > BREAK:  # nobody looked meanwhile: no line is drawn across
            self._history.append((pose.time - BREAK / 2, {}))
        values = {
            name: _running_on(float(np.degrees(a.values[0])), before.get(name, np.nan)) for name, a in angles.items()
        }
        self._values = values
        for name, value in values.items():
            if np.isfinite(value):
                self._least[name] = min(value, self._least.get(name, value))
                self._most[name] = max(value, self._most.get(name, value))
        self._history.append((pose.time, values))
        while self._history and self._history[0][0] < pose.time - KEPT:
            self._history.popleft()
        self.changed.emit()

    def shown(self) -> tuple[Shown, ...]:
        """Return the chosen angles as they stand."""
        return tuple(self._shown(name) for name in self.chosen)

    def window(self, name: str, seconds: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return times (n,), s, and degrees (n,) of the last seconds of an angle."""
        if not self._history:
            return np.empty(0), np.empty(0)
        since = self._history[-1][0] - seconds
        rows = [(time, values.get(name, np.nan)) for time, values in self._history if time >= since]
        table = np.array(rows).reshape(-1, 2)
        return table[:, 0], table[:, 1]

    def _shown(self, name: str) -> Shown:
        newest = self._newest.get(name)
        now = self._values.get(name, np.nan)
        least, most = self._least.get(name, np.nan), self._most.get(name, np.nan)
        return Shown(name, now, least, most, "" if newest is None else newest.positive)


def _running_on(degrees: float, before: float) -> float:
    """Return an angle without a jump of whole turns since the one before."""
    turns = (before - degrees) / 360.0
    return degrees + 360.0 * round(turns) if np.isfinite(turns) else degrees


def _moment(pose: Pose, alignment: Alignment, skeleton: Skeleton) -> Motion:
    """Return a pose as a motion of one frame."""
    worn = [place for place in PLACES if place in alignment.limbs and alignment.limbs[place].source != "unknown"]
    known = {place: np.array([place in pose.measured]) for place in worn}
    return Motion(
        time=np.array([pose.time]),
        frame_s=1.0,
        world_from_segment=pose.world_from_segment[None],
        hips=pose.hips[None],
        skeleton=skeleton,
        measured=known,
        lost={place: ~measured for place, measured in known.items()},
        alignment=alignment,
        method="live",
        attitude="",
    )
