"""What can be told of a take before it is begun."""

import shutil
from datetime import UTC, datetime

import pytest

from studio.capture.next_take import NextTake, next_take, seconds_that_fit
from studio.core.errors import PersonCodeInvalid
from studio.storage.session_folder import make_take_folder, new_session, open_session
from studio.storage.take_file import RESERVE
from tests.journeys.command_line import say


def today():
    return datetime.now(UTC).astimezone().date()


def test_in_an_empty_library_it_is_the_first_of_a_new_session_and_nothing_is_made(tmp_path):
    assert next_take(tmp_path / "takes", "P014") == NextTake("", 1)
    assert not (tmp_path / "takes").exists()


def test_it_is_what_the_folder_will_be(tmp_path):
    session = open_session(tmp_path, "P014", today())
    for _ in range(3):
        told = next_take(tmp_path, "P014")
        folder = make_take_folder(session, "walk")
        assert (told.session, f"take-{told.number:03d}_walk") == (session.name, folder.name)
    assert next_take(tmp_path, "P015") == NextTake("", 1), "another person has a session of their own"
    assert next_take(tmp_path, "P014").session == session.name
    assert next_take(tmp_path, "P014").number == 4
    latest = new_session(tmp_path, "P014", today())
    assert next_take(tmp_path, "P014") == NextTake(latest.name, 1)


def test_a_code_that_cannot_be_is_refused(tmp_path):
    with pytest.raises(PersonCodeInvalid):
        next_take(tmp_path, "Jane Doe")


def test_what_fits_is_what_a_recording_needs(tmp_path):
    source = "synthetic:walk?speed=max&tags=7"
    made = say("record", "--source", source, "--seconds", "20", "--library", tmp_path / "takes")
    (file,) = (tmp_path / "takes").rglob("take.mcap")
    assert made.code == 0

    fits = seconds_that_fit(tmp_path / "takes", 7 * 50.0)

    assert fits is not None
    a_second = (shutil.disk_usage(tmp_path).free - RESERVE) / fits
    # The file also holds the true motion of the suit, which no real take has.
    assert 0.5 < a_second * 20 / file.stat().st_size < 1.1


def test_a_library_that_is_not_there_yet_has_the_room_of_where_it_will_be(tmp_path):
    known, new = seconds_that_fit(tmp_path, 750.0), seconds_that_fit(tmp_path / "not" / "yet", 750.0)
    assert known is not None
    assert new == pytest.approx(known, rel=0.01)
