"""BVH as Blender, three.js, MotionBuilder and iClone all read it alike.

The file's axes are y up, z forward, x to the wearer's left. The rest pose (zero rotation) is the
T-pose. ROOT OFFSET is zero, because three.js adds it to the root's position and Blender does not;
only the root has positions; every other joint has three rotations, because Blender refuses fewer.

Rotations are written as Z, X', Y''. Middle angles near ±90 degrees swing the outer angles about, which
bends the motion in a program that interpolates between frames. With X (to the left) in the middle,
walking (any heading), lifted and reaching arms and bent elbows change by at most 4 degrees a frame at
60 Hz, and only thighs and shanks bent by 90 degrees (sitting) jump, by up to 80; with YXZ so do arms held
forward, with Y in the middle the Hips of someone who turns round, with Z the hanging arms.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import body, euler, rotation
from studio.core.body import Segment, Skeleton
from studio.core.pose import Motion
from studio.export.number_format import Numbers, Punctuation, as_text
from studio.export.resampling import Poses, blocks_of_poses, timing_of

Array = NDArray[np.float64]

BVH_FROM_WORLD: Array = np.array([0.5, -0.5, -0.5, -0.5])
"""World x (forward) becomes z, y (left) becomes x, z (up) becomes y."""
BVH_FROM_WORLD.flags.writeable = False

SEQUENCE = "ZXY"
ROTATION_CHANNELS = tuple(f"{axis}rotation" for axis in SEQUENCE)
POSITION_CHANNELS = ("Xposition", "Yposition", "Zposition")

RATES: tuple[float, ...] = (24000 / 1001, 24, 25, 30000 / 1001, 30, 50, 60, 100, 120)
"""Frames a second on offer beside the motion's own rate; of television in NTSC countries, 23.976 and 29.97 by name."""
DEFAULT_RATE = 60
"""Programs for animation play one frame of a file as one frame of the scene, so a file must be at a rate
that scenes use; of these 60 is the first that keeps a fast step or throw of a suit at 50 or 100 Hz."""

TURNS_KEPT = 3600.0  # degrees; readers store single floats, which at 3600 still resolve 0.0003 degrees


@dataclass(frozen=True)
class Preset:
    """Units for one family of programs; the format itself names none."""

    label: str
    units_per_metre: float
    decimals: int
    """Of lengths; rotations have six."""


PRESETS = {
    "blender": Preset("Blender (m)", 1.0, 9),
    "motionbuilder": Preset("MotionBuilder / iClone (cm)", 100.0, 6),
}

_PUNCTUATION = Punctuation(b".", b" ", b"\n")


def rate_name(fps: float) -> str:
    """Return what people call a rate: 23.976, 24, 29.97."""
    return f"{fps:.5g}"


def bvh_blocks(motion: Motion, preset: Preset, fps: float | None) -> Iterator[bytes]:
    """Yield the file: the header, then some frames at a time.

    Parameters
    ----------
    fps : float or None
        One of RATES; None keeps the motion's own rate.
    """
    timing = timing_of(motion, fps)
    motion_head = f"MOTION\nFrames: {timing.frames}\nFrame Time: {timing.frame_s:.12g}\n"
    yield (_hierarchy(motion.skeleton, preset) + motion_head).encode("ascii")
    last: Array | None = None
    for poses in blocks_of_poses(motion, fps):
        angles = euler.to_euler(_local_rotations(poses), SEQUENCE)
        if last is None:
            angles = euler.unwrap_continuous(angles, SEQUENCE)
        else:
            angles = euler.unwrap_continuous(np.concatenate([last, angles]), SEQUENCE)[1:]
        last = angles[-1:]
        yield _rows(poses, angles, preset)


def offsets_in_t_pose(skeleton: Skeleton) -> Array:
    """Return each joint from its parent's joint in the T-pose, (23, 3), m, BVH axes; the Hips at zero."""
    bvh_from_segment = rotation.multiply(BVH_FROM_WORLD, body.reference_pose("t"))
    offsets = np.zeros((body.SEGMENTS, 3))
    offsets[1:] = rotation.rotate(bvh_from_segment[list(body.PARENTS[1:])], skeleton.offsets[1:])
    return offsets


def _local_rotations(poses: Poses) -> Array:
    """Return ``parent_from_joint`` in the file's sense, (k, 23, 4): zero rotation is the T-pose, BVH axes."""
    rest = rotation.multiply(BVH_FROM_WORLD, body.reference_pose("t"))  # bvh_from_segment
    parents = list(body.PARENTS[1:])
    in_segments = rotation.multiply(
        rotation.inverse(poses.world_from_segment[:, parents]), poses.world_from_segment[:, 1:]
    )
    local = np.empty(poses.world_from_segment.shape)
    local[:, 0] = rotation.multiply(
        rotation.multiply(BVH_FROM_WORLD, poses.world_from_segment[:, 0]), rotation.inverse(rest[0])
    )
    local[:, 1:] = rotation.multiply(rotation.multiply(rest[parents], in_segments), rotation.inverse(rest[1:]))
    return local


def _rows(poses: Poses, angles: Array, preset: Preset) -> bytes:
    hips = rotation.rotate(BVH_FROM_WORLD, poses.hips) * preset.units_per_metre
    degrees = np.degrees(angles).reshape(len(angles), -1)
    # Whole turns are taken off far outside only, so that a dancer's spins run on without a jump.
    degrees -= 2 * TURNS_KEPT * np.rint(degrees / (2 * TURNS_KEPT))
    return as_text([Numbers(hips, preset.decimals), Numbers(degrees, 6)], _PUNCTUATION)


def _hierarchy(skeleton: Skeleton, preset: Preset) -> str:
    rest = rotation.multiply(BVH_FROM_WORLD, body.reference_pose("t"))
    offsets = offsets_in_t_pose(skeleton)
    children: dict[int, list[Segment]] = {segment: [] for segment in range(body.SEGMENTS)}
    for segment in list(Segment)[1:]:
        children[body.PARENTS[segment]].append(segment)

    def offset(pad: str, vector: Array) -> str:
        numbers = " ".join(f"{value * preset.units_per_metre + 0.0:.{preset.decimals}f}" for value in vector)
        return f"{pad}  OFFSET {numbers}\n"

    def joint(segment: Segment, depth: int) -> str:
        pad = "  " * depth
        channels = ROTATION_CHANNELS if depth else POSITION_CHANNELS + ROTATION_CHANNELS
        text = f"{pad}{'JOINT' if depth else 'ROOT'} {segment.name}\n{pad}{{\n" + offset(pad, offsets[segment])
        text += f"{pad}  CHANNELS {len(channels)} {' '.join(channels)}\n"
        text += "".join(joint(child, depth + 1) for child in children[segment])
        if segment in skeleton.ends:
            tip = rotation.rotate(rest[segment], skeleton.ends[segment])
            text += f"{pad}  End Site\n{pad}  {{\n" + offset(pad + "  ", tip) + f"{pad}  }}\n"
        return text + f"{pad}}}\n"

    return "HIERARCHY\n" + joint(Segment.Hips, 0)
