"""What ``studio record`` says: the folder on stdout, everything else on stderr, and how it ends."""

import asyncio
from pathlib import Path

import pytest

import studio.__main__ as program
from studio.capture import events
from studio.capture.sources import OpenSource
from studio.cli import main
from studio.cli.record_progress import RecordProgress, summary
from studio.core.body import PRESETS, Place
from studio.core.errors import HeadingsUnknown, MovedDuringHold, PortGone
from studio.core.take import Alignment, Assignment, Mark
from studio.storage.take_reader import read_take
from studio.ui.wording import one_line
from tests.capture.known_suit import told
from tests.core.worn_sensors import N_HOLD, sensor_of, worn_take

FOOT = sensor_of(Place.LEFT_FOOT)
WORN = Assignment({Place.LEFT_FOOT: FOOT})
BODY = Alignment("n", 1.0, 4.0, {})


class Breaking:
    """A link that gives what a suit of exact sensors says, and then breaks, or falls silent when nothing breaks it."""

    name = "breaking"
    dialect = ""

    def __init__(self, pieces, problem, *, paced=False):
        self._pieces, self._problem, self.paced = pieces, problem, paced

    async def arrivals(self):
        for start in range(0, len(self._pieces), 8):
            yield [piece for _, piece in self._pieces[start : start + 8]]
        if self._problem is None:
            await asyncio.Event().wait()
        raise self._problem

    async def send(self, data):
        """Nobody listens."""

    async def close(self):
        """Nothing is open."""


@pytest.fixture
def broken(tmp_path, monkeypatch, capsys):
    """Record from a source that breaks; return exit code, stdout and stderr."""

    def recorded(problem):
        take, _ = worn_take(PRESETS["lower"], 30.0)

        async def opened(source):
            return OpenSource(Breaking(told(take), problem), take.setup)

        monkeypatch.setattr("studio.capture.headless.open_source", opened)
        code = main(["record", "--source", "serial:ttyA", "--library", str(tmp_path)])
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return recorded


def test_a_source_that_is_lost_ends_in_its_sentence_after_the_folder(broken):
    code, out, err = broken(PortGone("ttyA"))

    assert code == 1
    take, report = read_take(Path(out.removesuffix("\n")))
    assert report.finished
    assert take.duration() == pytest.approx(30.0)
    lines = err.splitlines()
    assert lines[0] == "7 sensors found. Recording…"
    assert lines[-2] == "Saved: 30.0 s, 7 sensors."
    assert lines[-1].startswith("ttyA is not there.")


def test_a_source_that_falls_silent_is_told_and_no_loss_is_claimed(tmp_path, monkeypatch, capsys):
    take, _ = worn_take(PRESETS["lower"], 6.0)
    silent = Breaking(told(take), None, paced=True)

    async def opened(source):
        return OpenSource(silent, take.setup)

    monkeypatch.setattr("studio.capture.headless.open_source", opened)
    code = main(["record", "--source", "serial:ttyA", "--library", str(tmp_path), "--seconds", "8"])
    out, err = capsys.readouterr()

    assert code == 1
    assert read_take(Path(out.removesuffix("\n")))[0].duration() == pytest.approx(6.0)
    assert err.splitlines()[-2] == "Saved: 6.0 s, 7 sensors."
    assert err.splitlines()[-1].startswith("Nothing came for the last 2.0 s of 8.0 s.")


def test_our_own_mistake_saves_the_take_and_ends_in_a_report(broken):
    code, out, err = broken(ZeroDivisionError("ours"))

    assert code == 1
    _, report = read_take(Path(out.removesuffix("\n")))
    assert report.finished
    said = err.splitlines()[-1]
    assert said.startswith("The studio made a mistake")
    assert "ZeroDivisionError" in Path(said.split(" is in ")[1].split("; ")[0]).read_text()


def test_ctrl_c_before_anything_has_begun_leaves_no_traceback(monkeypatch, capsys):
    def stopped(words):
        raise KeyboardInterrupt

    monkeypatch.setattr("studio.cli.main", stopped)

    assert program.start() == 130
    assert capsys.readouterr().err == "Stopped.\n"


def said(*told_events):
    progress = RecordProgress()
    return [line for event in told_events for line in progress.lines(event, WORN)]


def test_sensors_are_counted_until_recording_begins_and_named_afterwards():
    assert said(
        events.SensorFound(FOOT), events.RecordingStarted(Path("x")), events.SensorFound(sensor_of(Place.HEAD))
    ) == ["1 sensor found. Recording…", f"{sensor_of(Place.HEAD)} is there, too."]


def test_poses_are_told_and_what_came_of_them():
    moved = MovedDuringHold("n", ("left_foot",), (7.0,))
    assert said(
        events.MarkSet(N_HOLD),
        events.MarkSet(Mark(1.0, "marker", "turn")),
        events.AlignmentRefused(HeadingsUnknown(("left_foot",))),
        events.Aligned(BODY),
        events.Aligned(BODY, moved),
        events.AlignmentRefused(moved),
    ) == [
        "N-pose held.",
        "Headings are not known yet: a bow tells them.",
        "The body is calibrated by the N-pose.",
        f"The body is calibrated by the N-pose. {one_line(moved)}",
        one_line(moved),
    ]


@pytest.mark.parametrize(
    ("kind", "facts", "line"),
    [
        ("link lost", {"link": "a"}, "The port is gone. Plug the receiver in again: recording goes on."),
        ("link back", {"link": "a", "after": 2.04}, "The port is back after 2.0 s."),
        ("dropped", {"link": "a", "bytes": 12}, "This computer was too busy: 12 bytes were thrown away."),
        ("sensor silent", {"sensor": FOOT}, f"Left foot ({FOOT}) has stopped sending."),
        ("sensor back", {"sensor": FOOT, "after": 3.5}, f"Left foot ({FOOT}) sends again after 3.5 s."),
        ("reboot", {"sensor": FOOT, "epoch": 1}, f"Left foot ({FOOT}) started anew."),
        (
            "duplicate number",
            {"number": 3, "sensors": [FOOT, "tag:1"]},
            f"Two tags have the number 3: Left foot ({FOOT}) and tag:1.",
        ),
    ],
)
def test_what_somebody_can_do_something_about_is_a_line(kind, facts, line):
    assert said(events.LinkNoted(kind, facts)) == [line]


def test_other_notes_are_for_the_take_only():
    assert said(events.LinkNoted("found", {"sensor": FOOT}), events.RecordingEnded(Path("x"), None)) == []


def test_the_last_line_sums_up():
    assert summary(12.34, 1, 0.01234) == "Saved: 12.3 s, 1 sensor, 1.23% lost."
    assert summary(12.34, 1, 0.0) == "Saved: 12.3 s, 1 sensor, 0.00% lost."


def test_the_last_line_says_nothing_of_losses_that_nobody_counted():
    assert summary(12.34, 1, None) == "Saved: 12.3 s, 1 sensor."
