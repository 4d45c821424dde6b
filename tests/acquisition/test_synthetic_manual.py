"""The printed table of errors is the one the tags are drawn from."""

import math
import re
from pathlib import Path

from studio.acquisition.synthetic.body_truth import (
    ADDUCTION_PER_FLEXION,
    CARRYING_ANGLE,
    JOINT_SWAY,
    LEAN_FORWARDS,
    LEAN_SIDEWAYS,
    REFERENCE_EXCURSION,
    ROTATION_PER_FLEXION,
)
from studio.acquisition.synthetic.errors_table import (
    CALIBRATED,
    DATA_SHEET,
    DEGREE,
    RESIDUAL_AXES,
    RESIDUAL_GAIN,
    RESIDUAL_OFFSET,
    ROOM_TEMPERATURE,
    WARM_UP_TIME,
)
from studio.acquisition.synthetic.scripts import PRELUDE_CUES, SCRIPT_BEGINS, WORN_SCRIPTS
from studio.acquisition.synthetic.words import OPTIONS, SCRIPTS
from studio.core.body import Place
from studio.core.frames import GRAVITY

MANUAL = (Path(__file__).resolve().parents[2] / "resources/manual/synthetic-suit.md").read_text(encoding="utf-8")
TEXT = " ".join(MANUAL.split())


def row(name: str) -> list[list[float]]:
    """Return the numbers of each cell of a row of a table."""
    (line,) = [line for line in MANUAL.splitlines() if line.startswith(f"| {name}")]
    return [[float(number) for number in re.findall(r"\d+(?:\.\d+)?", cell)] for cell in line.split("|")[2:-1]]


def test_the_gyroscope_is_printed_as_it_is_drawn():
    assert row("gyroscope scale") == [[100 * DATA_SHEET.gyro_scale], [100 * CALIBRATED.gyro_scale, 100 * RESIDUAL_GAIN]]
    cross, axes = 100 * DATA_SHEET.gyro_cross_axis, round(RESIDUAL_AXES / DEGREE, 6)
    assert row("gyroscope cross axis") == [[cross], [cross, axes]]
    offset, left = round(DATA_SHEET.gyro_offset / DEGREE, 6), round(RESIDUAL_OFFSET / DEGREE, 6)
    assert row("gyroscope offset") == [[offset], [offset, left, 60]]
    assert row("offset with temperature")[0] == [round(DATA_SHEET.gyro_offset_per_kelvin / DEGREE, 6)]
    per_g = [round(table.gyro_per_g / DEGREE, 6) for table in (DATA_SHEET, CALIBRATED)]
    assert row("g-sensitivity") == [[per_g[0]], [per_g[1], 1]]
    assert row("gyroscope noise")[0] == [round(DATA_SHEET.gyro_noise / DEGREE, 6)]
    assert row("bias instability")[0] == [round(DATA_SHEET.gyro_instability / DEGREE, 6), 100]
    assert row("warming")[0] == [ROOM_TEMPERATURE, ROOM_TEMPERATURE + DATA_SHEET.warm_up, WARM_UP_TIME / 60]


def test_the_accelerometer_is_printed_as_it_is_drawn():
    assert row("accelerometer scale") == [[100 * DATA_SHEET.accel_scale], [100 * CALIBRATED.accel_scale]]
    x, y, z = (round(1000 * limit / GRAVITY, 6) for limit in DATA_SHEET.accel_offset)
    assert row("accelerometer offset") == [[x, z], [round(1000 * CALIBRATED.accel_offset[0] / GRAVITY, 6)]]
    assert x == y
    assert row("accelerometer noise")[0] == [round(1e6 * DATA_SHEET.accel_noise / GRAVITY, 6)]


def test_the_body_is_printed_as_it_moves():
    degrees = [round(math.degrees(angle), 6) for angle in (LEAN_FORWARDS, LEAN_SIDEWAYS, JOINT_SWAY, CARRYING_ANGLE)]
    forwards, sideways, joint, carrying = degrees
    assert f"to and fro by {forwards:g}° and sideways by {sideways:g}°" in TEXT
    assert f"sways by {joint:g}°" in TEXT
    assert f"inclined by {carrying:g}°" in TEXT
    assert f"adds {ADDUCTION_PER_FLEXION:g}° of adduction and {ROTATION_PER_FLEXION:g}° of rotation" in TEXT
    assert row("soft tissue (Teufl 2018)")[0] == [round(DATA_SHEET.soft_tissue / DEGREE, 6)]
    for joint_name, place in (
        ("neck", Place.HEAD),
        ("trunk", Place.CHEST),
        ("shoulder", Place.LEFT_UPPER_ARM),
        ("elbow", Place.LEFT_FOREARM),
        ("wrist", Place.LEFT_HAND),
        ("hip", Place.LEFT_THIGH),
        ("knee", Place.LEFT_SHANK),
        ("ankle", Place.LEFT_FOOT),
    ):
        assert f"{joint_name} {REFERENCE_EXCURSION[place]:g}°" in TEXT


def test_every_script_and_option_and_every_marked_hold_is_printed():
    assert all(f"| `{script}`" in MANUAL for script in SCRIPTS)
    assert all(f"| `{option}=" in MANUAL for option in OPTIONS)
    assert f"the script follows at {SCRIPT_BEGINS:g} s" in TEXT
    for cue in (*PRELUDE_CUES, WORN_SCRIPTS["t"].cues[-1]):
        assert f"{cue.time:.1f} to {cue.end:.1f} s" in TEXT
