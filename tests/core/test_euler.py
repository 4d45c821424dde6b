"""Euler angles: all twelve sequences, the locks, and angles that run on."""

from itertools import product

import numpy as np
import pytest

from studio.core import euler, rotation

SEQUENCES = ["".join(axes) for axes in product("XYZ", repeat=3) if axes[0] != axes[1] != axes[2]]
ROUNDING = 1e-12  # rad; a few hundred operations in double precision


def random_rotations(count=2000, seed=0):
    return rotation.normalise(np.random.default_rng(seed).normal(size=(count, 4)))


def turning_about(sequence, middle, frames=400):
    """A motion whose middle angle follows ``middle`` (rad) while the outer ones turn slowly."""
    outer = np.linspace(0, 1.5, frames)
    return euler.from_euler(np.stack([outer, middle, -0.5 * outer], axis=1), sequence)


def largest_step(angles):
    return np.abs(np.diff(angles, axis=0)).max()


def test_there_are_twelve_sequences():
    assert len(SEQUENCES) == 12


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_agree_with_scipy(sequence):
    from scipy.spatial.transform import Rotation

    turned = random_rotations()

    angles = euler.to_euler(turned, sequence)

    other = Rotation.from_quat(turned[:, [1, 2, 3, 0]]).as_euler(sequence)
    # Near a lock the outer angles are worth as many digits less as the cosine of the middle one.
    np.testing.assert_allclose(euler.wrap(angles - other), 0, atol=1e-11)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_lead_back_to_the_rotation(sequence):
    turned = random_rotations()

    back = euler.from_euler(euler.to_euler(turned, sequence), sequence)

    assert rotation.angle_between(turned, back).max() < ROUNDING


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_in_the_lock_the_third_angle_is_zero_and_the_rotation_is_kept(sequence):
    locked = 0.0 if sequence[0] == sequence[2] else np.pi / 2
    turned = euler.from_euler([[0.4, locked, 0.3], [-2.0, locked, 1.0]], sequence)

    angles = euler.to_euler(turned, sequence)

    np.testing.assert_allclose(angles[:, 2], 0, atol=1e-12)
    assert rotation.angle_between(turned, euler.from_euler(angles, sequence)).max() < 1e-11


def test_rotations_may_be_stacked_in_any_shape():
    turned = random_rotations(24).reshape(2, 3, 4, 4)

    angles = euler.to_euler(turned, "ZXY")

    assert angles.shape == (2, 3, 4, 3)
    np.testing.assert_array_equal(angles[1, 2, 3], euler.to_euler(turned[1, 2, 3], "ZXY"))


@pytest.mark.parametrize("sequence", ["XX", "XXY", "ABC", "xyz"])
def test_what_is_no_sequence_is_our_own_mistake(sequence):
    with pytest.raises(ValueError, match=sequence):
        euler.to_euler(rotation.IDENTITY, sequence)


@pytest.mark.parametrize("sequence", SEQUENCES)
def test_angles_run_on_through_the_locks(sequence):
    """The middle angle goes three times round, through every lock there is."""
    middle = np.linspace(0.31, 0.31 + 6 * np.pi, 4000)
    turned = turning_about(sequence, middle, 4000)

    angles = euler.unwrap_continuous(euler.to_euler(turned, sequence), sequence)

    assert largest_step(angles) < np.radians(1)
    assert angles[:, 1].max() > 5 * np.pi
    assert rotation.angle_between(turned, euler.from_euler(angles, sequence)).max() < ROUNDING


def test_the_filter_of_paper_001_alone_would_jump_by_half_a_turn():
    turned = turning_about("ZXY", np.linspace(0, np.pi, 400))

    whole_turns_only = np.unwrap(euler.to_euler(turned, "ZXY"), axis=0)

    assert largest_step(whole_turns_only) > np.radians(150)
    assert largest_step(euler.unwrap_continuous(euler.to_euler(turned, "ZXY"), "ZXY")) < np.radians(1)


def test_the_first_row_is_kept_and_a_stretch_goes_on_from_it():
    turned = turning_about("YXY", np.linspace(0.2, 9, 600), 600)
    whole = euler.unwrap_continuous(euler.to_euler(turned, "YXY"), "YXY")

    second_half = euler.to_euler(turned[300:], "YXY")
    joined = euler.unwrap_continuous(np.concatenate([whole[299:300], second_half]), "YXY")

    np.testing.assert_allclose(joined, whole[299:], atol=ROUNDING)


def test_wrapping_keeps_plus_180_and_turns_minus_180_over():
    np.testing.assert_allclose(euler.wrap([np.pi, -np.pi, 3 * np.pi, 0.1 - 2 * np.pi]), [np.pi, np.pi, np.pi, 0.1])
