"""Paper 003, section 2.4: what it says of Euler angles and unit quaternions, and where it is misprinted."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core import euler, rotation

ROUNDING = 1e-12  # rad; the bar of the acceptance list
roll = yaw = st.floats(-np.pi, np.pi)
pitch = st.floats(-np.pi / 2, np.pi / 2)


def passive(axis, angle):
    """R_i of equation 2: the coordinates of a fixed vector after the frame turned by ``angle``."""
    c, s = np.cos(angle), np.sin(angle)
    about_x = [[1, 0, 0], [0, c, s], [0, -s, c]]
    about_y = [[c, 0, -s], [0, 1, 0], [s, 0, c]]
    about_z = [[c, s, 0], [-s, c, 0], [0, 0, 1]]
    return np.array([about_x, about_y, about_z][axis])


def equation_4(q):
    """As printed."""
    q0, q1, q2, q3 = q
    return np.array(
        [
            np.arctan2(2 * q2 * q3 + 2 * q0 * q1, q3**2 - q2**2 - q1**2 + q0**2),
            -np.arcsin(2 * q1 * q3 - 2 * q0 * q2),
            np.arctan2(2 * q1 * q2 + 2 * q0 * q3, q1**2 + q0**2 - q3**2 - q2**2),
        ]
    )


@given(roll, pitch, yaw)
def test_3_13_the_product_of_three_passive_rotations_is_the_inverse_of_the_quaternion(phi, theta, psi):
    """Equations 1 to 3: R123(u) = R1(φ) R2(θ) R3(ψ) leads from world to body."""
    body_from_world = passive(0, phi) @ passive(1, theta) @ passive(2, psi)

    world_from_body = euler.from_roll_pitch_yaw([phi, theta, psi])

    np.testing.assert_allclose(rotation.to_matrix(world_from_body).T, body_from_world, atol=ROUNDING)


def test_3_13_the_scalar_comes_first():
    """Equation 3: q = (q0, q1:3) = (w, x, y, z)."""
    half_turn_about_x = euler.from_roll_pitch_yaw([np.pi, 0, 0])

    np.testing.assert_allclose(half_turn_about_x, [0, 1, 0, 0], atol=1e-15)


@given(roll, st.floats(-1.5, 1.5), yaw)
def test_3_14_equation_4_as_printed_is_what_the_studio_computes(phi, theta, psi):
    q = euler.from_roll_pitch_yaw([phi, theta, psi])

    # The printed arcsine keeps 1e-15 / cos(1.5) at the ends of this range.
    np.testing.assert_allclose(euler.wrap(euler.roll_pitch_yaw(q) - equation_4(q)), 0, atol=1e-12)


@given(roll, pitch, yaw)
def test_3_14_quaternion_to_angles_to_quaternion(phi, theta, psi):
    q = euler.from_roll_pitch_yaw([phi, theta, psi])

    back = euler.from_roll_pitch_yaw(euler.roll_pitch_yaw(q))

    assert rotation.angle_between(q, back) < 4 * ROUNDING  # in the lock the third angle is set to zero


@given(roll, st.floats(-1.5, 1.5), yaw)
def test_3_14_angles_to_quaternion_to_angles(phi, theta, psi):
    back = euler.roll_pitch_yaw(euler.from_roll_pitch_yaw([phi, theta, psi]))

    np.testing.assert_allclose(euler.wrap(back - [phi, theta, psi]), 0, atol=ROUNDING)


def test_3_14_erratum_equation_5_as_printed_is_no_identity_at_zero_angles():
    """Printed: q1 = q2 = q3 = ±1 at φ = θ = ψ = 0, a quaternion of length 2."""
    printed = np.array([1.0, -1.0, 1.0, 1.0])

    corrected = euler.from_roll_pitch_yaw([0.0, 0.0, 0.0])

    assert np.linalg.norm(printed) == pytest.approx(2)
    np.testing.assert_array_equal(corrected, rotation.IDENTITY)


@pytest.mark.parametrize(("theta", "smallest"), [(0.0, 0.5), (np.pi / 2, 0.0), (np.pi, 0.5), (3 * np.pi / 2, 0.0)])
def test_3_14_erratum_the_gimbal_lock_is_at_quarter_turns_not_at_half_turns(theta, smallest):
    """Printed: the lock arises at θ = n π. The rank of the angles' effect says θ = π/2 + n π."""
    at = np.array([0.3, theta, -0.4])
    step = 1e-6
    effect = [
        (euler.from_roll_pitch_yaw(at + step * e) - euler.from_roll_pitch_yaw(at - step * e)) / (2 * step)
        for e in np.eye(3)
    ]

    assert np.linalg.svd(np.array(effect), compute_uv=False)[-1] == pytest.approx(smallest, abs=1e-9)


def test_3_14_in_the_lock_roll_is_zero_and_the_attitude_is_kept():
    q = euler.from_roll_pitch_yaw([0.3, np.pi / 2, -0.4])

    angles = euler.roll_pitch_yaw(q)

    assert angles[0] == pytest.approx(0, abs=1e-15)
    assert rotation.angle_between(q, euler.from_roll_pitch_yaw(angles)) < ROUNDING
