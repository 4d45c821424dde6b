"""What is wrong with a simulated tag, in one table (printed in resources/manual/synthetic-suit.md)."""

import math
from dataclasses import dataclass

from studio.core.frames import GRAVITY

DEGREE = math.pi / 180.0


@dataclass(frozen=True, slots=True)
class ErrorTable:
    """Limits and deviations from which each tag's own errors are drawn; SI units.

    "±" is a uniform draw between the limits for each axis of each tag, "SD" a normal draw.
    """

    gyro_scale: float
    """±, as a fraction."""
    gyro_cross_axis: float
    """±, as a fraction."""
    gyro_offset: float
    """±, rad/s at the temperature of switching on."""
    gyro_offset_per_kelvin: float
    """±, rad/s/K."""
    gyro_per_g: float
    """±, rad/s per g: each axis by each axis of the specific force."""
    gyro_noise: float
    """rad/s/sqrt(Hz), one-sided."""
    gyro_instability: float
    """SD, rad/s, of a first-order process with ``INSTABILITY_TIME``."""
    accel_scale: float
    """±, as a fraction."""
    accel_offset: tuple[float, float, float]
    """±, m/s², x, y, z."""
    accel_noise: float
    """m/s²/sqrt(Hz), one-sided."""
    soft_tissue: float
    """rad, the tag's turn on the skin when the joint above is flexed by its reference excursion."""
    warm_up: float
    """K, how much warmer the tag is after ``WARM_UP_TIME``; the rise is linear."""
    gyro_resolution: float
    """rad/s per count of the chip."""


DATA_SHEET = ErrorTable(
    gyro_scale=0.03,  # PS-MPU-6000A rev 3.4 (accuracy.md, section 3), and all of the chip's below
    gyro_cross_axis=0.02,
    gyro_offset=20.0 * DEGREE,
    gyro_offset_per_kelvin=0.16 * DEGREE,  # ±20 °/s over -40 to 85 °C
    gyro_per_g=0.1 * DEGREE,
    gyro_noise=0.005 * DEGREE,
    gyro_instability=0.0012 * DEGREE,  # one measured device (robotics.SE 8860; accuracy.md, section 3)
    accel_scale=0.03,
    accel_offset=(0.05 * GRAVITY, 0.05 * GRAVITY, 0.08 * GRAVITY),
    accel_noise=400e-6 * GRAVITY,
    soft_tissue=2.0 * DEGREE,  # Teufl 2018: soft tissue adds 2.2° (accuracy.md, section 3; contracts, section 8)
    warm_up=3.0,  # contracts, section 8
    gyro_resolution=2000.0 / 32768.0 * DEGREE,  # range ±2000 °/s in int16
)

CALIBRATED = ErrorTable(
    gyro_scale=DATA_SHEET.gyro_scale,  # the chip stays as it is: its tag corrects it by offset and gain
    gyro_cross_axis=DATA_SHEET.gyro_cross_axis,
    gyro_offset=DATA_SHEET.gyro_offset,
    gyro_offset_per_kelvin=DATA_SHEET.gyro_offset_per_kelvin,
    gyro_per_g=0.01 * DATA_SHEET.gyro_per_g,  # 1 % left after regression over poses (accuracy.md, drift after 5 min)
    gyro_noise=DATA_SHEET.gyro_noise,
    gyro_instability=DATA_SHEET.gyro_instability,
    accel_scale=0.0005,  # contracts, section 8; the wire has no accelerometer correction, so the chip itself is better
    accel_offset=(0.005 * GRAVITY, 0.005 * GRAVITY, 0.005 * GRAVITY),
    accel_noise=DATA_SHEET.accel_noise,
    soft_tissue=DATA_SHEET.soft_tissue,
    warm_up=DATA_SHEET.warm_up,
    gyro_resolution=DATA_SHEET.gyro_resolution,
)

NO_ERRORS = ErrorTable(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0)
"""For tests of the wire and the geometry; no words of a source select it."""

RESIDUAL_OFFSET = 0.005 * DEGREE  # rad/s, SD per axis; left in the stored offset after a rest of 60 s
RESIDUAL_GAIN = 0.0005  # SD, as a fraction; left in the stored gain of a calibrated tag (contracts, section 8)
RESIDUAL_AXES = 0.05 * DEGREE  # rad, SD of each cross term of it

INSTABILITY_TIME = 100.0  # s
WARM_UP_TIME = 600.0  # s
ROOM_TEMPERATURE = 25.0  # °C, of the chip at switching on

GYRO_RANGE = 2000.0 * DEGREE  # rad/s; readings beyond are clipped
ACCEL_RANGE = 16.0 * GRAVITY  # m/s²
