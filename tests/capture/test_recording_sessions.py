"""Recordings of the running studio: how long they are, what belongs to them, one at a time."""

import asyncio
import math
import time

import numpy as np
import pytest

from studio.capture import events
from studio.capture.headless import RecordRequest, record
from studio.capture.live_session import LiveSession
from studio.core.body import Place
from studio.core.errors import AlreadyRecording
from studio.storage.take_reader import read_events, read_take
from tests.capture.known_suit import (
    LOWER,
    HandFed,
    between,
    connected,
    events_of,
    run,
    start,
    told,
    until,
)
from tests.core.worn_sensors import sensor_of, worn_take


@pytest.fixture(scope="module")
def legs():
    take, truth = worn_take(LOWER, 30.0)
    return take, told(take), truth


def test_a_recording_has_its_length_though_nothing_comes_any_more(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        recording = await start(session, tmp_path, seconds=10.0)

        session.look(time.perf_counter() + 0.1)
        assert not recording.full.is_set()
        session.look(time.perf_counter() + 11.0)

        await session.finished(recording)
        await session.stop_recording()
        await session.disconnect()

    run(story())


def test_a_silent_tag_is_told_to_who_watches_and_kept_in_the_take(tmp_path, legs):
    take, pieces, _ = legs
    silent = sensor_of(Place.LEFT_FOOT)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await start(session, tmp_path)

        await link.give([one for one in between(pieces, 1, 4) if one[1].info.sensor != silent])
        await link.give(between(pieces, 4, 5))

        noted = [(event.kind, event.facts["sensor"]) for event in events_of(session, events.LinkNoted)]
        assert noted == [("sensor silent", silent), ("sensor back", silent)]
        folder = (await session.stop_recording()).folder
        kept = [event for event in read_events(folder) if event.kind.startswith("sensor ")]
        assert [(event.kind, event.facts["sensor"]) for event in kept] == noted
        assert kept[0].received == pytest.approx(2.0, abs=0.7)  # looked at once a batch
        assert kept[1].facts["after"] == pytest.approx(3.0, abs=0.05)
        await session.disconnect()

    run(story())


def test_there_is_one_recording_at_a_time_also_while_the_first_is_being_opened(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed()
        session = await connected(link, take, between(pieces, 0, 1))

        first = asyncio.create_task(start(session, tmp_path))
        await asyncio.sleep(0)
        with pytest.raises(AlreadyRecording):
            await start(session, tmp_path)
        recording = await first
        with pytest.raises(AlreadyRecording) as refused:
            await start(session, tmp_path)

        assert refused.value.folder == str(recording.writer.folder)
        assert len(list(tmp_path.glob("*/*/take-*"))) == 1
        await session.stop_recording()
        recording = await start(session, tmp_path)
        await session.stop_recording()
        await session.disconnect()

    run(story())


def test_what_comes_while_the_file_is_being_opened_is_kept_behind_the_pre_roll(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 6))
        opening = asyncio.create_task(start(session, tmp_path))
        await asyncio.sleep(0)
        # More than the pre-roll holds: the first kept sample stays the one that was the first at R.
        await link.give(between(pieces, 6, 10))
        recording = await opening
        await link.give(between(pieces, 10, 11))

        folder = (await session.stop_recording()).folder
        kept, _ = read_take(folder)
        for stream in kept.streams:
            assert np.array_equal(np.diff(stream.frame), np.ones(len(stream) - 1))
        assert recording.first == pytest.approx(4.0, abs=0.03)
        assert kept.duration() == pytest.approx(7.0, abs=0.05)
        (pressed,) = [mark for mark in kept.marks if mark.kind == "record"]
        assert pressed.time == pytest.approx(2.0, abs=0.05)
        await session.disconnect()

    run(story())


def test_a_recording_that_cannot_start_leaves_the_way_free_for_the_next(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 6))
        (tmp_path / "file").write_text("no folder")
        with pytest.raises(Exception, match="file"):
            await start(session, tmp_path / "file")

        await start(session, tmp_path / "library")
        saved = await session.stop_recording()

        assert saved.duration == pytest.approx(2.0, abs=0.05)  # the pre-roll was not lost with the refusal
        await session.disconnect()

    run(story())


def test_a_mark_is_set_at_the_newest_sample_also_when_an_older_one_came_last(legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await link.give(between(pieces, 2, 3))
        await link.give(between(pieces, 1, 1.1))

        assert session.mark("turn").time == pytest.approx(2.98)
        await session.disconnect()

    run(story())


def test_a_source_with_a_clock_of_its_own_is_not_ended_by_ours(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link, other = HandFed(paced=False), HandFed(paced=True)
        session = await connected(link, take, between(pieces, 0, 1))
        await session.connect("other", other)
        recording = await start(session, tmp_path, seconds=10.0)

        session.look(time.perf_counter() + 1000.0)

        assert not recording.full.is_set()
        await session.stop_recording()
        await session.disconnect()

    run(story())


def test_a_source_without_a_pace_waits_for_the_disk(tmp_path, legs, monkeypatch):
    take, pieces, _ = legs
    monkeypatch.setattr("studio.storage.take_writer.CAPACITY", 200)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 0.55), pre_roll=0.1)
        recording = await start(session, tmp_path)
        await link.give(between(pieces, 0.55, 6))
        await link.break_off(None)
        await session.finished(recording)

        kept, _ = read_take((await session.stop_recording()).folder)
        for stream in kept.streams:
            assert np.array_equal(np.diff(stream.frame), np.ones(len(stream) - 1))
        assert kept.duration() > 5.4
        await session.disconnect()

    run(story())


def test_counts_and_clocks_are_kept_every_ten_seconds_and_at_the_end(tmp_path):
    request = RecordRequest("synthetic:walk?tags=1&speed=max", 30.0, tmp_path, "P014", "walk")
    recorded = asyncio.run(record(request, LiveSession(pre_roll=math.inf), asyncio.Event()))

    noted = [event for event in read_events(recorded.saved.folder) if event.kind == "health"]

    *regular, last = [event.received for event in noted]
    assert len(regular) >= 2
    assert np.diff(regular) == pytest.approx(10.0, abs=1.5)
    assert last >= recorded.saved.duration
    assert noted[-1].facts["received"] >= recorded.saved.samples


def test_disconnecting_leaves_no_task_behind(legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        await session.disconnect()
        await until(lambda: len(asyncio.all_tasks()) <= 2)
        session.forget()
        assert session.infos == {}
        assert session.lost() is None

    run(story())
