"""``--stature``: asked once, kept for the person, and on solve and export for that run alone."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from studio.core.body import PRESETS, Place
from studio.importers.bvh import read_bvh
from studio.storage.person_file import load_person
from studio.storage.take_reader import read_take
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take
from tests.importers.mapped_tables import FULL, ROWS, text
from tests.journeys.command_line import say

SAMPLE = Path(__file__).resolve().parents[2] / "resources" / "samples" / "xio-lower-body"


def taken(answer):
    assert answer.code == 0, answer.err
    return read_take(Path(answer.out.strip()))[0]


@pytest.mark.parametrize("words", ["1.62", "162", "1,62", "162.0"])
def test_metres_and_centimetres_are_understood_alike(tmp_path, words):
    take = taken(say("import", SAMPLE, "--library", tmp_path, "--stature", words))

    assert (take.setup.stature, take.setup.stature_known) == (pytest.approx(1.62), True)


@pytest.mark.parametrize("words", ["0.2", "29", "2.9", "281", "tall", "nan", "-1.7", "5'6"])
def test_what_is_no_stature_is_usage(words, capsys, tmp_path):
    with pytest.raises(SystemExit) as end:
        say("import", SAMPLE, "--library", tmp_path, f"--stature={words}")

    assert end.value.code == 2


def test_an_import_keeps_it_for_the_person_and_the_next_import_knows_it(tmp_path):
    say("import", SAMPLE, "--library", tmp_path, "--person", "P014", "--stature", "181")

    again = taken(say("import", SAMPLE, "--library", tmp_path, "--person", "P014"))
    other = taken(say("import", SAMPLE, "--library", tmp_path, "--person", "P015"))

    assert load_person(tmp_path, "P014").stature == pytest.approx(1.81)
    assert (again.setup.stature, again.setup.stature_known) == (pytest.approx(1.81), True)
    assert not other.setup.stature_known


def test_what_the_recording_says_is_stronger_than_what_is_known_and_what_is_told_is_strongest(tmp_path):
    (tmp_path / "walk.csv").write_text(text(ROWS))
    (tmp_path / "map.json").write_text(json.dumps(FULL | {"person": {"stature_m": 1.72}}))
    words = ("import", tmp_path / "walk.csv", "--map", tmp_path / "map.json", "--library", tmp_path, "--person", "P014")

    say(*words, "--stature", "1.81")
    mapped, told = taken(say(*words)), taken(say(*words, "--stature", "1.90"))

    assert (mapped.setup.stature, told.setup.stature) == (1.72, 1.90)


def test_without_a_person_nothing_is_kept(tmp_path):
    take = taken(say("import", SAMPLE, "--library", tmp_path, "--stature", "1.81"))

    assert take.setup.stature == pytest.approx(1.81)
    assert list(tmp_path.glob("*/person.json")) == []


def test_a_recording_keeps_it_in_the_take_and_for_the_person(tmp_path):
    words = ["--source", "synthetic:walk?speed=max&tags=3", "--seconds", "2", "--library", tmp_path]

    take = taken(say("record", *words, "--person", "P014", "--stature", "1.62"))

    assert (take.setup.stature, take.setup.stature_known) == (1.62, True)
    assert load_person(tmp_path, "P014").stature == 1.62


@pytest.fixture
def folder(tmp_path):
    take, _ = worn_take(PRESETS["lower"], 10.0)
    return write_take(replace(take, setup=replace(take.setup, stature=1.75, stature_known=False)), tmp_path / "library")


def thigh(path):
    """The length of the thigh in a BVH in metres."""
    written = read_bvh(path)
    return abs(written.offsets[list(written.names).index("LeftLeg")]).max()


def test_export_takes_it_for_this_run_only_and_says_so(folder, tmp_path):
    before = (folder / "take.mcap").read_bytes()

    tall = say("export", folder, "--format", "bvh", "--stature", "200", "-o", tmp_path / "tall.bvh")
    assumed = say("export", folder, "--format", "bvh", "-o", tmp_path / "assumed.bvh")

    assert "Stature 2.00 m for this run only; the take has none." in tall.err
    assert "this run" not in assumed.err
    assert "Nobody entered a stature" in assumed.err
    assert thigh(tmp_path / "tall.bvh") / thigh(tmp_path / "assumed.bvh") == pytest.approx(2.0 / 1.75, rel=1e-6)
    said = json.loads((tmp_path / "tall.bvh.json").read_text(encoding="utf-8"))
    assert said["body"] == {"stature_m": 2.0, "stature_known": True}
    assert any("this run only" in note for note in said["solved"]["notes"])
    assert (folder / "take.mcap").read_bytes() == before
    assert read_take(folder)[0].setup.stature == 1.75


def test_solve_says_so_too(folder):
    said = say("solve", folder, "--stature", "2").out

    assert "Stature 2.00 m for this run only" in said
    assert "Nobody entered a stature" not in said


def test_the_places_worn_stay_when_a_stature_is_told(tmp_path):
    take = taken(say("import", SAMPLE, "--library", tmp_path, "--stature", "1.81"))

    assert Place.LEFT_THIGH in take.setup.assignment.sensors
