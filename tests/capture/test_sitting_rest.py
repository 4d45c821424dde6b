"""The rest of tags that are worn: asked only when missing, 5 s, worth less than a rest on a table."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.capture.procedures.sitting_rest import KNOWN, SETTLE, SITTING, Phase, Readings, SittingRest, is_missing
from studio.core.frames import GRAVITY, UP
from studio.core.sample import Correction, Flag, SensorId, SensorInfo
from studio.core.take import Calibration

FRAME = 0.02
OFFSET = np.radians([3.0, -2.0, 5.0])
ONE, TWO = SensorId("tag:00000001"), SensorId("tag:00000002")


def readings(sway, seed=0, seconds=SITTING):
    """What a tag says on somebody who sways by ``sway`` (SD, rad) about once in two seconds."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds / FRAME)) * FRAME
    phases = rng.uniform(0, 2 * np.pi, 3)
    angle = sway * np.sqrt(2) * np.sin(2 * np.pi * 0.5 * time[:, None] + phases)
    rate = OFFSET + np.gradient(angle, FRAME, axis=0) + rng.normal(0, np.radians(0.05), angle.shape)
    return Readings(rate, np.tile(UP * GRAVITY, (len(time), 1)) + rng.normal(0, 0.03, angle.shape))


def sat(sensors, said):
    rest = SittingRest()
    rest.start(0.0, sensors)
    assert not rest.tick(SITTING)
    assert rest.tick(SITTING + SETTLE)
    return rest, rest.judge(said)


def test_sitting_still_finds_the_offset_within_what_it_says_it_is_worth():
    _, found = sat({ONE: FRAME}, {ONE: readings(np.radians(0.2))})

    assert np.all(np.abs(found[ONE].offset - OFFSET) < 3 * found[ONE].sigma)
    assert found[ONE].sigma.max() > np.radians(0.03)  # a table is better
    assert found[ONE].sigma.max() <= KNOWN


def test_who_fidgets_is_asked_again_and_nobody_else():
    said = {ONE: readings(np.radians(0.1)), TWO: readings(np.radians(8.0))}
    rest, found = sat({ONE: FRAME, TWO: FRAME}, said)
    assert set(found) == {ONE}
    assert rest.moved == (TWO,)

    rest.again(10.0)
    rest.tick(10.0 + SITTING + SETTLE)
    again = rest.judge({TWO: readings(np.radians(0.1), seed=1)})

    assert set(again) == {TWO}
    assert set(rest.found) == {ONE, TWO}
    assert rest.moved == ()


def test_a_tag_that_sent_half_of_the_time_has_no_rest():
    rest, found = sat({ONE: FRAME}, {ONE: readings(0.0, seconds=2.5)})

    assert found == {}
    assert rest.moved == (ONE,)


def test_a_tag_that_sent_nothing_ends_the_waiting():
    rest = SittingRest()
    rest.start(0.0, {ONE: FRAME})
    rest.tick(SITTING + SETTLE)

    rest.tick(60.0)

    assert (rest.phase, rest.moved) == (Phase.JUDGED, (ONE,))


@pytest.mark.parametrize(
    ("flags", "calibration", "missing"),
    [
        (0, None, True),
        (Flag.OFFSET_OK, None, False),
        (Flag.CALIBRATED, None, False),
        (
            0,
            Calibration(
                ONE,
                Correction((0.0, 0.0, 0.0), ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))),
                "2025-01-01T00:00:00+00:00",
                "rest",
                offset_sigma=(math.radians(0.3),) * 3,
            ),
            False,
        ),
    ],
)
def test_a_rest_is_asked_only_of_tags_whose_offset_nobody_knows(flags, calibration, missing):
    assert is_missing(SensorInfo(ONE, FRAME), flags, calibration) == missing


@given(
    st.lists(st.tuples(st.sampled_from(["start", "again", "tick", "cancel", "judge"]), st.floats(0, 8)), max_size=40)
)
def test_any_order_of_events_leaves_a_legal_state(events):
    rest = SittingRest()
    now, due = 0.0, False
    for event, passed in events:
        now += passed
        if event == "start":
            rest.start(now, {ONE: FRAME})
        elif event == "again":
            rest.again(now)
        elif event == "tick":
            wanted = rest.tick(now)
            assert not (wanted and due and rest.phase is not Phase.READING)
            due = wanted or (due and rest.phase is Phase.READING)
        elif event == "cancel":
            rest.cancel()
        else:
            reading = rest.phase is Phase.READING
            assert rest.judge({}) == {}
            assert not reading or rest.phase is Phase.JUDGED
        assert set(rest.moved) <= set(rest.wanted)
        assert 0.0 <= rest.progress(now) <= 1.0
