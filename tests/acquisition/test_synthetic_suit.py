"""Simulated tags say what tags on that body would say: geometry, then the printed errors, then the wire."""

import struct
from itertools import pairwise

import numpy as np
import pytest

from studio.acquisition.dialects.tag_advert import ALL_TAGS, Command
from studio.acquisition.synthetic.errors_table import (
    CALIBRATED,
    DATA_SHEET,
    DEGREE,
    NO_ERRORS,
    RESIDUAL_AXES,
    RESIDUAL_GAIN,
    RESIDUAL_OFFSET,
)
from studio.acquisition.synthetic.firmware import running_product
from studio.acquisition.synthetic.suit import Suit
from studio.acquisition.synthetic.words import read_words
from studio.core import rotation
from studio.core.body import PLACES, Place
from studio.core.frames import GRAVITY, UP
from studio.core.sample import Flag, Sample
from tests.acquisition.synthetic_suit import Listened, Listener, listen

WIRE_RESOLUTION = np.radians(0.0086)  # of smallest three (PROTOCOL.md, section 2.2)


def measured(samples: list[Sample]) -> list[Sample]:
    """Return those that carry gyroscope and accelerometer."""
    return [sample for sample in samples if not sample.flags & Flag.FILLED]


def frames_of(heard: Listened, place: Place) -> tuple[list[Sample], np.ndarray]:
    """Return the samples of a tag and when they were taken, s since switching on: frame after frame from 0 on."""
    samples = heard.samples[heard.sensor(place)]
    count = np.array([sample.frame for sample in samples])
    return samples, (count - count[0]) * heard.suit.options.frame_s


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


def test_every_tag_draws_its_own_errors_within_the_data_sheet():
    suits = [Suit(read_words(f"walk?calibrated=0&seed={seed}")) for seed in range(20)]
    matrices = np.concatenate([suit.chips.matrix for suit in suits])
    offsets = np.concatenate([suit.chips.offset for suit in suits])

    scale = np.diagonal(matrices, axis1=1, axis2=2) - 1.0
    cross = matrices[:, ~np.eye(3, dtype=bool)]
    for drawn, limit in ((scale, 0.03), (cross, 0.02), (np.degrees(offsets), 20.0)):
        assert np.abs(drawn).max() <= limit
        assert drawn.std() == pytest.approx(limit / np.sqrt(3.0), rel=0.1)  # uniform


def test_an_uncalibrated_tag_at_rest_reads_its_offset_with_the_noise_of_the_data_sheet():
    heard = listen("rest?calibrated=0", 60.0)

    for row, place in enumerate(PLACES):
        samples = measured(heard.samples[heard.sensor(place)])
        rates = np.degrees([sample.rate for sample in samples])
        offset = np.degrees(heard.suit.chips.offset[row])
        assert np.abs(rates.mean(axis=0) - offset).max() < 0.15 + 0.16 * 0.3  # g-sensitivity 0.1 per axis; 0.3 K warmer
        # the mean of two ticks of 0.05 °/s each, and the wire's 0.061 °/s
        assert rates.std(axis=0) == pytest.approx(np.full(3, np.hypot(0.035, 0.025)), abs=0.03)
        assert not samples[0].flags & (Flag.CALIBRATED | Flag.OFFSET_OK)


def test_a_calibrated_tag_keeps_what_its_correction_leaves():
    suits = [Suit(read_words(f"walk?calibrated=1&seed={seed}")) for seed in range(30)]
    left, offsets = [], []
    for suit in suits:
        for row, tag in enumerate(suit.firmware.tags):
            left.append(np.array(tag.correction.gain) @ suit.chips.matrix[row] - np.eye(3))
            offsets.append(np.array(tag.correction.offset) - suit.chips.offset[row])
    errors = np.array(left)

    assert np.diagonal(errors, axis1=1, axis2=2).std() == pytest.approx(RESIDUAL_GAIN, rel=0.1)
    assert errors[:, ~np.eye(3, dtype=bool)].std() == pytest.approx(RESIDUAL_AXES, rel=0.1)
    assert np.array(offsets).std() == pytest.approx(RESIDUAL_OFFSET, rel=0.1)


def test_a_calibrated_tag_at_rest_keeps_its_orientation_to_its_residual_offset_and_warmth():
    heard = listen("rest?calibrated=1", 60.0)

    for readings in heard.readings.values():
        assert readings[0].flags & Flag.CALIBRATED
        drift = np.degrees(rotation.angle_between(readings[0].orientation, readings[-1].orientation))
        # SD 0.005 °/s per axis: 4 sigma 1.2°; warming 0.15 K on average at 0.16 °/s/K on three axes: 2.5°
        assert drift < 4.0


def test_the_tag_slides_on_the_skin_in_phase_with_the_joint_and_by_two_degrees_at_the_end_of_its_range():
    suit = Suit(read_words("walk"))
    times = np.arange(15.0, 17.0, 0.005)
    carried = suit.scene.carried(times)
    rigid = rotation.multiply(carried.orientation, suit.chips.segment_from_sensor)

    slid = np.degrees(rotation.angle_between(rigid, suit.chips.sensors(times)[0]))
    assert slid == pytest.approx(2.0 * np.abs(carried.excursion), abs=1e-6)
    assert 0.8 < slid[:, PLACES.index(Place.RIGHT_SHANK)].max() < 1.0  # 60 of 135 degrees


def test_a_reading_beyond_the_range_is_clipped_and_flagged():
    fast = Listener("rest?tags=1", NO_ERRORS)
    fast.suit.chips.offset[:] = np.radians([2500.0, 0.0, 0.0])
    heard = fast.hear(1.0)

    for sample in measured(heard.samples[heard.sensor(Place.HEAD)]):
        assert np.degrees(sample.rate[0]) == pytest.approx(2000.0, abs=0.1)
        assert sample.flags & Flag.CLIPPED


def test_the_two_tables_differ_only_in_what_calibration_can_reach():
    assert CALIBRATED.accel_scale < DATA_SHEET.accel_scale
    assert CALIBRATED.gyro_per_g == pytest.approx(0.01 * DATA_SHEET.gyro_per_g)
    assert (CALIBRATED.gyro_scale, CALIBRATED.gyro_offset) == (0.03, 20.0 * DEGREE)
    assert CALIBRATED.soft_tissue == DATA_SHEET.soft_tissue == 2.0 * DEGREE


def test_a_running_product_is_the_product_one_by_one():
    turns = rotation.normalise(np.random.default_rng(1).normal(size=(37, 3, 4)))
    expected = [turns[0]]
    for turn in turns[1:]:
        expected.append(rotation.multiply(expected[-1], turn))

    assert running_product(turns) == pytest.approx(np.array(expected), abs=1e-12)


def test_coefficients_are_told_when_asked():
    listener = Listener("walk?tags=3&calibrated=1")
    listener.hear(1.0)
    listener.tell(ALL_TAGS, Command.REPORT_COEFFICIENTS)
    heard = listener.hear(1.0)

    for tag in heard.suit.firmware.tags:
        assert heard.tracker.infos[heard.sensor(PLACES[tag.number - 1])].correction == tag.correction
        assert tag.correction.gain[0][0] != 1.0


def test_an_uncalibrated_tag_tells_the_identity():
    listener = Listener("walk?tags=1&calibrated=0")
    listener.tell(ALL_TAGS, Command.REPORT_COEFFICIENTS)
    heard = listener.hear(1.0)

    correction = heard.tracker.infos[heard.sensor(Place.HEAD)].correction
    assert correction is not None
    assert correction.offset == (0.0, 0.0, 0.0)
    assert correction.gain == ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def test_only_the_tag_that_is_addressed_obeys():
    listener = Listener("walk?tags=3")
    listener.tell(listener.suit.firmware.tags[1].serial, Command.ASSIGN_NUMBER, bytes([9]))
    heard = listener.hear(1.0)

    assert [heard.readings[heard.sensor(place)][0].number for place in PLACES[:3]] == [1, 9, 3]


def test_the_offset_is_measured_at_rest_and_the_orientation_starts_anew():
    listener = Listener("rest?tags=2&calibrated=0")
    listener.hear(2.0)
    listener.tell(ALL_TAGS, Command.MEASURE_OFFSET)
    heard = listener.hear(10.5)

    for place in PLACES[:2]:
        last = heard.readings[heard.sensor(place)][-1]
        assert last.flags & Flag.OFFSET_OK
        # ten seconds at the offset's 0.005 °/s of noise from half a second, and 0.05 K at 0.16 °/s/K
        assert np.degrees(2 * np.arccos(min(abs(last.orientation[0]), 1.0))) < 0.6


def test_the_offset_is_not_measured_on_a_body_in_motion():
    listener = Listener("walk?tags=2&calibrated=0")
    listener.hear(15.0)
    listener.tell(ALL_TAGS, Command.MEASURE_OFFSET)
    heard = listener.hear(2.0)

    assert not any(readings[-1].flags & Flag.OFFSET_OK for readings in heard.readings.values())


def test_integrals_tell_the_whole_turns_of_the_box():
    listener = Listener("turns?tags=4", NO_ERRORS)
    listener.hear(9.0)
    listener.tell(ALL_TAGS, Command.START_INTEGRALS)
    heard = listener.hear(5.0)  # one turn, from 10.0 to 12.5 s

    for readings in heard.readings.values():
        facts = next(reading.facts for reading in reversed(readings) if reading.facts and "angle_x" in reading.facts)
        swept = np.linalg.norm([float(facts[f"angle_{axis}"]) for axis in "xyz"])
        assert np.degrees(swept) == pytest.approx(360.0, abs=4.0)  # the hand stops at 1° SD and wobbles
        assert int(facts["samples"]) == pytest.approx(5.0 * 200, abs=8)

    listener.tell(ALL_TAGS, Command.STREAM)
    heard = listener.hear(0.5)
    assert all(np.isfinite(readings[-2].rate[0]) or readings[-2].facts for readings in heard.readings.values())


def test_a_coefficient_is_set_and_survives_a_reboot_only_when_saved():
    listener = Listener("rest?tags=2&reboot=3@head&calibrated=0")
    head, chest = listener.suit.firmware.tags
    for row, value in ((0, 0.25), (3, 1.02)):
        listener.tell(ALL_TAGS, Command.COEFFICIENT, struct.pack("<Bf", row, value))
    listener.hear(1.0)
    assert head.correction.offset[0] == 0.25
    assert head.correction.gain[0][0] == pytest.approx(1.02)

    listener.hear(4.0)
    assert head.correction.gain[0][0] == 1.0
    assert chest.correction.gain[0][0] == pytest.approx(1.02)


def test_saved_coefficients_survive_a_reboot():
    listener = Listener("rest?tags=1&reboot=3&calibrated=0")
    listener.tell(ALL_TAGS, Command.COEFFICIENT, struct.pack("<Bf", 3, 1.02))
    listener.tell(ALL_TAGS, Command.SAVE)
    listener.hear(5.0)

    assert listener.suit.firmware.tags[0].correction.gain[0][0] == pytest.approx(1.02)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e30])
def test_a_coefficient_no_chip_needs_is_not_taken(value):
    listener = Listener("rest?tags=1&calibrated=0")
    listener.tell(ALL_TAGS, Command.COEFFICIENT, struct.pack("<Bf", 3, value))

    assert listener.suit.firmware.tags[0].correction.gain[0][0] == 1.0
    assert not listener.hear(0.5).malformed
