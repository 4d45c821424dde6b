"""The sample, its stream, and what is known about the sensor that sent it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntFlag
from typing import Literal, NamedTuple, NewType

import numpy as np
from numpy.typing import NDArray

SensorId = NewType("SensorId", str)
"""``tag:<serial hex>``, ``<dialect>:<USB serial>:<letter or index>`` or ``file:<slug>``; the same on any port."""

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]

NAN = float("nan")
GAINS = (0.1, 10.0)  # singular values of a gain matrix; those of gyroscopes are within 3 % of 1
LARGEST_RATE = 1000.0  # rad/s; 57,000 °/s, ten times any gyroscope

MISSING_VECTOR: Vector = (NAN, NAN, NAN)
MISSING_QUATERNION: Quaternion = (NAN, NAN, NAN, NAN)


class Flag(IntFlag):
    """Quality of one sample, in the order of the wire (firmware/protocol/PROTOCOL.md, flags)."""

    CALIBRATED = 1
    AT_REST = 2
    OFFSET_OK = 4
    CLIPPED = 8
    IMU_ERROR = 16
    LOW_BATTERY = 32
    TIME_SYNCED = 64
    BUTTON = 128
    FILLED = 256
    """Set by the studio: gyroscope and accelerometer were not in this frame and come from its neighbours."""


class Sample(NamedTuple):
    """One reading of one sensor as it arrived: uncalibrated, in sensor axes.

    A named tuple of plain floats, because 1,500 of them are made each second.
    """

    sensor: SensorId
    epoch: int
    """+1 whenever the sensor started anew, so that ``orientation`` has another start frame."""
    frame: int
    """The sensor's own count of nominal frames, unwrapped; a missing number is a lost sample."""
    device_time: float
    """s, the sensor's clock, unwrapped."""
    time: float
    """s, when it was measured, on this computer's monotonic clock."""
    received: float
    """s, when it arrived, on this computer's monotonic clock."""
    orientation: Quaternion
    """``start_from_sensor`` or ``world_from_sensor`` as ``SensorInfo.orientation`` says; NaN when missing."""
    rate: Vector
    """rad/s, sensor axes, as the chip read it, before offset and gain; NaN when missing."""
    acceleration: Vector
    """m/s², sensor axes, specific force: +9.81 upwards at rest; NaN when missing."""
    flags: int
    battery: float
    """0…1; NaN when unknown."""
    temperature: float
    """°C; NaN when unknown."""
    rssi: float
    """dBm; NaN when unknown."""


@dataclass(frozen=True, slots=True)
class Correction:
    """Gyroscope offset and gain: corrected = gain @ (reading - offset)."""

    offset: Vector
    """rad/s, sensor axes."""
    gain: tuple[Vector, Vector, Vector]
    """3 x 3, rows; the identity until calibrated."""


def is_plausible_correction(correction: Correction) -> bool:
    """Return whether a gyroscope can need this correction: its gain has an inverse that is one, too."""
    gain = np.array(correction.gain)
    if not np.isfinite(gain).all() or not max(map(abs, correction.offset)) <= LARGEST_RATE:
        return False
    values = np.linalg.svd(gain, compute_uv=False)
    return bool(GAINS[0] <= values[-1] and values[0] <= GAINS[1])


NO_CORRECTION = Correction((0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))

OrientationKind = Literal["integrated", "world", "none"]


@dataclass(frozen=True, slots=True)
class SensorInfo:
    """What is known of one sensor while it sends; kept in each take."""

    sensor: SensorId
    frame_s: float
    """s, nominal time from one frame to the next."""
    label: str = ""
    """The name a person sees, or the name in the imported file."""
    number: int = 0
    """1…15 as stored in the tag; 0 when it has none."""
    orientation: OrientationKind = "integrated"
    """``integrated``: start_from_sensor, the tag's own gyroscope integral, heading free.
    ``world``: world_from_sensor of a filter on the device. ``none``: no orientation is sent."""
    common_world: bool = False
    """The device's orientations share one heading with those of the other sensors of this source."""
    has_rate: bool = True
    has_acceleration: bool = True
    correction: Correction | None = None
    """Offset and gain in force on the tag; None: the tag did not tell."""
    facts: Mapping[str, str | int | float] = field(default_factory=dict)
    """Address, hardware, firmware, ranges: shown, never computed with."""


@dataclass(frozen=True, slots=True)
class Stream:
    """All samples of one sensor in a take, as arrays, in the order of arrival."""

    info: SensorInfo
    arrival: NDArray[np.int64]
    """(n,), position of each sample among all samples of the take."""
    epoch: NDArray[np.int32]
    frame: NDArray[np.int64]
    device_time: NDArray[np.float64]
    """(n,), s."""
    time: NDArray[np.float64]
    """(n,), s of take time: 0 is the first kept sample of the take."""
    received: NDArray[np.float64]
    """(n,), s of take time."""
    orientation: NDArray[np.float64]
    """(n, 4)."""
    rate: NDArray[np.float64]
    """(n, 3), rad/s, sensor axes."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s², sensor axes."""
    flags: NDArray[np.uint32]
    battery: NDArray[np.float64]
    temperature: NDArray[np.float64]
    rssi: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.frame)
