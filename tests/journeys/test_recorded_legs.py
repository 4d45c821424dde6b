"""Real recorded sensors, from the importer to a file: seven x-IMU3 on somebody's legs (resources/samples)."""

import csv
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from studio.cli import main
from studio.core import rotation
from studio.core.body import Segment
from studio.core.solver import SolveOptions, solve
from studio.core.take import Mark
from studio.importers.bvh import joint_positions, read_bvh
from studio.storage.take_reader import read_take

RECORDING = Path(__file__).resolve().parents[2] / "resources" / "samples" / "xio-lower-body"

LOST = {
    "right_foot": 23,
    "right_thigh": 27,
    "left_thigh": 8,
    "pelvis": 28,
    "left_shank": 21,
    "left_foot": 8,
    "right_shank": 11,
}


@pytest.fixture
def take(tmp_path, capsys):
    assert main(["import", str(RECORDING), "--library", str(tmp_path / "library")]) == 0
    return Path(capsys.readouterr().out.strip())


def test_the_import_prints_the_folder_of_the_take_and_nothing_else(tmp_path, capsys):
    assert main(["import", str(RECORDING), "--format", "xio", "--library", str(tmp_path)]) == 0

    printed = capsys.readouterr()
    assert printed.err == ""
    assert (Path(printed.out.removesuffix("\n")) / "take.mcap").is_file()


def test_the_ledger_counts_what_the_radio_lost(take, capsys):
    assert main(["inspect", str(take), "--json"]) == 0

    sensors = json.loads(capsys.readouterr().out)["sensors"]
    assert {sensor["place"]: sensor["lost"] for sensor in sensors} == LOST
    assert max(sensor["longest_gap_s"] for sensor in sensors) == pytest.approx(0.060, abs=0.0005)


def knee_peaks(folder, attitude, method="offline"):
    take, _ = read_take(folder)
    options = SolveOptions(attitude=attitude, method=method, poses=(Mark(0.0, "pose", "n", 0.0),))
    motion = solve(take, options).motion
    sides = ((Segment.LeftUpLeg, Segment.LeftLeg), (Segment.RightUpLeg, Segment.RightLeg))
    return [
        float(np.degrees(rotation.angle_between(motion.parent_from_child(thigh, shank), rotation.IDENTITY)).max())
        for thigh, shank in sides
    ]


@pytest.mark.parametrize(
    ("attitude", "method"), [("vqf", "offline"), ("gyro", "offline"), ("device", "offline"), ("vqf", "live")]
)
def test_the_knees_bend_as_far_as_the_devices_own_filter_says(take, attitude, method):
    left, right = knee_peaks(take, attitude, method)

    assert left == pytest.approx(133, abs=3)
    assert right == pytest.approx(127, abs=3)


def test_the_joint_table_holds_the_legs_and_says_what_was_assumed(take, tmp_path, capsys):
    target = tmp_path / "joints.csv"

    assert main(["export", str(take), "--format", "csv", "--pose", "n=0..1", "-o", str(target)]) == 0

    with target.open(newline="") as file:
        rows = list(csv.DictReader(file))
    flexion = [float(row["left_knee_flexion_deg"]) for row in rows]
    assert 110 < max(flexion) < 135
    assert "left_elbow_flexion_deg" not in rows[0]
    said = json.loads(target.with_name("joints.csv.json").read_text())
    limbs = said["solved"]["alignment"]["limbs"]
    assert {limb["heading_source"] for limb in limbs.values()} == {"common world"}


def test_the_bvh_holds_a_person_whose_feet_are_on_the_floor(take, tmp_path):
    target = tmp_path / "legs.bvh"

    assert main(["export", str(take), "--format", "bvh", "--fps", "60", "-o", str(target)]) == 0

    written = read_bvh(target)
    height = joint_positions(written)[:, :, 1]  # y up
    assert written.frame_time == pytest.approx(1 / 60, abs=1e-9)
    assert len(written.values) == pytest.approx(18.6 * 60, abs=3)
    assert 1.5 < height[0].max() < 1.75
    assert height.min() > -0.08 * 1.75  # joints of a foot whose toes point down


def without_quaternions(tmp_path):
    copy = tmp_path / "gyroscopes only"
    shutil.copytree(RECORDING, copy, ignore=shutil.ignore_patterns("Quaternion.csv"))
    return copy


def test_without_recorded_quaternions_the_headings_are_unknown_and_no_angle_is_made_up(tmp_path, capsys):
    assert main(["import", str(without_quaternions(tmp_path)), "--library", str(tmp_path / "library")]) == 0
    take = capsys.readouterr().out.strip()
    target = tmp_path / "joints.csv"

    code = main(["export", take, "--format", "csv", "--table", "joints", "-o", str(target)])

    assert code == 1
    assert "headings unknown" in capsys.readouterr().err.lower()
    assert not target.exists()


def test_what_the_sensors_said_can_be_had_all_the_same(tmp_path, capsys):
    main(["import", str(without_quaternions(tmp_path)), "--library", str(tmp_path / "library")])
    take = capsys.readouterr().out.strip()

    for table in ("raw", "orientations"):
        target = tmp_path / f"{table}.csv"
        assert main(["export", take, "--format", "csv", "--table", table, "-o", str(target)]) == 0
        assert target.stat().st_size > 100_000
