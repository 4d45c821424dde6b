"""Quaternions (w, x, y, z): held against scipy, an independent implementation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from studio.core import rotation
from studio.core import single_rotation as single

RNG = np.random.default_rng(0)
MANY = rotation.normalise(RNG.normal(size=(500, 4)))
OTHERS = rotation.normalise(RNG.normal(size=(500, 4)))
VECTORS = RNG.normal(size=(500, 3))


def scipy_of(q):
    from scipy.spatial.transform import Rotation

    return Rotation.from_quat(np.asarray(q)[..., [1, 2, 3, 0]])


def same_rotation(a, b):
    return float(rotation.angle_between(a, b).max()) < 1e-12


def from_scipy(r):
    return r.as_quat()[..., [3, 0, 1, 2]]


def test_a_product_reads_like_a_fraction():
    assert same_rotation(rotation.multiply(MANY, OTHERS), from_scipy(scipy_of(MANY) * scipy_of(OTHERS)))


def test_vectors_turn_as_scipy_turns_them():
    np.testing.assert_allclose(rotation.rotate(MANY, VECTORS), scipy_of(MANY).apply(VECTORS), atol=1e-12)


def test_few_rotations_turn_as_many_do():
    for few in (1, 5, 23, 40):
        np.testing.assert_allclose(
            rotation.multiply(MANY[:few], OTHERS[:few]), rotation.multiply(MANY, OTHERS)[:few], atol=1e-15
        )
        np.testing.assert_allclose(
            rotation.rotate(MANY[:few], VECTORS[:few]), rotation.rotate(MANY, VECTORS)[:few], atol=1e-14
        )
    np.testing.assert_allclose(
        rotation.multiply(MANY[0], OTHERS), rotation.multiply(np.tile(MANY[0], (500, 1)), OTHERS)
    )


def test_the_inverse_undoes():
    assert same_rotation(rotation.multiply(MANY, rotation.inverse(MANY)), np.tile(rotation.IDENTITY, (500, 1)))


def test_rotation_vectors_go_there_and_back():
    vectors = rotation.to_rotation_vector(MANY)

    np.testing.assert_allclose(vectors, scipy_of(MANY).as_rotvec(), atol=1e-12)
    assert same_rotation(rotation.from_rotation_vector(vectors), MANY)


@given(arrays(np.float64, 3, elements=st.floats(-1e-7, 1e-7)))
def test_tiny_rotations_lose_nothing(vector):
    np.testing.assert_allclose(rotation.to_rotation_vector(rotation.from_rotation_vector(vector)), vector, atol=1e-18)


def test_matrices_go_there_and_back_also_for_half_turns():
    half_turns = np.array([[0, 1.0, 0, 0], [0, 0, 1.0, 0], [0, 0, 0, 1.0], [0, 0.6, 0.8, 0]])
    for quaternions in (MANY, half_turns):
        matrices = rotation.to_matrix(quaternions)
        np.testing.assert_allclose(matrices, scipy_of(quaternions).as_matrix(), atol=1e-12)
        assert same_rotation(rotation.from_matrix(matrices), quaternions)


def test_slerp_keeps_its_pace_on_the_shortest_way():
    start, end = MANY[0], rotation.multiply(MANY[0], rotation.about(1, 1.2))
    for flipped in (end, -end):
        for fraction in (0.0, 0.25, 1.0):
            found = rotation.slerp(start, flipped, np.array(fraction))
            assert rotation.angle_between(start, found) == pytest.approx(1.2 * fraction, abs=1e-12)


def test_the_mean_does_not_care_about_signs_and_beats_the_last_sample():
    centre = MANY[3]
    scattered = rotation.multiply(centre, rotation.from_rotation_vector(np.radians(1.0) * RNG.normal(size=(400, 3))))
    signs = np.where(RNG.random(400) < 0.5, -1.0, 1.0)[:, None]

    found = rotation.mean(scattered * signs)

    assert np.degrees(rotation.angle_between(found, centre)) < 0.2
    assert found[0] >= 0


def test_heading_is_what_turns_about_up():
    heading = np.linspace(-3, 3, 50)
    tilted = rotation.multiply(rotation.about(0, 0.4), rotation.about(1, -0.3))

    turned = rotation.multiply(rotation.about(2, heading), tilted)

    difference = rotation.twist_about(turned, 2) - rotation.twist_about(tilted, 2)
    np.testing.assert_allclose(np.angle(np.exp(1j * (difference - heading))), 0, atol=1e-12)


def test_single_rotations_say_the_same_as_arrays():
    for a, b, v in zip(MANY[:50], OTHERS[:50], VECTORS[:50], strict=True):
        one, other = tuple(a.tolist()), tuple(b.tolist())
        np.testing.assert_allclose(single.multiply(one, other), rotation.multiply(a, b), atol=1e-15)
        np.testing.assert_allclose(single.inverse(one), rotation.inverse(a))
        np.testing.assert_allclose(single.to_rotation_vector(one), rotation.to_rotation_vector(a), atol=1e-14)
        np.testing.assert_allclose(
            single.from_rotation_vector(tuple(v.tolist())), rotation.from_rotation_vector(v), atol=1e-15
        )
        assert single.heading(one) == pytest.approx(float(rotation.twist_about(a, 2)))
