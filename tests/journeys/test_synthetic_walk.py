"""The simulated suit from its words to a file: recorded, judged by its true motion, and exported.

Every tag is mounted at random and starts with a random heading. The bars of the calibrated walk are of rotation
errors against the true motion, RMS over the whole minute: median joint 1°, worst joint 2°.
"""

import json
from dataclasses import replace

import numpy as np
import pytest

from studio.acquisition.synthetic.truth import decode_truth
from studio.capture.truth import compare_with_truth
from studio.core.body import MEASURED_PARENT, PLACES, Place, Segment
from studio.core.solver import solve
from studio.core.take import Assignment
from studio.importers.bvh import joint_positions, read_bvh
from studio.storage.take_json import TakeDocument, save_document
from studio.storage.take_reader import read_attachment, read_take
from tests.journeys.between_frames import joints_at
from tests.journeys.command_line import columns_of, minute_of_walking, recorded, say

MEDIAN, WORST = 1.0, 2.0  # degrees
TOLERANCE = 1e-5  # m; a thousandth of a centimetre
MINUTE = 60

SHORT = ((1, 0.0), (2, 0.05))
ALL = [(seed, loss) for seed in range(1, 6) for loss in (0.0, 0.05)]
WALKS = [
    pytest.param((seed, loss), id=f"seed {seed}, loss {loss}", marks=() if (seed, loss) in SHORT else pytest.mark.long)
    for seed, loss in ALL
]


@pytest.fixture(scope="module", params=WALKS)
def walk(request, tmp_path_factory):
    """A calibrated walk of a minute: (share of lost packets, folder of the take)."""
    seed, loss = request.param
    return loss, minute_of_walking(seed, loss, tmp_path_factory)


def as_the_motion_has_it(take, fps):
    """Return forward kinematics of the motion at ``fps``, (n, 23, 3), m, world."""
    motion = solve(take).motion
    if fps is None:
        return motion.joint_positions()
    last = (len(motion) - 1) * motion.frame_s
    return joints_at(motion, np.arange(int(last * fps + 1e-6) + 1) / fps)


def test_the_joints_of_a_calibrated_walk_are_found_to_a_degree(walk):
    loss, take = walk

    answer = say("inspect", take, "--truth", "--json")

    said = json.loads(answer.out)
    joints = said["truth"]["joints"]
    print(f"median {said['truth']['median_rms_deg']}°, worst {said['truth']['worst_rms_deg']}°")
    assert set(joints) == {place.value for place in MEASURED_PARENT}
    assert said["truth"]["median_rms_deg"] == pytest.approx(np.median(list(joints.values())), abs=1e-3)
    assert said["truth"]["median_rms_deg"] <= MEDIAN
    assert said["truth"]["worst_rms_deg"] == max(joints.values())
    assert said["truth"]["worst_rms_deg"] <= WORST
    assert said["truth"]["to_s"] - said["truth"]["from_s"] == pytest.approx(MINUTE, abs=0.1)
    sent = [account["samples"] + account["lost"] for account in said["sensors"]]
    # Numbers lost before the first and after the last sample of a tag are not known to be missing.
    assert sent == [pytest.approx(MINUTE * 50, abs=6)] * len(PLACES)
    assert sum(account["lost"] for account in said["sensors"]) == pytest.approx(loss * sum(sent), rel=0.1)


def test_the_joints_of_the_bvh_are_where_the_motion_has_them(walk, tmp_path):
    loss, folder = walk
    # One rate, unit and axis order each: at the motion's own rate, and between its frames.
    preset, unit, fps = ("blender", 1.0, 60) if loss else ("motionbuilder", 100.0, None)
    words = ["--preset", preset, "--fps", fps or "native", "-o", tmp_path / "walk.bvh"]

    answer = say("export", folder, "--format", "bvh", *words)

    assert answer.code == 0, answer.err
    written = read_bvh(tmp_path / "walk.bvh")
    take, _ = read_take(folder)
    meant = as_the_motion_has_it(take, fps)[..., [1, 2, 0]]  # the file's x is left, y up, z forward
    found = joint_positions(written) / unit
    assert written.names == tuple(segment.name for segment in Segment)
    assert written.frame_time == pytest.approx(1 / (fps or 50), rel=1e-9)
    assert found.shape == meant.shape
    assert np.abs(found - meant).max() < TOLERANCE
    assert np.ptp(found[:, Segment.LeftFoot, 2]) > 1  # and it did walk


@pytest.mark.parametrize(
    ("tags", "angle", "missing"),
    [("upper", "left_elbow_flexion", "left_knee_flexion"), ("lower", "left_knee_flexion", "left_elbow_flexion")],
)
def test_half_a_suit_gives_the_angles_of_its_half(tmp_path, tags, angle, missing):
    take = recorded(f"synthetic:walk?tags={tags}&speed=max&calibrated=1", 12, tmp_path)

    bvh = say("export", take, "--format", "bvh", "-o", tmp_path / "half.bvh")
    table = say("export", take, "--format", "csv", "-o", tmp_path / "joints.csv")

    assert (bvh.code, table.code) == (0, 0), bvh.err + table.err
    assert np.isfinite(read_bvh(tmp_path / "half.bvh").values).all()
    columns = columns_of(tmp_path / "joints.csv")
    assert np.ptp(columns[f"{angle}_deg"]) > 20
    assert np.isnan(columns.get(f"{missing}_deg", np.nan)).all()


def test_a_single_tag_turns_its_segment_and_has_no_joint(tmp_path):
    take = recorded("synthetic:walk?tags=1&speed=max", 9, tmp_path)

    bvh = say("export", take, "--format", "bvh", "-o", tmp_path / "head.bvh")
    table = say("export", take, "--format", "csv", "-o", tmp_path / "joints.csv")

    assert bvh.code == 0
    assert read_bvh(tmp_path / "head.bvh").names[0] == "Hips"
    assert table.code == 1
    assert table.err.startswith("There is nothing to export. The take holds no joint angles: an angle needs ")
    assert table.err.count("\n") == 1
    assert not (tmp_path / "joints.csv").exists()


@pytest.mark.parametrize(
    "script", ["t", "sit", *(pytest.param(script, marks=pytest.mark.long) for script in ("n", "bow", "reach"))]
)
def test_each_thing_the_performer_does_is_recorded_and_found(tmp_path, script):
    take = recorded(f"synthetic:{script}?speed=max&calibrated=1", 15, tmp_path)

    truth = compare_with_truth(take)
    print(f"{script}: median {truth.median():.2f}°, worst {truth.worst():.2f}°")

    assert truth.median() <= MEDIAN
    # Raised sideways, arms turn most about their length, where strap and flesh hold a tag least (T-pose: 2.7°).
    assert truth.worst() <= (3.0 if script == "t" else WORST)


@pytest.mark.parametrize("script", ["rest", "turns"])
def test_tags_that_nobody_wears_have_orientations_and_no_joints(tmp_path, script):
    take = recorded(f"synthetic:{script}?speed=max", 13, tmp_path)
    tables = {
        table: say("export", take, "--format", "csv", "--table", table, "-o", tmp_path / f"{table}.csv")
        for table in ("raw", "orientations", "joints")
    }
    bvh = say("export", take, "--format", "bvh", "-o", tmp_path / "tags.bvh")

    assert [tables["raw"].code, tables["orientations"].code] == [0, 0]
    for refused in (tables["joints"], bvh):
        assert refused.code == 1
        assert refused.err.startswith("Headings unknown: head, chest, ")
        assert refused.err.count("\n") == 1
    assert sorted(file.name for file in tmp_path.glob("*.csv")) == ["orientations.csv", "raw.csv"]
    pelvis = columns_of(tmp_path / "orientations.csv")
    turned = np.ptp([pelvis[f"pelvis_{part}"] for part in "wxyz"], axis=1).max()
    assert turned < 0.01 if script == "rest" else turned > 1


def test_an_uncalibrated_suit_walks_too(tmp_path):
    """Gyroscopes off by up to 20 °/s and 3 %: worse than calibrated ones, and nowhere near their raw error."""
    take = recorded("synthetic:walk?speed=max&seed=3", 20, tmp_path)

    said = json.loads(say("inspect", take, "--truth", "--json").out)

    assert {account["calibration"] for account in said["sensors"]} == {"none"}
    assert MEDIAN < said["truth"]["median_rms_deg"] < 4
    assert said["truth"]["worst_rms_deg"] < 8


def test_outages_are_counted_to_the_packet(tmp_path):
    take = recorded("synthetic:walk?speed=max&calibrated=1&loss=0.1&burst=5", 14, tmp_path)

    said = json.loads(say("inspect", take, "--truth", "--json").out)

    sensors = said["sensors"]
    assert sum(s["lost"] for s in sensors) == pytest.approx(0.1 * 14 * 50 * len(PLACES), rel=0.25)
    assert np.mean([s["lost"] / s["gaps"] for s in sensors]) == pytest.approx(5, rel=0.25)
    kept, _ = read_take(take)
    for account, stream in zip(sensors, kept.streams, strict=True):
        numbers = np.sort(stream.frame)
        assert account["lost"] == numbers[-1] - numbers[0] + 1 - len(numbers)
        assert account["longest_gap_s"] == pytest.approx(np.diff(numbers).max() * 0.02, abs=0.002)


@pytest.mark.long
def test_tags_with_clocks_of_their_own_are_brought_to_one_time(tmp_path):
    take = recorded("synthetic:walk?speed=max&calibrated=1&skew=50", 26, tmp_path)

    said = json.loads(say("inspect", take, "--truth", "--json").out)

    skews = np.abs([account["clock_skew_ppm"] for account in said["sensors"]])
    assert skews.max() < 60
    assert skews.max() > 20
    assert said["truth"]["median_rms_deg"] <= MEDIAN
    assert said["truth"]["worst_rms_deg"] <= WORST


def test_a_tag_that_restarted_is_not_measured_from_then_on(tmp_path):
    """Its heading is another one, and nothing tells which: better no angle than a wrong one."""
    restart = 13.0  # s
    take = recorded(f"synthetic:walk?speed=max&calibrated=1&reboot={restart:.0f}@left_shank", 18, tmp_path)

    said = json.loads(say("inspect", take, "--truth", "--json").out)
    assert say("export", take, "--format", "csv", "-o", tmp_path / "joints.csv").code == 0

    accounts = {account["place"]: account["restarts"] for account in said["sensors"]}
    assert accounts.pop("left_shank") == 1
    assert set(accounts.values()) == {0}
    assert said["truth"]["worst_rms_deg"] <= WORST  # over what is called measured
    columns = columns_of(tmp_path / "joints.csv")
    time = columns.pop("time_s")
    before, after = time < restart - 0.1, time > restart + 0.1
    of_the_shank = [name for name in columns if name.startswith(("left_knee", "left_ankle"))]
    assert len(of_the_shank) == 6
    for name, values in columns.items():
        known = np.isfinite(values)  # a hanging arm has no plane of elevation
        assert known[before].any(), name
        assert known[after].any() != (name in of_the_shank), name


def test_swapped_tags_are_kept_as_they_were_believed_to_be_and_can_be_put_right(tmp_path):
    left, right = Place.LEFT_SHANK, Place.RIGHT_SHANK
    folder = recorded("synthetic:walk?speed=max&calibrated=1&swap=left_shank:right_shank", 15, tmp_path)
    attached = read_attachment(folder, "truth")
    assert attached is not None
    tags = decode_truth(attached).facts["tags"]
    assert isinstance(tags, dict)

    take, _ = read_take(folder)
    believed = {place: sensor.removeprefix("tag:") for place, sensor in take.setup.assignment.sensors.items()}
    assert tags[believed[left]]["place"] == right.value
    assert tags[believed[right]]["place"] == left.value
    assert compare_with_truth(folder).worst() > 10

    exchanged = {**take.setup.assignment.sensors, left: worn_at(take, right), right: worn_at(take, left)}
    setup = replace(take.setup, assignment=Assignment(exchanged))
    save_document(folder, TakeDocument(name="walk", setup=setup))
    assert compare_with_truth(folder).worst() <= WORST


def worn_at(take, place):
    return take.setup.assignment.sensors[place]


def test_a_suit_at_100_hz_is_as_good(tmp_path):
    take = recorded("synthetic:walk?speed=max&calibrated=1&rate=100", 12, tmp_path)
    bvh = say("export", take, "--format", "bvh", "--fps", "native", "-o", tmp_path / "fast.bvh")

    truth = compare_with_truth(take)

    assert bvh.code == 0
    assert read_bvh(tmp_path / "fast.bvh").frame_time == 0.01
    assert truth.median() <= MEDIAN
    assert truth.worst() <= WORST
