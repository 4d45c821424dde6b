"""The body is calibrated by holds, limb by limb, and a take knows the calibration it was begun with."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio.capture import events
from studio.core import rotation
from studio.core.body import Place
from studio.core.errors import HeadingsUnknown, MovedDuringHold, PoseMissing
from studio.core.sample import Correction
from studio.core.strapping import strap_rule
from studio.core.take import Alignment, Assignment, Calibration, CarriedAlignment
from studio.storage.take_reader import read_take
from tests.capture.known_suit import (
    LOWER,
    RESTLESS,
    UPPER,
    HandFed,
    between,
    connected,
    events_of,
    iter_events,
    restless_take,
    run,
    start,
    told,
)
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, procedure, sensor_of, stream, worn_take

AGAIN = replace(N_HOLD, time=12.0, end=15.0)


@pytest.fixture(scope="module")
def legs():
    take, truth = worn_take(LOWER, 30.0)
    return take, told(take), truth


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


@pytest.mark.parametrize("mounting", ["unknown", "strapped"])
def test_an_n_pose_held_again_takes_nothing_from_what_the_bow_told(tmp_path, mounting):
    time = np.arange(round(24.0 * 50) + 1) / 50
    turn = rotation.about(2, np.radians(40.0) * np.clip(time - 10.0, 0, 1))
    body = {place: rotation.multiply(turn, procedure(place, time, walking=0.0)) for place in LOWER}
    worn, _ = worn_take(LOWER, 24.0, motion=body)
    streams = tuple(
        stream(
            sensor_of(place),
            rotation.multiply(body[place], rotation.inverse(strap_rule()[place])),
            time,
            first_arrival=row,
            arrival_step=len(LOWER),
        )
        for row, place in enumerate(LOWER)
    )
    take = replace(worn, streams=streams, setup=replace(worn.setup, mounting=mounting))
    pieces = told(take)

    async def story():
        link = HandFed(paced=False)
        session = await connected(link, take, between(pieces, 0, 1))
        _, first = await aligned(session, link, pieces)
        await link.give(between(pieces, 8.5, 15.5))
        events_of(session, events.Aligned)
        again = await session.held(AGAIN)
        await link.give(between(pieces, 15.5, 16.0))

        _, pose = session.buffer.newest()
        assert pose.measured == frozenset(LOWER)
        if mounting == "strapped":
            (event,) = events_of(session, events.Aligned)
            assert event.alignment == again.alignment
            for place, limb in again.alignment.limbs.items():
                before = first.alignment.limbs[place]
                assert (limb.source, limb.sensor_from_segment) == ("bow", before.sensor_from_segment)
                turned = math.degrees(math.remainder(before.heading - limb.heading, 2 * math.pi))
                assert turned == pytest.approx(40.0, abs=1.0)  # the wearer faces x in the newest hold
            await link.give(between(pieces, 16.0, 20.0))
            await start(session, tmp_path)
            carried = carried_of((await session.stop_recording()).folder)
            assert {limb.source for limb in carried.alignment.limbs.values()} == {"bow"}
            assert set(carried.wearer_from_sensor) == set(LOWER)
        await session.disconnect()

    run(story())
