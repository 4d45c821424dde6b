"""x-io folders: the real recording of a lower body becomes a take in which every loss is a loss."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PRESETS, Place
from studio.core.errors import FormatUnknown, RecordingUnreadable
from studio.importers.xio import looks_like_xio, read_xio

SAMPLE = Path(__file__).parents[2] / "resources" / "samples" / "xio-lower-body"
PELVIS = "pelvis 64F0EDBF (UDP)"
# README of the shared recordings: counted from each sensor's median interval
LOST = {
    Place.RIGHT_FOOT: 23,
    Place.RIGHT_THIGH: 27,
    Place.LEFT_THIGH: 8,
    Place.PELVIS: 28,
    Place.LEFT_SHANK: 21,
    Place.LEFT_FOOT: 8,
    Place.RIGHT_SHANK: 11,
}


@pytest.fixture(scope="module")
def take():
    return read_xio(SAMPLE)


@pytest.fixture
def copy(tmp_path):
    """Return a folder with a copy of the pelvis sensor alone."""
    shutil.copytree(SAMPLE / PELVIS, tmp_path / "recording" / PELVIS)
    return tmp_path / "recording"


def worn(take, place):
    return take.stream(take.setup.assignment.sensors[place])


def edit(path, change):
    path.write_text("\n".join(change(path.read_text().splitlines())) + "\n")


def test_places_are_guessed_from_the_folder_names(take):
    assert set(take.setup.assignment.sensors) == set(PRESETS["lower"])
    assert take.setup.assignment.sensors[Place.LEFT_FOOT] == "file:left-foot-64f0ebce"
    assert worn(take, Place.LEFT_SHANK).info.label == "Left Lower Leg"
    assert take.setup.mounting == "unknown"


@pytest.mark.parametrize(("place", "lost"), LOST.items())
def test_lost_samples_are_missing_frame_numbers(take, place, lost):
    stream = worn(take, place)

    assert stream.frame[0] == 0
    assert int((np.diff(stream.frame) - 1).sum()) == lost


def test_the_longest_gap_is_60_ms(take):
    longest = max(float(np.diff(stream.time).max()) for stream in take.streams)

    assert longest == pytest.approx(0.060, abs=0.0005)


def test_gaps_stay_gaps(take):
    assert {stream.info.label: len(stream) for stream in take.streams} == {
        "Left Foot": 921,
        "Left Lower Leg": 911,
        "Left Upper Leg": 920,
        "Pelvis": 900,
        "Right Foot": 908,
        "Right Lower Leg": 920,
        "Right Upper Leg": 902,
    }


def test_all_sensors_share_one_take_time(take):
    starts = [float(stream.time[0]) for stream in take.streams]
    arrivals = np.concatenate([stream.arrival for stream in take.streams])
    times = np.concatenate([stream.time for stream in take.streams])

    assert min(starts) == 0.0
    assert max(starts) < 0.02  # all began within one frame
    assert sorted(arrivals) == list(range(sum(len(stream) for stream in take.streams)))
    assert (np.diff(times[np.argsort(arrivals)]) >= 0).all()
    assert take.duration() == pytest.approx(936.029594 - 917.410905, abs=1e-6)


def test_readings_are_in_si_units(take):
    pelvis = worn(take, Place.PELVIS)

    # first row of the pelvis' Inertial.csv: 1.013036 deg/s and 0.903545 g about x
    assert pelvis.rate[0, 0] == pytest.approx(1.013036 * np.pi / 180)
    assert pelvis.acceleration[0, 0] == pytest.approx(0.903545 * 9.80665)
    assert pelvis.device_time[0] == pytest.approx(917.418209)


@pytest.mark.parametrize("place", LOST)
def test_the_recorded_orientation_turns_the_accelerometer_upright(take, place):
    """The convention is world_from_sensor with z up: the inverse would leave the mean far from vertical."""
    stream = worn(take, place)
    second = stream.time < 1.0
    upright = rotation.rotate(stream.orientation[second], stream.acceleration[second]).mean(axis=0)

    assert stream.info.orientation == "world"
    assert stream.info.common_world
    # 1 % of g: the chips' offsets
    assert upright == pytest.approx([0, 0, 9.80665], abs=0.1)


@pytest.mark.parametrize(("side", "peak"), [("left", 133), ("right", 127)])
def test_recorded_orientations_give_the_known_peak_of_the_knees(take, side, peak):
    """Rotation of the shank against the thigh since the first frame; the figures are those of contracts §3."""
    since_start = {}
    grid = np.arange(0.02, 18.5, 0.02)
    for part in ("thigh", "shank"):
        stream = worn(take, Place(f"{side}_{part}"))
        nearest = np.abs(stream.time[:, None] - grid).argmin(axis=0)
        since_start[part] = rotation.multiply(stream.orientation[nearest], rotation.inverse(stream.orientation[0]))
    knee = np.degrees(rotation.angle_between(since_start["thigh"], since_start["shank"]))

    # 1 degree: the two sensors' nearest samples lie up to 10 ms apart, and the peak is rounded
    assert knee.max() == pytest.approx(peak, abs=1.0)


def test_battery_and_temperature_are_the_last_ones_told(take):
    pelvis = worn(take, Place.PELVIS)
    first_told = 918.050111 - 917.410905  # first row of Temperature.csv, s of take time
    before = pelvis.time < first_told

    assert np.isnan(pelvis.temperature[before]).all()
    assert pelvis.temperature[~before][0] == 40.0
    assert not np.isnan(pelvis.temperature[~before]).any()
    assert pelvis.battery[-1] == 1.0


def test_the_calendar_clock_of_the_sensors_is_kept_and_its_zone_is_said_to_be_assumed(take):
    assert take.started == "2023-09-16T02:06:24Z"
    assert take.versions["started"] == "calendar clock of the sensors, read as UTC"


def test_no_pose_is_invented(take):
    assert take.marks == ()


def test_a_single_sensor_folder_is_a_recording_too(copy):
    alone = read_xio(copy / PELVIS)

    assert [stream.info.sensor for stream in alone.streams] == ["file:pelvis-64f0edbf"]
    assert looks_like_xio([copy])
    assert looks_like_xio([copy / PELVIS])


def test_the_take_is_named_after_the_folder_from_wherever_it_is_seen(copy, monkeypatch):
    monkeypatch.chdir(copy)

    assert read_xio(Path()).name == "recording"
    assert read_xio(Path(PELVIS)).name == PELVIS


def test_without_quaternions_the_recording_has_no_orientation(copy):
    (copy / PELVIS / "Quaternion.csv").unlink()
    (stream,) = read_xio(copy).streams

    assert stream.info.orientation == "none"
    assert not stream.info.common_world
    assert np.isnan(stream.orientation).all()
    assert len(stream) == 900


def test_without_inertial_data_the_quaternions_keep_time(copy):
    (copy / PELVIS / "Inertial.csv").unlink()
    (stream,) = read_xio(copy).streams

    assert (stream.info.has_rate, stream.info.has_acceleration) == (False, False)
    assert np.isnan(stream.rate).all()
    assert int((np.diff(stream.frame) - 1).sum()) == LOST[Place.PELVIS]


def test_a_quaternion_belongs_to_the_sample_within_half_a_frame(copy):
    def shift(lines):
        rows = [line.split(",") for line in lines[1:]]
        return [lines[0], *(",".join([str(int(row[0]) + 9_000), *row[1:]]) for row in rows if row != rows[10])]

    whole = read_xio(SAMPLE / PELVIS).streams[0]
    edit(copy / PELVIS / "Quaternion.csv", shift)
    (stream,) = read_xio(copy).streams

    # the others keep theirs, 9 ms late of 20; the eleventh would have to borrow one that is 11 ms early
    assert np.isnan(stream.orientation[10]).all()
    assert np.array_equal(np.delete(stream.orientation, 10, 0), np.delete(whole.orientation, 10, 0))


def test_bad_rows_are_left_out_and_counted(copy):
    def damage(lines):
        return [*lines[:100], "917,1,2", *lines[100:200], lines[200].replace(",", ",x", 1), *lines[201:]]

    edit(copy / PELVIS / "Inertial.csv", damage)
    (stream,) = read_xio(copy).streams

    assert stream.info.facts["rows_dropped"] == 2
    assert len(stream) == 899
    assert int((np.diff(stream.frame) - 1).sum()) == LOST[Place.PELVIS] + 1


def test_rows_that_came_late_are_put_in_order(copy):
    whole = read_xio(SAMPLE / PELVIS).streams[0]
    edit(copy / PELVIS / "Inertial.csv", lambda lines: [*lines[:50], lines[52], lines[50], lines[51], *lines[53:]])
    (stream,) = read_xio(copy).streams

    assert np.array_equal(stream.rate, whole.rate)
    assert stream.info.facts["rows_reordered"] == 2


def test_a_damaged_stamp_costs_its_own_row_only(copy):
    edit(copy / PELVIS / "Inertial.csv", lambda lines: [*lines[:300], "9" + lines[300], *lines[301:]])
    (stream,) = read_xio(copy).streams

    assert len(stream) == 899
    assert stream.time[-1] == pytest.approx(936.014203 - 917.418209, abs=1e-6)


def test_a_wrong_column_is_named_with_its_file_and_line(copy):
    edit(copy / PELVIS / "Inertial.csv", lambda lines: [lines[0].replace("(g)", "(m/s^2)"), *lines[1:]])

    with pytest.raises(RecordingUnreadable) as refusal:
        read_xio(copy)
    assert refusal.value.file.endswith("Inertial.csv")
    assert (refusal.value.line, refusal.value.reason) == (1, "there is no column 'Accelerometer X (g)'")


def test_what_a_sensor_does_not_tell_is_unknown(copy):
    for name in ("Battery.csv", "Temperature.csv", "Command.json"):
        (copy / PELVIS / name).unlink()
    (stream,) = read_xio(copy).streams

    assert np.isnan([stream.battery, stream.temperature, stream.rssi]).all()
    assert len(stream) == 900


@pytest.mark.parametrize("content", ["", "Timestamp (us)\n", "\x00\x01\x02", "Timestamp (us),W,X,Y,Z\n1,1,0,0,0\n"])
def test_a_file_without_samples_is_refused(copy, content):
    (copy / PELVIS / "Inertial.csv").unlink()
    (copy / PELVIS / "Quaternion.csv").write_text(content)

    with pytest.raises(RecordingUnreadable):
        read_xio(copy)


@pytest.mark.parametrize("answers", ["", "{}", '["x", {"ping": 3}, {"time": 5}]', "[" * 100_000, "\xff"])
def test_answers_that_make_no_sense_cost_nothing_but_themselves(copy, answers):
    (copy / PELVIS / "Command.json").write_text(answers, encoding="latin-1")
    take = read_xio(copy)

    assert take.started == ""
    assert take.versions == {}
    assert take.streams[0].info.label == "pelvis 64F0EDBF"


def test_one_sensor_logged_twice_is_two_streams_of_which_none_is_assigned(copy):
    shutil.copytree(copy / PELVIS, copy / PELVIS.replace("UDP", "USB"))
    take = read_xio(copy)

    assert [stream.info.sensor for stream in take.streams] == ["file:pelvis-64f0edbf", "file:pelvis-64f0edbf-2"]
    assert take.setup.assignment.sensors == {}


def test_other_folders_are_not_taken_for_a_recording(tmp_path):
    (tmp_path / "notes.txt").write_text("x")

    assert not looks_like_xio([tmp_path, tmp_path / "notes.txt"])
    with pytest.raises(FormatUnknown):
        read_xio(tmp_path)


def test_the_sample_ships_with_its_licence():
    assert "Copyright (c) 2023 x-io Technologies" in (SAMPLE / "LICENSE.md").read_text()
    names = {json.loads((folder / "Command.json").read_text())[0]["ping"]["sn"] for folder in SAMPLE.glob("*/")}
    assert len(names) == 7
