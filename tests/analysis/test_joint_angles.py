"""Joint angles carry the names and signs a clinician expects, on both sides.

Truth is where the body goes: a segment is turned about a world axis in N-pose (world x forward, y left,
z up) and the angle's name says which way that is.
"""

from dataclasses import replace

import numpy as np
import pytest

from studio.analysis.joint_angles import joint_angles
from studio.core import euler, rotation
from studio.core.body import PARENTS, PRESETS, Place, Segment
from tests.export.moving_body import motion_of, moving_body, standing

FORWARD, LEFT, UP = 0, 1, 2  # world axes
TWENTY = np.radians(20.0)


def with_descendants(segment):
    """The segment and all that hangs on it."""
    chosen = {segment}
    for child, parent in enumerate(PARENTS):
        if parent in chosen:
            chosen.add(child)
    return sorted(chosen)


def bent(segment, axis, angle, pose="n"):
    """A motion that stands with one joint turned by ``angle`` about a world axis."""
    motion = standing(pose)
    world_from_segment = motion.world_from_segment.copy()
    moved = with_descendants(segment)
    world_from_segment[:, moved] = rotation.multiply(rotation.about(axis, angle), world_from_segment[:, moved])
    return replace(motion, world_from_segment=world_from_segment)


def degrees_of(motion):
    return {angle.name: np.degrees(angle.values) for angle in joint_angles(motion)}


def the_only_one(motion):
    """The names and values in degrees of all angles that are not zero."""
    return {
        name: round(float(values[0]), 6)
        for name, values in degrees_of(motion).items()
        if np.isfinite(values[0]) and abs(values[0]) > 1e-6
    }


@pytest.mark.parametrize(
    ("segment", "axis", "turn", "name"),
    [
        # A positive turn about the world's left axis takes what points down backward and what points up forward.
        (Segment.LeftUpLeg, LEFT, -1, "left_hip_flexion"),
        (Segment.RightUpLeg, LEFT, -1, "right_hip_flexion"),
        (Segment.LeftLeg, LEFT, 1, "left_knee_flexion"),
        (Segment.RightLeg, LEFT, 1, "right_knee_flexion"),
        (Segment.LeftFoot, LEFT, -1, "left_ankle_dorsiflexion"),
        (Segment.RightFoot, LEFT, -1, "right_ankle_dorsiflexion"),
        (Segment.LeftForeArm, LEFT, -1, "left_elbow_flexion"),
        (Segment.RightForeArm, LEFT, -1, "right_elbow_flexion"),
        # The little finger is behind in N-pose, palms to the thighs.
        (Segment.LeftHand, LEFT, 1, "left_wrist_ulnar_deviation"),
        (Segment.RightHand, LEFT, 1, "right_wrist_ulnar_deviation"),
        # A positive turn about forward takes what points down to the left and what points up to the right.
        (Segment.LeftUpLeg, FORWARD, -1, "left_hip_adduction"),
        (Segment.RightUpLeg, FORWARD, 1, "right_hip_adduction"),
        (Segment.LeftLeg, FORWARD, -1, "left_knee_varus"),
        (Segment.RightLeg, FORWARD, 1, "right_knee_varus"),
        (Segment.LeftFoot, FORWARD, -1, "left_ankle_inversion"),
        (Segment.RightFoot, FORWARD, 1, "right_ankle_inversion"),
        (Segment.LeftForeArm, FORWARD, 1, "left_elbow_carrying_angle"),
        (Segment.RightForeArm, FORWARD, -1, "right_elbow_carrying_angle"),
        # The palm faces the thigh: fingers to the midline is flexion.
        (Segment.LeftHand, FORWARD, -1, "left_wrist_flexion"),
        (Segment.RightHand, FORWARD, 1, "right_wrist_flexion"),
        # A positive turn about up takes what faces forward to the left.
        (Segment.LeftUpLeg, UP, -1, "left_hip_internal_rotation"),
        (Segment.RightUpLeg, UP, 1, "right_hip_internal_rotation"),
        (Segment.LeftLeg, UP, -1, "left_knee_internal_rotation"),
        (Segment.RightLeg, UP, 1, "right_knee_internal_rotation"),
        (Segment.LeftFoot, UP, -1, "left_ankle_internal_rotation"),
        (Segment.RightFoot, UP, 1, "right_ankle_internal_rotation"),
        (Segment.LeftForeArm, UP, -1, "left_elbow_pronation"),
        (Segment.RightForeArm, UP, 1, "right_elbow_pronation"),
        (Segment.LeftArm, UP, -1, "left_shoulder_axial_rotation"),
        (Segment.RightArm, UP, 1, "right_shoulder_axial_rotation"),
    ],
)
def test_turning_one_joint_by_20_degrees_makes_one_angle_20_degrees(segment, axis, turn, name):
    assert the_only_one(bent(segment, axis, turn * TWENTY)) == {name: 20.0}


@pytest.mark.parametrize(
    ("axis", "turn", "name"),
    [(LEFT, 1, "trunk_flexion"), (FORWARD, 1, "trunk_right_bending"), (UP, 1, "trunk_left_rotation")],
)
def test_the_trunk_turns_against_the_pelvis(axis, turn, name):
    assert the_only_one(bent(Segment.Spine3, axis, turn * TWENTY)) == {name: 20.0}


@pytest.mark.parametrize(
    ("axis", "turn", "name"),
    [(LEFT, -1, "pelvis_tilt"), (FORWARD, 1, "pelvis_list"), (UP, 1, "pelvis_rotation")],
)
def test_the_pelvis_turns_against_the_world(axis, turn, name):
    assert the_only_one(bent(Segment.Hips, axis, turn * TWENTY)) == {name: 20.0}


@pytest.mark.parametrize("heading", [0, 90, 180, -120])
def test_leaning_forwards_is_tilt_wherever_the_wearer_faces(heading):
    leaning = bent(Segment.Hips, LEFT, TWENTY)
    faced = rotation.about(UP, np.radians(heading))
    motion = replace(leaning, world_from_segment=rotation.multiply(faced, leaning.world_from_segment))

    angles = degrees_of(motion)

    assert angles["pelvis_tilt"][0] == pytest.approx(-20)
    assert angles["pelvis_list"][0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("side", "arm", "outward"), [("left", Segment.LeftArm, 1), ("right", Segment.RightArm, -1)])
def test_the_arm_has_an_elevation_and_its_plane(side, arm, outward):
    sideways = degrees_of(bent(arm, FORWARD, outward * np.radians(60)))
    forward = degrees_of(bent(arm, LEFT, -np.radians(60)))
    backward = degrees_of(bent(arm, LEFT, np.radians(30)))

    for angles, elevation, plane in ((sideways, 60, 0), (forward, 60, 90), (backward, 30, -90)):
        assert angles[f"{side}_shoulder_elevation"][0] == pytest.approx(elevation)
        assert angles[f"{side}_shoulder_plane_of_elevation"][0] == pytest.approx(plane, abs=1e-9)
        assert angles[f"{side}_shoulder_axial_rotation"][0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(("elevation", "is_known"), [(14, False), (16, True), (164, True), (166, False)])
def test_the_plane_of_elevation_is_empty_where_noise_would_make_it(elevation, is_known):
    angles = degrees_of(bent(Segment.RightArm, FORWARD, -np.radians(elevation)))

    assert np.isfinite(angles["right_shoulder_plane_of_elevation"][0]) == is_known
    assert angles["right_shoulder_elevation"][0] == pytest.approx(elevation)


def test_every_angle_of_the_n_pose_is_zero_and_the_plane_of_hanging_arms_is_empty():
    angles = degrees_of(standing("n"))

    planes = {name for name in angles if name.endswith("plane_of_elevation")}
    assert len(planes) == 2
    for name, values in angles.items():
        expected = np.nan if name in planes else 0.0
        np.testing.assert_allclose(values, expected, atol=1e-9, err_msg=name)


def test_the_t_pose_lifts_both_arms_sideways_by_90_degrees_and_nothing_else():
    angles = the_only_one(standing("t"))

    assert angles == {"left_shoulder_elevation": 90.0, "right_shoulder_elevation": 90.0}


def test_a_mirrored_motion_has_the_same_angles_on_the_other_side():
    motion = moving_body(50, swing=0.5)
    mirrored = mirror(motion)

    here, there = degrees_of(motion), degrees_of(mirrored)

    for name, values in here.items():
        if name.startswith("left_"):
            np.testing.assert_allclose(there[name.replace("left_", "right_")], values, atol=1e-9, err_msg=name)


def mirror(motion):
    """The motion as seen in a mirror on the sagittal plane: y changes its sign, left and right their places."""
    names = [segment.name.replace("Left", "·").replace("Right", "Left").replace("·", "Right") for segment in Segment]
    swapped = motion.world_from_segment[:, [Segment[name] for name in names]]
    # A mirror on y turns the rotation vector (x, y, z) into (-x, y, -z); the segment's own z axis, which
    # points to the right on both sides, changes its sign too.
    matrices = rotation.to_matrix(swapped)
    flipped = np.diag([1, -1, 1]) @ matrices @ np.diag([1, 1, -1])
    return motion_of(rotation.from_matrix(flipped), motion.hips * [1, -1, 1])


@pytest.mark.parametrize("seed", range(5))
def test_random_angles_come_back_from_the_pose_they_make(seed):
    """Flexion, adduction and rotation of the hip, set in this order, are read again."""
    flexion, adduction, internal = np.random.default_rng(seed).uniform(-80, 80, 3)
    for side, segment, mirrored in (("left", Segment.LeftUpLeg, -1), ("right", Segment.RightUpLeg, 1)):
        motion = standing("n")
        turned = euler.from_euler(np.radians([flexion, mirrored * adduction, mirrored * internal]), "ZXY")
        world_from_segment = motion.world_from_segment.copy()
        world_from_segment[:, segment] = rotation.multiply(world_from_segment[:, Segment.Hips], turned)

        angles = degrees_of(replace(motion, world_from_segment=world_from_segment))

        assert angles[f"{side}_hip_flexion"][0] == pytest.approx(flexion)
        assert angles[f"{side}_hip_adduction"][0] == pytest.approx(adduction)
        assert angles[f"{side}_hip_internal_rotation"][0] == pytest.approx(internal)


def test_someone_who_turns_round_three_times_has_turned_by_1080_degrees():
    turns = np.linspace(0, 6 * np.pi, 400)
    standing_still = standing("n", frames=400)
    motion = replace(
        standing_still,
        world_from_segment=rotation.multiply(rotation.about(UP, turns)[:, None], standing_still.world_from_segment),
    )

    np.testing.assert_allclose(degrees_of(motion)["pelvis_rotation"], np.degrees(turns), atol=1e-9)


def test_a_joint_is_empty_while_either_of_its_sensors_is_not_measured():
    motion = moving_body(100)
    silent = np.ones(100, bool)
    silent[40:60] = False
    motion = replace(motion, measured={**motion.measured, Place.LEFT_SHANK: silent})

    angles = degrees_of(motion)

    for name in ("left_knee_flexion", "left_ankle_dorsiflexion"):
        np.testing.assert_array_equal(np.isnan(angles[name]), ~silent)
    assert np.isfinite(angles["left_hip_flexion"]).all()


def test_after_a_gap_angles_begin_anew_within_half_a_turn():
    turns = np.linspace(0, 6 * np.pi, 400)
    still = standing("n", frames=400)
    silent = np.ones(400, bool)
    silent[300:310] = False
    motion = replace(
        still,
        world_from_segment=rotation.multiply(rotation.about(UP, turns)[:, None], still.world_from_segment),
        measured={**still.measured, Place.PELVIS: silent},
    )

    angle = degrees_of(motion)["pelvis_rotation"]

    assert abs(angle[310]) <= 180
    assert angle[399] - angle[310] == pytest.approx(np.degrees(turns[399] - turns[310]))


def test_only_joints_with_a_sensor_on_both_sides_have_columns():
    motion = standing("n")
    legs = replace(motion, measured={place: motion.measured[place] for place in PRESETS["lower"]})
    loose = replace(motion, measured={place: motion.measured[place] for place in (Place.LEFT_HAND, Place.HEAD)})

    names = [angle.name for angle in joint_angles(legs)]

    assert len(names) == 3 + 2 * 9
    assert not any("shoulder" in name or "trunk" in name for name in names)
    assert joint_angles(loose) == ()


def test_angles_below_what_sensors_can_tell_say_so():
    uncertain = {angle.name for angle in joint_angles(standing("n")) if angle.low_confidence}

    assert "left_knee_varus" in uncertain
    assert "right_knee_internal_rotation" in uncertain
    assert "left_knee_flexion" not in uncertain


def test_swing_and_twist_keep_the_noise_of_the_sensors_small_up_to_100_degrees():
    """1 degree of noise about each axis makes at most 1.6 degrees of axial rotation (Z-X'-Y'' would make 6 at 80)."""
    random = np.random.default_rng(1)
    noise = rotation.from_rotation_vector(np.radians(random.normal(size=(4000, 3))))
    for elevation in (30, 60, 90, 100):
        motion = bent(Segment.RightArm, FORWARD, -np.radians(elevation))
        world_from_segment = np.tile(motion.world_from_segment[:1], (4000, 1, 1))
        arm = world_from_segment[:, Segment.RightArm]
        world_from_segment[:, Segment.RightArm] = rotation.multiply(arm, noise)

        angles = degrees_of(motion_of(world_from_segment, np.zeros((4000, 3))))

        assert angles["right_shoulder_elevation"].std() < 1.1
        assert angles["right_shoulder_axial_rotation"].std() < 1.6
