"""The true motion of the performer: 23 segments over time, analytic, twice continuously differentiable."""

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.gait import STRIDE, Gait, course, evaluate
from studio.acquisition.synthetic.scripts import SCRIPT_BEGINS, Script
from studio.core import frames, rotation
from studio.core.body import MEASURED_PARENT, PLACES, SEGMENT_OF, SEGMENTS, Place, Segment, Skeleton

Array = NDArray[np.float64]

CARRYING_ANGLE = math.radians(3.0)  # rad; inclination of the flexion axes of elbow and knee (contracts, section 8)
ADDUCTION_PER_FLEXION = 0.01  # the elbow and knee are no perfect hinges: 0.6 degrees at 60 degrees of flexion
ROTATION_PER_FLEXION = 0.02  # 1.2 degrees at 60 degrees of flexion

LEAN_FORWARDS = math.radians(0.45)  # rad, SD of the body's lean in quiet standing, forwards and backwards
LEAN_SIDEWAYS = math.radians(0.22)  # rad, SD; both together 0.5 degrees (sideways sway is about half)
JOINT_SWAY = math.radians(0.2)  # rad, SD of each joint angle while a pose is held
SWAY_TIME = 0.8  # s, correlation time (biomechanics-and-formats, section 3)
SWAY_HIGHEST = 1.0  # Hz; muscles and mass leave nothing above it
SWAY_WAVES = 12

# Degrees of flexion at which soft tissue has moved the tag by its full 2 degrees: the ends of the joints' ranges
# (AAOS: shoulder 180, elbow 150, hip 120, knee 135, ankle 50, trunk 80, neck 60, wrist 80). It grows in phase with
# the joint and is never more; the pelvis has no joint above it and takes the hips' range.
REFERENCE_EXCURSION: dict[Place, float] = {
    Place.HEAD: 60.0,
    Place.CHEST: 80.0,
    Place.LEFT_UPPER_ARM: 180.0,
    Place.RIGHT_UPPER_ARM: 180.0,
    Place.LEFT_FOREARM: 150.0,
    Place.RIGHT_FOREARM: 150.0,
    Place.LEFT_HAND: 80.0,
    Place.RIGHT_HAND: 80.0,
    Place.PELVIS: 120.0,
    Place.LEFT_THIGH: 120.0,
    Place.RIGHT_THIGH: 120.0,
    Place.LEFT_SHANK: 135.0,
    Place.RIGHT_SHANK: 135.0,
    Place.LEFT_FOOT: 50.0,
    Place.RIGHT_FOOT: 50.0,
}
_EXCURSIONS = np.deg2rad([REFERENCE_EXCURSION[place] for place in PLACES])

_PELVIS = PLACES.index(Place.PELVIS)
_THIGHS = [PLACES.index(Place.LEFT_THIGH), PLACES.index(Place.RIGHT_THIGH)]
_FEET = [PLACES.index(Place.LEFT_FOOT), PLACES.index(Place.RIGHT_FOOT)]
_MEASURED_SEGMENTS = [int(SEGMENT_OF[place]) for place in PLACES]
# By segment number parents come before children.
_CHAIN_ORDER = [PLACES.index(place) for place in sorted(MEASURED_PARENT, key=lambda place: SEGMENT_OF[place])]
_PARENT_ROW = {PLACES.index(child): PLACES.index(parent) for child, parent in MEASURED_PARENT.items()}


class Carried(NamedTuple):
    """What the tags are fixed to, at n instants."""

    orientation: Array
    """(n, 15, 4), world_from_segment in the order of ``PLACES``."""
    position: Array
    """(n, 15, 3), m, world: origin of each segment."""
    excursion: Array
    """(n, 15), flexion of the joint above each segment as a share of its reference: what drives the soft tissue."""


class Scene(Protocol):
    """True motion of whatever carries the tags."""

    def carried(self, times: Array) -> Carried:
        """Return the 15 carriers at ``times`` (n,), s since switching on."""

    def true_pose(self, times: Array) -> tuple[Array, Array]:
        """Return world_from_segment (n, 23, 4) and hips (n, 3), m."""


class Sway:
    """Sums of sines whose spectrum is that of a first-order process with ``SWAY_TIME``, cut at ``SWAY_HIGHEST``."""

    def __init__(self, generator: np.random.Generator, deviations: Array) -> None:
        corner = 1.0 / (2 * math.pi * SWAY_TIME)
        # one frequency from each of equal shares of the power
        share = (np.arange(SWAY_WAVES) + generator.random((len(deviations), SWAY_WAVES))) / SWAY_WAVES
        self._frequency = 2 * math.pi * corner * np.tan(share * math.atan(SWAY_HIGHEST / corner))
        self._phase = generator.uniform(0, 2 * math.pi, self._frequency.shape)
        self._amplitude = deviations * math.sqrt(2.0 / SWAY_WAVES)

    def at(self, times: Array) -> Array:
        """Return (n, channels) at ``times`` (n,), s."""
        waves = np.sin(times[:, None, None] * self._frequency + self._phase)
        return np.asarray(waves.sum(axis=-1) * self._amplitude)


class Performer:
    """A body of one stature that follows a script and sways."""

    def __init__(self, script: Script, stature: float, generator: np.random.Generator) -> None:
        self.skeleton = Skeleton.from_stature(stature)
        self._script = script
        deviations = np.concatenate(
            # two neighbouring segments together sway the joint
            [[LEAN_SIDEWAYS, LEAN_FORWARDS], np.full(3 * len(PLACES), JOINT_SWAY / math.sqrt(2.0))]
        )
        self._sway = Sway(generator, deviations)
        self._balls_at_rest = self._feet(rotation.multiply(frames.N_POSE, np.tile(rotation.IDENTITY, (1, 15, 1))))[0]
        self._gait = self._fit_gait() if script.walks else None

    def true_pose(self, times: Array) -> tuple[Array, Array]:
        """Return world_from_segment (n, 23, 4) and hips (n, 3), m, at ``times`` (n,), s since switching on."""
        orientation, hips, _ = self._measured(times)
        return fill_unmeasured(orientation), hips

    def carried(self, times: Array) -> Carried:
        """Return the 15 segments that carry tags; see ``Scene``."""
        orientation, hips, angles = self._measured(times)
        positions = self.skeleton.joint_positions(fill_unmeasured(orientation), hips)
        return Carried(orientation, positions[:, _MEASURED_SEGMENTS], excursions(angles))

    def _measured(self, times: Array) -> tuple[Array, Array, Array]:
        """Return world_from_segment (n, 15, 4), hips (n, 3) and joint angles (n, 15, 3)."""
        angles = self._script.angles(times)
        upright = segments_from_angles(angles)
        hips, ground = self._over_the_feet(upright), np.zeros((len(times), 3))
        if self._gait is not None:
            share, walking, distance, pelvis = self._gait.at(times - SCRIPT_BEGINS)
            angles += walking
            upright = segments_from_angles(angles)
            # The legs shorten with the square of their swing.
            hips[:, 1:] += np.stack([share, share * share], axis=-1) * (pelvis - hips[:, 1:])
            heading, way = course(distance)
            turn = rotation.about(2, heading)
            upright = rotation.multiply(turn[:, None], upright)
            ground = np.concatenate([way, np.zeros((len(times), 1))], axis=1)
            hips = rotation.rotate(turn, hips)
        orientation, hips = self._swaying(times, upright, hips)
        return orientation, hips + ground, angles

    def _over_the_feet(self, orientation: Array) -> Array:
        """Return where the hips are when both balls of the feet stay where they stood, (n, 3)."""
        balls = self._feet(orientation)[:, 1::2].mean(axis=1)
        rest = self._balls_at_rest[1::2].mean(axis=0)
        at_rest = np.array([0.0, 0.0, self.skeleton.hips_height()])
        return np.asarray(at_rest + rest - balls)

    def _feet(self, orientation: Array) -> Array:
        """Return left heel, left ball, right heel, right ball relative to the Hips, (n, 4, 3)."""
        full = fill_unmeasured(orientation)
        joints = self.skeleton.joint_positions(full, np.zeros((len(full), 3)))
        points = [
            joints[:, foot] + rotation.rotate(full[:, foot], point)
            for foot in (Segment.LeftFoot, Segment.RightFoot)
            for point in self.skeleton.foot_points()
        ]
        return np.stack(points, axis=1)

    def _fit_gait(self) -> Gait:
        phase = np.arange(200) / 200
        return Gait.from_feet(self._feet(segments_from_angles(evaluate(STRIDE, phase))))

    def _swaying(self, times: Array, orientation: Array, hips: Array) -> tuple[Array, Array]:
        sway = self._sway.at(times)
        lean = np.zeros((len(times), 3))
        lean[:, :2] = sway[:, :2]
        turn = rotation.from_rotation_vector(lean)
        leaning = rotation.multiply(turn[:, None], orientation)
        leaning[:, _FEET] = orientation[:, _FEET]
        own = rotation.from_rotation_vector(sway[:, 2:].reshape(len(times), len(PLACES), 3))
        return rotation.multiply(leaning, own), rotation.rotate(turn, hips)


def segments_from_angles(angles: Array) -> Array:
    """Return world_from_segment (n, 15, 4) of a body facing x, from joint angles (n, 15, 3), rad."""
    joints = joint_rotations(angles)
    orientation = np.empty_like(joints)
    orientation[:, _PELVIS] = rotation.multiply(frames.N_POSE, joints[:, _PELVIS])
    for row in _CHAIN_ORDER:
        orientation[:, row] = rotation.multiply(orientation[:, _PARENT_ROW[row]], joints[:, row])
    return orientation


def joint_rotations(angles: Array) -> Array:
    """Return parent_from_child, (n, 15, 4), sequence ZXY; elbow and knee flex about inclined axes and are loose."""
    flexion = angles[..., 2]
    turned = rotation.from_rotation_vector(flexion[..., None] * _FLEXION_AXES)
    size = np.abs(flexion)
    tilted = rotation.about(0, angles[..., 0] + size * _ADDUCTION_COUPLING)
    twisted = rotation.about(1, angles[..., 1] + size * _ROTATION_COUPLING)
    return rotation.multiply(rotation.multiply(turned, tilted), twisted)


def _hinges() -> tuple[Array, Array, Array]:
    axes = np.tile([0.0, 0.0, 1.0], (len(PLACES), 1))
    mirrored = np.zeros(len(PLACES))
    for place in (Place.LEFT_FOREARM, Place.RIGHT_FOREARM, Place.LEFT_SHANK, Place.RIGHT_SHANK):
        side = -1.0 if place.value.startswith("left_") else 1.0
        axes[PLACES.index(place)] = (0.0, side * math.sin(CARRYING_ANGLE), math.cos(CARRYING_ANGLE))
        mirrored[PLACES.index(place)] = side
    return axes, ADDUCTION_PER_FLEXION * mirrored, ROTATION_PER_FLEXION * mirrored


_FLEXION_AXES, _ADDUCTION_COUPLING, _ROTATION_COUPLING = _hinges()


def fill_unmeasured(measured: Array) -> Array:
    """Return all 23 segments, (n, 23, 4), from the 15 measured ones (contracts, section 5)."""
    full = np.empty((len(measured), SEGMENTS, 4))
    full[:, _MEASURED_SEGMENTS] = measured
    hips, chest = full[:, Segment.Hips], full[:, Segment.Spine3]
    step = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(hips), chest))
    for segment, fraction in ((Segment.Spine, 0.25), (Segment.Spine1, 0.5), (Segment.Spine2, 0.75)):
        full[:, segment] = rotation.multiply(hips, rotation.from_rotation_vector(step * fraction))
    for rigid in (Segment.Neck, Segment.LeftShoulder, Segment.RightShoulder):
        full[:, rigid] = chest
    full[:, Segment.LeftToeBase] = full[:, Segment.LeftFoot]
    full[:, Segment.RightToeBase] = full[:, Segment.RightFoot]
    return full


def excursions(angles: Array) -> Array:
    """Return how far the joint above each segment is flexed, as a share of its reference, (n, 15).

    The pelvis has no joint above it: what moves its tag is the mean flexion of the hips.
    """
    flexion = angles[..., 2].copy()
    flexion[:, _PELVIS] = flexion[:, _THIGHS].mean(axis=1)
    return np.asarray(flexion / _EXCURSIONS)
