"""Stillness, and the offset of the gyroscope in it."""

import numpy as np
import pytest

from studio.core.frames import GRAVITY
from studio.core.rest import RATE_SPREAD_TABLE, RATE_SPREAD_WORN, Rest, combine, find_rest

FRAME = 0.02
OFFSET = np.radians([12.0, -7.0, 19.0])


NOISE = np.radians(0.2)  # rad/s; quantised quaternions 20 ms apart


def found(rate, force, spread=RATE_SPREAD_TABLE) -> Rest:
    rest = find_rest(rate, force, FRAME, spread)
    assert rest is not None
    return rest


def lying(seconds, rng):
    n = round(seconds / FRAME)
    return OFFSET + NOISE * rng.normal(size=(n, 3)), np.tile([0.0, 0.0, GRAVITY], (n, 1)) + 0.02 * rng.normal(
        size=(n, 3)
    )


def waving(seconds, rng):
    n = round(seconds / FRAME)
    t = np.arange(n) * FRAME
    rate = OFFSET + np.radians(80) * np.sin(np.outer(t, [4.0, 5.0, 6.0]))
    return rate, GRAVITY * np.stack([np.sin(t), np.zeros(n), np.cos(t)], axis=1)


def test_the_offset_of_a_tag_on_the_table_is_found_between_two_movements():
    rng = np.random.default_rng(0)
    parts = [waving(3, rng), lying(8, rng), waving(3, rng)]
    rate, force = (np.concatenate(column) for column in zip(*parts, strict=True))

    rest = found(rate, force)

    assert rest.first * FRAME == pytest.approx(3, abs=0.3)
    assert rest.last * FRAME == pytest.approx(11, abs=0.3)
    assert (np.abs(rest.offset - OFFSET) < 4 * rest.sigma).all()


def test_the_stated_uncertainty_covers_the_error_as_often_as_it_says():
    errors = []
    for seed in range(200):
        rest = found(*lying(6, np.random.default_rng(seed)))
        errors.append((rest.offset - OFFSET) / rest.sigma)

    covered = np.mean(np.abs(np.array(errors)) < 2)
    assert 0.90 < covered < 0.97  # 95 % for a normal distribution, a little less with 24 block means


def test_a_person_standing_still_is_at_rest_only_when_that_is_asked_for():
    rng = np.random.default_rng(1)
    rate, force = lying(8, rng)
    t = np.arange(len(rate)) * FRAME
    rate = rate + np.radians(1.0) * np.sin(2 * np.pi * 0.4 * t)[:, None]

    assert find_rest(rate, force, FRAME, RATE_SPREAD_TABLE) is None
    worn = found(rate, force, RATE_SPREAD_WORN)
    assert worn.sigma.max() > np.radians(0.1)  # sway is part of the uncertainty


def swaying(seconds, rng):
    """Somebody stands: 0.5° of smooth sway, a way of a second or two from side to side, on top of the offset."""
    kernel = np.exp(-0.5 * (np.arange(-140, 141) * FRAME / 0.7) ** 2)
    kernel *= np.radians(0.5) / np.sqrt((kernel**2).sum())
    count = round(seconds / FRAME) + 1
    angle = np.stack([np.convolve(rng.normal(size=count + 280), kernel, "valid") for _ in range(3)], axis=1)
    return OFFSET + np.diff(angle, axis=0) / FRAME, np.tile([0.0, 0.0, GRAVITY], (count - 1, 1))


@pytest.mark.parametrize("seconds", [5.0, 8.0])
def test_standing_the_stated_uncertainty_covers_the_error_and_is_not_much_more(seconds):
    """Block means of one who sways are not independent: type A alone covers 78 and 89 % of these."""
    errors, sigmas = [], []
    for seed in range(150):
        rate, force = swaying(seconds, np.random.default_rng(seed))
        rest = found(rate, force, RATE_SPREAD_WORN)
        errors.append(rest.offset - OFFSET)
        sigmas.append(rest.sigma)

    covered = np.mean(np.abs(np.array(errors)) < 2 * np.array(sigmas))
    assert covered > 0.94
    assert np.median(sigmas) < 2.5 * np.sqrt(np.mean(np.array(errors) ** 2))


def test_turning_steadily_is_not_rest():
    n = 500
    t = np.arange(n) * FRAME
    rate = np.tile(np.radians([15.0, 0, 0]), (n, 1))
    force = GRAVITY * np.stack([np.zeros(n), np.sin(np.radians(15) * t), np.cos(np.radians(15) * t)], axis=1)

    assert find_rest(rate, force, FRAME) is None


def test_less_than_two_seconds_are_too_few():
    rate, force = lying(1.5, np.random.default_rng(2))

    assert find_rest(rate, force, FRAME) is None


def test_more_than_the_data_sheet_allows_is_turning_and_not_offset():
    rate, force = lying(6, np.random.default_rng(3))

    assert find_rest(rate + np.radians(30), force, FRAME) is None


def test_a_poor_rest_moves_a_good_prior_only_a_little():
    offset, sigma = combine(np.full(3, 1.0), np.full(3, 1.0), prior_sigma=0.1)

    np.testing.assert_allclose(offset, 1.0 / 101)
    np.testing.assert_allclose(sigma, 0.1 / np.sqrt(1.01))
