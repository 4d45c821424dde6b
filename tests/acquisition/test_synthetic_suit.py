"""Simulated tags say what tags on that body would say: geometry, then the printed errors, then the wire."""

from itertools import pairwise

import numpy as np
import pytest

from studio.acquisition.synthetic.errors_table import (
    NO_ERRORS,
)
from studio.acquisition.synthetic.suit import Suit
from studio.acquisition.synthetic.words import read_words
from studio.core import rotation
from studio.core.body import PLACES, Place
from studio.core.frames import GRAVITY, UP
from studio.core.sample import Flag
from tests.acquisition.synthetic_suit import WIRE_RESOLUTION, frames_of, listen, measured


@pytest.mark.parametrize("script", ["walk", "reach", "turns"])
def test_the_quaternion_of_a_perfect_tag_is_its_true_turn_since_the_start(script):
    heard = listen(f"{script}?rate=100", 16.0, NO_ERRORS)

    for row, place in enumerate(PLACES):
        samples, times = frames_of(heard, place)
        true = heard.suit.chips.sensors(np.concatenate([[0.0], times]))[0][:, row]
        expected = rotation.multiply(rotation.inverse(true[:1]), true[1:])
        told = np.array([sample.orientation for sample in samples])
        assert rotation.angle_between(told, expected).max() < WIRE_RESOLUTION


def test_rate_and_acceleration_of_a_perfect_tag_are_those_of_its_motion():
    heard = listen("walk", 14.0, NO_ERRORS)

    for row, place in enumerate(PLACES):
        samples, times = frames_of(heard, place)
        keep = [i for i, sample in enumerate(samples) if not sample.flags & Flag.FILLED]
        times, step = times[keep], 1e-3
        sensor, position = zip(*(heard.suit.chips.sensors(times + d) for d in (-step, 0.0, step)), strict=True)
        before, here, after = (one[:, row] for one in sensor)
        rate = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(before), after)) / (2 * step)
        second = (position[2][:, row] - 2 * position[1][:, row] + position[0][:, row]) / step**2
        force = rotation.rotate(rotation.inverse(here), second + GRAVITY * UP)
        told_rate = np.array([samples[i].rate for i in keep])
        told_force = np.array([samples[i].acceleration for i in keep])
        # 10 ms windows against 2 ms windows: their difference is the third derivative's
        assert np.degrees(np.abs(told_rate - rate).max()) < 2.0
        assert np.abs(told_force - force).max() < 0.25
        assert np.degrees(np.sqrt(np.mean((told_rate - rate) ** 2))) < 0.25


def test_a_resting_tag_feels_one_g_upwards():
    heard = listen("rest?tags=15", 2.0, NO_ERRORS)

    for row, place in enumerate(PLACES):
        world_from_sensor = heard.suit.chips.sensors(np.zeros(1))[0][0, row]
        for sample in measured(heard.samples[heard.sensor(place)]):
            up = rotation.rotate(world_from_sensor, sample.acceleration)
            assert up == pytest.approx([0.0, 0.0, GRAVITY], abs=0.005)  # a count is 0.0048 m/s²
            assert sample.flags & Flag.AT_REST


def test_mountings_are_random_and_start_frames_too():
    suits = [Suit(read_words(f"walk?seed={seed}")) for seed in range(40)]
    mountings = np.concatenate([suit.chips.segment_from_sensor for suit in suits])

    # uniform over all rotations: the mean of the squared cosine of half the angle is 1/4, each axis likewise
    assert np.mean(mountings**2, axis=0) == pytest.approx(np.full(4, 0.25), abs=0.03)


def test_the_same_seed_gives_the_same_bytes_and_another_seed_others():
    def said(words: str) -> bytes:
        suit = Suit(read_words(words))
        return b"".join(heard.data for _ in range(6) for heard in suit.next_block())

    assert said("walk?seed=3&loss=0.1") == said("walk?seed=3&loss=0.1&speed=max")
    assert said("walk?seed=3") != said("walk?seed=4")


@pytest.mark.parametrize("words", ["walk", "walk?rate=100&tags=4", "sit?tags=lower&skew=50", "reach?tags=1&loss=0.9"])
def test_the_dialect_reads_every_frame(words):
    heard = listen(words, 6.0)

    options = heard.suit.options
    assert not heard.malformed
    expected = 6.0 * options.rate_hz * len(options.places) * (1.0 - options.loss)
    count = sum(len(readings) for readings in heard.readings.values())
    assert count == pytest.approx(expected, rel=0.5 * options.loss, abs=15)
    assert {reading.number for readings in heard.readings.values() for reading in readings} <= {
        place.number for place in options.places
    }


def test_the_receiver_counts_once_a_second_what_it_hands_on():
    heard = listen("walk?tags=3", 4.0)

    assert heard.status is not None
    assert heard.status.received == pytest.approx(3 * 50 * 3.5, abs=3 * 25)
    assert heard.status.slots == (1, 1, 1, *[0] * 12)


def test_packets_are_lost_as_often_as_asked():
    heard = listen("rest?loss=0.2", 60.0)

    lost = 1.0 - sum(len(readings) for readings in heard.readings.values()) / (60 * 50 * 15)
    assert lost == pytest.approx(0.2, abs=4 * np.sqrt(0.2 * 0.8 / 45_000))


def test_bursts_have_the_length_asked_and_the_same_share():
    heard = listen("rest?loss=0.2&burst=10", 120.0)

    gaps, kept = [], 0
    for samples in heard.samples.values():
        steps = np.diff([sample.frame for sample in samples])
        gaps += (steps[steps > 1] - 1).tolist()
        kept += len(samples)
    # about 2,000 bursts of a geometric length: the mean is good to 10/sqrt(2000) frames
    assert np.mean(gaps) == pytest.approx(10.0, abs=1.0)
    assert sum(gaps) / (sum(gaps) + kept) == pytest.approx(0.2, abs=0.02)


def test_a_reboot_is_a_silence_then_a_new_count_and_a_new_start_frame():
    heard = listen("walk?reboot=12.1@left_foot", 16.0)

    readings = heard.readings[heard.sensor(Place.LEFT_FOOT)]
    restart = next(i for i in range(1, len(readings)) if (readings[i].sequence - readings[i - 1].sequence) % 256 > 1)
    # switched on at 12.6 s, heard again 0.3 s later
    assert readings[restart].sequence == 15
    before, after = (readings[restart + step].orientation for step in (-1, 0))
    assert np.degrees(rotation.angle_between(before, after)) > 10.0
    assert [event[1]["sensor"] for event in heard.events("reboot")] == [heard.sensor(Place.LEFT_FOOT)]


def test_a_rebooted_tag_starts_from_the_identity():
    heard = listen("walk?reboot=12.1@left_foot", 16.0, NO_ERRORS)

    readings = heard.readings[heard.sensor(Place.LEFT_FOOT)]
    restart = next(i for i in range(1, len(readings)) if (readings[i].sequence - readings[i - 1].sequence) % 256 > 1)
    times = 12.6 + 0.02 * np.arange(15, 15 + len(readings) - restart)
    true = heard.suit.chips.sensors(np.concatenate([[12.6], times]))[0][:, PLACES.index(Place.LEFT_FOOT)]
    told = np.array([reading.orientation for reading in readings[restart:]])
    expected = rotation.multiply(rotation.inverse(true[:1]), true[1:])
    assert rotation.angle_between(told, expected).max() < WIRE_RESOLUTION


def test_synchronised_clocks_are_one_clock():
    heard = listen("walk", 3.0)

    clocks = [[reading.clock for reading in readings] for readings in heard.readings.values()]
    assert all(clock == clocks[0] for clock in clocks)
    assert all(reading.flags & Flag.TIME_SYNCED for readings in heard.readings.values() for reading in readings)


def test_clocks_of_their_own_run_as_fast_as_asked():
    heard = listen("rest?skew=200&tags=6", 120.0)

    skews = []
    for row, place in enumerate(heard.suit.options.places):
        readings = heard.readings[heard.sensor(place)]
        samples = heard.samples[heard.sensor(place)]
        assert not readings[0].flags & Flag.TIME_SYNCED
        ticks = (readings[-1].clock - readings[0].clock) % (1 << 24)
        period = (len(readings) - 1) * 0.02
        # by its own clock a frame is 20 ms; by true time it is not
        assert ticks * 64e-6 == pytest.approx(period, abs=130e-6)
        found = (ticks * 64e-6) / (samples[-1].received - samples[0].received) - 1.0
        assert found * 1e6 == pytest.approx(heard.suit.clocks.skew[row] * 1e6, abs=40.0)  # 4 ms of latency in 120 s
        skews.append(heard.suit.clocks.skew[row] * 1e6)
    assert np.abs(skews).max() < 200.0
    assert np.ptp(skews) > 50.0


def test_a_swap_changes_the_body_and_not_the_assignment():
    usual = listen("reach?tags=upper", 12.0, NO_ERRORS)
    swapped = listen("reach?tags=upper&swap=left_hand:right_hand", 12.0, NO_ERRORS)

    assert swapped.suit.assignment() == usual.suit.assignment()
    samples, times = frames_of(swapped, Place.LEFT_HAND)
    carried = swapped.suit.scene.carried(np.concatenate([[0.0], times])).orientation
    mounting = swapped.suit.chips.segment_from_sensor[PLACES.index(Place.LEFT_HAND)]
    told = np.array([sample.orientation for sample in samples])

    def error(place: Place) -> float:
        sensor = rotation.multiply(carried[:, PLACES.index(place)], mounting)
        expected = rotation.multiply(rotation.inverse(sensor[:1]), sensor[1:])
        return float(np.degrees(rotation.angle_between(told, expected).max()))

    assert error(Place.RIGHT_HAND) < 0.01
    assert error(Place.LEFT_HAND) > 20.0


def test_low_batteries_say_so():
    heard = listen("rest?battery=low&tags=2", 1.0)

    for readings in heard.readings.values():
        assert readings[0].flags & Flag.LOW_BATTERY
        assert readings[0].battery == pytest.approx(0.08)


def test_clocks_wrap_and_nothing_is_lost():
    wraps_after = {}
    for seed in range(100):
        microseconds = Suit(read_words(f"rest?tags=1&seed={seed}")).clocks.receiver(0.0)
        wraps_after[seed] = (-microseconds % (1 << 30)) * 1e-6  # 2^24 ticks of 64 µs
    seed = min(wraps_after, key=lambda seed: wraps_after[seed])
    heard = listen(f"rest?tags=1&seed={seed}", wraps_after[seed] + 2.0)

    (readings,), (samples,) = heard.readings.values(), heard.samples.values()
    assert sum(b.clock < a.clock for a, b in pairwise(readings)) == 1
    assert np.diff([sample.frame for sample in samples]).tolist() == [1] * (len(readings) - 1)
    assert np.diff([sample.device_time for sample in samples]) == pytest.approx(0.02, abs=65e-6)


def test_facts_stand_in_for_one_frame_in_fifty():
    heard = listen("rest?tags=2", 10.0)

    for place in heard.suit.options.places:
        told = [(i, r.facts) for i, r in enumerate(heard.readings[heard.sensor(place)]) if r.facts is not None]
        assert np.diff([i for i, _ in told]).tolist() == [50] * (len(told) - 1)
        kinds = ["firmware" if "firmware" in facts else "who_am_i" for _, facts in told]
        assert set(pairwise(kinds)) == {("firmware", "who_am_i"), ("who_am_i", "firmware")}
        assert all(f"tag:{facts['serial']}" == heard.sensor(place) for _, facts in told)
