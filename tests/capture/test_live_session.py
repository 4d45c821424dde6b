"""The running studio: what ends a recording, what is told meanwhile, and what a take knows of the body."""

import asyncio
import math
import time
from dataclasses import replace

import numpy as np
import pytest

from studio.capture import events
from studio.capture.headless import RecordRequest, record
from studio.capture.live_session import LiveSession
from studio.core import rotation
from studio.core.body import Place
from studio.core.errors import AlreadyRecording, HeadingsUnknown, MovedDuringHold, NoData, PortGone, PoseMissing
from studio.core.sample import Correction
from studio.core.take import Alignment, Assignment, Calibration, CarriedAlignment
from studio.storage.take_reader import read_events, read_take
from tests.capture.known_suit import (
    LOWER,
    RESTLESS,
    UPPER,
    HandFed,
    between,
    events_of,
    restless_take,
    run,
    told,
    until,
)
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, sensor_of, worn_take

AGAIN = replace(N_HOLD, time=12.0, end=15.0)


async def connected(link, take, pieces, *, source="hand", pre_roll=2.0):
    """Return a session that has heard all sensors and has the setup of the take."""
    session = LiveSession(pre_roll=pre_roll)
    await session.connect(source, link)
    await link.give(pieces)
    await session.sensors_known()
    session.adopt(take.setup)
    return session


@pytest.fixture(scope="module")
def legs():
    take, truth = worn_take(LOWER, 30.0)
    return take, told(take), truth


def start(session, library, seconds=math.inf):
    return session.start_recording(library, "P014", "walk", "hand", seconds)


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
        assert (await session.stop_recording()).verified
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


def carried_of(folder) -> CarriedAlignment:
    carried = read_take(folder)[0].setup.carried
    assert carried is not None
    return carried


async def aligned(session, link, pieces):
    """Let the wearer stand and bow."""
    await link.give(between(pieces, 1, 8.5))
    first = await session.held(N_HOLD)
    second = await session.held(BOW_HOLD)
    return first, second


def test_a_limb_that_moved_is_named_and_repeated_alone():
    take, _ = restless_take()
    pieces = told(take)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))

        first, second = await aligned(session, link, pieces)
        assert isinstance(first.error, MovedDuringHold)
        assert second.error.places == (RESTLESS.value,)
        assert set(second.alignment.limbs) == set(UPPER) - {RESTLESS}
        refused, accepted = (events_of(session, kind) for kind in (events.AlignmentRefused, events.Aligned))
        assert (len(refused), accepted) == (1, [])  # all was taken by the first look

        await link.give(between(pieces, 8.5, 15.5))
        third = await session.held(AGAIN, {RESTLESS})
        assert third.error is None
        assert set(third.alignment.limbs) == set(UPPER)
        for place in UPPER:
            if place is not RESTLESS:
                assert third.alignment.limbs[place] == second.alignment.limbs[place]
        (event,) = events_of(session, events.Aligned)
        assert (event.alignment, event.error) == (third.alignment, None)

        await link.give(between(pieces, 15.5, 16.5))
        _, pose = session.buffer.newest()
        assert RESTLESS in pose.measured
        await session.disconnect()

    run(story())


def test_an_alignment_with_a_limb_missing_is_told_with_its_name():
    take, _ = restless_take()
    pieces = told(take)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await aligned(session, link, pieces)

        (event,) = events_of(session, events.Aligned)
        assert event.error.places == (RESTLESS.value,)
        await session.disconnect()

    run(story())


def test_a_hold_without_headings_changes_nothing_that_was_in_force(legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        first, second = await aligned(session, link, pieces)
        assert isinstance(first.error, HeadingsUnknown)
        assert second.error is None
        (refused,) = (event for event in [*iter_events(session)] if isinstance(event, events.AlignmentRefused))
        assert refused.alignment == first.alignment

        await link.give(between(pieces, 8.5, 15.5))
        again = await session.held(AGAIN)
        assert isinstance(again.error, HeadingsUnknown | MovedDuringHold)
        await link.give(between(pieces, 15.5, 16.0))
        _, pose = session.buffer.newest()
        assert pose is not None
        await session.disconnect()

    run(story())


def iter_events(session):
    for _ in range(session.events.qsize()):
        yield session.events.get()


def test_other_places_need_another_hold(legs):
    take, pieces, _ = legs
    swapped = dict(take.setup.assignment.sensors)
    swapped[Place.LEFT_FOOT], swapped[Place.RIGHT_FOOT] = swapped[Place.RIGHT_FOOT], swapped[Place.LEFT_FOOT]

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await aligned(session, link, pieces)
        await link.give(between(pieces, 8.5, 9.0))
        assert session.buffer.newest()[1] is not None

        session.adopt(replace(take.setup, assignment=Assignment(swapped)))
        await link.give(between(pieces, 9.0, 9.5))

        assert session.buffer.newest()[1] is None
        refused = (await session.held(replace(BOW_HOLD, time=8.2, end=9.2))).error
        assert isinstance(refused, PoseMissing)  # the old N-pose is forgotten
        await session.disconnect()

    run(story())


def test_a_new_stature_or_calibration_leaves_the_body_calibrated(legs):
    take, pieces, _ = legs
    sensor = sensor_of(Place.LEFT_FOOT)
    none = Calibration(
        sensor, Correction((0.0, 0.0, 0.0), ((1.0, 0, 0), (0, 1.0, 0), (0, 0, 1.0))), "", "rest", (1e-4,) * 3
    )

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await aligned(session, link, pieces)
        await link.give(between(pieces, 8.5, 9.0))
        events_of(session, events.Aligned)

        session.adopt(replace(take.setup, stature=1.5, calibrations=(none,)))
        await link.give(between(pieces, 9.0, 11.0))

        _, pose = session.buffer.newest()
        assert pose.measured == frozenset(LOWER)
        assert pose.hips[2] < 0.87 * 1.75 * 0.6
        assert events_of(session, events.Aligned) == []
        await session.disconnect()

    run(story())


@pytest.mark.parametrize("begun", [14.0, 20.013])
def test_a_take_begun_after_the_holds_knows_how_each_sensor_was_turned_at_its_first_sample(tmp_path, legs, begun):
    take, pieces, truth = legs

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        _, second = await aligned(session, link, pieces)
        await link.give(between(pieces, 8.5, begun))
        await start(session, tmp_path)
        await link.give(between(pieces, begun, begun + 1))
        folder = (await session.stop_recording()).folder
        kept, _ = read_take(folder)

        carried = carried_of(folder)
        first = int(np.searchsorted(take.streams[0].time, begun - 2.0 - 0.021))
        rows = [first, first + 1, first + 2]
        assert carried.time == 0.0
        assert carried.alignment.to_s - carried.alignment.from_s == pytest.approx(3.0)
        assert carried.alignment.from_s == pytest.approx(1.0 - (begun - 2.0), abs=0.05)
        assert set(carried.wearer_from_sensor) == set(LOWER)
        for place, wearer_from_sensor in carried.wearer_from_sensor.items():
            limb = second.alignment.limbs[place]
            found = rotation.multiply(np.array(wearer_from_sensor), np.array(limb.sensor_from_segment))
            apart = np.degrees(rotation.angle_between(found, truth[place][rows]))
            assert apart.min() < 2.0, place
            older = begun - 2.0 - 4.0
            assert limb.heading_sigma < carried.alignment.limbs[place].heading_sigma
            assert carried.alignment.limbs[place].heading_sigma == pytest.approx(
                math.hypot(limb.heading_sigma, math.radians(0.3) * older), abs=0.01
            )
        assert kept.poses() == ()
        await session.disconnect()

    run(story())


def test_other_places_are_aligned_by_the_same_holds_while_their_samples_are_kept(tmp_path, legs):
    take, pieces, _ = legs
    fewer = {place: sensor for place, sensor in take.setup.assignment.sensors.items() if place is not Place.PELVIS}

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1), pre_roll=math.inf)
        await aligned(session, link, pieces)
        events_of(session, events.Aligned)

        session.adopt(replace(take.setup, assignment=Assignment(fewer)))

        (event,) = events_of(session, events.Aligned)
        assert set(event.alignment.limbs) == set(fewer)
        await start(session, tmp_path)
        kept, _ = read_take((await session.stop_recording()).folder)
        assert [mark.label for mark in kept.poses()] == ["n", "bow"]
        await session.disconnect()

    run(story())


@pytest.mark.parametrize(("pre_roll", "is_carried"), [(math.inf, True), (2.0, False)])
def test_what_a_replayed_take_carries_stays_with_its_first_sample(tmp_path, legs, pre_roll, is_carried):
    take, pieces, _ = legs
    carried = CarriedAlignment(Alignment("n", -9.0, -6.0, {}), 0.0, {})

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1), pre_roll=pre_roll)
        session.adopt(replace(take.setup, carried=carried))
        await link.give(between(pieces, 1, 5))
        await start(session, tmp_path)
        kept, _ = read_take((await session.stop_recording()).folder)

        assert kept.setup.carried == (carried if is_carried else None)
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


def test_counts_and_clocks_are_kept_every_ten_seconds_and_at_the_end(tmp_path):
    request = RecordRequest("synthetic:walk?tags=1&speed=max", 30.0, tmp_path, "P014", "walk")
    recorded = asyncio.run(record(request, LiveSession(pre_roll=math.inf), asyncio.Event()))

    noted = [event for event in read_events(recorded.saved.folder) if event.kind == "health"]

    *regular, last = [event.received for event in noted]
    assert len(regular) >= 2
    assert np.diff(regular) == pytest.approx(10.0, abs=1.5)
    assert last >= recorded.saved.duration
    assert noted[-1].facts["received"] >= recorded.saved.samples


def test_a_take_that_holds_the_poses_itself_carries_nothing(tmp_path, legs):
    take, pieces, _ = legs

    async def story():
        link = HandFed(paced=False)
        # The first kept sample is the first of the hold.
        session = await connected(link, take, between(pieces, 1, 1.9), pre_roll=math.inf)
        await link.give(between(pieces, 1.9, 8.5))
        await session.held(N_HOLD)
        await session.held(BOW_HOLD)
        await start(session, tmp_path)
        folder = (await session.stop_recording()).folder
        kept, _ = read_take(folder)

        assert kept.setup.carried is None
        assert [mark.label for mark in kept.poses()] == ["n", "bow"]
        await session.disconnect()

    run(story())


@pytest.mark.parametrize("silence", [(8.5, 14.0), (11.87, 12.13)])
def test_a_sensor_silent_when_the_take_begins_carries_no_attitude(tmp_path, legs, silence):
    take, pieces, _ = legs
    silent = sensor_of(Place.LEFT_FOOT)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await aligned(session, link, pieces)
        since, until = silence
        await link.give(
            [
                (received, known)
                for received, known in between(pieces, 8.5, 14)
                if known.info.sensor != silent or not since <= received < until
            ]
        )
        await start(session, tmp_path)
        carried = carried_of((await session.stop_recording()).folder)

        assert set(carried.wearer_from_sensor) == set(LOWER) - {Place.LEFT_FOOT}
        assert set(carried.alignment.limbs) == set(LOWER)
        await session.disconnect()

    run(story())


def test_a_sensor_that_started_anew_since_the_hold_carries_no_attitude(tmp_path, legs):
    take, pieces, _ = legs
    anew = sensor_of(Place.LEFT_FOOT)

    def restarted(one):
        received, known = one
        if known.info.sensor != anew:
            return one
        return received, known._replace(sample=known.sample._replace(epoch=1))

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        await aligned(session, link, pieces)
        await link.give([restarted(one) for one in between(pieces, 8.5, 14)])
        await start(session, tmp_path)
        carried = carried_of((await session.stop_recording()).folder)

        assert set(carried.wearer_from_sensor) == set(LOWER) - {Place.LEFT_FOOT}
        await session.disconnect()

    run(story())


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
