"""A unit quaternion in 48 bits: three components of 15 bits, and which one was left out.

The largest component is left out and made positive by flipping all signs, so that it follows from the
rest (PROTOCOL.md, "Smallest three"). The error is 0.0028 degrees rms, 0.0086 at worst.
"""

import math

from studio.core.sample import Quaternion

_FIELD_SCALE = math.sqrt(2.0) * 16384.0
_COMPONENT = tuple((field - 16384) / _FIELD_SCALE for field in range(32768))
_ROUNDING = 1e-3  # of a squared component; half a field step of 2.2e-5 gives 1e-4
_LEAST_LARGEST = 0.25 - _ROUNDING  # square of the largest of four components whose squares sum to 1


def pack(orientation: Quaternion) -> tuple[int, int]:
    """Return the low 32 and high 16 bits of the smallest-three form."""
    index = max(range(4), key=lambda i: abs(orientation[i]))
    scale = _FIELD_SCALE / math.copysign(math.sqrt(sum(c * c for c in orientation)), orientation[index])
    rest = [c for i, c in enumerate(orientation) if i != index]
    a, b, c = (min(max(math.floor(16384.5 + v * scale), 0), 32767) for v in rest)
    word = a | b << 15 | c << 30 | index << 46
    return word & 0xFFFFFFFF, word >> 32


def unpack(low: int, high: int) -> Quaternion | None:
    """Return the unit quaternion of the smallest-three form, None when no tag can have sent it."""
    a = _COMPONENT[low & 0x7FFF]
    b = _COMPONENT[low >> 15 & 0x7FFF]
    c = _COMPONENT[(low >> 30 | high << 2) & 0x7FFF]
    aa, bb, cc = a * a, b * b, c * c
    square = 1.0 - aa - bb - cc
    at_most = square + _ROUNDING
    if square < _LEAST_LARGEST or aa > at_most or bb > at_most or cc > at_most or high & 0x2000:
        return None
    largest = math.sqrt(square)
    index = high >> 14
    if index == 0:
        return largest, a, b, c
    if index == 1:
        return a, largest, b, c
    if index == 2:
        return a, b, largest, c
    return a, b, c, largest
