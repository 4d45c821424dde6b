"""take.json, person.json and the tags' files: damaged, old or newer ones never stand between a person and a take."""

import json
from dataclasses import replace
from pathlib import Path

import jsonschema
import pytest

from studio.core.body import Place
from studio.core.errors import (
    CalibrationUnreadable,
    FolderIsFile,
    PersonCodeInvalid,
    WrittenByNewerStudio,
)
from studio.core.sample import Correction
from studio.core.take import Alignment, Assignment, Calibration, CarriedAlignment, LimbAlignment, Mark, Setup
from studio.storage.person_file import Person, load_person, person_schema, save_person
from studio.storage.tag_file import Tag, add_calibration, load_tag, read_calibration, save_tag, write_calibration
from studio.storage.take_json import Edit, TakeDocument, document_schema, save_document
from studio.storage.take_reader import read_take
from tests.storage.recordings import SETUP, TAGS, samples, start_writing

RESOURCES = Path(__file__).parents[2] / "resources"
CALIBRATION = Calibration(
    TAGS[0],
    Correction((0.01, -0.02, 1 / 3), ((1.01, 0.0, 0.0), (0.001, 0.99, 0.0), (0.0, 1 / 7, 1.0))),
    "2026-11-24T09:00:00+00:00",
    "rest and turns",
    gain_sigma=0.002,
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    writer = start_writing(tmp_path)
    for one in samples(3):
        writer.sample(one)
    return writer.stop().result(30).folder


def test_what_people_say_about_a_take_is_applied_and_the_recording_stays(folder: Path) -> None:
    recorded = (folder / "take.mcap").read_bytes()
    now = Setup(Assignment({Place.HEAD: TAGS[2]}), (CALIBRATION,), stature=1.6, stature_known=True)
    marks = (Mark(0.01, "marker", "turn"),)
    save_document(folder, TakeDocument(name="walk, again", notes="slow", marks=marks, setup=now))

    take, report = read_take(folder)

    assert report.document == "kept"
    assert (take.name, take.setup.stature, take.setup.assignment) == ("walk, again", 1.6, now.assignment)
    assert take.setup.calibrations[0].correction == CALIBRATION.correction
    assert take.marks[0].label == "turn"
    assert (folder / "take.mcap").read_bytes() == recorded


def test_a_body_calibration_from_before_the_take_comes_back_as_it_was(folder: Path, tmp_path: Path) -> None:
    third = 1 / 3**0.5
    limb = LimbAlignment((0.5, -0.5, 0.5, 0.5), -1 / 3, "bow", 1 / 7, 1 / 9)
    carried = CarriedAlignment(
        Alignment("n", -12.5, -9.5, {Place.PELVIS: limb}), 0.0, {Place.PELVIS: (0.0, third, -third, third)}
    )
    setup = replace(SETUP, carried=carried)
    writer = start_writing(tmp_path / "other", setup=setup)
    recorded, _ = read_take(writer.stop().result(30).folder)
    save_document(folder, TakeDocument(name="walk", setup=setup))

    assert recorded.setup.carried == carried
    assert read_take(folder)[0].setup.carried == carried


@pytest.mark.parametrize(
    "content", [b"", b"{", b"[1]", b"\xff\xfe", b"[" * 100_000, b'{"schema":1,"marks":7}', b'{"schema":"1"}']
)
def test_a_damaged_take_json_is_made_again_and_kept_aside(folder: Path, content: bytes) -> None:
    (folder / "take.json").write_bytes(content)

    take, report = read_take(folder)

    assert (take.name, report.document) == ("walk", "damaged")
    assert repr(take.setup) == repr(SETUP)
    assert (folder / "take.json.bad").read_bytes() == content
    assert read_take(folder)[1].document == "kept"


def test_two_sensors_on_one_place_in_take_json_are_damage(folder: Path) -> None:
    content = {"schema": 1, "setup": {"assignment": {"sensors": {"head": "tag:1", "chest": "tag:1"}}}}
    (folder / "take.json").write_text(json.dumps(content))

    assert read_take(folder)[1].document == "damaged"


def test_a_lost_take_json_is_made_again(folder: Path) -> None:
    (folder / "take.json").unlink()

    assert read_take(folder)[1].document == "missing"
    assert json.loads((folder / "take.json").read_text())["name"] == "walk"


def test_reading_a_single_file_leaves_nothing_beside_it(folder: Path) -> None:
    (folder / "take.json").unlink()

    read_take(folder / "take.mcap")

    assert [file.name for file in folder.iterdir()] == ["take.mcap"]


def test_a_take_json_of_a_newer_studio_is_left_alone(folder: Path) -> None:
    newer = b'{"schema": 2, "name": {"en": "walk"}}'
    (folder / "take.json").write_bytes(newer)

    take, report = read_take(folder)

    assert (take.name, report.document) == ("walk", "newer")
    with pytest.raises(WrittenByNewerStudio):
        save_document(folder, TakeDocument())
    assert (folder / "take.json").read_bytes() == newer


def test_the_published_schemas_are_the_ones_in_use(folder: Path, tmp_path: Path) -> None:
    take_schema = json.loads((RESOURCES / "take.schema.json").read_text())
    person_json_schema = json.loads((RESOURCES / "person.schema.json").read_text())
    carried = CarriedAlignment(Alignment("n", -9.0, -6.0, {}), 0.0, {Place.PELVIS: (1.0, 0.0, 0.0, 0.0)})
    setup = replace(SETUP, calibrations=(CALIBRATION,), carried=carried)
    save_document(folder, TakeDocument(marks=(Mark(1.0, "marker"),), edits=(Edit("trim", {"to": 2.0}),), setup=setup))
    save_person(tmp_path, "P014", Person(stature=1.7, assignment=SETUP.assignment))

    assert take_schema == document_schema()
    assert person_json_schema == person_schema()
    jsonschema.Draft202012Validator.check_schema(take_schema)
    jsonschema.validate(json.loads((folder / "take.json").read_text()), take_schema)
    jsonschema.validate(json.loads((tmp_path / "P014" / "person.json").read_text()), person_json_schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"schema": 1, "marks": [{"kind": "marker"}]}, take_schema)


def test_a_persons_facts_come_back(tmp_path: Path) -> None:
    person = Person(stature=1.83, assignment=SETUP.assignment, mounting="strapped")

    assert load_person(tmp_path, "P014") == Person()
    save_person(tmp_path, "p014", person)
    assert load_person(tmp_path, "P014") == person


def test_a_damaged_person_json_is_kept_aside(tmp_path: Path) -> None:
    save_person(tmp_path, "P014", Person())
    file = tmp_path / "P014" / "person.json"
    file.write_text("{")

    assert load_person(tmp_path, "P014") == Person()
    assert (tmp_path / "P014" / "person.json.bad").read_text() == "{"


def test_a_person_of_a_newer_studio_is_not_overwritten(tmp_path: Path) -> None:
    save_person(tmp_path, "P014", Person())
    (tmp_path / "P014" / "person.json").write_text('{"schema": 2}')

    with pytest.raises(WrittenByNewerStudio):
        save_person(tmp_path, "P014", Person())
    with pytest.raises(PersonCodeInvalid):
        load_person(tmp_path, "../P014")


def test_a_person_cannot_be_kept_where_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "P014").write_text("a file where a folder should be")

    with pytest.raises(FolderIsFile):
        save_person(tmp_path, "P014", Person())


def test_a_tag_keeps_its_calibrations_newest_first(tmp_path: Path) -> None:
    later = replace(CALIBRATION, date="2026-11-25T09:00:00+00:00")
    save_tag(TAGS[0], Tag(nickname="lefty", place=Place.LEFT_SHANK), tmp_path)
    add_calibration(CALIBRATION, tmp_path)
    add_calibration(later, tmp_path)

    tag = load_tag(TAGS[0], tmp_path)

    assert [file.name for file in tmp_path.iterdir()] == ["00000000.json"]
    assert (tag.nickname, tag.place) == ("lefty", Place.LEFT_SHANK)
    assert [calibration.date for calibration in tag.calibrations] == [later.date, CALIBRATION.date]
    # As text: what is unknown is NaN, and NaN equals nothing.
    assert repr(read_calibration(tmp_path / "00000000.json")) == repr(tag.calibrations)


@pytest.mark.parametrize(
    "correction",
    [
        Correction((0.0, 0.0, 0.0), ((0.0, 0.0, 0.0),) * 3),
        Correction((0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1e6))),
        Correction((1e6, 0.0, 0.0), CALIBRATION.correction.gain),
    ],
)
def test_a_calibration_no_gyroscope_needs_is_not_taken(tmp_path: Path, correction: Correction) -> None:
    file = tmp_path / "00000000.json"
    write_calibration(file, (replace(CALIBRATION, correction=correction),))

    with pytest.raises(CalibrationUnreadable, match="gain"):
        read_calibration(file)
    assert load_tag(TAGS[0], tmp_path) == Tag()
    assert (tmp_path / "00000000.json.bad").exists()


@pytest.mark.parametrize("stature", [-1.0, 0.0, 99.0])
def test_a_stature_nobody_has_counts_as_damage(tmp_path: Path, stature: float) -> None:
    save_person(tmp_path, "P014", Person(stature=stature))

    assert load_person(tmp_path, "P014") == Person()
    assert (tmp_path / "P014" / "person.json.bad").exists()


def test_a_calibration_file_keeps_every_digit(tmp_path: Path) -> None:
    file = tmp_path / "calibration.json"
    write_calibration(file, (CALIBRATION,))

    (found,) = read_calibration(file)

    assert repr(found) == repr(CALIBRATION)


@pytest.mark.parametrize(
    "content", [None, "", "{}", '{"schema": 2, "calibrations": []}', '{"schema": 1, "calibrations": [{}]}']
)
def test_a_calibration_file_that_is_none_is_refused(tmp_path: Path, content: str | None) -> None:
    file = tmp_path / "calibration.json"
    if content is not None:
        file.write_text(content)

    with pytest.raises(CalibrationUnreadable):
        read_calibration(file)
