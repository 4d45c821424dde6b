"""Places where sensors sit, segments of the skeleton, and their lengths from stature."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np
from numpy.typing import NDArray

from studio.core import frames, rotation


class Place(Enum):
    """Where a sensor sits: the 15 rows of paper 003, Table 1, in its order.

    Table 1 names both 12/13 and 14/15 "ankle"; 12/13 are the shank and 14/15 the foot here.
    """

    HEAD = "head"
    CHEST = "chest"
    LEFT_UPPER_ARM = "left_upper_arm"
    RIGHT_UPPER_ARM = "right_upper_arm"
    LEFT_FOREARM = "left_forearm"
    RIGHT_FOREARM = "right_forearm"
    LEFT_HAND = "left_hand"
    RIGHT_HAND = "right_hand"
    PELVIS = "pelvis"
    LEFT_THIGH = "left_thigh"
    RIGHT_THIGH = "right_thigh"
    LEFT_SHANK = "left_shank"
    RIGHT_SHANK = "right_shank"
    LEFT_FOOT = "left_foot"
    RIGHT_FOOT = "right_foot"

    @property
    def number(self) -> int:
        """1…15, the row of Table 1."""
        return PLACES.index(self) + 1


PLACES: tuple[Place, ...] = tuple(Place)

ARMS: tuple[Place, ...] = PLACES[2:8]
"""Upper arms, forearms and hands."""

PRESETS: dict[str, tuple[Place, ...]] = {"full": PLACES, "upper": PLACES[:8], "lower": PLACES[8:]}
"""Paper 003, experiment 1: full body 15, upper body #1-8, lower body #9-15."""


class Segment(IntEnum):
    """The 23 segments (each with the joint at its origin), parents before children; HumanIK's names."""

    Hips = 0
    Spine = 1
    Spine1 = 2
    Spine2 = 3
    Spine3 = 4
    Neck = 5
    Head = 6
    LeftShoulder = 7
    LeftArm = 8
    LeftForeArm = 9
    LeftHand = 10
    RightShoulder = 11
    RightArm = 12
    RightForeArm = 13
    RightHand = 14
    LeftUpLeg = 15
    LeftLeg = 16
    LeftFoot = 17
    LeftToeBase = 18
    RightUpLeg = 19
    RightLeg = 20
    RightFoot = 21
    RightToeBase = 22


SEGMENTS = len(Segment)

PARENTS: tuple[int, ...] = (-1, 0, 1, 2, 3, 4, 5, 4, 7, 8, 9, 4, 11, 12, 13, 0, 15, 16, 17, 0, 19, 20, 21)
"""Index of each segment's parent; -1 for the Hips."""

SEGMENT_OF: dict[Place, Segment] = {
    Place.HEAD: Segment.Head,
    Place.CHEST: Segment.Spine3,
    Place.LEFT_UPPER_ARM: Segment.LeftArm,
    Place.RIGHT_UPPER_ARM: Segment.RightArm,
    Place.LEFT_FOREARM: Segment.LeftForeArm,
    Place.RIGHT_FOREARM: Segment.RightForeArm,
    Place.LEFT_HAND: Segment.LeftHand,
    Place.RIGHT_HAND: Segment.RightHand,
    Place.PELVIS: Segment.Hips,
    Place.LEFT_THIGH: Segment.LeftUpLeg,
    Place.RIGHT_THIGH: Segment.RightUpLeg,
    Place.LEFT_SHANK: Segment.LeftLeg,
    Place.RIGHT_SHANK: Segment.RightLeg,
    Place.LEFT_FOOT: Segment.LeftFoot,
    Place.RIGHT_FOOT: Segment.RightFoot,
}

MEASURED_PARENT: dict[Place, Place] = {
    Place.HEAD: Place.CHEST,
    Place.CHEST: Place.PELVIS,
    Place.LEFT_UPPER_ARM: Place.CHEST,
    Place.RIGHT_UPPER_ARM: Place.CHEST,
    Place.LEFT_FOREARM: Place.LEFT_UPPER_ARM,
    Place.RIGHT_FOREARM: Place.RIGHT_UPPER_ARM,
    Place.LEFT_HAND: Place.LEFT_FOREARM,
    Place.RIGHT_HAND: Place.RIGHT_FOREARM,
    Place.LEFT_THIGH: Place.PELVIS,
    Place.RIGHT_THIGH: Place.PELVIS,
    Place.LEFT_SHANK: Place.LEFT_THIGH,
    Place.RIGHT_SHANK: Place.RIGHT_THIGH,
    Place.LEFT_FOOT: Place.LEFT_SHANK,
    Place.RIGHT_FOOT: Place.RIGHT_SHANK,
}
"""The 14 joints between measured segments: child to parent."""

REFERENCE_POSES = ("n", "t", "sit")
"""Poses that are known for every segment, in the order in which they serve as the reference."""

LEFT_ARM = (Segment.LeftArm, Segment.LeftForeArm, Segment.LeftHand)
RIGHT_ARM = (Segment.RightArm, Segment.RightForeArm, Segment.RightHand)

DEFAULT_STATURE = 1.75  # m; used, and said, when nobody entered one

# Fractions of stature between joint centres, segment axes (x forward, y up, z right) in N-pose.
# Origin: joint-centre defaults of biomechanics-and-formats §1.2, not the landmark lengths of
# Drillis & Contini, which joined naively give an arm span of 1.14 H.
_OFFSETS: dict[Segment, tuple[float, float, float]] = {
    Segment.Hips: (0.0, 0.530, 0.0),
    Segment.Spine: (0.0, 0.055, 0.0),
    Segment.Spine1: (0.0, 0.064, 0.0),
    Segment.Spine2: (0.0, 0.058, 0.0),
    Segment.Spine3: (0.0, 0.058, 0.0),
    Segment.Neck: (0.0, 0.080, 0.0),
    Segment.Head: (0.0, 0.054, 0.0),
    Segment.LeftShoulder: (0.0, 0.044, -0.016),
    Segment.LeftArm: (0.0, 0.0, -0.074),
    Segment.LeftForeArm: (0.0, -0.162, 0.0),
    Segment.LeftHand: (0.0, -0.152, 0.0),
    Segment.RightShoulder: (0.0, 0.044, 0.016),
    Segment.RightArm: (0.0, 0.0, 0.074),
    Segment.RightForeArm: (0.0, -0.162, 0.0),
    Segment.RightHand: (0.0, -0.152, 0.0),
    Segment.LeftUpLeg: (0.0, 0.0, -0.045),
    Segment.LeftLeg: (0.0, -0.245, 0.0),
    Segment.LeftFoot: (0.0, -0.246, 0.0),
    Segment.LeftToeBase: (0.095, -0.030, 0.0),
    Segment.RightUpLeg: (0.0, 0.0, 0.045),
    Segment.RightLeg: (0.0, -0.245, 0.0),
    Segment.RightFoot: (0.0, -0.246, 0.0),
    Segment.RightToeBase: (0.095, -0.030, 0.0),
}
_ENDS: dict[Segment, tuple[float, float, float]] = {
    Segment.Head: (0.0, 0.101, 0.0),
    Segment.LeftHand: (0.0, -0.106, 0.0),
    Segment.RightHand: (0.0, -0.106, 0.0),
    Segment.LeftToeBase: (0.050, -0.009, 0.0),
    Segment.RightToeBase: (0.050, -0.009, 0.0),
}
HEEL = (-0.045, -0.039, 0.0)  # fraction of stature, from the ankle in foot axes
BALL = (0.095, -0.039, 0.0)  # fraction of stature, from the ankle in foot axes


@dataclass(frozen=True)
class Skeleton:
    """Lengths of one person's 23 segments."""

    stature: float
    """m."""
    offsets: NDArray[np.float64]
    """(23, 3), m, from the parent's joint to this segment's joint in the parent's axes; row 0 is the
    Hips above the floor in N-pose, world axes turned into segment axes (x forward, y up, z right)."""
    ends: dict[Segment, NDArray[np.float64]]
    """(3,), m, from the last joint of each chain to its tip, in that segment's axes."""

    @classmethod
    def from_stature(cls, stature: float) -> "Skeleton":
        """Return the default proportions for a body ``stature`` metres tall."""
        offsets = np.array([_OFFSETS[segment] for segment in Segment]) * stature
        offsets.flags.writeable = False
        return cls(stature, offsets, {segment: np.array(end) * stature for segment, end in _ENDS.items()})

    def hips_height(self) -> float:
        """Return the height of the Hips above the floor in N-pose, m."""
        return float(self.offsets[0, 1])

    def foot_points(self) -> NDArray[np.float64]:
        """Return heel and ball under the ankle, (2, 3), m, foot axes."""
        return np.array([HEEL, BALL]) * self.stature

    def joint_positions(
        self, world_from_segment: NDArray[np.float64], hips: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return where the joints are: forward kinematics.

        Parameters
        ----------
        world_from_segment : (..., 23, 4)
        hips : (..., 3), m, world
            Position of the Hips joint.

        Returns
        -------
        (..., 23, 3), m, world
        """
        positions = np.empty((*world_from_segment.shape[:-1], 3))
        positions[..., 0, :] = hips
        for segment in range(1, SEGMENTS):
            parent = PARENTS[segment]
            step = rotation.rotate(world_from_segment[..., parent, :], self.offsets[segment])
            positions[..., segment, :] = positions[..., parent, :] + step
        return positions


def reference_pose(name: str) -> NDArray[np.float64]:
    """Return ``world_from_segment`` (23, 4) of a reference pose.

    ``n``: N-pose. ``t``: T-pose. ``sit``: upright on a chair, thighs level, shanks upright, arms hanging.
    """
    if name not in REFERENCE_POSES:
        raise ValueError(f"no reference pose is called {name!r}")
    pose = np.tile(frames.N_POSE, (SEGMENTS, 1))
    if name == "t":
        pose[list(LEFT_ARM)] = frames.LEFT_ARM_T_POSE
        pose[list(RIGHT_ARM)] = frames.RIGHT_ARM_T_POSE
    elif name == "sit":
        pose[[Segment.LeftUpLeg, Segment.RightUpLeg]] = frames.SITTING_THIGH
    return pose


def measured_ancestor(segment: int, measured: Sequence[bool]) -> int:
    """Return the nearest ancestor of ``segment`` (or itself) that is measured, -1 when there is none."""
    while segment >= 0 and not measured[segment]:
        segment = PARENTS[segment]
    return segment
