"""A motion on another frame rate, a block of frames at a time."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import body, rotation
from studio.core.pose import Motion

Array = NDArray[np.float64]

BLOCK = 1024  # frames; small enough for the processor's cache, large enough that numpy's calls do not count
EVEN = 1e-6  # s; rounding of times, far below what clocks of sensors vary by
TICK = 1e-6  # frames; rounding of a duration must not lose the last frame


@dataclass(frozen=True)
class Timing:
    """The grid of an exported motion; row 0 is the motion's first row."""

    frames: int
    frame_s: float
    """s."""


@dataclass(frozen=True)
class Poses:
    """Some consecutive frames, all finite."""

    first: int
    """Row of the export's grid."""
    world_from_segment: Array
    """(k, 23, 4)."""
    hips: Array
    """(k, 3), m, world."""


def timing_of(motion: Motion, fps: float | None) -> Timing:
    """Return the grid at ``fps`` frames a second; None keeps the motion's own rate, evened out where it varies."""
    if fps is None and is_even(motion):
        return Timing(len(motion), motion.frame_s)
    frame_s = motion.frame_s if fps is None else 1 / fps
    return Timing(math.floor((motion.time[-1] - motion.time[0]) / frame_s + TICK) + 1, frame_s)


def is_even(motion: Motion) -> bool:
    """Return whether the rows lie one frame apart: those of a live motion come when the sensors sent."""
    return bool((np.abs(np.diff(motion.time) - motion.frame_s) <= EVEN).all())


def blocks_of_poses(motion: Motion, fps: float | None) -> Iterator[Poses]:
    """Yield the motion on the grid of ``timing_of``: rotations along the shortest way, the Hips linearly.

    A pose that is not finite is held from the frame before (the T-pose where there is none); how many
    there are, tells ``unfinished``.
    """
    timing, is_native = timing_of(motion, fps), fps is None and is_even(motion)
    rotations, hips = body.reference_pose("t"), np.array([0.0, 0.0, motion.skeleton.hips_height()])
    for first in range(0, timing.frames, BLOCK):
        rows = np.arange(first, min(first + BLOCK, timing.frames))
        turned, moved = _between(motion, rows, timing, is_native)
        turned, moved = _held(turned, rotations), _held(moved, hips)
        rotations, hips = turned[-1], moved[-1]
        yield Poses(first, turned, moved)


def unfinished(motion: Motion) -> int:
    """Return how many rows hold a segment or Hips that is not finite: 0 unless the solver failed."""
    rotations = np.isfinite(motion.world_from_segment).all(axis=(1, 2))
    return int((~(rotations & np.isfinite(motion.hips).all(axis=1))).sum())


def _between(motion: Motion, rows: NDArray[np.int64], timing: Timing, is_native: bool) -> tuple[Array, Array]:
    if is_native:
        return motion.world_from_segment[rows], motion.hips[rows]
    place = np.interp(motion.time[0] + rows * timing.frame_s, motion.time, np.arange(len(motion)))
    before = np.floor(place + TICK).astype(np.int64)
    after = np.minimum(before + 1, len(motion) - 1)
    fraction = np.clip(place - before, 0.0, 1.0)
    turned = rotation.slerp(motion.world_from_segment[before], motion.world_from_segment[after], fraction[:, None])
    moved = motion.hips[before] + (motion.hips[after] - motion.hips[before]) * fraction[:, None]
    return turned, moved


def _held(values: Array, last: Array) -> Array:
    """Return (k, ..., c) with rows that are not finite replaced by the row before, at first by ``last`` (..., c)."""
    finite = np.isfinite(values).all(axis=-1)
    if finite.all():
        return values
    stacked = np.concatenate([last[None], values])
    known = np.concatenate([np.ones((1, *finite.shape[1:]), bool), finite])
    order = np.arange(len(known)).reshape(-1, *[1] * (known.ndim - 1))
    source = np.maximum.accumulate(np.where(known, order, 0), axis=0)
    return np.asarray(np.take_along_axis(stacked, source[..., None], axis=0)[1:])
