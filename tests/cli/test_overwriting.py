"""What stands at the target is replaced when this studio wrote it from the same take, or when a person says so."""

import json
from dataclasses import replace

import pytest

from studio.core.body import PRESETS
from studio.export.file_target import is_taken
from studio.storage.take_json import TakeDocument, save_document
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take
from tests.journeys.command_line import say

TABLE = ("--format", "csv", "--table", "raw", "-o")


@pytest.fixture(scope="module")
def takes(tmp_path_factory):
    library = tmp_path_factory.mktemp("library")
    first, _ = worn_take(PRESETS["lower"], 3.0)
    # The same sensors, the same times: another take all the same.
    streams = tuple(replace(stream, acceleration=stream.acceleration * 1.01) for stream in first.streams)
    return write_take(first, library), write_take(replace(first, streams=streams), library)


@pytest.fixture
def target(tmp_path):
    return tmp_path / "walk.csv"


def kept(answer, target, content):
    """The export was refused by the name of the file, and nothing was touched."""
    assert (answer.code, answer.out) == (1, "")
    assert str(target) in answer.err
    assert "is there already" in answer.err
    assert "--overwrite" in answer.err
    return target.read_bytes() == content


def test_a_file_of_somebody_else_stays(takes, target):
    target.write_bytes(b"my thesis")

    assert kept(say("export", takes[0], *TABLE, target), target, b"my thesis")
    assert list(target.parent.iterdir()) == [target]


def test_overwrite_replaces_it(takes, target):
    target.write_bytes(b"my thesis")

    assert say("export", takes[0], *TABLE, target, "--overwrite").code == 0

    assert target.read_bytes().startswith(b"time_s,")


def test_the_same_take_may_be_exported_again(takes, target):
    assert say("export", takes[0], *TABLE, target).code == 0
    assert say("export", takes[0], *TABLE, target, "--preset", "excel").code == 0

    assert target.read_bytes().startswith(b"\xef\xbb\xbftime_s;")


def test_it_is_the_same_take_under_another_name(takes, target):
    assert say("export", takes[1], *TABLE, target).code == 0
    save_document(takes[1], TakeDocument(name="renamed"))

    assert say("export", takes[1], *TABLE, target).code == 0


def test_another_take_does_not_replace_it(takes, target):
    say("export", takes[0], *TABLE, target)

    assert kept(say("export", takes[1], *TABLE, target), target, target.read_bytes())


def test_another_kind_of_file_from_the_same_take_does_not_replace_it(takes, target):
    say("export", takes[0], *TABLE, target)

    answer = say("export", takes[0], "--format", "csv", "--table", "orientations", "-o", target)

    assert kept(answer, target, target.read_bytes())
    assert b"rate_x_rad_s" in target.read_bytes().partition(b"\n")[0]  # still what the chip read


def test_what_was_changed_since_stays(takes, target):
    """Somebody put a column of their own into the table."""
    say("export", takes[0], *TABLE, target)
    target.write_bytes(target.read_bytes() + b"\r\n")

    assert kept(say("export", takes[0], *TABLE, target), target, target.read_bytes())


@pytest.mark.parametrize(
    "content", [b"", b"{}", b"[]", b'{"made_by": 3}', b"\xff", b'{"made_by": {"program": "other"}}']
)
def test_a_sidecar_that_tells_nothing_protects_the_file(takes, target, content):
    say("export", takes[0], *TABLE, target)
    beside = target.with_name("walk.csv.json")
    beside.write_bytes(content)

    assert kept(say("export", takes[0], *TABLE, target), target, target.read_bytes())
    assert beside.read_bytes() == content


def test_a_file_of_somebody_else_under_the_sidecars_name_stays(takes, target):
    beside = target.with_name("walk.csv.json")
    beside.write_bytes(b'{"my": "settings"}')

    assert is_taken(target)
    assert kept(say("export", takes[0], *TABLE, target), beside, b'{"my": "settings"}')
    assert not target.exists()


def test_a_sidecar_whose_file_was_deleted_is_in_nobodys_way(takes, target):
    say("export", takes[0], *TABLE, target)
    target.unlink()

    assert say("export", takes[1], *TABLE, target).code == 0


def test_the_sidecar_says_which_file_it_describes(takes, target):
    say("export", takes[0], *TABLE, target)

    told = json.loads(target.with_name("walk.csv.json").read_text(encoding="utf-8"))["file"]

    assert told["bytes"] == target.stat().st_size
    assert len(told["sha256"]) == 64
