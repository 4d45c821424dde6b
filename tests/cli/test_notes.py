"""What an exported file cannot show of itself is said when it is written, and stands beside it."""

import json
from dataclasses import replace

import pytest

from studio.core.body import PLACES, PRESETS, Place
from studio.core.take import Assignment
from studio.export.bvh import RATES, rate_name
from studio.importers.bvh import read_bvh
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take
from tests.journeys.command_line import say

TRUNK_ALONE = "the trunk moves with the pelvis as one piece"
UPRIGHT_HIPS = "the hips stand upright and turn with the chest"
NO_TRUNK = "it stands upright and faces where the wearer faced at the hold"


def library(tmp_path, places, unworn=()):
    take, _ = worn_take(places, 14.0)
    sensors = {place: sensor for place, sensor in take.setup.assignment.sensors.items() if place not in unworn}
    return write_take(replace(take, setup=replace(take.setup, assignment=Assignment(sensors))), tmp_path / "library")


@pytest.mark.parametrize(
    ("places", "unworn", "said", "unsaid"),
    [
        (PLACES, (), [], [TRUNK_ALONE, UPRIGHT_HIPS, NO_TRUNK, "next part that has a sensor"]),
        (PRESETS["lower"], (), [TRUNK_ALONE, "head, left upper arm, right upper arm"], [UPRIGHT_HIPS, "left thigh"]),
        (PLACES, (Place.PELVIS,), [UPRIGHT_HIPS], [TRUNK_ALONE, NO_TRUNK, "next part that has a sensor"]),
        (PLACES, (Place.PELVIS, Place.CHEST), [NO_TRUNK], [TRUNK_ALONE, UPRIGHT_HIPS]),
    ],
    ids=["fifteen", "legs", "no pelvis", "no trunk"],
)
def test_a_bvh_says_what_stands_in_for_sensors_that_were_not_worn(tmp_path, places, unworn, said, unsaid):
    folder = library(tmp_path, places, unworn)

    answer = say("export", folder, "--format", "bvh", "-o", tmp_path / "walk.bvh")

    assert answer.code == 0, answer.err
    notes = " ".join(json.loads((tmp_path / "walk.bvh.json").read_text(encoding="utf-8"))["solved"]["notes"])
    for words in said:
        assert words in answer.err
        assert words in notes
    for words in unsaid:
        assert words not in answer.err


def test_a_table_of_joints_has_nothing_stand_in(tmp_path):
    """Its columns are those of the joints that were measured."""
    answer = say("export", library(tmp_path, PRESETS["lower"]), "--format", "csv", "-o", tmp_path / "walk.csv")

    assert answer.code == 0
    assert TRUNK_ALONE not in answer.err


def test_poses_on_the_command_line_are_said_to_replace_those_of_the_take(tmp_path):
    folder = library(tmp_path, PRESETS["lower"])
    poses = [f"--pose={mark.label}={mark.time}..{mark.end}" for mark in worn_take(PRESETS["lower"], 14.0)[0].poses()]

    plain = say("solve", folder)
    named = say("solve", folder, *poses)
    exported = say("export", folder, "--format", "csv", "-o", tmp_path / "walk.csv", *poses)

    words = "The poses named for this run (n "
    assert words not in plain.out
    assert words in named.out
    assert "replace all those of the take (n " in named.out
    assert words in exported.err


def test_a_limb_whose_heading_is_unknown_is_named_at_export_too(tmp_path):
    """A foot that was silent in the hold faces nobody knows where."""
    take, _ = worn_take(PRESETS["lower"], 14.0)
    foot = take.setup.assignment.sensors[Place.LEFT_FOOT]
    hold = take.poses()[0]
    streams = []
    for stream in take.streams:
        rows = stream.time > hold.end + 0.5 if stream.info.sensor == foot else stream.time >= 0
        streams.append(rows_of(stream, rows))
    folder = write_take(replace(take, streams=tuple(streams)), tmp_path / "library")

    for kind in ("csv", "bvh"):
        answer = say("export", folder, "--format", kind, "-o", tmp_path / f"walk.{kind}")
        assert answer.code == 0, answer.err
        assert "Heading unknown, so shown without a sensor of its own: left foot." in answer.err
    assert "right hand, left foot." in answer.err  # of the BVH: what is held still, the foot among it


def rows_of(stream, rows):
    arrays = ("arrival", "epoch", "frame", "device_time", "time", "received", "orientation", "rate", "acceleration",
              "flags", "battery", "temperature", "rssi")  # fmt: skip
    return replace(stream, **{name: getattr(stream, name)[rows] for name in arrays})


def test_a_refused_table_of_joints_says_which_sensors_there_are(tmp_path):
    folder = library(tmp_path, (Place.LEFT_SHANK, Place.RIGHT_FOREARM))

    answer = say("export", folder, "--format", "csv", "-o", tmp_path / "walk.csv")

    assert answer.code == 1
    assert "an angle needs the sensors on both sides of a joint" in answer.err
    assert "left shank" in answer.err
    assert "right forearm" in answer.err


@pytest.mark.parametrize("name", ["23.976", "29.97"])
def test_a_rate_of_television_is_asked_for_by_its_name(tmp_path, name):
    folder = library(tmp_path, PRESETS["lower"])

    answer = say("export", folder, "--format", "bvh", "--fps", name, "-o", tmp_path / "walk.bvh")

    assert answer.code == 0, answer.err
    (fps,) = [rate for rate in RATES if rate_name(rate) == name]
    assert read_bvh(tmp_path / "walk.bvh").frame_time == pytest.approx(1 / fps, rel=1e-11)
    assert fps == pytest.approx(round(fps) * 1000 / 1001, rel=1e-15)
