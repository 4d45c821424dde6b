"""The errors of simulated tags are those of the printed table, and end where a calibration reaches them."""

import numpy as np
import pytest

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
from studio.core.sample import Flag
from tests.acquisition.synthetic_suit import Listener, listen, measured


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
