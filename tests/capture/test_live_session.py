"""The running studio: what ends a recording, and what is told meanwhile."""

import asyncio

import pytest

from studio.capture import events
from studio.capture.live_session import LiveSession
from studio.core.body import Place
from studio.core.errors import NoData, PortGone
from tests.capture.known_suit import (
    LOWER,
    HandFed,
    between,
    connected,
    events_of,
    iter_events,
    run,
    start,
    told,
)
from tests.core.worn_sensors import sensor_of, worn_take


@pytest.fixture(scope="module")
def legs():
    take, truth = worn_take(LOWER, 30.0)
    return take, told(take), truth


def test_a_mistake_while_reading_ends_the_recording_and_is_not_lost(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        recording = await start(session, tmp_path)
        await link.give(between(pieces, 1, 2))

        await link.break_off(ZeroDivisionError("ours"))
        await session.finished(recording)

        saved = await session.stop_recording()
        assert saved.samples == len(between(pieces, 0, 2))
        told = [*iter_events(session)]
        assert [event.error for event in told if isinstance(event, events.LinkEnded)] == [None]
        assert [type(event.mistake) for event in told if isinstance(event, events.MistakeMade)] == [ZeroDivisionError]
        await session.disconnect()
        assert isinstance(session.take_mistake(), ZeroDivisionError)
        assert session.take_mistake() is None

    run(story())


class Puzzling(HandFed):
    """A port that cannot be asked any more whether it is there."""

    place, is_connected, dropped = "ttyA", True, 0
    readable = 1

    @property
    def interruptions(self) -> int:
        return 0 // self.readable


def test_a_mistake_while_watching_ends_the_recording_too(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = Puzzling()
        session = await connected(link, take, between(pieces, 0, 1))
        recording = await start(session, tmp_path)

        link.readable = 0

        await session.finished(recording)
        assert [type(event.mistake) for event in events_of(session, events.MistakeMade)] == [ZeroDivisionError]
        assert (await session.stop_recording()).samples > 0
        await session.disconnect()

    run(story())


def test_a_mistake_before_any_sensor_is_raised_at_once():
    async def story():
        link = HandFed()
        session = LiveSession()
        await session.connect("hand", link)
        await link.break_off(ZeroDivisionError("ours"))

        with pytest.raises(ZeroDivisionError):
            await session.sensors_known()
        await session.disconnect()

    run(story())


def test_a_lost_source_is_told_and_is_the_reason_of_the_end(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        recording = await start(session, tmp_path)
        assert session.lost() is None

        await link.break_off(PortGone("ttyA"))
        await session.finished(recording)

        (ended,) = events_of(session, events.LinkEnded)
        assert isinstance(ended.error, PortGone)
        assert session.lost() is ended.error
        await session.stop_recording()
        await session.disconnect()
        assert session.take_mistake() is None

    run(story())


@pytest.mark.parametrize("lost_is_first", [True, False])
def test_one_of_two_sources_lost_ends_nothing(tmp_path, legs, lost_is_first):
    _, pieces, _ = legs

    async def story():
        link, other = HandFed(), HandFed()
        session = LiveSession()
        for source, one in (("other", other), ("hand", link)) if lost_is_first else (("hand", link), ("other", other)):
            await session.connect(source, one)
        await link.give(between(pieces, 0, 1))
        await session.sensors_known()
        await start(session, tmp_path)

        await other.break_off(PortGone("ttyB"))

        assert session.lost() is None
        await link.give(between(pieces, 1, 2))
        saved = await session.stop_recording()
        assert saved.samples == len(between(pieces, 0, 2))
        await session.disconnect()

    run(story())


def test_a_source_that_was_lost_and_is_opened_again_is_not_lost(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link, again = HandFed(), HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        await link.break_off(PortGone("ttyA"))
        await session.connect("hand", again)

        assert session.lost() is None
        recording = await start(session, tmp_path)
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(session.finished(recording), 0.02)
        await session.stop_recording()
        await again.give(between(pieces, 1, 2))
        await session.disconnect()

    run(story())


def test_the_end_of_a_link_that_was_replaced_is_no_news(legs):
    take, pieces, _ = legs

    async def story():
        link, again = HandFed(), HandFed()
        session = await connected(link, take, between(pieces, 0, 1))
        await session.connect("hand", again)

        await link.break_off(PortGone("ttyA"))

        assert events_of(session, events.LinkEnded) == []
        assert session.lost() is None
        await session.disconnect()

    run(story())


def test_sensors_are_known_when_no_new_one_has_come_for_half_a_second(legs):
    _, pieces, _ = legs
    late = sensor_of(Place.LEFT_FOOT)

    async def story():
        link = HandFed()
        session = LiveSession()
        await session.connect("hand", link)
        await link.give([one for one in between(pieces, 0, 0.4) if one[1].info.sensor != late])
        await link.give(between(pieces, 0.4, 0.85))
        with pytest.raises(TimeoutError):
            await asyncio.wait_for(session.sensors_known(), 0.05)

        await link.give(between(pieces, 0.85, 0.95))

        await session.sensors_known(patience=0.5)
        assert len(session.infos) == len(LOWER)
        await session.disconnect()

    run(story())


def test_nothing_is_in_two_takes(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 2))
        await start(session, tmp_path)
        await link.give(between(pieces, 2, 3))
        first = await session.stop_recording()
        await link.give(between(pieces, 3, 4))
        await start(session, tmp_path)
        second = await session.stop_recording()

        assert (first.samples, second.samples) == (len(between(pieces, 0, 3)), len(between(pieces, 3, 4)))
        await session.disconnect()

    run(story())


def test_a_source_that_is_lost_before_it_sends_says_why():
    async def story():
        link = HandFed()
        session = LiveSession()
        await session.connect("hand", link)
        await link.break_off(PortGone("ttyA"))
        with pytest.raises(PortGone):
            await session.sensors_known()
        await session.disconnect()

    run(story())


def test_a_source_that_sends_nothing_is_waited_for_and_no_longer():
    async def story():
        link = HandFed()
        session = LiveSession()
        await session.connect("hand", link)
        with pytest.raises(NoData):
            await session.sensors_known(patience=0.0)
        await session.disconnect()

    run(story())
