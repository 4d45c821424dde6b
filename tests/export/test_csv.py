"""Tables: names with units, numbers that read the same everywhere, gaps that stay gaps."""

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.analysis.joint_angles import joint_angles
from studio.core import euler, rotation
from studio.core.body import Place
from studio.core.errors import NothingToExport, ReadBackDiffers
from studio.core.sample import SensorId
from studio.core.take import Assignment, Setup, Take
from studio.export.csv_tables import PRESETS, column_words, joints_table, orientations_table, raw_table
from studio.export.csv_text import compare_with_table, csv_blocks
from tests.export.moving_body import moving_body, standing
from tests.export.small_take import FORMULA_SENSOR, LEFT, RIGHT, small_take, stream_of

HALF_A_DIGIT = 0.5e-6 * 1.000001


def text_of(table, preset="plain"):
    return b"".join(csv_blocks(table, PRESETS[preset])).decode("utf-8-sig")


def rows_of(table, preset="plain"):
    """The table as the csv module reads it: one dict a row."""
    separator = PRESETS[preset].punctuation.separator.decode()
    return list(csv.DictReader(io.StringIO(text_of(table, preset), newline=""), delimiter=separator))


def numbers(rows, name):
    return np.array([float(row[name]) if row[name] else np.nan for row in rows])


def test_joints_have_one_column_for_each_angle_with_its_unit_in_the_name():
    header = text_of(joints_table(standing("t"))).splitlines()[0].split(",")

    assert header[0] == "time_s"
    assert {"left_knee_flexion_deg", "right_hip_adduction_deg", "trunk_flexion_deg", "pelvis_tilt_deg"} <= set(header)
    assert all(name.endswith("_deg") and name.isascii() and name == name.lower() for name in header[1:])
    assert len(set(header)) == len(header)


def test_the_t_pose_reads_90_degrees_of_shoulder_elevation():
    rows = rows_of(joints_table(standing("t")))

    assert [row["left_shoulder_elevation_deg"] for row in rows] == ["90.000000"] * 3
    assert [row["time_s"] for row in rows] == ["0.000000", "0.020000", "0.040000"]


def test_an_angle_that_was_not_measured_is_an_empty_cell():
    motion = moving_body(30)
    silent = np.ones(30, bool)
    silent[10:20] = False
    motion = replace(motion, measured={**motion.measured, Place.LEFT_SHANK: silent})

    rows = rows_of(joints_table(motion))

    assert [bool(row["left_knee_flexion_deg"]) for row in rows] == silent.tolist()
    assert all(row["right_knee_flexion_deg"] for row in rows)


@pytest.mark.parametrize("measured", [{}, {Place.LEFT_THIGH: np.zeros(30, bool), Place.LEFT_SHANK: np.zeros(30, bool)}])
def test_without_a_measured_joint_there_is_nothing_to_export(measured):
    """Also when both sensors were worn and neither's heading became known."""
    with pytest.raises(NothingToExport, match="joint angles"):
        joints_table(replace(moving_body(30), measured=measured))


def test_numpy_reads_the_joints_back():
    motion = moving_body(500)
    table = joints_table(motion)

    read = np.loadtxt(io.StringIO(text_of(table)), delimiter=",", skiprows=1, usecols=range(4))

    np.testing.assert_allclose(read[:, 0], motion.time, atol=HALF_A_DIGIT)
    angles = np.degrees([angle.values for angle in joint_angles(motion)[:3]]).T
    np.testing.assert_allclose(read[:, 1:], angles, atol=HALF_A_DIGIT)


def test_excel_gets_semicolons_decimal_commas_and_a_mark():
    table = joints_table(standing("t"))

    data = b"".join(csv_blocks(table, PRESETS["excel"]))

    assert data.startswith(b"\xef\xbb\xbftime_s;pelvis_tilt_deg;")
    assert data.count(b"\xef\xbb\xbf") == 1
    assert data.splitlines()[2].startswith(b"0,020000;0,000000;")
    assert b"." not in data


def test_plain_files_have_no_mark_and_end_lines_as_rfc_4180_says():
    data = b"".join(csv_blocks(joints_table(standing("t")), PRESETS["plain"]))

    assert data.startswith(b"time_s,")
    assert data.count(b"\r\n") == data.count(b"\n") == 4
    assert data.endswith(b"\r\n")


class TestOrientations:
    """Each sensor's attitude at the sample times of the fastest."""

    def turning(self, rate_hz, seconds=2.0, start=0.0):
        time = start + np.arange(int(seconds * rate_hz)) / rate_hz
        return time, rotation.about(2, 1.5 * time)

    def table(self, orientations, assignment=None):
        return orientations_table(orientations, assignment or Assignment())

    def test_columns_are_the_quaternion_and_its_roll_pitch_and_yaw(self):
        turned = euler.from_roll_pitch_yaw(np.radians([[10.0, 20.0, 30.0], [11.0, 21.0, 31.0]]))

        rows = rows_of(self.table({LEFT: (np.array([0.0, 0.01]), turned)}, Assignment({Place.LEFT_THIGH: LEFT})))

        assert list(rows[0]) == [
            "time_s",
            *(f"left_thigh_{part}" for part in ("w", "x", "y", "z", "roll_deg", "pitch_deg", "yaw_deg")),
        ]
        assert float(rows[0]["left_thigh_w"]) == pytest.approx(turned[0, 0], abs=1e-9)
        assert [float(rows[1][f"left_thigh_{angle}_deg"]) for angle in ("roll", "pitch", "yaw")] == [11, 21, 31]

    def test_the_slower_sensor_stands_between_its_samples(self):
        rows = rows_of(self.table({LEFT: self.turning(25), RIGHT: self.turning(100)}))

        assert len(rows) == 200
        time, yaw = numbers(rows, "time_s"), numbers(rows, "tag_1a2b_yaw_deg")
        until = time <= 49 / 25
        np.testing.assert_allclose(yaw[until], np.degrees(1.5 * time[until]), atol=1e-5)
        assert np.isnan(yaw[~until]).all()

    def test_across_a_gap_nothing_is_interpolated(self):
        time, turned = self.turning(50)
        kept = (time < 0.5) | (time > 0.7)

        rows = rows_of(self.table({LEFT: (time[kept], turned[kept]), RIGHT: self.turning(100)}))

        at, yaw = numbers(rows, "time_s"), numbers(rows, "tag_1a2b_yaw_deg")
        inside = (at > 0.485) & (at < 0.715)  # between the samples at 0.48 and 0.72 s
        assert inside.sum() == 23
        assert np.isnan(yaw[inside]).all()
        assert np.isfinite(yaw[~inside & (at < 1.9)]).all()

    def test_a_lossy_sensor_is_still_the_fastest(self):
        time, turned = self.turning(100)
        kept = np.ones(len(time), bool)
        kept[20:150] = False

        rows = rows_of(self.table({LEFT: self.turning(50), RIGHT: (time[kept], turned[kept])}))

        assert len(rows) == kept.sum()

    def test_names_that_would_collide_or_break_a_header_are_told_apart(self):
        sensors = [SensorId(name) for name in ("file:Fuß links", "file:Fu links", "sou:A/1:b", "=1+1", "§")]

        words = list(column_words(sensors, Assignment()).values())

        assert words == ["file_fu_links", "file_fu_links_2", "sou_a_1_b", "1_1", "sensor"]

    def test_without_any_there_is_nothing_to_export(self):
        with pytest.raises(NothingToExport, match="orientations"):
            self.table({LEFT: (np.array([0.0]), rotation.IDENTITY[None])})


class TestRaw:
    """The samples as they were kept."""

    def test_there_is_a_row_for_each_sample_in_the_order_of_arrival(self):
        take = small_take()

        rows = rows_of(raw_table(take))

        assert len(rows) == sum(len(stream) for stream in take.streams)
        assert [row["sensor"] for row in rows[:4]] == [LEFT, RIGHT, LEFT, RIGHT]
        assert [row["place"] for row in rows[:2]] == ["left_thigh", ""]
        assert list(rows[0]) == [
            *("time_s", "sensor", "place", "sample", "epoch", "frame", "lost_before", "device_time_s", "received_s"),
            *("orientation_w", "orientation_x", "orientation_y", "orientation_z"),
            *("rate_x_rad_s", "rate_y_rad_s", "rate_z_rad_s"),
            *("acceleration_x_m_s2", "acceleration_y_m_s2", "acceleration_z_m_s2"),
            *("flags", "battery", "temperature_c", "rssi_dbm"),
        ]

    def test_values_are_those_of_the_streams(self):
        take = small_take()
        stream = take.stream(LEFT)

        rows = [row for row in rows_of(raw_table(take)) if row["sensor"] == LEFT]

        np.testing.assert_allclose(numbers(rows, "rate_y_rad_s"), stream.rate[:, 1], atol=1e-9)
        np.testing.assert_allclose(numbers(rows, "acceleration_z_m_s2"), stream.acceleration[:, 2], atol=HALF_A_DIGIT)
        np.testing.assert_array_equal(numbers(rows, "frame"), stream.frame)
        np.testing.assert_array_equal(numbers(rows, "flags"), stream.flags)
        np.testing.assert_array_equal(numbers(rows, "sample"), np.arange(len(stream)))

    def test_lost_frames_are_counted_before_the_next_sample_and_nothing_stands_in(self):
        stream = stream_of(LEFT, frames=[0, 1, 5, 6, 0, 1], epochs=[0, 0, 0, 0, 1, 1])
        take = replace(small_take(), streams=(stream,))

        assert [row["lost_before"] for row in rows_of(raw_table(take))] == ["0", "0", "3", "0", "0", "0"]

    def test_samples_that_arrived_out_of_order_are_not_lost(self):
        stream = stream_of(LEFT, frames=[0, 2, 1, 3, 6], epochs=[0] * 5)

        assert [row["lost_before"] for row in rows_of(raw_table(replace(small_take(), streams=(stream,))))] == [
            *("0", "0", "0", "0"),
            "2",
        ]

    def test_a_name_that_is_a_formula_is_disarmed_and_negative_numbers_are_not(self):
        take = replace(small_take(), streams=(stream_of(FORMULA_SENSOR, frames=[0, 1], epochs=[0, 0]),))

        rows = rows_of(raw_table(take))

        assert {row["sensor"] for row in rows} == {"'" + FORMULA_SENSOR}
        assert numbers(rows, "rate_x_rad_s")[0] < 0
        assert rows[0]["rate_x_rad_s"].startswith("-")

    def test_a_take_without_samples_has_nothing_to_export(self):
        with pytest.raises(NothingToExport, match="samples"):
            raw_table(replace(small_take(), streams=(stream_of(LEFT, frames=[], epochs=[]),)))


@pytest.mark.parametrize("preset", PRESETS)
@given(name=st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), min_size=1, max_size=30))
def test_whatever_a_sensor_is_called_the_csv_module_reads_it_and_no_spreadsheet_computes_it(preset, name):
    sensor = SensorId(name)
    take = Take("t", "", "", "", (stream_of(sensor, frames=[0, 1], epochs=[0, 0]),), setup=Setup())

    rows = rows_of(raw_table(take), preset)

    assert [row["sensor"].removeprefix("'") for row in rows] == [name.removeprefix("'")] * 2
    assert not rows[0]["sensor"].startswith(("=", "+", "-", "@", "\t", "\r"))


class TestReadingBack:
    """The check before a file takes its place."""

    @pytest.mark.parametrize("preset", PRESETS)
    @pytest.mark.parametrize("table", [joints_table(moving_body(1500)), raw_table(small_take())], ids=["joints", "raw"])
    def test_what_was_written_is_accepted_and_one_row_more_is_not(self, tmp_path, table, preset):
        path = tmp_path / "table.csv"
        data = b"".join(csv_blocks(table, PRESETS[preset]))
        path.write_bytes(data)
        compare_with_table(path, table, PRESETS[preset])

        path.write_bytes(data + data.splitlines(keepends=True)[-1])

        with pytest.raises(ReadBackDiffers, match="more than meant"):
            compare_with_table(path, table, PRESETS[preset])

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            (b"time_s", b"time", "header"),
            (b"tag:1a2b", b"tag:1a2c", "sensor differs"),
            (b"0.020000", b"0.020001", "time_s differs"),
            (b"-0.1", b"0.1", "rate_x_rad_s differs"),
            (b"0.020000,", b"0.020000,,", "longer"),
            (b"0.020000", b"zero", "time_s differs"),
            (b"0.020000", b'"0.020000', "not CSV"),
            (b"tag:1a2b", b"tag:\xff", "not CSV"),
        ],
    )
    def test_a_damaged_file_is_refused(self, tmp_path, old, new, words):
        table, path = raw_table(small_take()), tmp_path / "table.csv"
        data = b"".join(csv_blocks(table, PRESETS["plain"]))
        assert old in data
        path.write_bytes(data.replace(old, new, 1))

        with pytest.raises(ReadBackDiffers, match=words):
            compare_with_table(path, table, PRESETS["plain"])

    def test_a_missing_row_is_found(self, tmp_path):
        table, path = raw_table(small_take()), tmp_path / "table.csv"
        lines = b"".join(csv_blocks(table, PRESETS["plain"])).splitlines(keepends=True)
        path.write_bytes(b"".join(lines[:-1]))

        with pytest.raises(ReadBackDiffers, match="rows instead of"):
            compare_with_table(path, table, PRESETS["plain"])
