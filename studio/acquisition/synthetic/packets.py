"""What a tag says in one frame: a sample, or facts in its place (PROTOCOL.md, section 2)."""

from typing import NamedTuple

from studio.acquisition.dialects import tag_advert
from studio.acquisition.dialects.tag_advert import PREFIX
from studio.acquisition.synthetic.firmware import TagState
from studio.core.sample import Quaternion, Vector

HARDWARE = 1
FIRMWARE_VERSION = 0x0100  # 1.0
WHO_AM_I = 0x68  # of an MPU-6050
GYRO_RANGE_DEG_S, ACCEL_RANGE_G = 2000, 16
BANDWIDTH_HZ, INTERNAL_RATE_HZ = 94, 200
FACTS_PERIOD = 50  # frames; one of them tells INFO or DEVICE
EMPTY_VOLT, FULL_VOLT = 3.3, 4.2  # V of a lithium cell, taken as a straight line


class Moment(NamedTuple):
    """One frame of one tag."""

    sequence: int
    counter: int
    """Frame counter of the receiver, or the tag's own."""
    temperature: float
    """°C."""
    clock: int
    flags: int
    orientation: Quaternion
    rate: Vector
    acceleration: Vector
    angle: Vector
    """rad, running integrals."""
    summed: int
    """Ticks in them."""


def payload(tag: TagState, moment: Moment) -> bytes:
    """Return the 27 bytes a receiver hands on."""
    return _advert(tag, moment)[len(PREFIX) :]


def _advert(tag: TagState, moment: Moment) -> bytes:
    head = (tag.number, moment.sequence, moment.clock, moment.flags)
    if tag.rows_to_tell:
        row = tag.rows_to_tell.pop(0)
        values = (tag.correction.offset, *tag.correction.gain)[row]
        return tag_advert.encode_coefficients(*head, row, values, tag.crc, tag.battery)
    if (moment.counter - 3 * tag.number) % FACTS_PERIOD == 0:
        return _facts(tag, moment, head)
    if tag.integrating:
        return tag_advert.encode_integral(*head, moment.angle, moment.summed, moment.temperature, tag.battery)
    return tag_advert.encode_sample(*head, moment.orientation, moment.rate, moment.acceleration, tag.battery)


def _facts(tag: TagState, moment: Moment, head: tuple[int, int, int, int]) -> bytes:
    """Return INFO or DEVICE, in turn."""
    if moment.counter // FACTS_PERIOD % 2 == 0:
        volt = EMPTY_VOLT + tag.battery * (FULL_VOLT - EMPTY_VOLT)
        names = (tag.crc, tag.serial)
        return tag_advert.encode_info(
            *head, moment.orientation, FIRMWARE_VERSION, volt, moment.temperature, *names, tag.battery
        )
    chip = (HARDWARE, WHO_AM_I, GYRO_RANGE_DEG_S, ACCEL_RANGE_G, BANDWIDTH_HZ, INTERNAL_RATE_HZ)
    return tag_advert.encode_device(*head, moment.orientation, *chip, tag.serial, tag.battery)
