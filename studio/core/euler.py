"""Euler angles of unit quaternions: any of the twelve intrinsic sequences, and continuity in time.

``to_euler(q, "ZXY")`` returns (a, b, c) with ``q = about(Z, a) * about(X, b) * about(Y, c)``: the
frame is turned about its Z, then its new X, then its newest Y. Angles are in rad.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.core import rotation

Array = NDArray[np.float64]

LOCKED = 1e-12  # sine or cosine of half the middle angle; rounding of double precision leaves 1e-16


def to_euler(a: ArrayLike, sequence: str) -> Array:
    """Return the angles of unit quaternions about the axes of ``sequence``.

    Parameters
    ----------
    a : (..., 4)
    sequence
        Three letters of XYZ, neighbours different.

    Returns
    -------
    (..., 3), rad
        The outer angles in (-π, π]; the middle angle in [-π/2, π/2] for three different axes and in
        [0, π] when the last axis is the first again. Where the outer axes are parallel (gimbal
        lock) only their sum or difference exists: the third angle is then 0.
    """
    first, second, third = _axes(sequence)
    q = np.asarray(a, np.float64)
    last = 3 - first - second
    sign = _parity(first, second, last)
    w, i, j, k = q[..., 0], q[..., 1 + first], q[..., 1 + second], sign * q[..., 1 + last]
    if third == first:
        return _two_axes(w, i, j, k)
    # Turned by a quarter about the second axis the third axis lies on the first: i-j-k becomes i-j-i,
    # whose half-angle sums are the quaternion's own components.
    angles = _two_axes(w + sign * j, i + sign * k, w - sign * j, i - sign * k)
    angles[..., 1] = sign * (np.pi / 2 - angles[..., 1])
    return angles


def _two_axes(w: Array, i: Array, j: Array, k: Array) -> Array:
    """Return the angles (..., 3) of i-j-i from w + i + j + k of any length."""
    cosine, sine = np.hypot(w, i), np.hypot(j, k)
    length = np.hypot(cosine, sine)
    half_sum, half_difference = np.arctan2(i, w), np.arctan2(k, j)
    half_sum = np.where(cosine < LOCKED * length, half_difference, half_sum)
    half_difference = np.where(sine < LOCKED * length, half_sum, half_difference)
    out = np.empty((*np.shape(w), 3))
    out[..., 0] = wrap(half_sum + half_difference)
    out[..., 1] = 2 * np.arctan2(sine, cosine)
    out[..., 2] = wrap(half_sum - half_difference)
    return out


def from_euler(angles: ArrayLike, sequence: str) -> Array:
    """Return the unit quaternions (..., 4) of angles (..., 3) in rad about the axes of ``sequence``."""
    first, second, third = _axes(sequence)
    u = np.asarray(angles, np.float64)
    outer = rotation.multiply(rotation.about(first, u[..., 0]), rotation.about(second, u[..., 1]))
    return rotation.multiply(outer, rotation.about(third, u[..., 2]))


def wrap(angle: ArrayLike) -> Array:
    """Return angles in rad as the same directions in (-π, π]."""
    turned = np.asarray(angle, np.float64)
    return np.asarray(np.pi - np.mod(np.pi - turned, 2 * np.pi))


def unwrap_continuous(angles: ArrayLike, sequence: str) -> Array:
    """Return the same rotations with angles that run on without jumps.

    Parameters
    ----------
    angles : (n, ..., 3), rad
        Rows in order of time, all finite.
    sequence
        The axes the angles are about.

    Returns
    -------
    (n, ..., 3), rad
        The first row is returned as it is.

    Notes
    -----
    Every rotation has two sets of angles: for three different axes (a, b, c) and (a+π, π-b, c+π), for
    i-j-i (a, b, c) and (a+π, -b, c+π), each up to whole turns. Each row takes the set nearest to the
    row before: the filter of paper 001 against discontinuities of Euler angles, which there adds or
    removes 360 degrees only.
    """
    u = np.asarray(angles, np.float64)
    first, _, third = _axes(sequence)
    other = u + np.pi
    other[..., 1] = -u[..., 1] if first == third else np.pi - u[..., 1]
    # Staying costs the same in both sets, and so does changing over: whether a row changes does not
    # depend on the set of the row before, so a running count replaces a loop over time.
    stay = (wrap(u[1:] - u[:-1]) ** 2).sum(axis=-1)
    change = (wrap(other[1:] - u[:-1]) ** 2).sum(axis=-1)
    changed = np.zeros(u.shape[:-1], bool)
    changed[1:] = np.cumsum(change < stay, axis=0) % 2 == 1
    return np.asarray(np.unwrap(np.where(changed[..., None], other, u), axis=0))


def roll_pitch_yaw(world_from_body: ArrayLike) -> Array:
    """Return roll φ, pitch θ and yaw ψ, (..., 4) to (..., 3) in rad: equation 4 of paper 003.

    Notes
    -----
    The paper writes R(u) = R1(φ) R2(θ) R3(ψ) with passive rotations from world to body (Diebel's
    convention). Read actively that is the usual ``world_from_body = Rz(ψ) Ry(θ) Rx(φ)`` with the same
    angles and signs. Erratum: section 2.4 places the gimbal lock at θ = nπ; it is at θ = π/2 + nπ,
    where φ and ψ turn about one axis and this function sets φ to 0.
    """
    return to_euler(world_from_body, "ZYX")[..., ::-1]


def from_roll_pitch_yaw(angles: ArrayLike) -> Array:
    """Return ``world_from_body`` (..., 4) of (φ, θ, ψ) (..., 3) in rad: equation 5 of paper 003, corrected.

    Notes
    -----
    Erratum: q1, q2 and q3 are misprinted; at φ = θ = ψ = 0 they give (1, -1, 1, 1), not the identity.
    With C and S the cosine and sine of the half angles,
    q0 = Cφ Cθ Cψ + Sφ Sθ Sψ, q1 = Sφ Cθ Cψ - Cφ Sθ Sψ, q2 = Cφ Sθ Cψ + Sφ Cθ Sψ,
    q3 = Cφ Cθ Sψ - Sφ Sθ Cψ. The components are not made positive: q and -q are one rotation.
    """
    half = 0.5 * np.asarray(angles, np.float64)
    cosine, sine = np.cos(half), np.sin(half)
    c1, c2, c3 = cosine[..., 0], cosine[..., 1], cosine[..., 2]
    s1, s2, s3 = sine[..., 0], sine[..., 1], sine[..., 2]
    return np.stack(
        [
            c1 * c2 * c3 + s1 * s2 * s3,
            s1 * c2 * c3 - c1 * s2 * s3,
            c1 * s2 * c3 + s1 * c2 * s3,
            c1 * c2 * s3 - s1 * s2 * c3,
        ],
        axis=-1,
    )


def _axes(sequence: str) -> tuple[int, int, int]:
    if len(sequence) != 3 or any(letter not in "XYZ" for letter in sequence):
        raise ValueError(f"{sequence!r} is not a sequence of three axes")
    first, second, third = ("XYZ".index(letter) for letter in sequence)
    if second in (first, third):
        raise ValueError(f"{sequence!r} turns twice about one axis")
    return first, second, third


def _parity(i: int, j: int, k: int) -> float:
    """Return +1 when i, j, k are a cyclic order of x, y, z and -1 otherwise."""
    return 1.0 if (j - i) % 3 == 1 else -1.0
