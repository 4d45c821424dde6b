"""Unit quaternions (w, x, y, z) on arrays (..., 4); ``a_from_b`` turns b coordinates into a coordinates.

Products read like fractions: ``world_from_segment = multiply(world_from_sensor, sensor_from_segment)``.
Every function broadcasts and returns float64.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

IDENTITY: Array = np.array([1.0, 0.0, 0.0, 0.0])
IDENTITY.flags.writeable = False

_CONJUGATE: Array = np.array([1.0, -1.0, -1.0, -1.0])

# For few rotations the number of numpy calls is the cost: one outer product and one matrix product take 4 µs where the
# products written out take 11 to 17; from some hundred rotations on it is the other way round.
FEW = 256  # numbers in both arguments


def _hamilton() -> Array:
    """Return the (16, 4) matrix that makes a product of the outer product of two quaternions."""
    table = np.zeros((4, 4, 4))
    products = [
        [(0, 1), (1, 1), (2, 1), (3, 1)],
        [(1, 1), (0, -1), (3, 1), (2, -1)],
        [(2, 1), (3, -1), (0, -1), (1, 1)],
        [(3, 1), (2, 1), (1, -1), (0, -1)],
    ]  # unit i times unit j is sign times unit k
    for i, row in enumerate(products):
        for j, (k, sign) in enumerate(row):
            table[i, j, k] = sign
    return table.reshape(16, 4)


_HAMILTON = _hamilton()


def _sandwich() -> Array:
    """Return the (16, 9) matrix that makes the rotation matrix of a unit quaternion's outer product with itself."""
    units = np.eye(4)
    table = np.zeros((4, 4, 3, 3))
    conjugate = _CONJUGATE
    for i in range(4):
        for j in range(4):
            for axis in range(3):
                left = np.outer(units[i], units[axis + 1]).reshape(16) @ _HAMILTON
                turned = np.outer(left, units[j] * conjugate).reshape(16) @ _HAMILTON
                table[i, j, :, axis] = turned[1:]
    return table.reshape(16, 9)


SMALL_ANGLE = 1e-8  # rad; below it sin(x)/x is 1 to double precision


_MATRIX = _sandwich()


def multiply(a: ArrayLike, b: ArrayLike) -> Array:
    """Return the Hamilton product ``a_from_c = a_from_b * b_from_c``, (..., 4)."""
    p, q = np.asarray(a, np.float64), np.asarray(b, np.float64)
    if p.size + q.size <= FEW:
        outer = p[..., :, None] * q[..., None, :]
        few: Array = outer.reshape(*outer.shape[:-2], 16) @ _HAMILTON
        return few
    pw, px, py, pz = p[..., 0], p[..., 1], p[..., 2], p[..., 3]
    qw, qx, qy, qz = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    real = pw * qw - px * qx - py * qy - pz * qz
    out = np.empty((*real.shape, 4))
    out[..., 0] = real
    out[..., 1] = pw * qx + px * qw + py * qz - pz * qy
    out[..., 2] = pw * qy - px * qz + py * qw + pz * qx
    out[..., 3] = pw * qz + px * qy - py * qx + pz * qw
    return out


def inverse(a: ArrayLike) -> Array:
    """Return ``b_from_a`` for a unit ``a_from_b``, (..., 4)."""
    conjugate: Array = np.asarray(a, np.float64) * _CONJUGATE
    return conjugate


def rotate(a: ArrayLike, v: ArrayLike) -> Array:
    """Return vectors ``v`` given in b as seen in a, (..., 3), for ``a_from_b`` (..., 4)."""
    q, p = np.asarray(a, np.float64), np.asarray(v, np.float64)
    if q.size + p.size <= FEW:
        outer = q[..., :, None] * q[..., None, :]
        matrix = (outer.reshape(*outer.shape[:-2], 16) @ _MATRIX).reshape(*outer.shape[:-2], 3, 3)
        few: Array = (matrix @ p[..., None])[..., 0]
        return few
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    vx, vy, vz = p[..., 0], p[..., 1], p[..., 2]
    # v + 2 w (u x v) + 2 u x (u x v), written out: three times faster than np.cross
    tx, ty, tz = 2 * (y * vz - z * vy), 2 * (z * vx - x * vz), 2 * (x * vy - y * vx)
    first = vx + w * tx + y * tz - z * ty
    out = np.empty((*first.shape, 3))
    out[..., 0] = first
    out[..., 1] = vy + w * ty + z * tx - x * tz
    out[..., 2] = vz + w * tz + x * ty - y * tx
    return out


def normalise(a: ArrayLike) -> Array:
    """Return ``a`` scaled to unit length, (..., 4); zero quaternions become NaN."""
    q = np.asarray(a, np.float64)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(q / np.sqrt((q * q).sum(axis=-1, keepdims=True)))


def from_rotation_vector(v: ArrayLike) -> Array:
    """Return the quaternion of rotation vectors, (..., 3) in rad to (..., 4)."""
    vector = np.asarray(v, np.float64)
    angle = np.sqrt((vector * vector).sum(axis=-1))
    half = 0.5 * angle
    scale = np.where(angle > SMALL_ANGLE, np.sin(half) / np.where(angle > SMALL_ANGLE, angle, 1.0), 0.5)
    out = np.empty((*vector.shape[:-1], 4))
    out[..., 0] = np.cos(half)
    out[..., 1:] = vector * scale[..., None]
    return out


def to_rotation_vector(a: ArrayLike) -> Array:
    """Return the shortest rotation vector of unit quaternions, (..., 4) to (..., 3) in rad."""
    q = np.asarray(a, np.float64)
    q = np.where(q[..., :1] < 0, -q, q)
    sine = np.sqrt((q[..., 1:] * q[..., 1:]).sum(axis=-1))
    angle = 2 * np.arctan2(sine, q[..., 0])
    scale = np.where(sine > SMALL_ANGLE, angle / np.where(sine > SMALL_ANGLE, sine, 1.0), 2.0)
    return np.asarray(q[..., 1:] * scale[..., None])


def angle_between(a: ArrayLike, b: ArrayLike) -> Array:
    """Return the angle of the rotation from a to b in rad, 0…π, (...,)."""
    relative = multiply(inverse(a), b)
    sine = np.sqrt((relative[..., 1:] ** 2).sum(axis=-1))
    return np.asarray(2 * np.arctan2(sine, np.abs(relative[..., 0])))


def about(axis: int, angle: ArrayLike) -> Array:
    """Return rotations about coordinate axis 0, 1 or 2 by ``angle`` in rad, (..., 4)."""
    half = 0.5 * np.asarray(angle, np.float64)
    out = np.zeros((*half.shape, 4))
    out[..., 0] = np.cos(half)
    out[..., 1 + axis] = np.sin(half)
    return out


def slerp(a: ArrayLike, b: ArrayLike, fraction: ArrayLike) -> Array:
    """Return the rotation ``fraction`` of the shortest way from a to b, (..., 4)."""
    step = to_rotation_vector(multiply(inverse(a), b))
    return multiply(a, from_rotation_vector(step * np.asarray(fraction, np.float64)[..., None]))


def mean(rotations: ArrayLike, weights: ArrayLike | None = None) -> Array:
    """Return Markley's mean of (n, 4) quaternions, whatever their signs, (4,).

    The eigenvector of the largest eigenvalue of the sum of outer products
    (Markley, Cheng, Crassidis, Oshman 2007, "Averaging Quaternions").
    """
    q = np.asarray(rotations, np.float64)
    weighted = q if weights is None else q * np.asarray(weights, np.float64)[:, None]
    _, vectors = np.linalg.eigh(weighted.T @ q)
    best: Array = vectors[:, -1]
    return best if best[0] >= 0 else -best


def to_matrix(a: ArrayLike) -> Array:
    """Return rotation matrices whose columns are b's axes in a, (..., 4) to (..., 3, 3)."""
    q = np.asarray(a, np.float64)
    return np.stack([rotate(q, axis) for axis in np.eye(3)], axis=-1)


def from_matrix(m: ArrayLike) -> Array:
    """Return unit quaternions with w >= 0 of rotation matrices, (..., 3, 3) to (..., 4)."""
    r = np.asarray(m, np.float64)
    xx, yy, zz = r[..., 0, 0], r[..., 1, 1], r[..., 2, 2]
    skew = [r[..., 2, 1] - r[..., 1, 2], r[..., 0, 2] - r[..., 2, 0], r[..., 1, 0] - r[..., 0, 1]]
    xy, xz, yz = r[..., 0, 1] + r[..., 1, 0], r[..., 0, 2] + r[..., 2, 0], r[..., 1, 2] + r[..., 2, 1]
    # All four candidates; the one with the largest leading term is the accurate one (Shepperd 1978).
    rows = [
        [1 + xx + yy + zz, *skew],
        [skew[0], 1 + xx - yy - zz, xy, xz],
        [skew[1], xy, 1 - xx + yy - zz, yz],
        [skew[2], xz, yz, 1 - xx - yy + zz],
    ]
    candidates = np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
    best = np.argmax(np.stack([candidates[..., i, i] for i in range(4)], axis=-1), axis=-1)
    chosen = np.take_along_axis(candidates, best[..., None, None], axis=-2)[..., 0, :]
    unit = normalise(chosen)
    return np.where(unit[..., :1] < 0, -unit, unit)


def twist_about(a: ArrayLike, axis: int) -> Array:
    """Return the angle in rad of the part of ``a_from_b`` that turns about a's coordinate ``axis``, (...,).

    The swing-twist decomposition a = twist * swing; for axis 2 of a z-up world the heading.
    """
    q = np.asarray(a, np.float64)
    return np.asarray(2 * np.arctan2(q[..., 1 + axis], q[..., 0]))
