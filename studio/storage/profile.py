"""The capture profile ``kinetag.take/1``: what stands where in a take file (resources/manual/take-file.md)."""

from typing import Final

import numpy as np
from mcap.opcode import Opcode

PROFILE: Final = "kinetag.take/1"
FAMILY: Final = "kinetag.take/"
MAGIC: Final = b"\x89MCAP0\r\n"  # MCAP specification, "Magic"

BLOCK_HEAD: Final = 0x80  # first opcode MCAP leaves to private records
SYNC: Final = bytes.fromhex("9d1c6b746b74616b65f7a3e25bd80e41")
"""Starts every block head; drawn once at random, so that it does not occur in sensor data."""

MAX_CHUNK: Final = 4 << 20  # bytes; a reader never holds more than one chunk it has not checked
MAX_BLOCK: Final = 2 * MAX_CHUNK  # bytes; the largest chunk with others, their indexes and all channels
MAX_CHANNELS: Final = 1000  # 15 tags, a receiver and events need 17
MAX_SAMPLES: Final = 260_000_000  # 24 h of 30 tags at 100 Hz
MAX_EVENTS: Final = 1_000_000  # a marker every 86 ms for 24 h
PART: Final = 4 << 20  # bytes of an attachment in one record, at most

BLOCK_DTYPE: Final = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("sync", "V16"),
        ("take", "V8"),
        ("number", "<u4"),
        ("body_length", "<u4"),
        ("body_crc", "<u4"),
        ("head_crc", "<u4"),
    ]
)
"""A block head. ``take`` is the random identity of this file: pages of another take that a power cut
left in this one are recognised. ``head_crc`` covers everything before it."""
BLOCK_HEAD_SIZE: Final = BLOCK_DTYPE.itemsize

MESSAGE_HEAD: Final = [
    ("opcode", "u1"),
    ("length", "<u8"),
    ("channel", "<u2"),
    ("sequence", "<u4"),
    ("log_time", "<u8"),
    ("publish_time", "<u8"),
]
MESSAGE_HEAD_SIZE: Final = np.dtype(MESSAGE_HEAD).itemsize
RECORD_HEAD_SIZE: Final = 9  # opcode and length

SAMPLE_DTYPE: Final = np.dtype(
    [
        *MESSAGE_HEAD,
        ("cdr", "<u4"),
        ("device_time", "<f8"),
        ("time", "<f8"),
        ("received", "<f8"),
        ("orientation", "<f8", (4,)),
        ("rate", "<f8", (3,)),
        ("acceleration", "<f8", (3,)),
        ("frame", "<i8"),
        ("battery", "<f8"),
        ("temperature", "<f8"),
        ("rssi", "<f8"),
        ("epoch", "<i4"),
        ("flags", "<u4"),
    ]
)
"""One message of an ``/imu/`` channel as it stands in a chunk, MCAP's message head included."""
CDR_LITTLE_ENDIAN: Final = 0x00000100  # bytes 00 01 00 00: OMG CDR encapsulation, little endian, no options
SAMPLE_LENGTH: Final = SAMPLE_DTYPE.itemsize - RECORD_HEAD_SIZE
MESSAGE: Final = int(Opcode.MESSAGE)

IMU_TOPIC: Final = "/imu/"
RAW_TOPIC: Final = "/raw/"
EVENT_TOPIC: Final = "/event"

IMU_SCHEMA: Final = """\
# One reading of one sensor as it arrived, uncalibrated, in sensor axes. A missing quantity is NaN.
float64 device_time      # s, the sensor's clock, unwrapped
float64 time             # s, when it was measured, monotonic clock of the recording computer
float64 received         # s, when it arrived, monotonic clock of the recording computer
float64[4] orientation   # w x y z; start_from_sensor or world_from_sensor as the channel's metadata says
float64[3] rate          # rad/s, as the chip read it
float64[3] acceleration  # m/s2, specific force
int64 frame              # the sensor's count of nominal frames, unwrapped; a missing number is a lost sample
float64 battery          # 0..1
float64 temperature      # degrees Celsius
float64 rssi             # dBm
int32 epoch              # +1 whenever the sensor started anew
uint32 flags             # bits: calibrated, at rest, offset ok, clipped, imu error, low battery, synced, button, filled
"""
RAW_SCHEMA: Final = """\
kinetag.raw/1: the bytes of one link as reads gave them. A message is a sequence of
  int64 received   ns, monotonic clock of the recording computer
  uint32 length    bytes
  length bytes
all little endian, without padding, to the end of the message.
"""
EVENT_SCHEMA: Final = """\
{"$schema": "https://json-schema.org/draft/2020-12/schema", "type": "object",
 "required": ["kind", "received", "facts"],
 "properties": {"kind": {"type": "string"},
  "received": {"type": "number", "description": "s, monotonic clock of the recording computer"},
  "facts": {"type": "object"}}}
"""

SCHEMAS: Final = (
    (1, "kinetag_msgs/msg/Imu", "ros2msg", IMU_SCHEMA),
    (2, "kinetag.raw/1", "text", RAW_SCHEMA),
    (3, "kinetag.event/1", "jsonschema", EVENT_SCHEMA),
)
"""(id, name, encoding, text) of all schemas a take has."""
MESSAGE_ENCODING: Final = {1: "cdr", 2: "kinetag.raw/1", 3: "json"}

TAKE_FILE: Final = "take.mcap"
PART_FILE: Final = "take.part.mcap"
BALLAST_FILE: Final = ".ballast"
DERIVED: Final = "derived"


def part_name(name: str, part: int, parts: int) -> str:
    """Return what one part of an attachment is called: the name itself when there is only one."""
    return name if parts == 1 else f"{name}.part-{part + 1}-of-{parts}"
