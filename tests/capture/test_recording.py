"""Until when a recording keeps what comes, and how it ends when nothing comes."""

import asyncio

import pytest

from studio.capture.recording import HEALTH_EVERY, MARGIN, Recording
from studio.core.take import Mark
from studio.storage.take_reader import read_events, read_take
from tests.storage.recordings import START, TAGS, info, sample, start_writing


@pytest.fixture
def recording(tmp_path):
    async def made():
        return Recording(start_writing(tmp_path, tags=0), 1.0, START - 5.0)

    made_one = asyncio.run(made())
    yield made_one
    made_one.writer.stop().result(30)


def keep(recording, *frames):
    for frame in frames:
        recording.sample(sample(TAGS[0], frame), info(TAGS[0]))


def test_the_length_is_counted_from_the_first_kept_sample(recording):
    keep(recording, *range(99))
    assert not recording.full.is_set()
    keep(recording, 99)
    assert not recording.full.is_set()

    keep(recording, 100)

    assert recording.full.is_set()
    folder = recording.writer.stop().result(30).folder
    take, _ = read_take(folder)
    assert len(take.streams[0]) == 100


def test_nothing_is_kept_after_the_end(recording):
    keep(recording, 0, 100)
    recording.raw("a", START + 2, b"late")
    recording.note("late", {}, START + 2)
    recording.mark(Mark(START + 1.0, "marker", "late"))
    recording.mark(Mark(START + 0.99, "marker", "in time"))

    folder = recording.writer.stop().result(30).folder

    take, _ = read_take(folder)
    assert [mark.label for mark in take.marks] == ["in time"]
    assert "late" not in [event.kind for event in read_events(folder)]


def test_when_nothing_comes_any_more_the_clock_of_this_computer_ends_it(recording):
    keep(recording, 0, 20)
    received = sample(TAGS[0], 0).received
    heard = sample(TAGS[0], 20).received

    recording.look(received + 1.0 + MARGIN - 1e-6, heard)
    assert not recording.full.is_set()
    recording.look(received + 1.0 + MARGIN + 1e-6, heard)
    assert recording.full.is_set()


def test_a_source_slower_than_time_is_not_cut_off_while_it_sends(recording):
    keep(recording, 0, 20)

    recording.look(START + 60.0, START + 60.0 - MARGIN + 0.01)

    assert not recording.full.is_set()


def test_into_which_nothing_ever_came_ends_too(recording):
    recording.look(START - 5.0 + 1.0 + MARGIN - 0.01, float("-inf"))
    assert not recording.full.is_set()

    recording.look(START - 5.0 + 1.0 + MARGIN + 0.01, float("-inf"))

    assert recording.full.is_set()


def test_counts_are_due_every_ten_seconds(recording):
    assert recording.health_is_due(START)
    recording.note_health((), START)

    assert not recording.health_is_due(START + HEALTH_EVERY - 0.01)
    assert recording.health_is_due(START + HEALTH_EVERY)
