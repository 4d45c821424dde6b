"""Until when a recording keeps what comes, and how it ends when nothing comes."""

import asyncio
import contextlib
from dataclasses import replace

import pytest

from studio.capture.recording import HEALTH_EVERY, MARGIN, Recording
from studio.core.errors import DiskFull
from studio.core.take import Mark
from studio.storage.take_reader import read_events, read_take
from tests.storage.disks import FullDisk
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


@pytest.mark.parametrize(("last", "silent_for"), [(20, 0.8), (40, 0.6), (60, 0.0)])
def test_how_much_is_missing_at_the_end_is_told_beyond_what_may_be_lost_on_the_way(recording, last, silent_for):
    keep(recording, 0, last)

    recording.look(START + 10.0, START)

    assert recording.silent_for == pytest.approx(silent_for)


def test_a_recording_that_has_its_length_did_not_end_in_silence(recording):
    keep(recording, 0, 20, 100)

    recording.look(START + 10.0, START)

    assert recording.full.is_set()
    assert recording.silent_for == 0.0


def test_a_source_slower_than_time_is_not_cut_off_while_it_sends(recording):
    keep(recording, 0, 20)

    recording.look(START + 60.0, START + 60.0 - MARGIN + 0.01)

    assert not recording.full.is_set()


def test_into_which_nothing_ever_came_ends_too(recording):
    recording.look(START - 5.0 + 1.0 + MARGIN - 0.01, float("-inf"))
    assert not recording.full.is_set()

    recording.look(START - 5.0 + 1.0 + MARGIN + 0.01, float("-inf"))

    assert recording.full.is_set()


def test_what_becomes_known_of_a_sensor_is_kept(recording):
    keep(recording, 0)
    recording.sample(sample(TAGS[0], 1), replace(info(TAGS[0]), number=9))

    take, _ = read_take(recording.writer.stop().result(30).folder)

    assert take.streams[0].info.number == 9


def test_a_mark_before_the_first_sample_is_kept(recording):
    recording.mark(Mark(START, "record"))

    take, _ = read_take(recording.writer.stop().result(30).folder)

    assert [mark.kind for mark in take.marks] == ["record"]


@pytest.mark.parametrize("sends", [True, False])
def test_a_disk_that_refuses_ends_it_whether_something_comes_or_not(tmp_path, sends):
    async def story():
        disk = FullDisk(1, for_good=True)
        recording = Recording(start_writing(tmp_path, disk, tags=0), float("inf"), START)
        keep(recording, 0)
        while recording.writer.failure is None:  # noqa: ASYNC110  # the writer is a thread that tells nobody
            await asyncio.sleep(0)
        assert not recording.full.is_set()

        if sends:
            keep(recording, 1)
        else:
            recording.look(START, START)

        assert recording.full.is_set()
        with contextlib.suppress(DiskFull):
            recording.writer.stop().result(30)

    asyncio.run(story())


def test_counts_are_due_every_ten_seconds(recording):
    assert recording.health_is_due(START)
    recording.note_health((), START)

    assert not recording.health_is_due(START + HEALTH_EVERY - 0.01)
    assert recording.health_is_due(START + HEALTH_EVERY)
