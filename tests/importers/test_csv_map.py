"""Any CSV recording through a map: units, orders, axes and clocks come out as SI, world_from_sensor and take time."""

import copy
import json
from pathlib import Path
from typing import Any

import jsonschema
import msgspec
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core import rotation
from studio.core.body import Place
from studio.core.errors import MapFileInvalid, RecordingUnreadable
from studio.core.take import Mark
from studio.importers.csv_map import read_csv
from studio.importers.map_file import Map, read_map, schema
from studio.importers.registry import import_recording
from studio.importers.xio import read_xio

RESOURCES = Path(__file__).parents[2] / "resources"
SAMPLE = RESOURCES / "samples" / "xio-lower-body"

HEADER = "t,gx,gy,gz,ax,ay,az,qw,qx,qy,qz"
ROWS = [(0.01 * i, 0.1, 0.2, 0.3, 1.0, 2.0, 9.5, 0.8, 0.6, 0.0, 0.0) for i in range(10)]
FULL = {
    "sensors": [
        {
            "file": "walk.csv",
            "sensor": "Left Knee",
            "place": "left_thigh",
            "time": {"column": "t", "unit": "s"},
            "gyroscope": {"columns": ["gx", "gy", "gz"], "unit": "rad/s"},
            "accelerometer": {"columns": ["ax", "ay", "az"], "unit": "m/s2"},
            "orientation": {
                "columns": ["qw", "qx", "qy", "qz"],
                "order": "wxyz",
                "meaning": "world_from_sensor",
                "common_world": True,
            },
        }
    ]
}


def text(rows, header=HEADER):
    return "\n".join([header, *(",".join(str(cell) for cell in row) for row in rows)]) + "\n"


@pytest.fixture
def read(tmp_path):
    """Return the take of a map and its table; ``change`` edits the map's only sensor."""

    def write_and_read(rows=ROWS, content=None, **change):
        described = copy.deepcopy(FULL)
        for key, value in change.items():
            if value is None:
                del described["sensors"][0][key]
            else:
                described["sensors"][0][key] = value
        (tmp_path / "walk.csv").write_text(content or text(rows))
        (tmp_path / "map.json").write_text(json.dumps(described))
        return read_csv([tmp_path / "walk.csv"], tmp_path / "map.json")

    return write_and_read


def refused(read, **change):
    with pytest.raises(MapFileInvalid) as refusal:
        read(**change)
    return refusal.value.reason


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


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"time": {"column": "t", "unit": "min"}}, "$.sensors[0].time.unit: invalid enum value 'min'"),
        ({"time": {"column": "t", "unit": "sample"}}, "$.sensors[0].time.rate_hz: samples are counted"),
        ({"time": {"column": "t", "unit": "s", "rate_hz": 0}}, "$.sensors[0].time.rate_hz: expected `float` > 0"),
        ({"time": {"column": "t", "unit": "s", "rate_hz": 20}}, "$.sensors[0].time.rate_hz: its rows are 0.01 s apart"),
        (
            {"time": {"column": "t", "unit": "sample", "rate_hz": 9}},
            "$.sensors[0].time.unit: the column does not count",
        ),
        ({"time": {"column": "T", "unit": "s"}}, "$.sensors[0]: "),
        ({"time": {"column": 11, "unit": "s"}}, "$.sensors[0]: "),
        ({"time": {"column": -1, "unit": "s"}}, "$.sensors[0].time.column: expected `int` >= 0"),
        ({"time": None}, "$.sensors[0]: object missing required field `time`"),
        ({"place": "left_knee"}, "$.sensors[0].place: invalid enum value 'left_knee'"),
        ({"colour": "red"}, "$.sensors[0]: object contains unknown field `colour`"),
        ({"sensor": ""}, "$.sensors[0].sensor: expected `str` of length >= 1"),
        ({"file": "../walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "/walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "C:\\walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "run.csv"}, "$.sensors[0].file: there is no 'run.csv'"),
        ({"axes": ["+x", "+y"]}, "$.sensors[0].axes: expected `array` of length 3"),
        ({"axes": ["+x", "+y", "+w"]}, "$.sensors[0].axes[2]: invalid enum value '+w'"),
        ({"axes": ["+x", "+y", "-z"]}, "$.sensors[0].axes: they are no right-handed set"),
        ({"axes": ["+x", "+x", "+z"]}, "$.sensors[0].axes: they are no right-handed set"),
        ({"gyroscope": {"columns": ["gx", "gy"], "unit": "deg/s"}}, "$.sensors[0].gyroscope.columns: expected"),
        (
            {"orientation": {"columns": ["ax", "ay", "az", "t"], "order": "wxyz", "meaning": "world_from_sensor"}},
            "$.sensors[0].orientation.columns: their length is 9.76",
        ),
        (
            {"gyroscope": None, "accelerometer": None, "orientation": None},
            "$.sensors[0]: neither gyroscope nor accelerometer nor orientation is named",
        ),
    ],
)
def test_a_map_that_does_not_hold_together_is_refused_with_the_place(read, change, reason):
    assert refused(read, **change).startswith(reason)


def test_a_name_that_two_columns_have_is_refused(read):
    content = text(ROWS, HEADER.replace("gy", "gx"))

    assert "more than one column 'gx'" in refused(read, content=content)


def write_map(folder, described):
    path = folder / "map.json"
    path.write_text(described if isinstance(described, str) else json.dumps(described))
    return path


@pytest.mark.parametrize(
    ("second", "reason"),
    [
        ({"sensor": "left  knee", "place": "head"}, "$.sensors[1].sensor: 'left  knee' names two sensors"),
        ({"sensor": "b"}, "$.sensors[1].place: two sensors sit on left_thigh"),
    ],
)
def test_sensors_must_differ_in_name_and_place(tmp_path, second, reason):
    sensor = FULL["sensors"][0]

    with pytest.raises(MapFileInvalid) as refusal:
        read_map(write_map(tmp_path, {"sensors": [sensor, sensor | second]}))
    assert refusal.value.reason == reason


@pytest.mark.parametrize(
    ("described", "reason"),
    [
        ("", "$: input data was truncated"),
        ("{", "$: input data was truncated"),
        ("[]", "$: expected `object`, got `array`"),
        ('{"sensors": []}', "$.sensors: expected `array` of length >= 1"),
        ("[" * 100_000, "$: "),
        (FULL | {"person": {"stature_m": 170}}, "$.person.stature_m: expected `float` <= 2.8"),
        (FULL | {"poses": [{"name": "a", "from_s": 0, "to_s": 1}]}, "$.poses[0].name: invalid enum value 'a'"),
        (FULL | {"poses": [{"name": "n", "from_s": 2, "to_s": 1}]}, "$.poses[0].to_s: 1 is not after from_s"),
    ],
)
def test_other_mistakes_in_a_map_are_refused_with_the_place(tmp_path, described, reason):
    with pytest.raises(MapFileInvalid) as refusal:
        read_map(write_map(tmp_path, described))
    assert refusal.value.reason.startswith(reason)


def test_a_map_may_begin_with_a_byte_order_mark(tmp_path):
    assert read_map(write_map(tmp_path, "\ufeff" + json.dumps(FULL))).sensors[0].sensor == "Left Knee"


def test_a_missing_map_is_refused(tmp_path):
    with pytest.raises(MapFileInvalid):
        read_map(tmp_path / "none.json")


def test_a_file_that_no_sensor_is_in_is_refused(read, tmp_path):
    read()
    (tmp_path / "other.csv").write_text(text(ROWS))

    with pytest.raises(MapFileInvalid, match=r"none of them is in 'other.csv'"):
        read_csv([tmp_path / "walk.csv", tmp_path / "other.csv"], tmp_path / "map.json")


@pytest.mark.parametrize("rows", [ROWS[:1], [(0, *ROWS[0][1:]), (0, *ROWS[1][1:])], [("", *ROWS[0][1:])] * 3])
def test_a_table_without_two_times_is_refused(read, rows):
    with pytest.raises(RecordingUnreadable, match="fewer than two rows"):
        read(rows=rows)


def test_the_schema_in_resources_is_the_map_the_importer_reads():
    kept = json.loads((RESOURCES / "map.schema.json").read_text(encoding="utf-8"))

    assert kept == schema()
    jsonschema.Draft202012Validator.check_schema(kept)


_EDITS: st.SearchStrategy[Any] = st.sampled_from(
    [None, 0, 1.5, -1, "", "t", "deg/s", "head", [], ["+x", "+y", "+z"], ["t", 1, 2], {}, True]
)


def paths_in(node, prefix=()):
    """Return the path of every value in a JSON document."""
    children = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    return [prefix, *(path for key, child in children for path in paths_in(child, (*prefix, key)))]


@settings(max_examples=200, deadline=None)
@given(path=st.sampled_from(paths_in(FULL)[1:]), instead=_EDITS)
def test_an_independent_validator_accepts_what_the_importer_accepts(path, instead):
    described = copy.deepcopy(FULL)
    node: Any = described
    for key in path[:-1]:
        node = node[key]
    node[path[-1]] = instead
    try:
        msgspec.json.decode(json.dumps(described), type=Map)
        accepted = True
    except msgspec.ValidationError:
        accepted = False

    assert jsonschema.Draft202012Validator(schema()).is_valid(described) == accepted
