"""A map that does not hold together, or a table it does not fit, is refused with the place; its schema is published."""

import copy
import json
from typing import Any

import jsonschema
import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.core.errors import MapFileInvalid, RecordingUnreadable
from studio.importers.csv_map import read_csv
from studio.importers.map_file import Map, read_map, schema
from tests.importers.mapped_tables import FULL, HEADER, RESOURCES, ROWS, refused, text


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"time": {"column": "t", "unit": "min"}}, "$.sensors[0].time.unit: 'min' is none of ms, s, sample, us"),
        ({"time": {"column": "t", "unit": "sample"}}, "$.sensors[0].time.rate_hz: samples are counted"),
        ({"time": {"column": "t", "unit": "s", "rate_hz": 0}}, "$.sensors[0].time.rate_hz: it must be a number > 0"),
        ({"time": {"column": "t", "unit": "s", "rate_hz": 20}}, "$.sensors[0].time.rate_hz: its rows are 0.01 s apart"),
        (
            {"time": {"column": "t", "unit": "sample", "rate_hz": 9}},
            "$.sensors[0].time.unit: the column does not count",
        ),
        ({"time": {"column": "T", "unit": "s"}}, "$.sensors[0]: "),
        ({"time": {"column": 11, "unit": "s"}}, "$.sensors[0]: "),
        ({"time": {"column": -1, "unit": "s"}}, "$.sensors[0].time.column: it must be a whole number >= 0"),
        ({"time": None}, "$.sensors[0]: the entry 'time' is missing"),
        ({"place": "left_knee"}, "$.sensors[0].place: 'left_knee' is none of chest, head, left_foot, "),
        ({"colour": "red"}, "$.sensors[0]: there is no entry 'colour', only file, sensor, time, place, "),
        ({"sensor": ""}, "$.sensors[0].sensor: it must be a text that is not empty"),
        ({"file": "../walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "/walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "C:\\walk.csv"}, "$.sensors[0].file: it must lie in the folder of the recording"),
        ({"file": "run.csv"}, "$.sensors[0].file: there is no 'run.csv'"),
        ({"axes": ["+x", "+y"]}, "$.sensors[0].axes: it must be a list of 3"),
        ({"axes": ["+x", "+y", "+w"]}, "$.sensors[0].axes[2]: '+w' is none of +x, +y, +z, -x, -y, -z"),
        ({"axes": ["+x", "+y", "-z"]}, "$.sensors[0].axes: they are no right-handed set"),
        ({"axes": ["+x", "+x", "+z"]}, "$.sensors[0].axes: they are no right-handed set"),
        (
            {"gyroscope": {"columns": ["gx", "gy"], "unit": "deg/s"}},
            "$.sensors[0].gyroscope.columns: it must be a list of 3",
        ),
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
        ("", "$: it ends too early"),
        ("{", "$: it ends too early"),
        ('{"sensors":\n[\n,]}', "$: line 3 is no JSON: "),
        ('{"sensors": 3}', "$.sensors: it must be a list, not a whole number"),
        ("[]", "$: it must be entries in braces, not a list"),
        ('{"sensors": []}', "$.sensors: it must be a list that is not empty"),
        ("[" * 100_000, "$: "),
        (FULL | {"person": {}}, "$.person: the entry 'stature_m' is missing"),
        (FULL | {"person": {"stature_m": 170}}, "$.person.stature_m: it must be a number <= 2.8"),
        (FULL | {"poses": [{"name": "a", "from_s": 0, "to_s": 1}]}, "$.poses[0].name: 'a' is none of bow, n, sit, t"),
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
