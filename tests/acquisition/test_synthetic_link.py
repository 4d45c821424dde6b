"""The simulated suit as a link: what it yields, on which clock, and the truth it hands to the judge."""

import asyncio
import time
from collections.abc import Sequence

import numpy as np
import pytest

from studio.acquisition.dialects.receiver_frames import HELLO_REQUEST, ReceiverFrames, encode_command
from studio.acquisition.dialects.tag_advert import ALL_TAGS, Command, sensor_of
from studio.acquisition.driver import Arrival, Cue, Known
from studio.acquisition.registry import open_link
from studio.acquisition.synthetic.link import SyntheticDriver, SyntheticLink
from studio.acquisition.synthetic.truth import decode_truth
from studio.core import rotation
from studio.core.body import PLACES, Place, Segment, reference_pose
from studio.core.errors import SourceUnreadable

Batch = Sequence[Arrival | Known | Cue]


def read(link: SyntheticLink, seconds: float) -> list[Arrival | Known | Cue]:
    """Return what a link yields in so many seconds of its own time."""

    async def reading() -> list[Arrival | Known | Cue]:
        told: list[Arrival | Known | Cue] = []
        async for batch in link.arrivals():
            told += batch
            if link.suit.elapsed >= seconds:
                await link.close()
        return told

    return asyncio.run(reading())


def opened(words: str) -> SyntheticLink:
    return asyncio.run(SyntheticDriver().open(words))


def bytes_of(told: list[Arrival | Known | Cue]) -> bytes:
    return b"".join(piece.data for piece in told if isinstance(piece, Arrival))


def test_the_registry_opens_it_and_its_driver_finds_it():
    link = asyncio.run(open_link("synthetic:walk?tags=2&speed=max"))

    assert (link.name, link.dialect, link.paced) == ("synthetic", "receiver_frames", False)
    assert all(asyncio.run(open_link(found.source)) for found in SyntheticDriver().find())


def test_words_it_does_not_know_are_refused_on_opening():
    with pytest.raises(SourceUnreadable):
        opened("walk?tags=16")


def test_the_receiver_says_hello_first_and_again_when_asked():
    link = opened("rest?tags=1&speed=max")
    first = ReceiverFrames()
    first.feed(bytes_of(read(link, 0.5)))
    assert first.hello is not None

    link = opened("rest?tags=1&speed=max")
    asyncio.run(link.send(HELLO_REQUEST + HELLO_REQUEST))
    assert bytes_of(read(link, 0.5)).count(link.suit.hello()) == 3


def test_bytes_arrive_in_order_one_to_four_milliseconds_after_they_were_measured():
    link = opened("walk?tags=2&speed=max&seed=4")
    told = [piece for piece in read(link, 4.0) if isinstance(piece, Arrival)]
    measured = decode_truth(link.truth_attachment()).time
    received = np.array([piece.received for piece in told])

    assert (np.diff(received) >= 0.0).all()
    packets = [piece.received for piece in told if len(piece.data) > 80]  # both tags; hello and status are shorter
    late = np.array(packets) - measured
    assert late.min() >= 0.001
    assert late.max() <= 0.004


def test_the_performer_tells_each_held_pose_when_its_hold_ends():
    told = read(opened("t?tags=1&speed=max"), 16.0)

    start = next(piece.received for piece in told if isinstance(piece, Arrival))
    newest, cues = start, []
    for piece in told:
        if isinstance(piece, Arrival):
            newest = piece.received
        elif isinstance(piece, Cue):
            cues.append(piece.mark)
            assert newest < piece.mark.end + 0.03
            assert newest >= piece.mark.end - 0.03
    assert [(mark.kind, mark.label) for mark in cues] == [("pose", "n"), ("pose", "bow"), ("pose", "t")]
    assert [round(mark.end - mark.time, 3) for mark in cues] == [2.8, 2.0, 3.0]


@pytest.mark.parametrize("script", ["rest", "turns"])
def test_tags_that_nobody_wears_hold_no_pose(script):
    assert not [piece for piece in read(opened(f"{script}?tags=1&speed=max"), 12.0) if isinstance(piece, Cue)]


def test_tag_number_k_sits_at_row_k_of_table_1():
    link = opened("walk?tags=lower&speed=max")

    assignment = link.assignment()
    assert assignment.places() == PLACES[8:]
    numbers = {sensor_of(tag.serial): tag.number for tag in link.suit.firmware.tags}
    assert all(numbers[sensor] == place.number for place, sensor in assignment.sensors.items())
    assert sorted(numbers.values()) == list(range(9, 16))
    assert (link.mounting, opened("?stature=1.6").stature) == ("unknown", 1.6)


def test_commands_sent_as_bytes_are_answered():
    link = opened("walk?tags=2&speed=max")
    question = encode_command(ALL_TAGS, Command.REPORT_COEFFICIENTS)
    asyncio.run(link.send(question[:5]))
    asyncio.run(link.send(question[5:]))

    readings = ReceiverFrames().feed(bytes_of(read(link, 1.0)))
    rows = [reading.facts["coefficients"] for reading in readings if reading.facts and "coefficients" in reading.facts]
    assert sorted(rows) == [0, 0, 1, 1, 2, 2, 3, 3]


def test_a_paced_link_takes_its_time_and_closing_ends_it():
    async def half_a_second() -> tuple[float, list[float]]:
        link = await SyntheticDriver().open("rest?tags=1&speed=10")
        stamps: list[float] = []
        began = time.perf_counter()
        async for batch in link.arrivals():
            stamps += [piece.received for piece in batch if isinstance(piece, Arrival)]
            if stamps[-1] - stamps[0] > 1.99:
                await link.close()
        return time.perf_counter() - began, stamps

    took, stamps = asyncio.run(half_a_second())

    assert took > 0.19  # two seconds of the suit ten times as fast; a busy computer takes longer
    assert stamps[-1] - stamps[0] == pytest.approx(2.0, abs=0.02)


def test_the_truth_lies_on_the_clock_of_the_arrivals():
    link = opened("reach?speed=max&seed=2")
    told = read(link, 20.0)
    truth = decode_truth(link.truth_attachment())

    assert len(truth.time) == 1000
    first = next(piece.received for piece in told if isinstance(piece, Arrival))
    assert 0.001 <= first - truth.time[0] <= 0.004
    assert np.diff(truth.time) == pytest.approx(0.02, abs=1e-9)
    pose, hips = link.suit.scene.true_pose(truth.time - truth.time[0])
    hand = truth.world_from_segment[:, PLACES.index(Place.RIGHT_HAND)]
    assert rotation.angle_between(hand, pose[:, Segment.RightHand]).max() < 1e-6
    assert truth.hips == pytest.approx(hips, abs=1e-6)
    n_pose = truth.world_from_segment[100]
    assert np.degrees(rotation.angle_between(n_pose, reference_pose("n")[:15])).max() < 3.0


def test_the_truth_tells_how_each_tag_really_was_worn():
    link = opened("walk?speed=max&tags=2&swap=head:chest&seed=5")
    read(link, 1.0)
    facts = decode_truth(link.truth_attachment()).facts

    assert (facts["script"], facts["seed"]) == ("walk", 5)
    tags = facts["tags"]
    assert isinstance(tags, dict)
    assert [tag["place"] for tag in tags.values()] == ["chest", "head"]
    mountings = [tag["segment_from_sensor"] for tag in tags.values()]
    assert np.array(mountings) == pytest.approx(link.suit.chips.segment_from_sensor)


@pytest.mark.parametrize("data", [b"", b"PK\x03\x04", b"no archive at all"])
def test_bytes_that_are_no_truth_are_refused(data):
    with pytest.raises(ValueError, match="no true motion"):
        decode_truth(data)


def test_seconds_ahead_arrive_at_once_and_lie_in_the_past():
    async def first_of_now():
        link = await SyntheticDriver().open("walk?tags=1&ahead=4")
        opened = time.perf_counter()
        async for batch in link.arrivals():
            last = batch[-1]
            if isinstance(last, Arrival) and last.received > opened:
                await link.close()
                return last.received - opened, time.perf_counter() - opened
        raise AssertionError("the suit stopped")

    late, waited = asyncio.run(first_of_now())

    assert 0 < late < 0.6  # a batch is half a second at most
    assert waited < 3.5  # four seconds of walking were not waited for
