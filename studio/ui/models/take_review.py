"""A solved take as it is looked at: angles, what is lost, and what its numbers are worth."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.analysis.joint_angles import JointAngle, Side, joint_angles
from studio.core.body import MEASURED_PARENT, PLACES, Place
from studio.core.pose import Motion
from studio.core.take import Alignment, HeadingSource, Mark
from studio.storage.take_summary import TakeSummary

Array = NDArray[np.float64]

FIRST_CHOICE = ("left_knee_flexion", "right_knee_flexion")

_CHILDREN: dict[str, tuple[Place, ...]] = {
    "trunk": (Place.CHEST,),
    "hip": (Place.LEFT_THIGH, Place.RIGHT_THIGH),
    "knee": (Place.LEFT_SHANK, Place.RIGHT_SHANK),
    "ankle": (Place.LEFT_FOOT, Place.RIGHT_FOOT),
    "shoulder": (Place.LEFT_UPPER_ARM, Place.RIGHT_UPPER_ARM),
    "elbow": (Place.LEFT_FOREARM, Place.RIGHT_FOREARM),
    "wrist": (Place.LEFT_HAND, Place.RIGHT_HAND),
}
"""The further sensor of each joint, by the word its angles begin with."""


class Stretch(NamedTuple):
    """A piece of time."""

    from_s: float
    to_s: float


class Measure(NamedTuple):
    """One angle over a stretch of a take, degrees; NaN where nothing was measured."""

    name: str
    least: float
    most: float
    least_at: float
    """s"""
    most_at: float
    """s"""
    missing: float
    """Share of the time in which it was not measured, 0…1."""

    @property
    def range(self) -> float:
        """Most minus least."""
        return self.most - self.least


@dataclass(frozen=True, eq=False)
class TakeReview:
    """Everything the review page shows of one take. Made off the Qt thread: angles of an hour take seconds."""

    summary: TakeSummary
    motion: Motion
    marks: tuple[Mark, ...]
    degrees: Mapping[str, Array]
    """For each angle of ``analysis.joint_angles`` its values, (n,), degrees."""
    angles: Mapping[str, JointAngle]

    @property
    def duration(self) -> float:
        """s, from the start of the take to the last frame."""
        return float(self.motion.time[-1]) if len(self.motion) else 0.0

    def first_choice(self) -> tuple[str, ...]:
        """Return the angles that are shown when nobody chose any."""
        known = tuple(name for name in FIRST_CHOICE if name in self.degrees)
        return known or tuple(self.degrees)[:2]


def review_take(summary: TakeSummary, marks: Sequence[Mark], motion: Motion) -> TakeReview:
    """Return a take ready to be looked at."""
    angles = {angle.name: angle for angle in joint_angles(motion)} if len(motion) else {}
    degrees = {name: np.degrees(angle.values) for name, angle in angles.items()}
    return TakeReview(summary, motion, tuple(sorted(marks, key=lambda mark: mark.time)), degrees, angles)


def measure(review: TakeReview, name: str, from_s: float, to_s: float) -> Measure:
    """Return what an angle did between two times, s."""
    first, after = np.searchsorted(review.motion.time, [from_s, to_s + review.motion.frame_s / 2])
    values = review.degrees[name][first:after]
    known = np.isfinite(values)
    if not known.any():
        return Measure(name, math.nan, math.nan, math.nan, math.nan, 1.0)
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    times = review.motion.time[first:after]
    missing = 1.0 - float(known.mean())
    return Measure(name, float(values[low]), float(values[high]), float(times[low]), float(times[high]), missing)


def value_at(review: TakeReview, name: str, time: float) -> float:
    """Return an angle at the frame shown at a time, degrees; NaN where it was not measured."""
    times = review.motion.time
    row = int(np.searchsorted(times, time - review.motion.frame_s / 2))
    return float(review.degrees[name][min(row, len(times) - 1)])


def envelope(time: Array, values: Array, edges: Array) -> tuple[Array, Array]:
    """Return the least and the most value in each column between ``edges``, (k + 1,), s; NaN where there is none.

    Each column reaches to the values of the one before, so that a steep line is drawn without gaps.
    """
    columns = len(edges) - 1
    if not len(time):
        return np.full(columns, np.nan), np.full(columns, np.nan)
    first = _first_rows(time, edges)
    lower = np.where(np.isnan(values), np.inf, values)
    upper = np.where(np.isnan(values), -np.inf, values)
    least, most = np.minimum.reduceat(lower, first), np.maximum.reduceat(upper, first)
    before_least, before_most = least[:-1].copy(), most[:-1].copy()
    joined = np.isfinite(before_least) & np.isfinite(least[1:])
    least[1:] = np.where(joined & (least[1:] > before_most), before_most, least[1:])
    most[1:] = np.where(joined & (most[1:] < before_least), before_least, most[1:])
    return np.where(np.isinf(least), np.nan, least), np.where(np.isinf(most), np.nan, most)


def lost_share(review: TakeReview, name: str, edges: Array) -> Array:
    """Return which share of the frames in each column stands in for samples that are missing, 0…1."""
    time = review.motion.time
    if not len(time):
        return np.zeros(len(edges) - 1)
    first = _first_rows(time, edges)
    missing = np.add.reduceat(_missing(review, name).astype(np.float64), first)
    counts = np.maximum(np.diff(np.append(first, max(len(time), first[-1] + 1))), 1)
    return np.asarray(missing / counts)


def gaps(review: TakeReview, name: str, least_s: float) -> list[Stretch]:
    """Return where samples behind an angle are missing for ``least_s`` s or longer."""
    motion = review.motion
    edges = np.flatnonzero(np.diff(np.concatenate([[False], _missing(review, name), [False]]).astype(np.int8)))
    half = motion.frame_s / 2
    starts, ends = motion.time[edges[::2]] - half, motion.time[edges[1::2] - 1] + half
    long = ends - starts >= least_s - 1e-9
    return [Stretch(a, b) for a, b in zip(starts[long].tolist(), ends[long].tolist(), strict=True)]


def _first_rows(time: Array, edges: Array) -> NDArray[np.intp]:
    """Return the first row of each column; a column narrower than a frame shows the frame before it."""
    at = np.searchsorted(time, edges)
    empty = at[:-1] == at[1:]
    return np.clip(np.where(empty, at[:-1] - 1, at[:-1]), 0, len(time) - 1)


def _missing(review: TakeReview, name: str) -> NDArray[np.bool_]:
    motion = review.motion
    missing = np.zeros(len(motion), np.bool_)
    for place in places_of(name):
        if place in motion.lost:
            missing |= motion.lost[place] | ~motion.measured[place]
    return missing


def places_of(name: str) -> tuple[Place, ...]:
    """Return the places whose sensors an angle is made of."""
    side, _, rest = name.partition("_")
    joint = rest.partition("_")[0] if side in ("left", "right") else side
    if joint == "pelvis":
        return (Place.PELVIS,)
    children = [p for p in _CHILDREN[joint] if side not in ("left", "right") or p.value.startswith(side)]
    return tuple(place for child in children for place in (child, MEASURED_PARENT[child]))


def heading_sources(alignment: Alignment) -> dict[HeadingSource, tuple[Place, ...]]:
    """Return which limbs have their heading from where; limbs in the order of Table 1."""
    found: dict[HeadingSource, tuple[Place, ...]] = {}
    for place in PLACES:
        limb = alignment.limbs.get(place)
        if limb is not None:
            found[limb.source] = (*found.get(limb.source, ()), place)
    return found


def in_words(name: str) -> str:
    """Return the name of an angle as people write it: ``Left knee flexion``."""
    return name.replace("_", " ").capitalize()


def side_of(name: str) -> Side:
    """Return on which side of the body an angle is."""
    if name.startswith("left_"):
        return "left"
    return "right" if name.startswith("right_") else ""
