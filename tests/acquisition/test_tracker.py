"""Readings become samples: numbered without a wrap, placed in time, each once, and nothing lost uncounted.

Faults F22 to F25 of the design's table: order, repeats, wraps, restarts, loss.
"""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.acquisition.dialects import tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.core.sample import Flag
from tests.acquisition.tracked_tags import SENSOR, TICK, Tag, bursty, frames, kinds, link, samples
from tests.acquisition.wire_vectors import VECTORS


@pytest.mark.parametrize("vector", VECTORS["streams"], ids=lambda v: v["name"])
def test_the_streams_of_the_protocol_are_numbered_as_it_says(vector):
    tracker = link()
    readings = [tag_advert.decode(bytes.fromhex(advert), SENSOR) for advert in vector["adverts"]]

    found = samples(
        tracker,
        (
            (r, 50.0 + k * vector["frame_s"])
            for r, k in zip(readings, vector["frames"], strict=True)
            if isinstance(r, Reading)
        ),
    )

    first = found[0]
    assert [s.frame - first.frame for s in found] == vector["frames"]
    times = [k * vector["frame_s"] for k in vector["frames"]]
    assert [s.device_time - first.device_time for s in found] == pytest.approx(times, abs=TICK)
    assert [s.time - first.time for s in found] == pytest.approx(times, abs=TICK)
    health = tracker.health[SENSOR]
    assert health.lost == vector["frames"][-1] + 1 - len(found)
    assert tracker.infos[SENSOR].frame_s == vector["frame_s"]


def test_counters_and_clocks_are_monotone_over_ten_turns_of_the_clock():
    """Three hours at one packet in two seconds: the counter turns 2,100 times, the clock ten times."""
    tracker = link()

    found = samples(tracker, Tag(skew_ppm=40).heard(range(0, 540_000, 100)))

    assert frames(found) == list(range(0, 540_000, 100))
    assert all(b.device_time > a.device_time and b.time > a.time for a, b in pairwise(found))
    assert found[-1].device_time - found[0].device_time == pytest.approx(539_900 * 0.02 * (1 + 40e-6), abs=TICK)
    assert tracker.health[SENSOR].skew == pytest.approx(40.0, abs=0.5)
    assert tracker.health[SENSOR].reboots == 0


def test_a_silence_longer_than_a_turn_of_the_clock_is_counted_exactly():
    tracker = link()

    found = samples(tracker, Tag(skew_ppm=-50).heard([0, 1, 2, 100_000, 100_001]))

    assert frames(found) == [0, 1, 2, 100_000, 100_001]
    assert tracker.health[SENSOR].lost == 99_997
    assert kinds(tracker) == ["found", "gap"]


@given(st.permutations(range(8)), st.integers(0, 7))
def test_any_order_within_the_window_gives_every_sample_once_and_nothing_lost(order, repeated):
    tracker, tag = link(), Tag()
    before, after = list(range(20)), list(range(28, 40))
    sent = before + [20 + k for k in order] + [20 + repeated] + after

    found = samples(tracker, ((tag.reading(k), 100.0 + i * 0.02) for i, k in enumerate(sent)))

    in_order = sorted(found, key=lambda s: s.frame)
    assert frames(in_order) == list(range(40))
    assert all(b.time > a.time and b.device_time > a.device_time for a, b in pairwise(in_order))
    health = tracker.health[SENSOR]
    assert (health.received, health.lost, health.duplicates, health.reboots) == (40, 0, 1, 0)


def test_a_repeat_is_dropped_and_counted():
    tracker, tag = link(), Tag()
    heard = [item for item in tag.heard(range(50)) for _ in range(3)]

    found = samples(tracker, heard)

    assert frames(found) == list(range(50))
    assert (tracker.health[SENSOR].duplicates, tracker.health[SENSOR].lost) == (100, 0)


def test_what_comes_later_than_the_window_stays_lost():
    tracker, tag = link(), Tag()
    order = [*range(10), *range(11, 30), 10, *range(30, 40)]

    found = samples(tracker, ((tag.reading(k), 100.0 + i * 0.02) for i, k in enumerate(order)))

    assert 10 not in frames(found)
    assert (tracker.health[SENSOR].lost, tracker.health[SENSOR].late) == (1, 0)


@pytest.mark.parametrize("loss", [0.0, 0.05, 0.3])
def test_loss_is_counted_exactly(loss):
    tracker = link()
    kept = bursty(20_000, loss, seed=1)

    samples(tracker, Tag().heard(kept))

    assert tracker.health[SENSOR].received == len(kept)
    assert tracker.health[SENSOR].lost == kept[-1] - kept[0] + 1 - len(kept)


@pytest.mark.parametrize("frame_s", [0.02, 0.01, 0.0125, 0.005])
@pytest.mark.parametrize("skew", [-200.0, 0.0, 200.0])
@pytest.mark.parametrize("flags", [0, Flag.TIME_SYNCED.value])
def test_loss_in_bursts_skew_and_jitter_are_never_taken_for_a_restart(frame_s, skew, flags):
    """Ten minutes each: 30 % lost in bursts of up to seconds, delays of up to 300 ms, three silences of a minute."""
    tracker, tag = link(), Tag(frame_s=frame_s, skew_ppm=skew, flags=flags)
    rng = np.random.default_rng(2)
    silences = [(at, at + 60) for at in (50, 250, 450)]
    kept = [
        k
        for k in bursty(round(600 / frame_s), 0.3, seed=3, mean_burst=30.0)
        if not any(a < k * frame_s < b for a, b in silences)
    ]
    delays = rng.exponential(0.01, len(kept)).clip(max=0.3)
    arrivals = np.maximum.accumulate(np.array([tag.measured(k) for k in kept]) + delays)

    found = samples(tracker, ((tag.reading(k), at) for k, at in zip(kept, arrivals.tolist(), strict=True)))

    health = tracker.health[SENSOR]
    assert (health.reboots, health.inconsistent, health.duplicates) == (0, 0, 0)
    assert frames(found) == [k - kept[0] + found[0].frame for k in kept]
    assert {s.epoch for s in found} == {0}
    assert health.skew == pytest.approx(skew, abs=5.0)
    assert found[-1].time == pytest.approx(tag.measured(kept[-1]), abs=0.005)


@pytest.mark.long
def test_a_day_with_loss_and_a_drifting_crystal_has_no_false_restart():
    tracker, tag = link(), Tag(skew_ppm=40)
    rng = np.random.default_rng(4)
    kept = bursty(24 * 3600 * 50, 0.3, seed=5)
    delays = rng.exponential(0.01, len(kept)).clip(max=0.3)
    arrivals = np.maximum.accumulate(100.0 + np.array(kept) * 0.02 + delays)

    for k, at in zip(kept, arrivals.tolist(), strict=True):
        tracker.accept(tag.reading(k), at)

    health = tracker.health[SENSOR]
    assert (health.reboots, health.inconsistent, health.received) == (0, 0, len(kept))
    assert health.lost == kept[-1] - kept[0] + 1 - len(kept)


def test_a_frame_of_ten_milliseconds_is_recognised_from_the_second_packet():
    tracker = link()

    samples(tracker, Tag(frame_s=0.01).heard([5, 8]))

    assert tracker.infos[SENSOR].frame_s == 0.01
