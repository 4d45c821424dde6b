"""Paper 000: rotations of bones, and the pose that is held at the start."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PARENTS, SEGMENTS, Segment
from studio.importers.bvh import joint_positions, read_bvh
from tests.export.moving_body import moving_body
from tests.journeys.command_line import say


def random_rotations(*shape):
    return rotation.normalise(np.random.default_rng(14).normal(size=(*shape, 4)))


@pytest.fixture
def tumbling():
    """A body whose segments are turned at random."""
    return replace(moving_body(400), world_from_segment=random_rotations(400, SEGMENTS))


def test_0_14_a_bones_own_rotation_is_the_parents_inverse_times_the_childs(tumbling):
    """Forward kinematics leads back to the child exactly; as printed (child times inverse parent) it does not."""
    world = tumbling.world_from_segment
    for segment in list(Segment)[1:]:
        parent = Segment(PARENTS[segment])

        own = tumbling.parent_from_child(parent, segment)

        printed = rotation.multiply(world[:, segment], rotation.inverse(world[:, parent]))
        residual = rotation.angle_between(rotation.multiply(world[:, parent], own), world[:, segment])
        printed_residual = rotation.angle_between(rotation.multiply(world[:, parent], printed), world[:, segment])
        assert residual.max() < 1e-12
        assert np.degrees(np.median(printed_residual)) > 60


def test_0_14_erratum_the_conjugate_changes_the_sign_of_the_vector_part():
    """Printed: q* = (w, n)."""
    q = random_rotations(50)

    undone = rotation.multiply(rotation.inverse(q), q)

    np.testing.assert_allclose(rotation.inverse(q), q * [1, -1, -1, -1], atol=1e-15)
    np.testing.assert_allclose(undone, np.tile(rotation.IDENTITY, (50, 1)), atol=1e-15)


def test_0_14_a_vector_is_turned_by_q_p_q_conjugate():
    """R90x = (1/√2, 1/√2, 0, 0) carries y to z; any rotation agrees with its matrix."""
    quarter = np.array([np.sqrt(0.5), np.sqrt(0.5), 0, 0])
    q, p = random_rotations(50), np.random.default_rng(1).normal(size=(50, 3))

    as_printed = rotation.multiply(rotation.multiply(q, np.pad(p, ((0, 0), (1, 0)))), rotation.inverse(q))

    np.testing.assert_allclose(rotation.rotate(quarter, np.array([0.0, 1.0, 0.0])), [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(as_printed[:, 0], 0, atol=1e-14)
    np.testing.assert_allclose(rotation.rotate(q, p), as_printed[:, 1:], atol=1e-14)
    np.testing.assert_allclose(rotation.rotate(q, p), np.einsum("nij,nj->ni", rotation.to_matrix(q), p), atol=1e-14)


def test_0_14_head_and_trunk_of_figure_24(tmp_path, t_pose_take):
    """Bowing tips the trunk forwards, and the head with it."""
    assert say("export", t_pose_take, "--format", "bvh", "--fps", "native", "-o", tmp_path / "b.bvh").code == 0

    joints = joint_positions(read_bvh(tmp_path / "b.bvh"))

    upright, bowed = joints[150], joints[330]  # 3 s and 6.6 s
    trunk_up, trunk_bowed = (at[Segment.Neck] - at[Segment.Hips] for at in (upright, bowed))
    head_up, head_bowed = (at[Segment.Head] - at[Segment.Neck] for at in (upright, bowed))
    tilt_of_trunk, tilt_of_head = tilt(trunk_bowed) - tilt(trunk_up), tilt(head_bowed) - tilt(head_up)
    assert tilt_of_trunk > 30
    assert tilt_of_head > 30


def tilt(vector):
    """Return the angle forwards from upright in the file's axes (y up, z forward), degrees."""
    return np.degrees(np.arctan2(vector[2], vector[1]))


def test_0_15_a_t_pose_held_for_three_seconds_tells_how_the_arms_sensors_sit(t_pose_take):
    """The paper allows 30 s. The T-pose is one fact and standing before it the other."""
    poses = ["--pose", "t=11.8..14.4", "--pose", "n=1.5..3.9"]

    told = say("solve", t_pose_take, *poses)

    assert told.code == 0
    assert "reference pose n from 1.50 s to 3.90 s" in told.out
    arms = [line for line in told.out.splitlines() if "arm" in line.split(" ")[0]]
    assert len(arms) == 4
    assert all("two poses" in line for line in arms)


@pytest.mark.parametrize("pose", ["t=9.4..10.8", "n=9.4..10.8"])
def test_0_15_who_moves_is_told_which_limbs_moved(tmp_path, t_pose_take, pose):
    """From 9.4 s to 10.8 s the arms are being raised, and nothing else moves."""
    refused = say("export", t_pose_take, "--format", "bvh", "--pose", pose, "-o", tmp_path / "moved.bvh")

    assert refused.code == 1
    name = pose[0].upper()
    assert refused.err.startswith(
        "Left upper arm, right upper arm, left forearm, right forearm, left hand and right hand moved "
        f"while the {name}-pose was held."
    )
    assert not (tmp_path / "moved.bvh").exists()
