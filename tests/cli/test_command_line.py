"""The command line: 0 done, 1 the operator can act, 2 usage; one sentence, never an exception."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from studio.cli import main
from studio.core.body import PRESETS
from studio.core.sample import Correction
from studio.core.take import Calibration
from studio.storage.tag_file import add_calibration, tags_folder, write_calibration
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take


@pytest.fixture
def take(tmp_path):
    worn, _ = worn_take(PRESETS["lower"], 14.0)
    return write_take(worn, tmp_path / "library")


def refused(capsys, *words):
    """Run a verb that must be refused and return its one line."""
    assert main([str(word) for word in words]) == 1
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.endswith(".\n")
    assert printed.err.count("\n") == 1
    assert "Error" not in printed.err
    return printed.err


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="elsewhere there is always a screen")
def test_without_a_verb_and_a_screen_it_says_so(capsys, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    assert main([]) == 1

    said = capsys.readouterr().err
    assert "no screen" in said
    assert "--help" in said


@pytest.mark.parametrize(
    "words",
    [
        ["fly"],
        ["record", "--library", "x"],
        ["record", "--source", "synthetic", "--library", "x", "--seconds", "-3"],
        ["record", "--source", "synthetic", "--library", "x", "--seconds", "soon"],
        ["export", "x", "--format", "bvh", "--fps", "17", "-o", "y.bvh"],
        ["export", "x", "--format", "bvh", "--preset", "excel", "-o", "y.bvh"],
        ["export", "x", "--format", "bvh", "--table", "raw", "-o", "y.bvh"],
        ["export", "x", "--format", "bvh", "-o", "y.csv"],
        ["export", "x", "--format", "csv", "-o", "y.bvh"],
        ["export", "x", "--format", "csv", "-o", "y"],
        ["export", "x", "--format", "csv", "--fps", "60", "-o", "y.csv"],
        ["export", "x", "--format", "csv", "--fps", "native", "-o", "y.csv"],
        ["export", "x", "--format", "bvh", "--fps", "23.98", "-o", "y.bvh"],
        ["inspect", ""],
        ["solve", "x", "--pose", "n=3"],
        ["solve", "x", "--pose", "handstand=1..2"],
        ["solve", "x", "--pose", "n=4..2"],
        ["import", "x", "--format", "xio", "--map", "m.json", "--library", "y"],
    ],
)
def test_words_that_make_no_sense_end_with_2(words, capsys):
    with pytest.raises(SystemExit) as end:
        main(words)

    assert end.value.code == 2
    assert "usage:" in capsys.readouterr().err


def test_what_cannot_be_done_is_one_sentence_and_1(tmp_path, capsys, take):
    orders = [
        ("inspect", tmp_path / "nothing here"),
        ("record", "--source", "pigeon", "--library", tmp_path),
        ("record", "--source", f"serial:{tmp_path}/no-port", "--library", tmp_path),
        ("record", "--source", "synthetic", "--library", tmp_path, "--person", "Jane Doe"),
        ("import", tmp_path / "nothing here", "--library", tmp_path),
        ("export", take, "--format", "bvh", "-o", tmp_path / "no" / "such" / "folder.bvh"),
        ("solve", take, "--calibration", tmp_path / "none.json"),
        ("solve", take, "--pose", "n=50..60"),
        ("inspect", take, "--truth"),
    ]
    said = [refused(capsys, *order) for order in orders]
    assert len({*said}) == len(orders), "each says its own reason"


def test_a_refusal_gives_the_reason_that_is_true(tmp_path, capsys, take):
    """What there is to do depends on it."""
    table, file = tmp_path / "walk.csv", tmp_path / "file"
    table.write_text("a,b\n1,2\n3,4\n")
    file.write_text("no folder")
    bvh = ("export", take, "--format", "bvh", "-o")
    into = ("--library", tmp_path / "other")

    assert "there is no folder" in refused(capsys, *bvh, tmp_path / "no" / "walk.bvh")
    (tmp_path / "walk.bvh").mkdir()
    assert "it is a folder" in refused(capsys, *bvh, tmp_path / "walk.bvh")
    assert "is a file, not a folder" in refused(capsys, *bvh, file / "walk.bvh")
    assert "the folder of a take" in refused(capsys, *bvh, take / "walk.bvh")
    assert "is not there" in refused(capsys, "import", tmp_path / "gone", *into)
    assert "is not there" in refused(capsys, "import", table, "--map", tmp_path / "gone.json", *into)
    assert "A map is missing" in refused(capsys, "import", table, *into)
    assert "this is neither" in refused(capsys, "import", file, *into)
    assert "and name it too where poses are named" in refused(capsys, "solve", take, "--pose", "n=1..4")
    synthetic = ("record", "--source", "synthetic:walk?speed=max", "--seconds", "1")
    assert "is a file, not a folder" in refused(capsys, *synthetic, "--library", file)
    assert "Jane" in refused(capsys, *synthetic, *into, "--person", "Jane")
    assert not (tmp_path / "other").exists()


def test_solve_shows_where_each_heading_came_from(take, capsys):
    assert main(["solve", str(take)]) == 0

    shown = capsys.readouterr().out
    assert shown.count(" bow ") == 7
    assert "reference pose n" in shown
    assert list((take / "derived").iterdir())


def test_devices_are_listed_for_people_and_programs(capsys):
    assert main(["devices"]) == 0
    people = capsys.readouterr().out
    assert main(["devices", "--json"]) == 0
    programs = json.loads(capsys.readouterr().out)

    assert any(found["source"].startswith("synthetic") for found in programs)
    assert all(found["source"] in people for found in programs)


def test_another_stature_makes_another_bvh(tmp_path):
    worn, _ = worn_take(PRESETS["lower"], 10.0)
    tall = replace(worn, setup=replace(worn.setup, stature=2.0))
    files = []
    for name, take in (("short", worn), ("tall", tall)):
        folder = write_take(take, tmp_path / name)
        target = tmp_path / f"{name}.bvh"
        assert main(["export", str(folder), "--format", "bvh", "-o", str(target)]) == 0
        files.append(target.read_text().split("MOTION")[0])

    assert files[0] != files[1]


@pytest.fixture
def wrong_gain(take):
    """A calibration that halves what every gyroscope of the take said."""
    half = Correction((0.0, 0.0, 0.0), ((0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5)))
    worn, _ = worn_take(PRESETS["lower"], 14.0)
    return tuple(Calibration(s.info.sensor, half, "2026-01-01T00:00:00Z", "test") for s in worn.streams)


@pytest.mark.parametrize("choice", ["file", "latest"])
def test_a_take_can_be_solved_with_another_calibration(take, wrong_gain, choice, tmp_path):
    for calibration in wrong_gain:
        add_calibration(calibration, tags_folder())
    write_calibration(tmp_path / "half.json", wrong_gain)
    plain, other = tmp_path / "plain.csv", tmp_path / "other.csv"
    words = ["export", str(take), "--format", "csv", "--table", "orientations", "--attitude", "gyro", "-o"]

    assert main([*words, str(plain)]) == 0
    named = "latest" if choice == "latest" else str(tmp_path / "half.json")
    assert main([*words, str(other), "--calibration", named]) == 0

    assert plain.read_text() != other.read_text()


def test_our_own_mistakes_leave_a_report_and_no_stack_on_the_screen(take, capsys, monkeypatch):
    monkeypatch.setattr("studio.cli.verbs.read_take", lambda path: 1 / 0)

    assert main(["inspect", str(take)]) == 1

    said = capsys.readouterr().err
    assert "Traceback" not in said
    report = Path(said.split(" is in ")[1].split("; ")[0])
    assert "ZeroDivisionError" in report.read_text()
