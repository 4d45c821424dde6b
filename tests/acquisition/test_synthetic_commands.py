"""Simulated tags obey what a receiver tells them: coefficients, offsets, integrals; and forget what was not saved."""

import struct

import numpy as np
import pytest

from studio.acquisition.dialects.tag_advert import ALL_TAGS, Command
from studio.acquisition.synthetic.errors_table import (
    NO_ERRORS,
)
from studio.core.body import PLACES, Place
from studio.core.sample import Flag
from tests.acquisition.synthetic_suit import Listener


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
