"""Counters and clocks wrap and drift; the time they stand for does not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core.timeline import ClockMap, SharedClock, nearest

TICK = 64e-6  # s, PROTOCOL.md 2.1
MODULUS = 1 << 24
FRAME = 0.02  # s


@given(st.integers(0, 10**9), st.integers(-127, 127))
def test_a_wrapped_counter_is_recovered_from_an_expectation_half_a_turn_off(true, error):
    assert nearest(true % 256, 256, true + error) == true


@pytest.mark.parametrize("modulus", [1 << 8, 1 << 16, 1 << 24, 1 << 32])
def test_ten_turns_of_any_counter_are_monotone(modulus):
    steps = np.arange(0, 10 * modulus, modulus // 7)

    found, last = [], 0
    for true in steps.tolist():
        last = nearest(true % modulus, modulus, last + modulus // 7)
        found.append(last)

    assert np.array_equal(np.array(found), steps)


def arrivals(
    seconds: float, skew_ppm: float, seed: int, slowest: float = 0.03
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return device times, true times and arrivals of a device that started 1,000 s ago here."""
    rng = np.random.default_rng(seed)
    true = 1000.0 + np.arange(0, seconds, FRAME)
    device = 5.0 + (true - 1000.0) * (1 + skew_ppm * 1e-6)
    delay = 0.002 + rng.exponential(slowest / 5, len(true)).clip(max=slowest)
    return device, true, true + delay


def observed(device: np.ndarray, received: np.ndarray) -> ClockMap:
    clock = ClockMap()
    for stamp, arrival in zip(device.tolist(), received.tolist(), strict=True):
        clock.observe(stamp, arrival)
    return clock


def test_the_map_is_usable_from_the_first_arrival():
    clock = observed(np.array([7.0]), np.array([1000.5]))

    assert clock.host(7.0) == pytest.approx(1000.5)
    assert clock.offset == pytest.approx(993.5)
    assert clock.skew == 0.0


def test_a_map_nobody_fed_is_our_own_mistake():
    with pytest.raises(ValueError, match="nothing observed"):
        ClockMap().host(1.0)


@pytest.mark.parametrize("skew", [-100.0, -20.0, 0.0, 40.0, 100.0])
def test_skew_is_found_through_the_jitter_of_the_transport(skew):
    device, true, received = arrivals(300.0, skew, seed=4)

    clock = observed(device, received)

    assert clock.skew == pytest.approx(skew, abs=2.0)  # 0.3 ms of envelope noise over 300 s are 1 ppm
    # The shortest delay, 2 ms, cannot be told from an offset.
    assert clock.host(float(device[-1])) == pytest.approx(true[-1] + 0.002, abs=0.001)


def test_delays_only_ever_make_packets_late():
    """Half of all packets held up by up to a second do not move the line."""
    device, true, received = arrivals(120.0, 30.0, seed=5)
    rng = np.random.default_rng(6)
    held_up = received + np.where(rng.random(len(received)) < 0.5, rng.uniform(0, 1, len(received)), 0)

    clock = observed(device, held_up)

    assert clock.host(float(device[-1])) == pytest.approx(true[-1] + 0.002, abs=0.002)
    assert clock.skew == pytest.approx(30.0, abs=5.0)


def test_the_first_packets_may_have_been_kept_waiting():
    device, true, received = arrivals(30.0, 0.0, seed=7)
    received[:25] = received[25]

    clock = observed(device, received)

    assert clock.host(float(device[-1])) == pytest.approx(true[-1] + 0.002, abs=0.001)


def test_the_line_follows_a_crystal_that_warms():
    """40 ppm at the start, 20 ppm after an hour: the line forgets what is older than five minutes."""
    rng = np.random.default_rng(8)
    true = np.arange(0, 3600.0, 0.1)
    rate = 1 + 1e-6 * (20 + 20 * np.exp(-true / 600))
    device = np.concatenate([[0.0], np.cumsum(rate[:-1] * 0.1)])
    received = true + 0.002 + rng.exponential(0.003, len(true))

    clock = observed(device, received)

    assert clock.skew == pytest.approx(1e6 * (rate[-1] - 1), abs=2.0)
    assert clock.host(float(device[-1])) == pytest.approx(true[-1] + 0.002, abs=0.001)


def ticks(seconds: float) -> int:
    return round(seconds / TICK)


def clock_at(seconds: float) -> int:
    return ticks(seconds) % MODULUS


def test_a_shared_clock_wraps_without_a_step():
    clock = SharedClock(MODULUS, TICK)
    start = MODULUS * TICK - 1.0

    times = [clock.time_of(clock_at(start + at), 50.0 + at) for at in np.arange(0, 3.0, FRAME).tolist()]

    assert np.allclose(np.diff(np.array(times, float)), FRAME, atol=1e-4)
    assert clock.restarts == 0


def test_a_silence_longer_than_a_turn_of_the_clock_is_bridged_by_arrivals():
    clock = SharedClock(MODULUS, TICK)
    clock.time_of(clock_at(5.0), 100.0)

    assert clock.time_of(clock_at(2505.0), 2600.0) == pytest.approx(2600.0, abs=1e-3)


def test_another_clock_is_told_apart_and_does_not_move_ours():
    clock = SharedClock(MODULUS, TICK)
    ours, strange = [], []

    for at in np.arange(0, 10.0, FRAME).tolist():
        ours.append(clock.time_of(clock_at(20.0 + at), 100.0 + at))
        strange.append(clock.time_of(clock_at(400.0 + at), 100.0 + at + 0.005))

    assert np.allclose(np.array(ours, float), 100.0 + np.arange(0, 10.0, FRAME), atol=1e-3)
    assert strange == [None] * len(strange)
    assert clock.restarts == 0


def test_a_receiver_that_started_anew_is_followed_again():
    clock = SharedClock(MODULUS, TICK)
    for at in np.arange(0, 10.0, FRAME).tolist():
        clock.time_of(clock_at(200.0 + at), 100.0 + at)

    after = [clock.time_of(clock_at(1.0 + at), 115.0 + at) for at in np.arange(0, 1.0, FRAME).tolist()]

    assert after[:2] == [None, None]
    assert np.allclose(np.array(after[2:], float), 115.0 + np.arange(0, 1.0, FRAME)[2:], atol=1e-3)
    assert clock.restarts == 1


def test_a_backlog_is_placed_when_it_was_measured():
    """Five seconds held up at once: each of them keeps its own time."""
    clock = SharedClock(MODULUS, TICK)
    for at in np.arange(0, 5.0, FRAME).tolist():
        clock.time_of(clock_at(20.0 + at), 100.0 + at)

    late = [clock.time_of(clock_at(25.0 + at), 110.0) for at in np.arange(0, 5.0, FRAME).tolist()]

    assert np.allclose(np.array(late, float), 105.0 + np.arange(0, 5.0, FRAME), atol=1e-3)
    assert clock.restarts == 0
