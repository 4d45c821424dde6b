"""A unit that was mixed up is seen in the numbers: real legs, told in every unit but their own."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from studio.core.errors import MapFileInvalid
from studio.importers.csv_map import read_csv
from studio.importers.xio import read_xio
from studio.ui.fact_words import LONGEST_FACT
from studio.ui.wording import one_line

SAMPLE = Path(__file__).resolve().parents[2] / "resources" / "samples" / "xio-lower-body"
IN_FILE = {"deg/s": 1.0, "rad/s": np.radians(1.0), "g": 1.0, "m/s2": 9.80665, "mg": 1000.0}
"""What one deg/s and one g are in a file of each unit."""


@pytest.fixture(scope="module", params=range(7), ids=lambda number: f"sensor {number}")
def stream(request):
    return read_xio(SAMPLE).streams[request.param]


@pytest.fixture
def read(tmp_path):
    """Write a table in some units, say that it has others, and read it."""

    def write_and_read(time, rate, acceleration, told):
        with (tmp_path / "leg.csv").open("w", newline="") as file:
            rows = csv.writer(file)
            rows.writerow(["t", "gx", "gy", "gz", "ax", "ay", "az"])
            for row in np.column_stack([time, rate, acceleration]):
                rows.writerow(["" if np.isnan(cell) else cell for cell in row.tolist()])
        sensor = {
            "file": "leg.csv",
            "sensor": "left shank",
            "place": "left_shank",
            "time": {"column": "t", "unit": "s"},
            "gyroscope": {"columns": ["gx", "gy", "gz"], "unit": told[0]},
            "accelerometer": {"columns": ["ax", "ay", "az"], "unit": told[1]},
        }
        (tmp_path / "map.json").write_text(json.dumps({"sensors": [sensor]}))
        return read_csv([tmp_path / "leg.csv"], tmp_path / "map.json")

    return write_and_read


def legs(stream, rate_unit, acceleration_unit):
    rate = np.degrees(stream.rate) * IN_FILE[rate_unit]
    return stream.time, rate, stream.acceleration / 9.80665 * IN_FILE[acceleration_unit]


def refusal_of(read, *numbers, told):
    with pytest.raises(MapFileInvalid) as refusal:
        read(*numbers, told)
    return refusal.value


@pytest.mark.parametrize("units", [("deg/s", "g"), ("rad/s", "m/s2"), ("deg/s", "m/s2"), ("rad/s", "g")])
def test_the_right_units_are_believed(read, stream, units):
    taken = read(*legs(stream, *units), units).streams[0]

    assert taken.rate == pytest.approx(stream.rate, abs=1e-6)
    assert taken.acceleration == pytest.approx(stream.acceleration, abs=1e-6)


@pytest.mark.parametrize(
    ("true", "told", "seen", "hint"),
    [
        ("g", "m/s2", r"at rest it reads (1|1\.\d+|0\.9\d+), and gravity is 9\.807 m/s2", "it looks like g"),
        ("mg", "m/s2", r"at rest it reads (9|10)\d\d(\.\d)?, and gravity is 9\.807 m/s2", "divide the columns by 1000"),
        ("m/s2", "g", r"at rest it reads 9\.\d+, and gravity is 1 g", "it looks like m/s2"),
        ("mg", "g", r"at rest it reads (9|10)\d\d(\.\d)?, and gravity is 1 g", "divide the columns by 1000"),
    ],
)
def test_gravity_tells_the_unit_of_the_accelerometer(read, stream, true, told, seen, hint):
    refusal = refusal_of(read, *legs(stream, "deg/s", true), told=("deg/s", told))

    assert refusal.reason.startswith("$.sensors[0].accelerometer.unit of 'left shank': ")
    assert re.search(seen, refusal.reason)
    assert hint in refusal.reason


@pytest.mark.parametrize(("true", "told"), [("deg/s", "rad/s"), ("rad/s", "deg/s")])
def test_turning_gravity_tells_the_unit_of_the_gyroscope(read, stream, true, told):
    refusal = refusal_of(read, *legs(stream, true, "g"), told=(told, "g"))

    assert refusal.reason.startswith("$.sensors[0].gyroscope.unit of 'left shank': it turns by up to ")
    assert refusal.reason.endswith(f"it looks like {true}")
    assert len(refusal.reason) <= LONGEST_FACT  # nothing is cut out of the sentence
    assert one_line(refusal).endswith("Correct the map; the manual shows each of its entries.")


def test_without_accelerometer_a_rate_beyond_every_gyroscope_is_seen(read, stream):
    time, rate, acceleration = legs(stream, "deg/s", "g")

    refusal = refusal_of(read, time, rate, np.full_like(acceleration, np.nan), told=("rad/s", "g"))

    assert "it looks like deg/s" in refusal.reason


@pytest.mark.parametrize("scale", [0.001, 0.02])
def test_acceleration_without_gravity_is_no_accelerometer(read, stream, scale):
    time, rate, acceleration = legs(stream, "deg/s", "g")

    refusal = refusal_of(read, time, rate, acceleration * scale, told=("deg/s", "g"))

    assert "leave it out if gravity was taken off" in refusal.reason


def test_who_only_stands_is_not_doubted(read):
    """Sway and an offset of 0.2 deg/s: nothing turns enough to tell the units apart."""
    rng = np.random.default_rng(7)
    time = np.arange(3000) * 0.01
    rate = 0.2 + 0.3 * rng.standard_normal((3000, 3))
    acceleration = np.array([0.02, 0.0, 1.0]) + 0.004 * rng.standard_normal((3000, 3))

    for unit in ("deg/s", "rad/s"):
        assert len(read(time, rate, acceleration, (unit, "g")).streams[0]) == 3000


def test_a_spin_about_the_vertical_and_a_shaken_tag_are_not_doubted(read):
    """Gravity does not turn with the one, and the gyroscope not with the other."""
    rng = np.random.default_rng(8)
    time = np.arange(2000) * 0.01
    up = np.tile([0.0, 0.0, 1.0], (2000, 1)) + 0.004 * rng.standard_normal((2000, 3))
    spin = np.tile([0.0, 0.0, 12.0], (2000, 1))
    shaken = up + 0.8 * np.sin(2 * np.pi * 6 * time)[:, None] * np.array([1.0, 0.3, 0.0])

    assert len(read(time, spin, up, ("rad/s", "g")).streams[0]) == 2000
    assert len(read(time, 0.01 * spin, shaken, ("rad/s", "g")).streams[0]) == 2000


def test_a_part_of_a_second_is_not_judged(read, stream):
    time, rate, acceleration = (part[:40] for part in legs(stream, "deg/s", "g"))

    assert time[-1] < 1.0
    assert len(read(time, rate * 0 + 1, acceleration, ("rad/s", "m/s2")).streams[0]) == 40
