"""What a tag says in 31 bytes (firmware/protocol/PROTOCOL.md 2 and 3), held against vectors.json both ways."""

import math
from typing import Any

import numpy as np
import pytest

from studio.acquisition.dialects import smallest_three, tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.dialects.tag_advert import Sync, decode, sensor_of
from studio.core import rotation
from studio.core.frames import GRAVITY
from studio.core.sample import Correction, Flag, Quaternion
from tests.acquisition.wire_vectors import VECTORS, advert, neighbourhood

SENSOR = sensor_of(0x12345678)
PAYLOADS = VECTORS["payloads"]
WORST_QUATERNION = math.degrees(2 * math.sqrt(12) * 0.5 / (math.sqrt(2) * 16384))
"""Degrees, 0.0086: half a step in three components of (½, ½, ½, ½), and three half steps in the one left out."""


def of_type(*kinds: str) -> Any:
    return pytest.mark.parametrize("vector", [v for v in PAYLOADS if v["type"] in kinds], ids=lambda v: v["name"])


def read(vector: dict[str, Any]) -> Reading:
    reading = decode(bytes.fromhex(vector["advert"]), SENSOR, -60.0)
    assert isinstance(reading, Reading)
    return reading


def degrees_apart(a: Any, b: Any) -> float:
    return math.degrees(float(rotation.angle_between(a, b)))


def battery_of(vector: dict[str, Any]) -> float:
    level = vector["values"]["battery"]
    return math.nan if level is None else level


@of_type("sample", "integral", "info", "device", "coefficients")
def test_every_packet_tells_who_when_and_in_what_state(vector):
    reading, raw = read(vector), vector["raw"]

    assert (reading.sensor, reading.rssi) == ("tag:12345678", -60.0)
    assert (reading.number, reading.sequence, reading.clock) == (raw["number"], raw["sequence"], raw["clock"])
    assert reading.flags == vector["values"]["flags"]
    assert reading.battery == pytest.approx(battery_of(vector), nan_ok=True)


@of_type("sample")
def test_a_sample_has_orientation_rate_and_acceleration(vector):
    reading, values = read(vector), vector["values"]

    assert degrees_apart(reading.orientation, values["orientation"]) <= WORST_QUATERNION
    assert reading.rate == pytest.approx(values["rate"], rel=1e-12)
    assert reading.acceleration == pytest.approx(values["acceleration"], rel=1e-12)


@of_type("sample")
def test_a_sample_is_encoded_to_the_same_bytes(vector):
    raw, values = vector["raw"], vector["values"]
    head = (raw["number"], raw["sequence"], raw["clock"], raw["flags"])

    made = tag_advert.encode_sample(
        *head, values["orientation"], values["rate"], values["acceleration"], battery_of(vector)
    )

    assert made.hex() == vector["advert"]


@of_type("integral")
def test_a_running_integral_keeps_every_count(vector):
    raw, values, reading = vector["raw"], vector["values"], read(vector)
    head = (raw["number"], raw["sequence"], raw["clock"], raw["flags"])

    made = tag_advert.encode_integral(
        *head, values["angle"], values["samples"], values["temperature"], values["battery"]
    )

    assert made.hex() == vector["advert"]
    assert reading.facts is not None
    assert [reading.facts[f"angle_{axis}"] for axis in "xyz"] == pytest.approx(values["angle"], rel=1e-12)
    assert reading.facts["samples"] == values["samples"]
    assert reading.temperature == pytest.approx(values["temperature"])
    assert all(math.isnan(v) for v in (*reading.orientation, *reading.rate, *reading.acceleration))


@of_type("info")
def test_info_tells_firmware_battery_and_calibration_beside_the_orientation(vector):
    raw, values, reading = vector["raw"], vector["values"], read(vector)
    head = (raw["number"], raw["sequence"], raw["clock"], raw["flags"])

    made = tag_advert.encode_info(
        *head,
        values["orientation"],
        raw["firmware"],
        values["battery_volt"],
        values["temperature"],
        values["calibration_crc"],
        raw["serial"],
        values["battery"],
    )

    assert made.hex() == vector["advert"]
    assert reading.facts == {name: values[name] for name in ("firmware", "battery_volt", "calibration_crc", "serial")}
    assert degrees_apart(reading.orientation, values["orientation"]) <= WORST_QUATERNION
    assert reading.temperature == pytest.approx(values["temperature"])
    assert all(math.isnan(v) for v in (*reading.rate, *reading.acceleration))


@of_type("device")
def test_device_tells_the_chip_and_its_ranges_beside_the_orientation(vector):
    raw, values, reading = vector["raw"], vector["values"], read(vector)
    names = ("hardware", "who_am_i", "gyro_range_deg_s", "accel_range_g", "bandwidth_hz", "internal_rate_hz")
    head = (raw["number"], raw["sequence"], raw["clock"], raw["flags"])

    made = tag_advert.encode_device(
        *head,
        orientation=values["orientation"],
        serial=raw["serial"],
        battery=values["battery"],
        **{name: values[name] for name in names},
    )

    assert made.hex() == vector["advert"]
    assert reading.facts == {name: values[name] for name in (*names, "serial")}
    assert degrees_apart(reading.orientation, values["orientation"]) <= WORST_QUATERNION


@of_type("coefficients")
def test_coefficients_tell_one_row_of_the_correction_in_force(vector):
    raw, values, reading = vector["raw"], vector["values"], read(vector)
    head = (raw["number"], raw["sequence"], raw["clock"], raw["flags"])

    made = tag_advert.encode_coefficients(
        *head, values["index"], values["value"], values["calibration_crc"], values["battery"]
    )

    assert made.hex() == vector["advert"]
    assert reading.facts is not None
    assert [reading.facts[f"coefficient_{axis}"] for axis in "xyz"] == values["value"]
    assert reading.facts["coefficients"] == values["index"]
    assert reading.facts["calibration_crc"] == values["calibration_crc"]


def test_the_four_rows_are_named_by_the_crc_of_their_floats():
    rows = [v["values"] for v in PAYLOADS if v["type"] == "coefficients"]
    offset, *gain = (tuple(row["value"]) for row in rows)

    assert tag_advert.calibration_crc(Correction(offset, (gain[0], gain[1], gain[2]))) == rows[0]["calibration_crc"]


@of_type("sync")
def test_a_beacon_is_no_reading(vector):
    raw = vector["raw"]

    beacon = decode(bytes.fromhex(vector["advert"]), SENSOR)

    assert isinstance(beacon, Sync)
    assert beacon.frame_s == pytest.approx(vector["values"]["frame_s"])
    assert (beacon.suit, beacon.clock_us, beacon.frame_counter) == (raw["suit"], raw["clock_us"], raw["frame_counter"])
    assert (beacon.command, beacon.target, beacon.value.hex()) == (raw["command"], raw["target"], raw["value"])
    assert tag_advert.encode_sync(beacon).hex() == vector["advert"]


@pytest.mark.parametrize("vector", VECTORS["refused"], ids=lambda v: v["name"])
def test_what_makes_no_sense_is_refused_with_its_reason(vector):
    assert decode(bytes.fromhex(vector["advert"]), SENSOR) == vector["reason"]


def test_other_structures_may_stand_in_front():
    sample = advert("sample")

    assert decode(bytes.fromhex("020106") + sample, SENSOR) == decode(sample, SENSOR)


def test_the_payload_alone_is_enough():
    sample = advert("sample")

    assert decode(sample[4:], SENSOR) == decode(sample, SENSOR)


def test_no_neighbour_is_taken_for_a_tag():
    reports = list(neighbourhood())

    assert len(reports) == 303
    assert {decode(report, SENSOR) for report in reports} == {"foreign"}


def test_orientations_lose_less_than_the_worst_case_of_the_protocol():
    rng = np.random.default_rng(3)
    sent = rotation.normalise(rng.normal(size=(20_000, 4)))

    back = [smallest_three.unpack(*smallest_three.pack(_tuple(q))) for q in sent]

    assert all(q is not None for q in back)
    error = np.degrees(rotation.angle_between(sent, np.array(back)))
    assert error.max() <= WORST_QUATERNION
    assert np.sqrt((error**2).mean()) <= 0.0031  # half a step of uniform noise in three components, firmware 4.1


def test_a_quaternion_and_its_negative_are_one_rotation_on_the_wire():
    q: Quaternion = (0.1, -0.7, 0.3, 0.64)

    low, high = smallest_three.pack(q)

    assert (low | high << 32).to_bytes(6, "little").hex() == "f2b66b128441"  # contracts, "Second vector"
    assert smallest_three.pack((-0.1, 0.7, -0.3, -0.64)) == (low, high)


@pytest.mark.parametrize(
    ("rate", "acceleration", "is_clipped"),
    [
        ((34.9, 0.0, 0.0), (0.0, 0.0, GRAVITY), False),
        ((34.95, 0.0, 0.0), (0.0, 0.0, GRAVITY), True),
        ((0.0, -99.0, 0.0), (0.0, 0.0, GRAVITY), True),
        ((0.0, 0.0, 0.0), (0.0, 0.0, 17 * GRAVITY), True),
    ],
)
def test_readings_at_the_end_of_the_range_are_flagged_whatever_the_tag_says(rate, acceleration, is_clipped):
    sent = tag_advert.encode_sample(1, 0, 0, 0, (1.0, 0.0, 0.0, 0.0), rate, acceleration, 0.5)

    reading = decode(sent, SENSOR)

    assert isinstance(reading, Reading)
    assert bool(reading.flags & Flag.CLIPPED) is is_clipped


def test_noise_is_neither_an_exception_nor_a_sample():
    rng = np.random.default_rng(11)

    answers = [decode(rng.bytes(int(rng.integers(40))), SENSOR) for _ in range(30_000)]

    assert all(isinstance(answer, str) for answer in answers)


def _tuple(q: np.ndarray) -> Quaternion:
    w, x, y, z = q.tolist()
    return w, x, y, z
