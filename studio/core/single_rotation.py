"""``rotation`` for one quaternion at a time, on plain floats.

numpy needs about 10 µs to multiply two single quaternions, this 1 µs; live, 1,500 samples a second pass
here. The same formulas; a test holds both against each other.
"""

import math

from studio.core.rotation import SMALL_ANGLE
from studio.core.sample import Quaternion, Vector

IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def multiply(a: Quaternion, b: Quaternion) -> Quaternion:
    """Return ``a_from_c = a_from_b * b_from_c``."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def inverse(a: Quaternion) -> Quaternion:
    """Return ``b_from_a``."""
    return (a[0], -a[1], -a[2], -a[3])


def to_rotation_vector(a: Quaternion) -> Vector:
    """Return the shortest rotation vector, rad."""
    w, x, y, z = a if a[0] >= 0 else (-a[0], -a[1], -a[2], -a[3])
    sine = math.sqrt(x * x + y * y + z * z)
    scale = 2 * math.atan2(sine, w) / sine if sine > SMALL_ANGLE else 2.0
    return (x * scale, y * scale, z * scale)


def from_rotation_vector(v: Vector) -> Quaternion:
    """Return the quaternion of a rotation vector in rad."""
    angle = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    scale = math.sin(0.5 * angle) / angle if angle > SMALL_ANGLE else 0.5
    return (math.cos(0.5 * angle), v[0] * scale, v[1] * scale, v[2] * scale)


def heading(a: Quaternion) -> float:
    """Return the turn about z in rad of the swing-twist decomposition."""
    return 2 * math.atan2(a[3], a[0])
