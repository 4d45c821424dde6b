"""The 23 segments: proportions, poses and forward kinematics."""

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import (
    MEASURED_PARENT,
    PARENTS,
    PLACES,
    PRESETS,
    SEGMENT_OF,
    Segment,
    Skeleton,
    reference_pose,
)
from studio.core.root import Root


@pytest.mark.parametrize("stature", [1.1, 1.75, 2.05])
def test_the_vertical_chain_adds_up_to_the_stature(stature):
    skeleton = Skeleton.from_stature(stature)
    hips = np.array([0, 0, skeleton.hips_height()])
    joints = skeleton.joint_positions(reference_pose("n"), hips)

    vertex = joints[Segment.Head] + rotation.rotate(reference_pose("n")[Segment.Head], skeleton.ends[Segment.Head])
    assert vertex[2] == pytest.approx(stature, abs=1e-3)
    ankle = joints[Segment.LeftFoot]
    sole = ankle + rotation.rotate(reference_pose("n")[Segment.LeftFoot], skeleton.foot_points())
    np.testing.assert_allclose(sole[:, 2], 0, atol=1e-3)


def test_the_arm_span_in_t_pose_is_that_of_a_person():
    skeleton = Skeleton.from_stature(1.0)
    pose = reference_pose("t")
    joints = skeleton.joint_positions(pose, np.zeros(3))
    tips = [
        joints[hand] + rotation.rotate(pose[hand], skeleton.ends[hand])
        for hand in (Segment.LeftHand, Segment.RightHand)
    ]

    span = tips[0][1] - tips[1][1]  # the left hand is at +y

    assert 0.98 < span < 1.05


def test_no_bone_is_shorter_than_two_centimetres():
    lengths = np.linalg.norm(Skeleton.from_stature(1.75).offsets[1:], axis=1)

    assert lengths.min() > 0.02


def test_in_n_pose_segments_point_forward_up_and_right():
    pose = reference_pose("n")

    for segment in Segment:
        np.testing.assert_allclose(rotation.rotate(pose[segment], [1, 0, 0]), [1, 0, 0], atol=1e-12)
        np.testing.assert_allclose(rotation.rotate(pose[segment], [0, 1, 0]), [0, 0, 1], atol=1e-12)
        np.testing.assert_allclose(rotation.rotate(pose[segment], [0, 0, 1]), [0, -1, 0], atol=1e-12)


def test_in_t_pose_palms_look_down():
    # The palm looks to the thigh in N-pose: right (+z) on the left hand, left (-z) on the right.
    pose = reference_pose("t")

    np.testing.assert_allclose(rotation.rotate(pose[Segment.LeftHand], [0, 0, 1]), [0, 0, -1], atol=1e-12)
    np.testing.assert_allclose(rotation.rotate(pose[Segment.RightHand], [0, 0, -1]), [0, 0, -1], atol=1e-12)


def test_parents_come_before_children_and_every_place_has_a_segment():
    assert all(parent < child for child, parent in enumerate(PARENTS))
    assert set(SEGMENT_OF) == set(PLACES)
    assert len(MEASURED_PARENT) == 14
    assert [len(PRESETS[name]) for name in ("full", "upper", "lower")] == [15, 8, 7]
    assert PRESETS["upper"] + PRESETS["lower"] == PLACES


def stepping(frames, rate):
    """Walk in place of the pelvis: each leg swings ±20° with the knee bent while it comes forward."""
    t = np.arange(frames) / rate
    world = np.tile(reference_pose("n"), (frames, 1, 1))
    for side, phase in ((Segment.LeftUpLeg, 0.0), (Segment.RightUpLeg, np.pi)):
        hip = np.radians(20) * np.sin(2 * np.pi * t + phase)
        knee = np.radians(40) * np.clip(np.cos(2 * np.pi * t + phase), 0, None) ** 2
        world[:, side] = rotation.multiply(world[:, side], rotation.about(2, hip))
        world[:, side + 1] = rotation.multiply(world[:, side + 1], rotation.about(2, hip - knee))
    return world


def test_the_supporting_foot_stays_and_the_body_moves_over_it():
    skeleton = Skeleton.from_stature(1.75)
    world = stepping(500, 100)

    hips = Root(skeleton).run(world, np.full(500, 0.01))

    # The leg swings back by 2 × 0.491 H × sin 20° in each of the two steps of a cycle.
    step = 2 * (0.245 + 0.246) * 1.75 * np.sin(np.radians(20))
    assert hips[-1, 0] == pytest.approx(10 * step, rel=0.12)
    assert abs(hips[-1, 1]) < 0.05
    joints = skeleton.joint_positions(world, hips)
    soles = np.stack([
        joints[:, foot, None] + rotation.rotate(world[:, foot, None], skeleton.foot_points())
        for foot in (Segment.LeftFoot, Segment.RightFoot)
    ])  # fmt: skip
    assert soles[..., 2].min() == pytest.approx(0, abs=1e-9)


def test_stepping_frame_by_frame_gives_the_same_path():
    skeleton = Skeleton.from_stature(1.75)
    world = stepping(200, 100)
    live = Root(skeleton)

    one_by_one = np.array([live.step(pose, 0.01) for pose in world])

    np.testing.assert_allclose(one_by_one, Root(skeleton).run(world, np.full(200, 0.01)), atol=1e-12)
