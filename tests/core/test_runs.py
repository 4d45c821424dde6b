"""From a stream with holes to what a filter steps through: nothing is invented, and nothing twice corrected."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.frames import GRAVITY
from studio.core.runs import chained, is_bridged, recorrect, runs_of, steps_across
from studio.core.sample import Correction, Flag, SensorId, SensorInfo
from tests.core.altered_takes import kept
from tests.core.worn_sensors import RATE, stream

FRAME = 1 / RATE
TIME = np.arange(500) / RATE
ID = SensorId("tag:00000001")
GAIN = ((1.03, 0.01, 0.0), (0.0, 0.97, -0.02), (0.005, 0.0, 1.01))
OFFSET = (0.1, -0.2, 0.05)


def swinging(info=None):
    """A sensor that swings about all axes."""
    angles = np.radians([40.0, 25.0, 60.0]) * np.sin(np.outer(TIME, [3.0, 4.0, 2.0]))
    return stream(ID, rotation.from_rotation_vector(angles), TIME, info=info)


def turned(runs):
    return np.concatenate([run.increments[1:] for run in runs]).sum(axis=0)


def test_a_correction_on_the_tag_is_undone_before_another_is_applied():
    """The rate a chip read, corrected by hand in two ways: the tag's way and back gives the wanted one."""
    read = np.random.default_rng(0).normal(size=(20, 3))
    applied = Correction((0.3, 0.1, -0.2), ((1.1, 0.02, 0.0), (0.0, 0.9, 0.03), (-0.01, 0.0, 1.05)))
    by_tag = (read - np.array(applied.offset)) @ np.array(applied.gain).T

    found = recorrect(by_tag * FRAME, FRAME, applied, Correction(OFFSET, GAIN))

    np.testing.assert_allclose(found / FRAME, (read - np.array(OFFSET)) @ np.array(GAIN).T, atol=1e-12)


def test_a_correction_that_is_in_force_already_changes_nothing():
    increments = np.random.default_rng(1).normal(size=(20, 3)) * FRAME
    same = Correction(OFFSET, GAIN)

    np.testing.assert_allclose(recorrect(increments, FRAME, same, same), increments, atol=1e-12)


def test_a_packet_that_tells_of_the_tag_is_bridged_and_not_lost():
    """One in 50 says what the tag is, some say its coefficients and have no orientation: the radio lost nothing."""
    sent = swinging()
    orientation, flags = sent.orientation.copy(), sent.flags.copy()
    orientation[[100, 300]] = np.nan
    flags[[100, 200, 300]] = Flag.FILLED
    told = replace(sent, orientation=orientation, flags=flags)

    (run,) = runs_of(kept(told, np.arange(500) != 400), None)

    assert np.flatnonzero(run.lost).tolist() == [400]
    whole = runs_of(sent, None)
    assert rotation.angle_between(run.orientation[300], sent.orientation[300]) < np.radians(0.2)  # between neighbours
    np.testing.assert_allclose(turned([run]), turned(whole), atol=0.01)


def test_samples_of_a_broken_chip_say_nothing_about_turning():
    sent = swinging()
    orientation, flags = sent.orientation.copy(), sent.flags.copy()
    orientation[250] = rotation.from_rotation_vector([2.0, 1.0, 0.0])
    flags[250] = Flag.IMU_ERROR

    (run,) = runs_of(replace(sent, orientation=orientation, flags=flags), None)

    assert np.linalg.norm(run.increments, axis=1).max() < np.radians(200) * FRAME
    assert run.lost[250]


@pytest.mark.parametrize("row", [0, 250, 499])
def test_one_orientation_that_is_no_number_is_one_row(row):
    """A source with a gyroscope and an orientation of its own: the others stand."""
    info = SensorInfo(ID, FRAME, orientation="world")
    sent = swinging(info)
    orientation = sent.orientation.copy()
    orientation[row] = np.nan

    (run,) = runs_of(replace(sent, orientation=orientation), None)

    others = np.arange(500) != row
    assert rotation.angle_between(run.orientation[others], sent.orientation[others]).max() < 1e-9
    assert rotation.angle_between(run.orientation[row], sent.orientation[row]) < np.radians(5)


def test_a_second_of_silence_is_bridged_whatever_the_clock_says_about_it():
    assert is_bridged(1.0, FRAME)
    assert is_bridged(1.0 + 1e-9, FRAME)
    assert not is_bridged(1.0 + FRAME, FRAME)
    sent = swinging()
    for silent, runs in ((50, 1), (51, 2)):
        rows = (np.arange(500) <= 100) | (np.arange(500) >= 100 + silent)
        assert len(runs_of(kept(sent, rows), None)) == runs


def test_a_chain_leads_across_a_silence_by_the_sensors_own_quaternion():
    sent = swinging()
    before, after = runs_of(kept(sent, (sent.time < 3.0) | (sent.time >= 6.0)), None)

    chain = chained(before, after, sent.info, None)

    across = rotation.IDENTITY
    for increment in chain.increments[len(before.time) : -len(after.time) + 1 or None]:
        across = rotation.multiply(across, rotation.from_rotation_vector(increment))
    meant = rotation.multiply(rotation.inverse(before.orientation[-1]), after.orientation[0])
    assert rotation.angle_between(across, meant) < 1e-9
    assert chain.silent.sum() == steps_across(3.0, FRAME) - 1 == 49
    assert np.isnan(chain.acceleration[chain.silent]).all()
    assert (np.diff(chain.time) > 0).all()
    assert np.linalg.norm(chain.acceleration[~chain.silent], axis=1) == pytest.approx(GRAVITY)


def test_what_a_chain_turns_in_a_silence_is_corrected_for_all_of_its_time():
    """A tag at rest with a raw offset: corrected, it did not turn in three seconds of silence."""
    still = np.tile(rotation.IDENTITY, (len(TIME), 1))
    sent = stream(ID, still, TIME, bias=OFFSET)
    wanted = Correction(OFFSET, ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
    before, after = runs_of(kept(sent, (sent.time < 3.0) | (sent.time >= 6.0)), wanted)

    chain = chained(before, after, sent.info, wanted)

    assert np.abs(chain.increments).max() < 1e-9
