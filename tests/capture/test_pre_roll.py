"""The seconds before R."""

from studio.acquisition.driver import Arrival
from studio.capture.pre_roll import PreRoll
from studio.core.sample import SensorId
from tests.storage.recordings import START, TAGS, sample


def filled(seconds):
    roll = PreRoll(seconds)
    for frame in range(100):
        roll.keep("a", Arrival(START + frame / 100 + 0.001, b"x"))
        roll.keep("a", sample(TAGS[frame % 2], frame))
    return roll


def arrived(roll):
    return [kept.piece.received for kept in roll]


def test_what_arrived_longer_ago_is_forgotten_and_nothing_else():
    roll = filled(0.5)
    newest = max(arrived(roll))

    roll.forget(newest)

    assert newest - 0.5 <= min(arrived(roll)) < newest - 0.48
    assert max(arrived(roll)) == newest
    assert arrived(roll) == sorted(arrived(roll))


def test_what_is_exactly_so_old_is_kept():
    roll = filled(0.5)
    oldest = min(arrived(roll))

    roll.forget(oldest + 0.5)
    assert min(arrived(roll)) == oldest
    roll.forget(oldest + 0.5 + 1e-6)
    assert min(arrived(roll)) > oldest


def test_nothing_is_forgotten_while_a_take_is_being_opened():
    roll = filled(0.5)
    before = arrived(roll)

    roll.is_frozen = True
    roll.forget(START + 100)

    assert arrived(roll) == before


def test_the_first_sample_tells_when_a_take_would_begin():
    roll = filled(9.0)

    assert roll.first() == sample(TAGS[0], 0).time
    assert [one.sensor for one in roll.samples()][:3] == [TAGS[0], TAGS[1], TAGS[0]]
    assert {one.sensor for one in roll.samples(TAGS[1])} == {TAGS[1]}
    assert len(roll.samples(TAGS[1])) == 50
    assert roll.samples(SensorId("tag:ffff")) == []


def test_without_samples_there_is_no_first():
    roll = PreRoll(2.0)
    roll.keep("a", Arrival(1.0, b"x"))

    assert roll.first() is None
    roll.clear()
    assert list(roll) == []
