"""Poses of a take: any frame at once, between frames along the shortest way, silent limbs by name."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import Place
from studio.ui.models.pose_source import PATH_POINTS, MotionSource
from tests.export.moving_body import moving_body

WORDS = {Place.LEFT_HAND: "Left hand"}


def test_at_a_frame_the_pose_is_that_of_the_motion():
    motion = moving_body(frames=50)
    pose = MotionSource(motion, WORDS).pose_at(float(motion.time[20]))

    assert pose is not None
    np.testing.assert_allclose(pose.world_from_segment, motion.world_from_segment[20], atol=1e-12)
    np.testing.assert_allclose(pose.joints, motion.joint_positions()[20], atol=1e-12)
    assert pose.measured == frozenset(motion.measured)
    assert not pose.silent


def test_between_two_frames_each_segment_has_turned_a_part_of_the_way():
    motion = moving_body(frames=50)
    pose = MotionSource(motion, WORDS).pose_at(float(motion.time[20]) + 0.25 * motion.frame_s)

    assert pose is not None
    whole = rotation.angle_between(motion.world_from_segment[20], motion.world_from_segment[21])
    part = rotation.angle_between(motion.world_from_segment[20], pose.world_from_segment)
    np.testing.assert_allclose(part, 0.25 * whole, atol=1e-9)


@pytest.mark.parametrize(("time", "row"), [(-1.0, 0), (1e6, 49)])
def test_outside_the_take_its_ends_are_shown(time, row):
    motion = moving_body(frames=50)
    pose = MotionSource(motion, WORDS).pose_at(time)

    assert pose is not None
    np.testing.assert_allclose(pose.world_from_segment, motion.world_from_segment[row])


def test_nothing_is_invented_across_a_gap():
    motion = moving_body(frames=50)
    time = motion.time.copy()
    time[21:] += 1.0
    source = MotionSource(replace(motion, time=time), WORDS)
    pose = source.pose_at(float(time[20]) + 0.5)

    assert pose is not None
    np.testing.assert_allclose(pose.world_from_segment, motion.world_from_segment[20])


def test_the_same_moment_is_the_same_object():
    source = MotionSource(moving_body(frames=50), WORDS)

    assert source.pose_at(0.5) is source.pose_at(0.5)
    assert source.pose_at(0.5) is not source.pose_at(0.51)


def test_a_limb_whose_sensor_was_silent_is_named():
    motion = moving_body(frames=50)
    motion.measured[Place.LEFT_HAND][10:20] = False
    source = MotionSource(motion, WORDS)
    silent, sending = source.pose_at(float(motion.time[15])), source.pose_at(float(motion.time[25]))

    assert silent is not None
    assert sending is not None
    assert silent.silent == {Place.LEFT_HAND: "Left hand"}
    assert Place.LEFT_HAND not in silent.measured
    assert Place.LEFT_HAND in sending.measured


def test_the_path_is_where_the_hips_went_with_no_more_points_than_can_be_seen():
    motion = moving_body(frames=5000)
    source = MotionSource(motion, WORDS)

    np.testing.assert_allclose(source.window(1.0, 2.0), motion.hips[50:101, :2])
    assert len(source.window(0.0, 1e9)) <= PATH_POINTS + 1


def test_an_empty_motion_has_no_pose():
    motion = moving_body(frames=2)
    empty = replace(
        motion, time=motion.time[:0], world_from_segment=motion.world_from_segment[:0], hips=motion.hips[:0]
    )

    assert MotionSource(empty, WORDS).pose_at(0.0) is None
