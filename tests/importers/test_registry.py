"""Which importer reads what, and which place a name means."""

from importlib import import_module
from pathlib import Path

import pytest

from studio.core.body import Place
from studio.core.errors import FormatUnknown, MapMissing, RecordingMissing
from studio.core.sample import SensorId
from studio.importers.place_words import guess_assignment, guess_place
from studio.importers.registry import IMPORTERS, detect, import_recording

SAMPLE = Path(__file__).parents[2] / "resources" / "samples" / "xio-lower-body"


def test_every_importer_exists():
    for target in IMPORTERS.values():
        module, _, function = target.partition(":")
        assert callable(getattr(import_module(module), function))


def test_formats_are_recognised(tmp_path):
    table = tmp_path / "walk.CSV"
    table.write_text("1,2\n")

    assert detect([SAMPLE]) == "xio"
    assert detect(sorted(SAMPLE.glob("*Leg*"))) == "xio"
    assert detect([table, table]) == "csv"


@pytest.mark.parametrize("paths", [[], [Path("film.mp4")], [Path("a.csv"), Path("b.bvh")]])
def test_what_nobody_knows_is_refused_by_name(paths):
    with pytest.raises(FormatUnknown) as refusal:
        detect(paths)
    assert refusal.value.paths == tuple(str(path) for path in paths)


def test_a_recognised_folder_is_imported():
    assert len(import_recording([SAMPLE], "auto", None).streams) == 7
    assert len(import_recording(sorted(SAMPLE.glob("*Leg*")), "xio", None).streams) == 4


def test_a_table_needs_a_map(tmp_path):
    table = tmp_path / "walk.csv"
    table.write_text("1,2\n")

    for name in ("auto", "csv"):
        with pytest.raises(MapMissing) as refusal:
            import_recording([table], name, None)
        assert refusal.value.paths == (str(table),)


def test_a_path_that_is_not_there_is_named_whatever_the_format(tmp_path):
    table = tmp_path / "walk.csv"
    table.write_text("1,2\n")

    for paths, name, map_file in (
        ([tmp_path / "gone"], "auto", None),
        ([tmp_path / "gone"], "xio", None),
        ([table, tmp_path / "gone"], "csv", table),
        ([table], "csv", tmp_path / "gone"),
    ):
        with pytest.raises(RecordingMissing) as refusal:
            import_recording(paths, name, map_file)
        assert refusal.value.path == str(tmp_path / "gone")


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("Left Upper Leg 64F61CC4", Place.LEFT_THIGH),
        ("Right Lower Leg 64F61B2A", Place.RIGHT_SHANK),
        ("left_foot", Place.LEFT_FOOT),
        ("R Shank", Place.RIGHT_SHANK),
        ("pelvis 64F0EDBF", Place.PELVIS),
        ("Upper Torso", Place.CHEST),
        ("Chest", Place.CHEST),
        ("Head 1", Place.HEAD),
        ("Right Upper Arm", Place.RIGHT_UPPER_ARM),
        ("Left Forearm", Place.LEFT_FOREARM),
        ("LeftLowerArm", Place.LEFT_FOREARM),
        ("RightHand", Place.RIGHT_HAND),
        ("Upper Leg", None),
        ("Left Right Foot", None),
        ("Left Arm", None),
        ("Left Leg", None),
        ("Lower Torso", None),
        ("64F0EDBF", None),
        ("Left Chest", None),
        ("", None),
    ],
)
def test_a_name_means_a_place_only_when_it_tells_all_of_it(name, place):
    assert guess_place(name) is place


def test_a_place_that_two_sensors_claim_is_given_to_none():
    a, b, c = SensorId("file:a"), SensorId("file:b"), SensorId("file:c")

    assert guess_assignment([(a, "Left Foot"), (b, "left foot"), (c, "Head")]) == {Place.HEAD: c}
