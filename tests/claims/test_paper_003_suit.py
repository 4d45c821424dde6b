"""Paper 003, sections 2.5, 2.6 and 3: what fifteen tags tell, what gyroscopes alone tell, and where offsets come from.

The performer is simulated, with the errors of the data sheets.
"""

import csv
import re
from dataclasses import replace

import numpy as np
import pytest

from studio.capture.truth import compare_with_truth
from studio.core import rotation
from studio.core.body import MEASURED_PARENT, PLACES, PRESETS, SEGMENT_OF, Segment, reference_pose
from studio.core.sample import Flag
from studio.core.solver import SolveOptions, solve, solve_tracks
from studio.importers.bvh import joint_positions, read_bvh
from studio.storage.take_reader import read_take
from tests.journeys.command_line import columns_of, recorded, say


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_3_10_fifteen_tags_at_once_each_with_its_sequence_and_its_status(tmp_path):
    take = recorded("synthetic:walk?speed=max&loss=0.05&battery=low", 3, tmp_path)

    assert say("export", take, "--format", "csv", "--table", "raw", "-o", tmp_path / "raw.csv").code == 0

    rows = rows_of(tmp_path / "raw.csv")
    assert {row["place"] for row in rows} == {place.value for place in PLACES}
    lost = 0
    for place in PLACES:
        own = [row for row in rows if row["place"] == place.value]
        numbers = [int(row["frame"]) for row in own]
        missing = [int(row["lost_before"]) for row in own]
        assert np.diff(numbers).tolist() == [1 + count for count in missing[1:]]
        lost += sum(missing)
        flags = [int(row["flags"]) for row in own]
        assert all(flag & Flag.TIME_SYNCED and flag & Flag.LOW_BATTERY for flag in flags)
        assert {round(float(row["battery"]), 2) for row in own} == {0.08}
    assert lost == pytest.approx(0.05 * 15 * 150, rel=0.3)


def test_3_10_the_index_brings_the_tags_to_one_time(tmp_path):
    """Synchronised tags sample together: samples with one time on the receiver's clock, to a millisecond."""
    take, _ = read_take(recorded("synthetic:walk?speed=max", 3, tmp_path))

    first = take.streams[0].time[:140]

    assert np.diff(first) == pytest.approx(0.02, abs=2e-3)
    for stream in take.streams[1:]:
        assert np.abs(stream.time[:140] - first).max() < 1e-3


def test_3_15_gyroscopes_alone_keep_the_joints_within_three_degrees_for_a_minute(walk_take, tmp_path):
    """Calibrated ones, offset removed at the start; the joint is between two of them. The default is better."""
    gyroscopes, default = (compare_with_truth(walk_take, SolveOptions(attitude=name)) for name in ("gyro", "vqf"))
    print(f"gyroscopes alone over 60 s: median {gyroscopes.median():.2f}°, worst joint {gyroscopes.worst():.2f}° RMS")

    exported = say("export", walk_take, "--format", "csv", "--attitude", "gyro", "-o", tmp_path / "joints.csv")

    assert exported.code == 0
    assert np.ptp(columns_of(tmp_path / "joints.csv")["left_knee_flexion_deg"]) > 40
    assert default.median() < gyroscopes.median() < 1.5
    assert default.worst() < gyroscopes.worst() < 3.5


def test_3_15_the_accelerometer_has_no_say_once_the_start_is_level(walk_take):
    take, _ = read_take(walk_take)
    random = np.random.default_rng(0)
    shaken = []
    for stream in take.streams:
        force = stream.acceleration.copy()
        later = stream.time > 10
        force[later] = random.normal(0, 20, (int(later.sum()), 3))
        shaken.append(replace(stream, acceleration=force))
    options = SolveOptions(attitude="gyro")

    with_and_without = [solve(one, options).motion for one in (take, replace(take, streams=tuple(shaken)))]

    assert np.array_equal(with_and_without[0].world_from_segment, with_and_without[1].world_from_segment)


def test_3_15_the_motion_is_relative_to_the_pose_at_the_start(walk_take):
    take, _ = read_take(walk_take)

    motion = solve(take, SolveOptions(attitude="gyro")).motion

    held = (motion.time > motion.alignment.from_s) & (motion.time < motion.alignment.to_s)
    segments = [SEGMENT_OF[place] for place in PLACES]
    away = rotation.angle_between(motion.world_from_segment[held][:, segments], reference_pose("n")[segments])
    assert np.degrees(np.sqrt(np.mean(away**2))) < 1  # a standing person sways by half a degree


def test_3_16_the_offset_is_the_mean_of_ten_still_seconds_with_its_uncertainty(tmp_path):
    """The studio reads it off the tags' orientations; a second way is the mean of the gyroscopes' own readings."""
    still = recorded("synthetic:rest?speed=max&seed=4", 10, tmp_path)
    take, _ = read_take(still)

    tracks = solve_tracks(take, SolveOptions())

    for stream in take.streams:
        track = tracks[stream.info.sensor]
        readings = stream.rate[np.isfinite(stream.rate).all(axis=1)]  # one packet in 25 tells of the tag instead
        mean, uncertainty = readings.mean(axis=0), readings.std(axis=0, ddof=1) / np.sqrt(len(readings))
        assert (np.abs(track.offset - mean) < 4 * np.hypot(uncertainty, track.offset_sigma)).all()
        assert 0 < np.degrees(track.offset_sigma) < 0.02
    assert max(np.degrees(np.abs(track.offset)).max() for track in tracks.values()) > 10  # data sheet: up to 20 °/s


def test_3_16_rid_of_its_offset_a_tag_at_rest_stays_where_it_is(tmp_path):
    still = recorded("synthetic:rest?speed=max&seed=4", 10, tmp_path)
    words = ["--format", "csv", "--table", "orientations", "--attitude", "gyro"]

    assert say("export", still, *words, "-o", tmp_path / "turned.csv").code == 0

    columns = columns_of(tmp_path / "turned.csv")
    for place in PLACES:
        turned = np.stack([columns[f"{place.value}_{part}"] for part in "wxyz"], axis=1)
        assert np.degrees(rotation.angle_between(turned[0], turned)).max() < 0.2


def test_3_16_a_person_is_told_the_offset_of_each_sensor_and_how_sure_it_is(tmp_path):
    take = recorded("synthetic:n?speed=max", 10, tmp_path)

    told = say("solve", take).out

    line = re.compile(r"^tag:[0-9a-f]{8} +vqf +(-?[0-9.]+) +(-?[0-9.]+) +(-?[0-9.]+) +([0-9.]+)$", re.MULTILINE)
    offsets = np.array([[float(cell) for cell in found.groups()] for found in line.finditer(told)])
    assert len(offsets) == len(PLACES)
    assert np.abs(offsets[:, :3]).max() > 5
    assert ((offsets[:, 3] > 0) & (offsets[:, 3] < 1)).all()  # worn, a person sways: °/s


def test_3_20_the_three_presets_are_the_sensors_of_the_experiment():
    """Upper body: #1 to #8. Lower body: #9 to #15. Full body: all."""
    assert [place.number for place in PRESETS["upper"]] == list(range(1, 9))
    assert [place.number for place in PRESETS["lower"]] == list(range(9, 16))
    assert [place.number for place in PRESETS["full"]] == list(range(1, 16))


@pytest.mark.parametrize("preset", ["full", "upper", "lower"])
def test_3_20_the_t_pose_is_seen_with_each_preset(t_pose_take, tmp_path, preset):
    """By geometry: raised arms are level and hands are an arm's length from the shoulders; legs stand."""
    source = f"synthetic:t?speed=max&calibrated=1&tags={preset}"
    take = t_pose_take if preset == "full" else recorded(source, 15, tmp_path)

    assert say("export", take, "--format", "bvh", "--fps", "native", "-o", tmp_path / "t.bvh").code == 0

    joint = joint_positions(read_bvh(tmp_path / "t.bvh"))[600:720].mean(axis=0)  # 12 s to 14.4 s; x left, y up
    for side, arm, hand, hip, foot in (
        (1, Segment.LeftArm, Segment.LeftHand, Segment.LeftUpLeg, Segment.LeftFoot),
        (-1, Segment.RightArm, Segment.RightHand, Segment.RightUpLeg, Segment.RightFoot),
    ):
        reach, leg = joint[hand] - joint[arm], joint[foot] - joint[hip]
        expected = (side, 0, 0) if preset != "lower" else (0, -1, 0)  # nothing is known of arms without sensors
        assert within_degrees(reach, expected) < 4
        assert within_degrees(leg, (0, -1, 0)) < 4


def within_degrees(vector, direction):
    return np.degrees(np.arccos(np.dot(vector, direction) / np.linalg.norm(vector)))


def test_3_20_free_movement_gives_all_fourteen_joints(walk_take):
    truth = compare_with_truth(walk_take)

    assert set(truth.joint_rms_deg) == set(MEASURED_PARENT)
    assert truth.worst() < 2


def test_3_19_the_text_file_opens_in_a_spreadsheet_with_decimal_commas(t_pose_take, tmp_path):
    """Semicolons and commas, as a spreadsheet of a European system reads them; the numbers are the same."""
    for preset in ("plain", "excel"):
        words = ["--format", "csv", "--preset", preset, "-o", tmp_path / f"{preset}.csv"]
        assert say("export", t_pose_take, *words).code == 0

    text = (tmp_path / "excel.csv").read_bytes()
    assert text.startswith(b"\xef\xbb\xbf")
    names, *rows = csv.reader(text.decode("utf-8-sig").splitlines(), delimiter=";")
    plain = columns_of(tmp_path / "plain.csv")
    assert names == list(plain)
    for name, cells in zip(names, zip(*rows, strict=True), strict=True):
        shown = np.array([float(cell.replace(",", ".")) if cell else np.nan for cell in cells])
        np.testing.assert_array_equal(shown, plain[name])
