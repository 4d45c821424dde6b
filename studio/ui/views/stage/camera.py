"""The eye in front of the stage: a perspective projection that is orbited, moved and zoomed."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
View = Literal["front", "side", "top", "free"]
VIEWS: tuple[View, ...] = ("front", "side", "top", "free")

FIELD = math.radians(26.0)  # rad, of the picture's height; a portrait lens (75 mm on 35 mm film)
ROOM = 1.42  # of the stature; what the height shows at the target
NARROWEST = 0.86  # of the height; a narrower picture is measured by its width, so that the arms stay in it
LARGE = 900.0  # px; from this height on lines grow
NEAR = 0.2  # m; nothing nearer is drawn
NEAREST, FARTHEST = 1.5, 15.0  # m, from eye to target
STEEPEST = math.radians(89.9)  # rad; straight down has no "up"
LOWEST = math.radians(-20.0)  # rad; from below one would look through the floor

_DIRECTIONS: dict[View, tuple[float, float]] = {
    "front": (0.0, math.radians(7.0)),
    "side": (-math.pi / 2, math.radians(7.0)),
    "top": (0.0, STEEPEST),
    "free": (math.radians(-38.0), math.radians(14.0)),
}
"""Azimuth from where the wearer faces and elevation, rad; "side" looks at the right side, so that walking goes to the
right of the picture."""


@dataclass(frozen=True)
class Camera:
    """Where the eye is and what it looks at; replaced, never changed."""

    target: tuple[float, float, float]
    """m, world."""
    azimuth: float
    """rad, direction from the target to the eye, counted from world x towards world y."""
    elevation: float
    """rad, of the eye above the target's horizon."""
    distance: float
    """m, from the eye to the target."""
    size: tuple[float, float] = (640.0, 480.0)
    """px, width and height of the picture."""
    top: float = 0.0
    """px; where the picture begins below the upper edge of what is painted."""

    @cached_property
    def focal(self) -> float:
        """px; a metre at one metre's distance is that long."""
        width, height = self.size
        return min(height, width / NARROWEST) / (2 * math.tan(FIELD / 2))

    @property
    def hairline(self) -> float:
        """px; lines grow with the picture, so that they are still seen on a wall."""
        return max(1.0, min(self.size) / LARGE)

    @cached_property
    def axes(self) -> Array:
        """(3, 3): rows are the picture's right and up and the way towards the eye, in world axes."""
        ca, sa = math.cos(self.azimuth), math.sin(self.azimuth)
        ce, se = math.cos(self.elevation), math.sin(self.elevation)
        return np.array([[-sa, ca, 0.0], [-se * ca, -se * sa, ce], [ce * ca, ce * sa, se]])

    @cached_property
    def eye(self) -> Array:
        """(3,), m, world."""
        return np.asarray(np.array(self.target) + self.distance * self.axes[2])

    @property
    def horizon(self) -> float:
        """px from the top, where the floor ends."""
        return self.top + self.size[1] / 2 - self.focal * math.tan(self.elevation)

    def seen(self, points: Array) -> Array:
        """Return ``points`` (..., 3), m, world, along the picture's right, up and depth (away from the eye), m."""
        seen: Array = (points - self.eye) @ self.axes.T
        seen[..., 2] *= -1.0
        return seen

    def on_picture(self, seen: Array) -> Array:
        """Return px from the left and from the top, (..., 2), of ``seen`` points; NaN for what is nearer than NEAR."""
        depth = np.where(seen[..., 2] > NEAR, seen[..., 2], np.nan)
        out = np.empty((*seen.shape[:-1], 2))
        scale = self.focal / depth
        out[..., 0] = 0.5 * self.size[0] + seen[..., 0] * scale
        out[..., 1] = self.top + 0.5 * self.size[1] - seen[..., 1] * scale
        return out

    def project(self, points: Array) -> Array:
        """Return px from the left and from the top, (..., 2), of ``points`` (..., 3), m, world."""
        return self.on_picture(self.seen(points))

    def orbited(self, right: float, down: float) -> "Camera":
        """Return the camera after a drag in px: the width of the picture is half a turn."""
        turn = math.pi / max(self.size)
        elevation = min(max(self.elevation + down * turn, LOWEST), STEEPEST)
        return replace(self, azimuth=self.azimuth - right * turn, elevation=elevation)

    def moved(self, right: float, down: float) -> "Camera":
        """Return the camera after the picture was dragged by px: the target's distance follows the pointer."""
        metres = self.distance / self.focal
        step = metres * (-right * self.axes[0] + down * self.axes[1])
        return self.at(np.array(self.target) + step)

    def zoomed(self, factor: float) -> "Camera":
        """Return the camera ``factor`` times as far from its target."""
        return replace(self, distance=min(max(self.distance * factor, NEAREST), FARTHEST))

    def at(self, target: Array) -> "Camera":
        """Return the camera looking at another target, (3,), m, world, in the same direction."""
        x, y, z = (float(value) for value in target)
        return replace(self, target=(x, y, z))

    def between(self, other: "Camera", share: float) -> "Camera":
        """Return a camera on the shortest way to ``other``; 0 is this one."""
        turn = math.remainder(other.azimuth - self.azimuth, math.tau)
        target = np.array(self.target) * (1 - share) + np.array(other.target) * share
        return replace(
            self.at(target),
            azimuth=self.azimuth + share * turn,
            elevation=self.elevation + share * (other.elevation - self.elevation),
            distance=self.distance + share * (other.distance - self.distance),
        )


def standing(view: View, stature: float, heading: float, from_behind: bool, target: Array) -> Camera:
    """Return the camera of a named view of a body.

    Parameters
    ----------
    heading : rad, world
        Where the wearer faces.
    target : (3,), m, world
    """
    azimuth, elevation = _DIRECTIONS[view]
    distance = ROOM * stature / (2 * math.tan(FIELD / 2))
    turned = heading + azimuth + (math.pi if from_behind else 0.0)
    return Camera((0.0, 0.0, 0.0), turned, elevation, distance).at(target)
