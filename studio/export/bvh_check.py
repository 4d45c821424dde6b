"""A written BVH against the motion it was made from: joint positions, by mathematics of its own.

The file's forward kinematics multiplies matrices of sines and cosines in the order of its channels;
the motion's is ``Skeleton.joint_positions``. They share neither Euler angles nor offsets nor digits.
"""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core import body, rotation
from studio.core.errors import ReadBackDiffers
from studio.core.pose import Motion
from studio.export.bvh import BVH_FROM_WORLD, Preset
from studio.export.resampling import blocks_of_poses, timing_of

Array = NDArray[np.float64]

TOLERANCE = 1e-5  # m; 1e-3 cm, a tenth of a hair
RATE_TOLERANCE = 1e-9  # of the frame time; six decimals, as many programs write them, miss it


class BvhFile(Protocol):
    """What a reader of BVH files returns."""

    @property
    def names(self) -> Sequence[str]:
        """Joints in the order of the file."""
        ...

    @property
    def parents(self) -> Sequence[int]:
        """Index of each joint's parent, -1 for the root."""
        ...

    @property
    def offsets(self) -> Array:
        """(joints, 3), in the file's unit."""
        ...

    @property
    def channels(self) -> Sequence[Sequence[str]]:
        """Names of each joint's channels in the order of the file, e.g. ``Zrotation``."""
        ...

    @property
    def frame_time(self) -> float:
        """s."""
        ...

    @property
    def values(self) -> Array:
        """(frames, channels), rotations in degrees."""
        ...

    @property
    def notes(self) -> Sequence[str]:
        """What was unusual about the file, e.g. a count of frames that differs from the rows."""
        ...


def compare_with_motion(written: BvhFile, path: str, motion: Motion, preset: Preset, fps: float | None) -> None:
    """Raise ReadBackDiffers unless every joint of every frame stands where the motion has it, within 1e-3 cm."""
    timing = timing_of(motion, fps)
    if written.notes:
        raise ReadBackDiffers(path, "; ".join(written.notes))
    if tuple(written.names) != tuple(segment.name for segment in body.Segment):
        raise ReadBackDiffers(path, f"{len(written.names)} joints, not those of the skeleton")
    if tuple(written.parents) != body.PARENTS:
        raise ReadBackDiffers(path, "the joints hang together differently")
    if len(written.values) != timing.frames:
        raise ReadBackDiffers(path, f"{len(written.values)} frames instead of {timing.frames}")
    if abs(written.frame_time - timing.frame_s) > RATE_TOLERANCE * timing.frame_s:
        raise ReadBackDiffers(path, f"frame time {written.frame_time!r} s instead of {timing.frame_s!r} s")
    for poses in blocks_of_poses(motion, fps):
        rows = slice(poses.first, poses.first + len(poses.hips))
        found = joint_positions(written, rows) / preset.units_per_metre
        meant = motion.skeleton.joint_positions(poses.world_from_segment, poses.hips)
        apart = np.abs(found - rotation.rotate(BVH_FROM_WORLD, meant)).max(axis=(1, 2))
        if not (apart <= TOLERANCE).all():  # also when NaN
            worst = int(np.argmax(np.where(np.isnan(apart), np.inf, apart)))
            raise ReadBackDiffers(path, f"joints of frame {poses.first + worst} are {apart[worst] * 100:.4f} cm apart")


def joint_positions(written: BvhFile, rows: slice) -> Array:
    """Return where the file puts its joints, (frames, joints, 3), in its own unit and axes."""
    values = written.values[rows]
    positions = np.empty((len(values), len(written.names), 3))
    turned: list[Array] = []
    first = 0
    for joint, parent in enumerate(written.parents):
        names = written.channels[joint]
        columns = values[:, first : first + len(names)]
        first += len(names)
        step = written.offsets[joint] + _moved(columns, names)
        local = _turned(columns, names)
        if parent < 0:
            positions[:, joint] = step
            turned.append(local)
            continue
        positions[:, joint] = positions[:, parent] + np.einsum("nij,nj->ni", turned[parent], step)
        turned.append(turned[parent] @ local)
    return positions


def _moved(columns: Array, names: Sequence[str]) -> Array:
    moved = np.zeros((len(columns), 3))
    for column, name in zip(columns.T, names, strict=True):
        if name.lower().endswith("position"):
            moved[:, "XYZ".index(name[0].upper())] = column
    return moved


def _turned(columns: Array, names: Sequence[str]) -> Array:
    turned = np.tile(np.eye(3), (len(columns), 1, 1))
    for column, name in zip(columns.T, names, strict=True):
        if not name.lower().endswith("rotation"):
            continue
        axis = "XYZ".index(name[0].upper())
        one, two = (axis + 1) % 3, (axis + 2) % 3
        cosine, sine = np.cos(np.radians(column)), np.sin(np.radians(column))
        about = np.zeros((len(columns), 3, 3))
        about[:, axis, axis] = 1
        about[:, one, one], about[:, one, two] = cosine, -sine
        about[:, two, one], about[:, two, two] = sine, cosine
        turned = turned @ about
    return turned
