"""A motion made of arithmetic: every joint swings on its own, the body walks along and turns."""

from dataclasses import replace

import numpy as np

from studio.core import body, rotation
from studio.core.body import PLACES, Segment, Skeleton
from studio.core.pose import Motion
from studio.core.take import Alignment


def moving_body(frames=300, frame_s=0.02, seed=0, swing=0.8, stature=1.75):
    """Return a motion of all 23 joints; ``swing`` is the amplitude about each axis in rad."""
    random = np.random.default_rng(seed)
    time = np.arange(frames) * frame_s
    speed = 2 * np.pi * random.uniform(0.2, 1.0, (body.SEGMENTS, 3))
    start = random.uniform(0, 2 * np.pi, (body.SEGMENTS, 3))
    parent_from_segment = rotation.from_rotation_vector(swing * np.sin(speed * time[:, None, None] + start))
    world_from_segment = np.empty((frames, body.SEGMENTS, 4))
    turning = rotation.multiply(rotation.about(2, 0.7 * time), body.reference_pose("n")[Segment.Hips])
    world_from_segment[:, 0] = rotation.multiply(turning, parent_from_segment[:, 0])
    for segment in range(1, body.SEGMENTS):
        parent = world_from_segment[:, body.PARENTS[segment]]
        world_from_segment[:, segment] = rotation.multiply(parent, parent_from_segment[:, segment])
    hips = np.stack([0.8 * time, 0.1 * np.sin(time), 0.93 + 0.03 * np.cos(7 * time)], axis=1)
    return motion_of(world_from_segment, hips, frame_s, stature)


def standing(pose, frames=3, stature=1.75):
    """Return a motion that holds the pose ``n`` or ``t``."""
    skeleton = Skeleton.from_stature(stature)
    held = np.tile(body.reference_pose(pose), (frames, 1, 1))
    return motion_of(held, np.tile([0.0, 0.0, skeleton.hips_height()], (frames, 1)), 0.02, stature)


def motion_of(world_from_segment, hips, frame_s=0.02, stature=1.75):
    """Return a motion with all 15 sensors measured and nothing lost."""
    frames = len(hips)
    return Motion(
        time=np.arange(frames) * frame_s,
        frame_s=frame_s,
        world_from_segment=world_from_segment,
        hips=hips,
        skeleton=Skeleton.from_stature(stature),
        measured={place: np.ones(frames, bool) for place in PLACES},
        lost={place: np.zeros(frames, bool) for place in PLACES},
        alignment=Alignment("n", 0.0, 3.0, {}),
        method="offline",
        attitude="gyro-only",
    )


def turned(motion, segments, world_turn):
    """Return ``motion`` with some segments turned by ``world_turn`` (4,) in world axes."""
    world_from_segment = motion.world_from_segment.copy()
    world_from_segment[:, segments] = rotation.multiply(world_turn, world_from_segment[:, segments])
    return replace(motion, world_from_segment=world_from_segment)
