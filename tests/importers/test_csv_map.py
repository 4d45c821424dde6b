"""Any CSV recording through a map: units, orders, axes and clocks come out as SI, world_from_sensor and take time."""

import json

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import Place
from studio.core.take import Mark
from studio.importers.csv_map import read_csv
from studio.importers.registry import import_recording
from studio.importers.xio import read_xio
from tests.importers.mapped_tables import FULL, ROWS, SAMPLE, refused, text


def test_columns_become_a_stream(read):
    take = read()
    (stream,) = take.streams

    assert stream.info.sensor == "file:left-knee"
    assert (stream.info.label, stream.info.orientation, stream.info.common_world) == ("Left Knee", "world", True)
    assert take.setup.assignment.sensors == {Place.LEFT_THIGH: "file:left-knee"}
    assert (take.name, take.source, take.started, take.marks) == ("walk", "csv", "", ())
    assert stream.rate == pytest.approx(np.tile([0.1, 0.2, 0.3], (10, 1)))
    assert stream.acceleration == pytest.approx(np.tile([1.0, 2.0, 9.5], (10, 1)))
    assert stream.orientation == pytest.approx(np.tile([0.8, 0.6, 0, 0], (10, 1)))
    assert stream.time == pytest.approx(np.arange(10) * 0.01)
    assert np.array_equal(stream.frame, np.arange(10))
    assert stream.info.frame_s == pytest.approx(0.01)
    assert stream.info.facts == {"file": "walk.csv", "rows_dropped": 0}


def test_columns_may_be_counted_from_zero(read):
    by_name = read().streams[0]
    by_position = read(
        content=text(ROWS).partition("\n")[2],
        time={"column": 0, "unit": "s"},
        gyroscope={"columns": [1, 2, 3], "unit": "rad/s"},
        accelerometer={"columns": [4, 5, 6], "unit": "m/s2"},
        orientation={"columns": [7, 8, 9, 10], "order": "wxyz", "meaning": "world_from_sensor"},
    ).streams[0]

    assert np.array_equal(by_position.rate, by_name.rate)
    assert np.array_equal(by_position.acceleration, by_name.acceleration)
    assert np.array_equal(by_position.orientation, by_name.orientation)
    assert not by_position.info.common_world


def test_degrees_and_g_become_si(read):
    (stream,) = read(
        gyroscope={"columns": ["gx", "gy", "gz"], "unit": "deg/s"},
        accelerometer={"columns": ["ax", "ay", "az"], "unit": "g"},
    ).streams

    assert stream.rate[0] == pytest.approx(np.radians([0.1, 0.2, 0.3]))
    assert stream.acceleration[0] == pytest.approx(np.array([1.0, 2.0, 9.5]) * 9.80665)


@pytest.mark.parametrize(("unit", "tick"), [("s", 0.01), ("ms", 10), ("us", 10_000), ("sample", 1)])
def test_units_of_time_give_the_same_take_time(read, unit, tick):
    rows = [(1000 + tick * i, *row[1:]) for i, row in enumerate(ROWS) if i != 4]
    (stream,) = read(rows=rows, time={"column": "t", "unit": unit, "rate_hz": 100}).streams

    assert stream.time == pytest.approx(np.delete(np.arange(10), 4) * 0.01)
    assert np.array_equal(stream.frame, np.delete(np.arange(10), 4))
    assert stream.info.frame_s == pytest.approx(0.01)


def test_a_nominal_rate_tells_losses_that_the_median_would_hide(read):
    every_second = [ROWS[i] for i in range(0, 10, 2)]

    assert list(read(rows=every_second).streams[0].frame) == [0, 1, 2, 3, 4]
    assert list(read(rows=every_second, time={"column": "t", "unit": "s", "rate_hz": 100}).streams[0].frame) == [
        0,
        2,
        4,
        6,
        8,
    ]


def test_order_and_meaning_of_the_quaternion_do_not_change_what_it_says(read):
    def meant(order, meaning, columns):
        told = {"columns": columns, "order": order, "meaning": meaning}
        return read(orientation=told).streams[0].orientation[0]

    assert meant("wxyz", "world_from_sensor", ["qw", "qx", "qy", "qz"]) == pytest.approx([0.8, 0.6, 0, 0])
    assert meant("xyzw", "world_from_sensor", ["qx", "qy", "qz", "qw"]) == pytest.approx([0.8, 0.6, 0, 0])
    assert meant("wxyz", "sensor_from_world", ["qw", "qx", "qy", "qz"]) == pytest.approx([0.8, -0.6, 0, 0])


def test_axes_name_for_each_sensor_axis_the_axis_of_the_file(read):
    (stream,) = read(axes=["+x", "-z", "+y"]).streams

    assert stream.rate[0] == pytest.approx([0.1, -0.3, 0.2])
    assert stream.acceleration[0] == pytest.approx([1.0, -9.5, 2.0])


@pytest.mark.parametrize("axes", [["+x", "+y", "+z"], ["+x", "-z", "+y"], ["-y", "+x", "+z"], ["+z", "+x", "+y"]])
@pytest.mark.parametrize("meaning", ["world_from_sensor", "sensor_from_world"])
def test_axes_turn_readings_and_orientation_alike(read, axes, meaning):
    """Whatever the sensor's axes are called, gravity points the same way in the world."""
    told = {"columns": ["qw", "qx", "qy", "qz"], "order": "wxyz", "meaning": meaning}
    world_from_file = np.array([0.8, 0.6 if meaning == "world_from_sensor" else -0.6, 0, 0])
    (stream,) = read(axes=axes, orientation=told).streams

    in_the_world = rotation.rotate(stream.orientation[0], stream.acceleration[0])
    assert in_the_world == pytest.approx(rotation.rotate(world_from_file, [1.0, 2.0, 9.5]))


def test_missing_quantities_are_missing(read):
    (stream,) = read(gyroscope=None, orientation=None).streams

    assert (stream.info.has_rate, stream.info.has_acceleration, stream.info.orientation) == (False, True, "none")
    assert np.isnan(stream.rate).all()
    assert np.isnan(stream.orientation).all()


def test_columns_that_are_all_empty_are_missing_too(read):
    (stream,) = read(rows=[(row[0], "", "", "", *row[4:]) for row in ROWS]).streams

    assert not stream.info.has_rate
    assert stream.info.has_acceleration


def test_an_empty_cell_leaves_the_rest_of_its_row(read):
    rows = [*ROWS[:3], (ROWS[3][0], "", *ROWS[3][2:]), *ROWS[4:]]
    (stream,) = read(rows=rows, axes=["+x", "-z", "+y"]).streams

    assert len(stream) == 10
    assert stream.rate[3] == pytest.approx([np.nan, -0.3, 0.2], nan_ok=True)


def test_the_magnetometer_is_named_and_not_kept(read):
    (stream,) = read(magnetometer={"columns": ["gx", "gy", "gz"], "unit": "uT"}).streams

    assert stream.info.facts["magnetometer"] == "in the file, not kept"
    assert "no column 'mx'" in refused(read, magnetometer={"columns": ["mx", "gy", "gz"]})


def test_sensors_of_one_file_at_different_rates_keep_their_own_rows(tmp_path):
    """The second sensor sends every other row and is empty between; its empty rows are no samples and no losses."""
    lines = ["t,a1,a2,a3,b1,b2,b3", *(f"{i},1,2,3,{'4,5,6' if i % 2 == 0 else ',,'}" for i in range(20))]
    (tmp_path / "both.csv").write_text("\n".join(lines))
    sensors = [
        {
            "file": "both.csv",
            "sensor": name,
            "time": {"column": "t", "unit": "ms"},
            "accelerometer": {"columns": [f"{name}1", f"{name}2", f"{name}3"], "unit": "g"},
        }
        for name in "ab"
    ]
    (tmp_path / "map.json").write_text(json.dumps({"sensors": sensors}))
    a, b = read_csv([], tmp_path / "map.json").streams

    assert (len(a), len(b)) == (20, 10)
    assert np.array_equal(b.frame, np.arange(10))
    assert (a.info.frame_s, b.info.frame_s) == pytest.approx((0.001, 0.002))
    assert b.info.facts["rows_dropped"] == 0
    assert np.array_equal(np.sort(np.concatenate([a.arrival, b.arrival])), np.arange(30))


def test_a_cell_that_is_bad_for_one_sensor_costs_the_other_nothing(tmp_path):
    (tmp_path / "both.csv").write_text("t,a,b\n" + "".join(f"{i},1,{'?' if i == 5 else 2}\n" for i in range(20)))
    sensors = [
        {
            "file": "both.csv",
            "sensor": name,
            "time": {"column": "t", "unit": "ms"},
            "accelerometer": {"columns": [name] * 3, "unit": "g"},
        }
        for name in "ab"
    ]
    (tmp_path / "map.json").write_text(json.dumps({"sensors": sensors}))
    a, b = read_csv([tmp_path], tmp_path / "map.json").streams

    assert (len(a), a.info.facts["rows_dropped"]) == (20, 0)
    assert (len(b), b.info.facts["rows_dropped"], b.info.facts["first_bad_line"]) == (19, 1, 7)


def test_bad_rows_leave_gaps_and_are_counted(read):
    lines = text(ROWS).splitlines()
    lines[4], lines[7] = "0.03,garbage", lines[7] + ",1"
    (stream,) = read(content="\n".join(lines)).streams

    assert list(stream.frame) == [0, 1, 2, 4, 5, 7, 8, 9]
    assert (stream.info.facts["rows_dropped"], stream.info.facts["first_bad_line"]) == (2, 5)


def test_late_and_double_rows_are_put_right_and_counted(read):
    (stream,) = read(rows=[*ROWS[:3], ROWS[4], ROWS[3], *ROWS[4:]]).streams

    assert stream.time == pytest.approx(np.arange(10) * 0.01)
    assert (stream.info.facts["rows_reordered"], stream.info.facts["rows_dropped"]) == (1, 1)


def test_single_quaternions_of_wrong_length_are_left_out_and_counted(read):
    rows = [*ROWS[:3], (*ROWS[3][:7], 0, 0, 0, 0), (*ROWS[4][:7], 80, 60, 0, 0), *ROWS[5:]]
    (stream,) = read(rows=rows).streams

    assert list(np.flatnonzero(np.isnan(stream.orientation).any(axis=1))) == [3, 4]
    assert stream.info.facts["orientations_refused"] == 2


def test_person_and_poses_of_the_map_are_kept(tmp_path):
    (tmp_path / "walk.csv").write_text(text(ROWS))
    poses = [{"name": "n", "from_s": 0.01, "to_s": 0.05}, {"name": "bow", "from_s": 0.06, "to_s": 0.08}]
    (tmp_path / "map.json").write_text(json.dumps(FULL | {"person": {"stature_m": 1.68}, "poses": poses}))
    take = import_recording([tmp_path], "auto", tmp_path / "map.json")

    assert (take.setup.stature, take.setup.stature_known) == (1.68, True)
    assert take.marks == (Mark(0.01, "pose", "n", 0.05), Mark(0.06, "pose", "bow", 0.08))
    assert take.setup.mounting == "unknown"


def test_a_map_of_the_sample_take_gives_what_its_own_importer_gives(tmp_path):
    """Two paths to one truth: the general importer told what the special one knows."""
    own = read_xio(SAMPLE)
    sensors = []
    for folder in sorted(path.name for path in SAMPLE.iterdir() if path.is_dir()):
        kinds = (("Gyroscope", "deg/s"), ("Accelerometer", "g"))
        names = [f"{kind} {axis} ({unit})" for kind, unit in kinds for axis in "XYZ"]
        sensors.append(
            {
                "file": f"{folder}/Inertial.csv",
                "sensor": folder.removesuffix(" (UDP)"),
                "time": {"column": "Timestamp (us)", "unit": "us"},
                "gyroscope": {"columns": names[:3], "unit": "deg/s"},
                "accelerometer": {"columns": names[3:], "unit": "g"},
            }
        )
    (tmp_path / "map.json").write_text(json.dumps({"sensors": sensors}))
    mapped = read_csv([SAMPLE], tmp_path / "map.json")

    for stream in own.streams:
        same = mapped.stream(stream.info.sensor)
        assert np.array_equal(same.frame, stream.frame)
        assert np.array_equal(same.arrival, stream.arrival)
        assert np.allclose(same.time, stream.time, rtol=0, atol=1e-9)
        assert np.allclose(same.rate, stream.rate, rtol=1e-12, atol=0)
        assert np.allclose(same.acceleration, stream.acceleration, rtol=1e-12, atol=0)
