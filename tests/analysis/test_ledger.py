"""The account of a sensor's samples."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio.analysis.ledger import ledger
from studio.core.body import PRESETS
from studio.core.sample import NO_CORRECTION, Flag
from studio.core.take import Calibration, Take
from tests.core.worn_sensors import worn_take


def taken(rows: slice, skew_ppm: float = 0.0) -> Take:
    """Return a take of one sensor whose clock is quicker than the computer's, and whose arrivals are late by chance."""
    whole, _ = worn_take(PRESETS["lower"], 30.0)
    stream = whole.streams[0]
    late = np.random.default_rng(0).exponential(1e-3, len(stream))
    values = {name: getattr(stream, name)[rows] for name in stream.__dataclass_fields__ if name != "info"}
    values["device_time"] = values["time"] * (1.0 + skew_ppm * 1e-6)
    values["received"] = values["time"] + late[rows]
    return replace(whole, streams=(replace(stream, **values),))


def test_the_skew_of_a_clock_is_told_from_the_quickest_arrivals() -> None:
    (account,) = ledger(taken(slice(None), skew_ppm=200.0))

    assert account.clock_skew_ppm == pytest.approx(-200.0, abs=20.0)  # 1 ms of lateness in 30 s is 33 ppm


@pytest.mark.parametrize("step", [400, 100])
def test_too_few_samples_tell_nothing_of_a_clock(step: int) -> None:
    (account,) = ledger(taken(slice(0, None, step)))

    assert math.isnan(account.clock_skew_ppm)


@pytest.mark.parametrize(("flags", "said"), [(0, "2026-11-24"), (Flag.CALIBRATED, "in the tag")])
def test_a_stored_calibration_is_said_to_correct_only_where_it_does(flags: int, said: str) -> None:
    """A tag that corrects by itself and did not tell how is not corrected a second time."""
    take = taken(slice(None))
    tag = replace(take.streams[0].info, orientation="integrated", correction=None)
    stream = replace(take.streams[0], info=tag, flags=np.full(len(take.streams[0]), flags, np.uint32))
    stored = Calibration(tag.sensor, NO_CORRECTION, "2026-11-24", "rest")

    (account,) = ledger(replace(take, streams=(stream,), setup=replace(take.setup, calibrations=(stored,))))

    assert account.calibration == said


def test_lost_frames_that_count_as_measured_are_told_from_those_of_long_silences() -> None:
    """Stretches of 3 and 40 frames of 20 ms are bridged; a silence of two seconds is none of them."""
    whole = taken(slice(None))
    away = [*range(100, 103), *range(500, 540), *range(1000, 1200)]
    present = np.setdiff1d(np.arange(len(whole.streams[0])), away)
    stream = whole.streams[0]
    values = {name: getattr(stream, name)[present] for name in stream.__dataclass_fields__ if name != "info"}

    (account,) = ledger(replace(whole, streams=(replace(stream, **values),)))

    assert account.lost == 243
    assert account.bridged_share == pytest.approx(43 / (len(stream) - 200))
