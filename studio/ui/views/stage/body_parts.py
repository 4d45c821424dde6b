"""The shape of the body: each part is the convex hull of a few balls that are fixed to segments.

A hull of balls has a hull of circles as its picture, whose edge in any direction is that of its outermost circle: all
parts, from a finger to the chest, are projected in one step.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Place, Segment, Skeleton

Array = NDArray[np.float64]
Side = Literal["left", "right"]
Tone = Literal["limb", "joint", "left", "right", "face"]

_MODEL = 1.75  # m; the stature that the numbers below belong to
MOST_BALLS = 7
ARM, LEG = ("upper_arm", "forearm", "hand"), ("thigh", "shank", "foot")
OUT: dict[Side, float] = {"left": -1.0, "right": 1.0}
"""Which way of z leads away from the body."""


@dataclass(frozen=True)
class Ball:
    """A ball fixed to a segment."""

    segment: Segment
    where: tuple[float, float, float]
    """m, segment axes, of a body of ``_MODEL``."""
    radius: float
    """m, of a body of ``_MODEL``."""
    towards: Segment | None = None
    share: float = 1.0
    """``where`` counts from this share of the way to the joint of ``towards``, if there is one."""


@dataclass(frozen=True)
class Part:
    """A convex piece of the body."""

    name: str
    place: Place
    """Whose sensor moves it."""
    tone: Tone
    balls: tuple[Ball, ...]
    """From the upper end to the lower."""
    row: int = 1
    """How many balls make an end: the axis joins the middles of both ends."""
    needs: tuple[Place, ...] = ()
    """What joins these is drawn only while all of them are known."""
    lead: float = 0.0
    """m; how much nearer it counts where it is as deep as another part, so that the same one always covers."""


def body_parts() -> tuple[Part, ...]:
    """Return all parts of a body."""
    return (*_trunk(), *_head(), *_arm("left"), *_leg("left"), *_arm("right"), *_leg("right"))


def _trunk() -> tuple[Part, ...]:
    s = Segment
    return (
        Part(
            "pelvis",
            Place.PELVIS,
            "limb",
            (
                *_pair(s.Hips, (0.0, 0.085, 0.060), 0.074),
                *_pair(s.Hips, (-0.008, 0.012, 0.078), 0.080),
                *_pair(s.Hips, (-0.006, -0.042, 0.022), 0.074),
            ),
            2,
            lead=0.10,
        ),
        Part(
            "abdomen",
            Place.PELVIS,
            "limb",
            (*_pair(s.Spine2, (0.006, 0.0, 0.056), 0.080), *_pair(s.Spine, (0.0, -0.01, 0.054), 0.076)),
            2,
            lead=-0.06,
        ),
        Part(
            "chest",
            Place.CHEST,
            "limb",
            (
                *_pair(s.Spine3, (-0.006, 0.080, 0.106), 0.058),
                Ball(s.Neck, (-0.016, -0.030, 0.0), 0.058),
                *_pair(s.Spine3, (0.014, 0.035, 0.072), 0.094),
                *_pair(s.Spine2, (0.010, 0.025, 0.060), 0.084),
            ),
            2,
        ),
        Part(
            "neck",
            Place.CHEST,
            "limb",
            (Ball(s.Head, (0.002, -0.016, 0.0), 0.050), Ball(s.Neck, (-0.010, 0.026, 0.0), 0.055)),
            lead=-0.05,
        ),
    )


def _head() -> tuple[Part, ...]:
    s = Segment
    return (
        Part(
            "head",
            Place.HEAD,
            "limb",
            (
                Ball(s.Head, (-0.014, 0.102, 0.0), 0.080),
                Ball(s.Head, (0.012, 0.098, 0.0), 0.077),
                Ball(s.Head, (0.020, 0.062, 0.0), 0.068),
                Ball(s.Head, (0.030, 0.020, 0.0), 0.052),
            ),
        ),
        Part(
            "brow",
            Place.HEAD,
            "face",
            (*_pair(s.Head, (0.058, 0.103, 0.050), 0.015), *_pair(s.Head, (0.078, 0.101, 0.020), 0.015)),
            2,
            lead=0.03,
        ),
        Part(
            "nose",
            Place.HEAD,
            "joint",
            (
                Ball(s.Head, (0.080, 0.094, 0.0), 0.008),
                *_pair(s.Head, (0.082, 0.056, 0.011), 0.010),
                Ball(s.Head, (0.104, 0.058, 0.0), 0.012),
            ),
            lead=0.04,
        ),
    )


def _arm(side: Side) -> tuple[Part, ...]:
    place, out = _places(side), OUT[side]
    arm, forearm, hand = (Segment[side.capitalize() + name] for name in ("Arm", "ForeArm", "Hand"))
    return (
        _joint("shoulder", place["upper_arm"], arm, 0.060, (place["upper_arm"], Place.CHEST)),
        _limb("upper_arm", place["upper_arm"], (Ball(arm, (0, 0, 0), 0.054), Ball(forearm, (0, 0, 0), 0.042))),
        _joint("elbow", place["forearm"], forearm, 0.044, (place["upper_arm"], place["forearm"])),
        _limb(
            "forearm",
            place["forearm"],
            (
                Ball(forearm, (0, 0, 0), 0.041),
                Ball(forearm, (0, 0, 0), 0.043, hand, 0.28),
                Ball(hand, (0, 0.004, 0), 0.030),
            ),
        ),
        Part(
            "hand",
            place["hand"],
            side,
            (
                Ball(hand, (0, -0.004, 0), 0.026),
                Ball(hand, (0.033, -0.084, 0), 0.018),
                Ball(hand, (-0.030, -0.082, 0), 0.018),
                Ball(hand, (0.020, -0.160, -0.012 * out), 0.011),
                Ball(hand, (-0.014, -0.162, -0.012 * out), 0.011),
            ),
            lead=-0.02,
        ),
        Part(
            "thumb",
            place["hand"],
            side,
            (Ball(hand, (0.018, -0.028, -0.006 * out), 0.017), Ball(hand, (0.058, -0.092, -0.020 * out), 0.012)),
        ),
    )


def _leg(side: Side) -> tuple[Part, ...]:
    place, out = _places(side), OUT[side]
    upper, lower, foot, toes = (Segment[side.capitalize() + name] for name in ("UpLeg", "Leg", "Foot", "ToeBase"))
    return (
        _limb(
            "thigh",
            place["thigh"],
            (
                Ball(upper, (0, -0.01, -0.002 * out), 0.080),
                Ball(upper, (0.008, 0, -0.002 * out), 0.073, lower, 0.35),
                Ball(lower, (0, 0, 0), 0.054),
            ),
        ),
        _joint("knee", place["shank"], lower, 0.0565, (place["thigh"], place["shank"])),
        _limb(
            "shank",
            place["shank"],
            (
                Ball(lower, (0, 0, 0), 0.053),
                Ball(lower, (-0.010, 0, 0), 0.0555, foot, 0.17),
                Ball(lower, (-0.011, 0, 0), 0.0535, foot, 0.34),
                Ball(foot, (0, 0, 0), 0.035),
            ),
        ),
        _joint("ankle", place["foot"], foot, 0.0375, (place["shank"], place["foot"])),
        Part(
            "foot",
            place["foot"],
            side,
            (
                Ball(foot, (-0.046, -0.036, 0), 0.033),
                Ball(foot, (0.004, -0.012, 0), 0.035),
                Ball(toes, (-0.012, 0.004, 0.032), 0.020),
                Ball(toes, (-0.012, 0.004, -0.032), 0.020),
            ),
        ),
        Part(
            "toes",
            place["foot"],
            side,
            (
                Ball(toes, (-0.010, 0.003, 0.032), 0.0195),
                Ball(toes, (-0.010, 0.003, -0.032), 0.0195),
                Ball(toes, (0.070, -0.001, 0.020), 0.0155),
                Ball(toes, (0.070, -0.001, -0.020), 0.0155),
            ),
            2,
            lead=-0.02,
        ),
    )


def _places(side: Side) -> dict[str, Place]:
    return {name: Place(f"{side}_{name}") for name in (*ARM, *LEG)}


def _pair(segment: Segment, where: tuple[float, float, float], radius: float) -> tuple[Ball, Ball]:
    x, y, z = where
    return Ball(segment, (x, y, -z), radius), Ball(segment, (x, y, z), radius)


def _limb(name: str, place: Place, balls: tuple[Ball, ...]) -> Part:
    return Part(name, place, "limb", balls, lead=0.01)


def _joint(name: str, place: Place, segment: Segment, radius: float, needs: tuple[Place, ...]) -> Part:
    return Part(name, place, "joint", (Ball(segment, (0.0, 0.0, 0.0), radius),), 1, needs, lead=0.05)


class Body:
    """The balls of all parts of one person, ready to be posed."""

    def __init__(self, skeleton: Skeleton, parts: Sequence[Part] | None = None) -> None:
        self.parts = tuple(body_parts() if parts is None else parts)
        self.stature = skeleton.stature
        self.limbs = np.array([_limb_of(part.place) for part in self.parts])
        """(parts,): one number for all parts of an arm, of a leg, and of the trunk."""
        self.sides = np.array([{"left": -1, "right": 1}.get(part.tone, 0) for part in self.parts])
        """(parts,): -1 for the left glove and shoe, 1 for the right ones, else 0."""
        scale = skeleton.stature / _MODEL
        balls = [ball for part in self.parts for ball in part.balls]
        self._segments = np.array([ball.segment for ball in balls])
        self._where = np.array([np.multiply(ball.where, scale) + _on_the_way(ball, skeleton) for ball in balls])
        radii = np.array([ball.radius * scale for ball in balls])
        # every part gets the same number of balls: the first is repeated
        first = np.cumsum([0, *(len(part.balls) for part in self.parts[:-1])])
        self._rows = np.array(
            [
                [start + (i if i < len(part.balls) else 0) for i in range(MOST_BALLS)]
                for start, part in zip(first, self.parts, strict=True)
            ]
        )
        self.radii: Array = radii[self._rows]
        """(parts, MOST_BALLS), m."""
        last = first + np.array([len(part.balls) for part in self.parts])
        self._upper = np.array([(start, start + part.row - 1) for start, part in zip(first, self.parts, strict=True)])
        self._lower = np.array([(end - 1, end - part.row) for end, part in zip(last, self.parts, strict=True)])
        self.end_widths: Array = np.stack(
            [
                radii[end[:, 0]] + np.linalg.norm(self._where[end[:, 0]] - self._where[end[:, 1]], axis=1) / 2
                for end in (self._upper, self._lower)
            ],
            axis=1,
        )
        """(parts, 2), m: half the width of each end of the axis."""

    def whole(self, known: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return which parts have all their segments, (parts,); ``known`` (23,) says which segments are."""
        return np.asarray(known[self._segments][self._rows].all(axis=1))

    def posed(self, world_from_segment: Array, joints: Array) -> tuple[Array, Array]:
        """Return the centres of the balls, (parts, MOST_BALLS, 3), and both ends of the axes, (parts, 2, 3), m, world.

        Parameters
        ----------
        world_from_segment : (23, 4)
        joints : (23, 3), m, world
        """
        turned = rotation.rotate(world_from_segment[self._segments], self._where)
        centres = joints[self._segments] + turned
        ends = np.stack([centres[self._upper].mean(axis=1), centres[self._lower].mean(axis=1)], axis=1)
        return centres[self._rows], ends


def _limb_of(place: Place) -> int:
    side, _, name = place.value.partition("_")
    if not name:
        return 0
    return 1 + 2 * (side == "left") + (name in ARM)


def _on_the_way(ball: Ball, skeleton: Skeleton) -> Array:
    if ball.towards is None:
        return np.zeros(3)
    return np.asarray(skeleton.offsets[ball.towards] * ball.share)
