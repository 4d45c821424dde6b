"""Who holds the camera: follows the body, swings to another view, and does what the hand says."""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import DEFAULT_STATURE, Segment, Skeleton
from studio.ui.models.stage_pose import StagePose
from studio.ui.views.stage.camera import VIEWS, Camera, View, standing

Array = NDArray[np.float64]

MIDDLE = 0.5  # of the stature; the height that is looked at
SWING = 0.18  # s; how long the way to another view takes
EASE = np.array([2.2, 2.2, 0.8])  # 1/s, along x, y, z; steps come at 2 Hz and must not shake the picture
LONGEST_STEP = 0.1  # s; after a stall the camera does not leap
FOLLOW_JUMP = 2.0  # m; a body that far away is another moment or another take: nothing to travel along
STILL = 1e-4  # m, and m/s: a camera that would move less stands


class Cameraman:
    """The camera and what it is doing; widgets give it times, bodies and drags."""

    def __init__(self) -> None:
        self.skeleton = Skeleton.from_stature(DEFAULT_STATURE)
        self.view: View = "free"
        self.mirrored = False
        self.follow = True
        self._body: StagePose | None = None
        self._panned = np.zeros(3)
        self._pace = np.zeros(3)
        self._size, self._top = (640.0, 480.0), 0.0
        self._swing: tuple[Camera, Camera, float] | None = None
        self.camera = self._standing()

    def frame(self, width: float, height: float, top: float) -> None:
        """Take over the size of the picture and where it begins, px."""
        framed = ((max(width, 1.0), max(height, 1.0)), top)
        if framed == (self._size, self._top):
            return
        self._size, self._top = framed
        if self._swing is not None:
            start, end, begun = self._swing
            self._swing = (self._framed(start), self._framed(end), begun)
        self.camera = self._framed(self.camera)

    def see(self, pose: StagePose | None) -> None:
        """Take over where the body is: one that appears or jumps is looked at without travelling there."""
        appeared = self._body is None
        self._body = pose if has_place(pose) else None
        if self._body is None or not self.follow:
            return
        if appeared or math.dist(self._goal(self._body), self.camera.target) > FOLLOW_JUMP:
            self.camera = self.camera.at(self._goal(self._body))
            self._pace = np.zeros(3)

    def choose(self, view: View, now: float | None) -> None:
        """Go to a named view; ``now`` in s, None to be there at once."""
        if view not in VIEWS:
            raise ValueError(f"no view is called {view!r}")
        self.view = view
        self._panned = np.zeros(3)
        self._go(self._standing(), now)

    def face(self, mirrored: bool, now: float | None) -> None:
        """Go to the other side of the body."""
        if mirrored != self.mirrored:
            self.mirrored = mirrored
            start = self.camera if self._swing is None else self._swing[1]
            self._go(replace(start, azimuth=start.azimuth + math.pi), now)

    def set_follow(self, on: bool) -> None:
        """Go with the body, or stay."""
        self.follow = on
        self._panned = np.zeros(3)

    def advance(self, since: float, now: float) -> bool:
        """Move on by ``since`` s; return whether the camera moved."""
        if self._swing is not None:
            start, end, begun = self._swing
            share = min((now - begun) / SWING, 1.0)
            self.camera = start.between(end, share * share * (3.0 - 2.0 * share))
            if share >= 1.0:
                self.camera, self._swing = end, None
            return True
        return self.follow and self._body is not None and self._keep_up(self._body, min(since, LONGEST_STEP))

    def _keep_up(self, body: StagePose, since: float) -> bool:
        """Go after the body like a critically damped mass that learns its pace: one who walks evenly is centred."""
        way = self._goal(body) - np.array(self.camera.target)
        if max(np.abs(way).max(), np.abs(self._pace).max()) < STILL:
            return False
        self._pace = self._pace + EASE * EASE * way * since
        step = (self._pace + 2.0 * EASE * way) * since
        self.camera = self.camera.at(np.array(self.camera.target) + step)
        return True

    def orbit(self, right: float, down: float) -> None:
        """Turn the eye around the body by a drag in px."""
        self._swing = None
        self.camera = self.camera.orbited(right, down)

    def pan(self, right: float, down: float) -> None:
        """Move the picture by a drag in px; it stays moved while following."""
        self._swing = None
        moved = self.camera.moved(right, down)
        self._panned += np.array(moved.target) - np.array(self.camera.target)
        self.camera = moved

    def zoom(self, factor: float) -> None:
        """Change the distance by a factor."""
        self._swing = None
        self.camera = self.camera.zoomed(factor)

    def _standing(self) -> Camera:
        heading, target = 0.0, np.array([0.0, 0.0, MIDDLE * self.skeleton.stature])
        if self._body is not None:
            heading, target = facing(self._body), self._goal(self._body)
        return self._framed(standing(self.view, self.skeleton.stature, heading, self.mirrored, target))

    def _go(self, camera: Camera, now: float | None) -> None:
        if now is None:
            self.camera, self._swing = camera, None
        else:
            self._swing = (self.camera, camera, now)

    def _goal(self, pose: StagePose) -> Array:
        lower = MIDDLE * self.skeleton.stature - self.skeleton.hips_height()
        return np.asarray(pose.joints[Segment.Hips] + (0.0, 0.0, lower) + self._panned)

    def _framed(self, camera: Camera) -> Camera:
        return replace(camera, size=self._size, top=self._top)


def has_place(pose: StagePose | None) -> bool:
    """Return whether it is known where a body is."""
    return pose is not None and bool(np.isfinite(pose.joints[Segment.Hips]).all())


def facing(pose: StagePose) -> float:
    """Return where a body faces, rad, from world x towards world y."""
    forward = rotation.rotate(pose.world_from_segment[Segment.Hips], (1.0, 0.0, 0.0))
    heading = math.atan2(forward[1], forward[0])
    return heading if math.isfinite(heading) else 0.0
