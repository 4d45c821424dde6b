"""Where the Hips are: the supporting foot stays on the floor, and the body moves over it.

Orientations alone say nothing about position. Each frame, the foot that is lower and turns less supports;
its lowest point (heel or ball) is held, and the lowest point of both feet is put on the floor. Against
Xsens' own root this stays within 1 % of the path in walking (biomechanics-and-formats §1.3).
"""

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Segment, Skeleton
from studio.core.take import Alignment

HEIGHT_SCALE = 0.03  # m; a foot 3 cm higher counts as much against support as TURN_SCALE
TURN_SCALE = 2.0  # rad/s
HYSTERESIS = 0.6  # of the score; the supporting foot must lose by as much
POINT_HYSTERESIS = 0.01  # m; heel to ball

_Corners = list[list[list[float]]]
"""Foot, heel or ball, coordinate: relative to the Hips, m, world axes."""

_FEET = [Segment.LeftFoot, Segment.RightFoot]
_CHAIN = np.array([[foot - 2, foot - 1, foot] for foot in _FEET]).T
"""(3, 2): thigh, shank, foot of both legs."""
_PARENTS_DOWN = np.array([[Segment.Hips, foot - 2, foot - 1] for foot in _FEET]).T


class Root:
    """Hips position frame by frame; the same steps live and offline."""

    def __init__(self, skeleton: Skeleton) -> None:
        """Begin over the world's origin, with the left foot as the supporting one."""
        self._skeleton = skeleton
        self._hips = (0.0, 0.0)
        self._foot = 0
        self._point = 0
        self._anchor = (0.0, 0.0)
        self._last_corners: _Corners | None = None
        self._last_feet: NDArray[np.float64] | None = None

    def step(self, world_from_segment: NDArray[np.float64], dt: float) -> NDArray[np.float64]:
        """Return the Hips position (3,), m, world, for one pose (23, 4) ``dt`` s after the one before."""
        return np.asarray(self.run(world_from_segment[None], np.array([dt]))[0])

    def run(self, world_from_segment: NDArray[np.float64], dt: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return Hips positions (n, 3), m, world, for poses (n, 23, 4) and the time since each one before (n,), s."""
        points = _foot_points(self._skeleton, world_from_segment)
        feet = world_from_segment[:, _FEET]
        before = np.concatenate([feet[:1] if self._last_feet is None else self._last_feet, feet[:-1]])
        turning = rotation.angle_between(before, feet) / np.maximum(dt, 1e-6)[:, None]
        self._last_feet = feet[-1:].copy()
        hips = np.empty((len(points), 3))
        for row, (corners, turns) in enumerate(zip(points.tolist(), turning.tolist(), strict=True)):
            hips[row] = self._advance(corners, turns)
        return hips

    def _advance(self, corners: _Corners, turning: list[float]) -> tuple[float, float, float]:
        lows = [min(corners[foot][0][2], corners[foot][1][2]) for foot in (0, 1)]
        lowest = min(lows)
        scores = [(lows[foot] - lowest) / HEIGHT_SCALE + turning[foot] / TURN_SCALE for foot in (0, 1)]
        other = 1 - self._foot
        if scores[other] + HYSTERESIS < scores[self._foot]:
            self._move_anchor(other, self._point)
        foot, point = self._foot, self._point
        if corners[foot][1 - point][2] + POINT_HYSTERESIS < corners[foot][point][2]:
            self._move_anchor(foot, 1 - point)
        held = corners[self._foot][self._point]
        if self._last_corners is None:
            self._anchor = (held[0], held[1])
        self._hips = (self._anchor[0] - held[0], self._anchor[1] - held[1])
        self._last_corners = corners
        return (*self._hips, -lowest)

    def _move_anchor(self, foot: int, point: int) -> None:
        """Hold another point, from where it stood in the frame before: nothing jumps and no frame's way is lost."""
        self._foot, self._point = foot, point
        if self._last_corners is not None:
            stood = self._last_corners[foot][point]
            self._anchor = (self._hips[0] + stood[0], self._hips[1] + stood[1])


def put_under_hold(hips: NDArray[np.float64], time: NDArray[np.float64], alignment: Alignment) -> None:
    """Move Hips (n, 3), m, in place, so that the world's origin lies under the pelvis at the reference hold.

    A hold that came before the take leaves the origin where the take began.
    """
    held = (time >= alignment.from_s) & (time <= max(alignment.to_s, alignment.from_s))
    if not held.any() and time[0] <= alignment.from_s <= time[-1]:  # a single moment, between two frames
        held[int(np.argmin(np.abs(time - alignment.from_s)))] = True
    if held.any():
        hips[:, :2] -= hips[held, :2].mean(axis=0)


def _foot_points(skeleton: Skeleton, world_from_segment: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return heel and ball of both feet relative to the Hips, (n, 2 feet, 2 points, 3), m, world axes."""
    links = rotation.rotate(world_from_segment[:, _PARENTS_DOWN], skeleton.offsets[_CHAIN])
    ankles = links.sum(axis=1)
    soles = rotation.rotate(world_from_segment[:, _FEET][:, :, None], skeleton.foot_points())
    return np.asarray(ankles[:, :, None] + soles)
