"""What is exported where: names that replace nothing, a choice that is remembered, sizes that are about right."""

from dataclasses import replace
from pathlib import Path

import pytest

from studio.capture.jobs import ExportRequest, SolveRequest, run_export
from studio.core.body import PLACES, Place
from studio.core.errors import NotATake
from studio.storage.take_summary import summarise
from studio.ui.models.export_choice import FORMATS, ExportChoice, angle_count, estimate
from tests.journeys.command_line import say
from tests.ui.reviewed import summary

EXPORTS = Path("/exports")
SAMPLES = Path(__file__).resolve().parents[2] / "resources" / "samples"


@pytest.fixture
def there():
    """The files that are there already."""
    return set()


@pytest.fixture
def choice(there):
    made = ExportChoice(there.__contains__)
    made.set_folder(EXPORTS)
    made.set_takes([summary(1)])
    return made


def test_a_name_is_suggested_that_tells_whose_take_it_is(choice):
    assert choice.name == "P014_2026-11-02a_take-001_walk.bvh"
    choice.set_format("joints")
    assert choice.name == "P014_2026-11-02a_take-001_walk_joints.csv"


def test_a_suggested_name_replaces_no_file(choice, there):
    there.add(EXPORTS / "P014_2026-11-02a_take-001_walk.bvh")
    assert choice.name == "P014_2026-11-02a_take-001_walk-2.bvh"
    there.add(EXPORTS / "P014_2026-11-02a_take-001_walk-2.bvh")
    assert choice.name == "P014_2026-11-02a_take-001_walk-3.bvh"
    assert choice.replaced() == ()


def test_a_typed_name_may_replace_a_file_and_says_so(choice, there):
    there.add(EXPORTS / "walk.bvh")
    choice.set_name("walk")

    assert choice.name == "walk.bvh"
    assert choice.replaced() == (EXPORTS / "walk.bvh",)
    choice.set_name("")
    assert choice.replaced() == ()


@pytest.mark.parametrize(
    ("typed", "name"), [("../up", "-up.bvh"), ("a:b?.bvh", "a-b-.bvh"), (" . ", "export.bvh"), ("läuft", "läuft.bvh")]
)
def test_a_typed_name_stays_in_its_folder(choice, typed, name):
    choice.set_name(typed)

    assert choice.items()[0].target == EXPORTS / name


def test_takes_of_one_name_get_files_of_their_own(choice):
    one = summary(1)
    choice.set_takes([one, replace(one, folder=Path("/other/P014/2026-11-02a/take-001_walk"))])
    targets = [item.target.name for item in choice.items()]

    assert targets == ["P014_2026-11-02a_take-001_walk.bvh", "P014_2026-11-02a_take-001_walk-2.bvh"]
    assert choice.name == ""


def test_takes_that_cannot_be_read_are_left_out(choice):
    choice.set_takes([summary(1), summary(2, refusal=NotATake("/x"))])
    assert len(choice.items()) == 1
    choice.remove_take(summary(1).folder)
    assert choice.items() == ()


@pytest.mark.parametrize("preset", ["blender:60", "blender:own", "motionbuilder:30", "joints:excel", "raw:plain"])
def test_a_choice_is_remembered(preset, there):
    choice = ExportChoice(there.__contains__)
    choice.use(preset)

    assert choice.preset == preset


@pytest.mark.parametrize(("preset", "used"), [("bvh", "blender:60"), ("joints", "joints:plain"), ("", "blender:60"),
                                             ("blender:61", "blender:60"), ("fbx:1", "blender:60")])  # fmt: skip
def test_words_of_another_studio_change_nothing_they_do_not_name(preset, used, there):
    choice = ExportChoice(there.__contains__)
    choice.use(preset)

    assert choice.preset == used


def test_the_order_names_exporter_preset_and_rate(choice):
    choice.use("motionbuilder:25")
    order = choice.values()
    assert (order.exporter, order.wish.preset, order.wish.fps) == ("bvh", "motionbuilder", 25)
    choice.use("orientations:excel")
    order = choice.values()
    assert (order.exporter, order.wish.preset, order.wish.fps) == ("orientations", "excel", None)
    assert order.items == choice.items()


def test_angles_are_counted_as_the_analysis_gives_them():
    assert angle_count(PLACES) == 40
    assert angle_count(PLACES[8:]) == 21
    assert angle_count((Place.HEAD,)) == 0


def test_a_take_without_samples_makes_an_empty_file():
    for kind in FORMATS:
        assert estimate(summary(1, samples=0, duration_s=0.0), kind, None).rows == 0


@pytest.fixture(scope="module")
def takes(tmp_path_factory):
    """A simulated walk of 15 sensors with loss, and the recorded legs."""
    library = tmp_path_factory.mktemp("library")
    walk = say("record", "--source", "synthetic:walk?speed=max&loss=0.05&seed=3", "--seconds", "12", "--library",
               library, "--person", "P014")  # fmt: skip
    legs = say("import", SAMPLES / "xio-lower-body", "--library", library)
    return [Path(walk.out.strip()), Path(legs.out.strip())]


@pytest.mark.parametrize("kind", FORMATS, ids=lambda kind: kind.key)
def test_the_estimate_is_within_15_percent_of_the_file(takes, kind, tmp_path, there):
    choice = ExportChoice(there.__contains__)
    choice.use(kind.key)
    for number, folder in enumerate(takes):
        choice.set_takes([summarise(folder)])
        target = tmp_path / f"{number}{kind.suffix}"
        order = choice.values()
        run_export(ExportRequest(SolveRequest(folder), order.exporter, order.wish, target), lambda what, share: None)
        (guess,) = choice.estimates()

        assert guess.size == pytest.approx(target.stat().st_size, rel=0.15)
        content = target.read_bytes()
        rows = content.count(b"\n") - 1 if kind.family == "csv" else int(content.split(b"Frames:")[1].split()[0])
        assert guess.rows == pytest.approx(rows, abs=2)
