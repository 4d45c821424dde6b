"""What a tag says in one radio packet, both directions (firmware/protocol/PROTOCOL.md, "Tag to air").

Scales and layouts mirror firmware/protocol/packets.h; tests/conformance holds the two together.
"""

import math
import struct
from binascii import crc_hqx
from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import Final, Literal, NamedTuple

from studio.acquisition.dialects import smallest_three
from studio.acquisition.dialects.dialect import Reading, Traits
from studio.core.frames import GRAVITY
from studio.core.sample import MISSING_QUATERNION, MISSING_VECTOR, NAN, Correction, Quaternion, SensorId, Vector

VERSION = 1  # of the wire protocol
MAGIC = 0x6D  # 'm'; company 0xFFFF is shared by everybody's prototypes
PREFIX = b"\x1e\xff\xff\xff"  # AD length 30, manufacturer data, company 0xFFFF
PAYLOAD_SIZE = 27  # bytes after the prefix
ADVERT_SIZE = len(PREFIX) + PAYLOAD_SIZE

TRAITS = Traits(sequence_modulus=1 << 8, clock_modulus=1 << 24, clock_tick=64e-6, frame_s=0.02)

RATE_UNIT = math.radians(2000.0 / 32768.0)  # rad/s per count
ACCELERATION_UNIT = 16.0 / 32768.0 * GRAVITY  # m/s² per count
INTEGRAL_UNIT = math.radians(1.0 / 1024.0)  # rad per count
TEMPERATURE_UNIT = 0.01  # °C per count
BATTERY_UNIT = 0.005  # of a full battery per count
BATTERY_UNKNOWN = 255
FULL_SCALE = 32767  # a reading at either end of int16 is clipped, whatever the tag's flag says

OFFSET_LIMIT = math.radians(2000.0)  # rad/s; a larger offset than full scale is no offset
GAIN_LIMIT = 2.0  # the data sheet allows 3 % of scale and 2 % of cross axis (MPU-6050); 2 is nonsense

Refusal = Literal["foreign", "short", "long", "version", "type", "number", "orientation", "value", "reserved"]
"""Why a packet is not a reading; the key under which it is counted."""


class Packet(IntEnum):
    """Kinds of payload: the low half of byte 1."""

    SAMPLE = 1
    INTEGRAL = 3
    INFO = 4
    DEVICE = 5
    COEFFICIENTS = 6
    SYNC = 15


class Command(IntEnum):
    """What a receiver tells tags in SYNC."""

    NONE = 0
    ASSIGN_NUMBER = 1
    MEASURE_OFFSET = 2
    START_INTEGRALS = 3
    STREAM = 4
    COEFFICIENT = 5
    SAVE = 6
    BLINK = 7
    LEAVE_SLOTS = 8
    REPORT_COEFFICIENTS = 9


ALL_TAGS = 0xFFFFFFFF  # target serial of a command to every tag


class Sync(NamedTuple):
    """A receiver's beacon, heard or to be sent."""

    suit: int
    """1…254; 255 is every suit."""
    sequence: int
    clock_us: int
    """µs, the receiver's clock at the beacon's ADDRESS instant; wraps at 2^32."""
    frame_counter: int
    frame_s: float
    """s, a multiple of 100 µs."""
    slots: int
    command: int = Command.NONE
    target: int = ALL_TAGS
    """Serial of the tag the command is for."""
    value: bytes = bytes(5)
    nonce: int = 0
    """Of the pairing; 0 before."""
    command_serial: int = 0
    """Changes with each new command: beacons repeat a command ten times."""


_HEAD = "<BBBBHBB"  # magic, version and type, number, sequence, clock low 16, clock high 8, flags
_SAMPLE = struct.Struct(_HEAD + "IH6hB")
_INTEGRAL = struct.Struct(_HEAD + "3iHBhBB")
_INFO = struct.Struct(_HEAD + "IHHHhHIB")
_DEVICE = struct.Struct(_HEAD + "IHBBHBBHIB")
_COEFFICIENTS = struct.Struct(_HEAD + "B3fH3sB")
_SYNC = struct.Struct("<BBBBIIBBBI5sHB")

_BATTERY = (*(count * BATTERY_UNIT for count in range(201)), *[NAN] * 55)


def sensor_of(serial: int) -> SensorId:
    """Return the id of the tag whose device address has these low 32 bits."""
    return SensorId(f"tag:{serial:08x}")


def calibration_crc(correction: Correction) -> int:
    """Return what names a set of coefficients in INFO and COEFFICIENTS: CRC-16 of its twelve float32."""
    rows = (correction.offset, *correction.gain)
    return crc_hqx(struct.pack("<12f", *(value for row in rows for value in row)), 0xFFFF)


def encode_sample(
    number: int,
    sequence: int,
    clock: int,
    flags: int,
    orientation: Quaternion,
    rate: Vector,
    acceleration: Vector,
    battery: float,
) -> bytes:
    """Return the advert (31 bytes) of one sample; the clock in ticks, rates in rad/s, acceleration in m/s²."""
    counts = (*(_int16(v / RATE_UNIT) for v in rate), *(_int16(v / ACCELERATION_UNIT) for v in acceleration))
    head = _head(Packet.SAMPLE, number, sequence, clock, flags)
    return PREFIX + _SAMPLE.pack(*head, *smallest_three.pack(orientation), *counts, _battery(battery))


def encode_integral(
    number: int,
    sequence: int,
    clock: int,
    flags: int,
    angle: Sequence[float],
    samples: int,
    temperature: float,
    battery: float,
) -> bytes:
    """Return the advert of a running gyroscope integral, rad about each axis since its start."""
    counts = (((round(v / INTEGRAL_UNIT) + 0x80000000) & 0xFFFFFFFF) - 0x80000000 for v in angle)
    head = _head(Packet.INTEGRAL, number, sequence, clock, flags)
    middle = (samples & 0xFFFF, samples >> 16 & 0xFF, _int16(temperature / TEMPERATURE_UNIT), 0)
    return PREFIX + _INTEGRAL.pack(*head, *counts, *middle, _battery(battery))


def encode_info(
    number: int,
    sequence: int,
    clock: int,
    flags: int,
    orientation: Quaternion,
    firmware: int,
    battery_volt: float,
    temperature: float,
    calibration_crc: int,
    serial: int,
    battery: float,
) -> bytes:
    """Return the advert that tells firmware (major << 8 | minor), battery, temperature and calibration."""
    head = _head(Packet.INFO, number, sequence, clock, flags)
    facts = (firmware, round(battery_volt * 1000), _int16(temperature / TEMPERATURE_UNIT), calibration_crc, serial)
    return PREFIX + _INFO.pack(*head, *smallest_three.pack(orientation), *facts, _battery(battery))


def encode_device(
    number: int,
    sequence: int,
    clock: int,
    flags: int,
    orientation: Quaternion,
    hardware: int,
    who_am_i: int,
    gyro_range_deg_s: int,
    accel_range_g: int,
    bandwidth_hz: int,
    internal_rate_hz: int,
    serial: int,
    battery: float,
) -> bytes:
    """Return the advert that tells which chip measures, and how it is set."""
    head = _head(Packet.DEVICE, number, sequence, clock, flags)
    facts = (hardware, who_am_i, gyro_range_deg_s, accel_range_g, bandwidth_hz, internal_rate_hz, serial)
    return PREFIX + _DEVICE.pack(*head, *smallest_three.pack(orientation), *facts, _battery(battery))


def encode_coefficients(
    number: int,
    sequence: int,
    clock: int,
    flags: int,
    index: int,
    values: Sequence[float],
    calibration_crc: int,
    battery: float,
) -> bytes:
    """Return the advert of one row of the correction in force: 0 is the offset in rad/s, 1…3 the rows of the gain."""
    head = _head(Packet.COEFFICIENTS, number, sequence, clock, flags)
    return PREFIX + _COEFFICIENTS.pack(*head, index, *values, calibration_crc, bytes(3), _battery(battery))


def encode_sync(sync: Sync) -> bytes:
    """Return the advert of a receiver's beacon."""
    head = (MAGIC, VERSION << 4 | Packet.SYNC, sync.suit, sync.sequence & 0xFF, sync.clock_us & 0xFFFFFFFF)
    frame = (sync.frame_counter & 0xFFFFFFFF, round(sync.frame_s / 1e-4), sync.slots)
    command = (sync.command, sync.target, sync.value, sync.nonce, sync.command_serial)
    return PREFIX + _SYNC.pack(*head, *frame, *command)


def decode(advert: bytes, sensor: SensorId, rssi: float = NAN) -> Reading | Sync | Refusal:
    """Return what a packet of ``sensor`` says, or why it is not ours.

    ``advert`` is the payload (27 bytes) as the receiver hands it on, or the whole advertising data.
    """
    is_payload = len(advert) == PAYLOAD_SIZE and advert[0] == MAGIC
    payload = advert if is_payload else _payload_of(advert)
    if isinstance(payload, str):
        return payload
    head = payload[1]
    decoder = _DECODERS.get(head)
    if decoder is None:
        return "version" if head >> 4 != VERSION else "type"
    if payload[2] > 15 and head & 15 != Packet.SYNC:
        return "number"
    return decoder(payload, sensor, rssi)


def _payload_of(advert: bytes) -> bytes | Refusal:
    """Return our payload out of advertising data, whatever other structures stand before it."""
    at = 0
    while at < len(advert) and advert[at]:
        size = advert[at]
        if advert[at + 1 : at + 4] == PREFIX[1:]:
            return _payload_in(advert, at, size)
        at += 1 + size
    return "foreign"


def _payload_in(advert: bytes, at: int, size: int) -> bytes | Refusal:
    payload = advert[at + len(PREFIX) : at + 1 + size]
    if payload[:1] != bytes([MAGIC]):
        return "foreign"
    if size < PREFIX[0] or len(payload) < PAYLOAD_SIZE:
        return "short"
    if size > PREFIX[0]:
        return "long"
    return payload


def _decode_sample(payload: bytes, sensor: SensorId, rssi: float) -> Reading | Refusal:
    _, _, number, sequence, low, high, flags, q_low, q_high, gx, gy, gz, ax, ay, az, battery = _SAMPLE.unpack(payload)
    orientation = smallest_three.unpack(q_low, q_high)
    if orientation is None:
        return "orientation"
    counts = (gx, gy, gz, ax, ay, az)
    if max(counts) >= FULL_SCALE or min(counts) <= -FULL_SCALE:
        flags |= 8  # Flag.CLIPPED; members of an IntFlag cost a microsecond each time
    return Reading(
        sensor,
        number,
        sequence,
        high << 16 | low,
        orientation,
        (gx * RATE_UNIT, gy * RATE_UNIT, gz * RATE_UNIT),
        (ax * ACCELERATION_UNIT, ay * ACCELERATION_UNIT, az * ACCELERATION_UNIT),
        flags,
        _BATTERY[battery],
        NAN,
        rssi,
    )


def _decode_integral(payload: bytes, sensor: SensorId, rssi: float) -> Reading | Refusal:
    _, _, number, sequence, low, high, flags, x, y, z, *told = _INTEGRAL.unpack(payload)
    n_low, n_high, temperature, zero, battery = told
    if zero:
        return "reserved"
    facts: dict[str, str | int | float] = {
        "angle_x": x * INTEGRAL_UNIT,
        "angle_y": y * INTEGRAL_UNIT,
        "angle_z": z * INTEGRAL_UNIT,
        "samples": n_high << 16 | n_low,
    }
    celsius = temperature * TEMPERATURE_UNIT
    return _told(sensor, number, sequence, high << 16 | low, MISSING_QUATERNION, flags, battery, celsius, rssi, facts)


def _decode_info(payload: bytes, sensor: SensorId, rssi: float) -> Reading | Refusal:
    _, _, number, sequence, low, high, flags, q_low, q_high, *told = _INFO.unpack(payload)
    firmware, millivolt, temperature, crc, serial, battery = told
    orientation = smallest_three.unpack(q_low, q_high)
    if orientation is None:
        return "orientation"
    facts: dict[str, str | int | float] = {
        "firmware": f"{firmware >> 8}.{firmware & 0xFF}",
        "battery_volt": millivolt / 1000,
        "calibration_crc": crc,
        "serial": f"{serial:08x}",
    }
    celsius = temperature * TEMPERATURE_UNIT
    return _told(sensor, number, sequence, high << 16 | low, orientation, flags, battery, celsius, rssi, facts)


def _decode_device(payload: bytes, sensor: SensorId, rssi: float) -> Reading | Refusal:
    _, _, number, sequence, low, high, flags, q_low, q_high, *told = _DEVICE.unpack(payload)
    hardware, who_am_i, gyro_range, accel_range, bandwidth, internal_rate, serial, battery = told
    orientation = smallest_three.unpack(q_low, q_high)
    if orientation is None:
        return "orientation"
    facts: dict[str, str | int | float] = {
        "hardware": hardware,
        "who_am_i": who_am_i,
        "gyro_range_deg_s": gyro_range,
        "accel_range_g": accel_range,
        "bandwidth_hz": bandwidth,
        "internal_rate_hz": internal_rate,
        "serial": f"{serial:08x}",
    }
    return _told(sensor, number, sequence, high << 16 | low, orientation, flags, battery, NAN, rssi, facts)


def _decode_coefficients(payload: bytes, sensor: SensorId, rssi: float) -> Reading | Refusal:
    _, _, number, sequence, low, high, flags, index, x, y, z, crc, zeros, battery = _COEFFICIENTS.unpack(payload)
    if any(zeros):
        return "reserved"
    limit = GAIN_LIMIT if index else OFFSET_LIMIT
    # Written so that NaN fails too.
    if index > 3 or not (abs(x) <= limit and abs(y) <= limit and abs(z) <= limit):
        return "value"
    facts: dict[str, str | int | float] = {
        "coefficients": index,
        "coefficient_x": x,
        "coefficient_y": y,
        "coefficient_z": z,
        "calibration_crc": crc,
    }
    return _told(sensor, number, sequence, high << 16 | low, MISSING_QUATERNION, flags, battery, NAN, rssi, facts)


def _decode_sync(payload: bytes, sensor: SensorId, rssi: float) -> Sync | Refusal:
    _, _, suit, sequence, clock_us, counter, length, *told = _SYNC.unpack(payload)
    if not (suit and length):
        return "value"
    return Sync(suit, sequence, clock_us, counter, length * 1e-4, *told)


def _told(
    sensor: SensorId,
    number: int,
    sequence: int,
    clock: int,
    orientation: Quaternion,
    flags: int,
    battery: int,
    temperature: float,
    rssi: float,
    facts: dict[str, str | int | float],
) -> Reading:
    """Return the reading of a packet that tells facts in place of gyroscope and accelerometer."""
    return Reading(
        sensor,
        number,
        sequence,
        clock,
        orientation,
        MISSING_VECTOR,
        MISSING_VECTOR,
        flags,
        _BATTERY[battery],
        temperature,
        rssi,
        facts,
    )


_DECODERS: Final[dict[int, Callable[[bytes, SensorId, float], Reading | Sync | Refusal]]] = {
    VERSION << 4 | Packet.SAMPLE: _decode_sample,
    VERSION << 4 | Packet.INTEGRAL: _decode_integral,
    VERSION << 4 | Packet.INFO: _decode_info,
    VERSION << 4 | Packet.DEVICE: _decode_device,
    VERSION << 4 | Packet.COEFFICIENTS: _decode_coefficients,
    VERSION << 4 | Packet.SYNC: _decode_sync,
}


def _head(packet: Packet, number: int, sequence: int, clock: int, flags: int) -> tuple[int, ...]:
    kind = VERSION << 4 | packet
    return MAGIC, kind, number, sequence & 0xFF, clock & 0xFFFF, clock >> 16 & 0xFF, flags & 0xFF


def _int16(count: float) -> int:
    return min(max(math.floor(count + 0.5), -32768), 32767)


def _battery(level: float) -> int:
    return BATTERY_UNKNOWN if math.isnan(level) else min(max(round(level / BATTERY_UNIT), 0), 200)
