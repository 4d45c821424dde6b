"""Frames on a byte stream: COBS with a zero behind each, and a CRC-16 inside.

COBS (Cheshire, Baker 1999, "Consistent Overhead Byte Stuffing") leaves no zero inside a frame, so a
reader is in step again at the next zero whatever was lost. The check is CRC-16/CCITT-FALSE: polynomial
0x1021, start 0xFFFF, little endian behind the body; it detects every burst of up to 16 bits.
"""

import struct
from binascii import crc_hqx

_CHECK = struct.Struct("<H")
CHECK_SIZE = 2  # bytes of the CRC
FULL_BLOCK = 0xFE  # bytes without a zero, as many as one distance spans
CHECK_START = 0xFFFF  # CRC-16/CCITT-FALSE


def frame(body: bytes) -> bytes:
    """Return ``body`` with its CRC, stuffed, and the closing zero."""
    return stuff(body + _CHECK.pack(crc_hqx(body, CHECK_START))) + b"\0"


def stuff(data: bytes) -> bytes:
    """Return ``data`` without zeros: each is replaced by the distance to the next."""
    blocks = bytearray()
    runs = data.split(b"\0")
    for run in runs:
        at = 0
        while len(run) - at > FULL_BLOCK:
            blocks += b"\xff" + run[at : at + FULL_BLOCK]
            at += FULL_BLOCK
        blocks.append(len(run) - at + 1)
        blocks += run[at:]
        if len(run) - at == FULL_BLOCK and run is not runs[-1]:
            blocks.append(1)  # a full block implies no zero behind it
    return bytes(blocks)


def unstuff(stuffed: bytes) -> bytes | None:
    """Return what ``stuff`` was given, None when a distance points past the end."""
    end = len(stuffed)
    parts = []
    at = 0
    while at < end:
        distance = stuffed[at]
        following = at + distance
        if following > end or not distance:
            return None
        parts.append(stuffed[at + 1 : following])
        if distance != 0xFF and following < end:
            parts.append(b"\0")
        at = following
    return b"".join(parts)


def is_intact(checked: bytes) -> bool:
    """Tell whether the last two bytes are the CRC of what is before them."""
    size = len(checked) - CHECK_SIZE
    return size >= 0 and crc_hqx(checked[:size], CHECK_START) == checked[size] | checked[size + 1] << 8
