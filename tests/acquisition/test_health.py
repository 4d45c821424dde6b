"""How well a sensor is heard, in figures a person can act on."""

import math

import pytest

from studio.acquisition.health import SensorHealth
from studio.core.sample import SensorId

SENSOR = SensorId("tag:12345678")


def heard(times: list[float], delays: list[float] | None = None) -> SensorHealth:
    health = SensorHealth(SENSOR)
    for time, delay in zip(times, delays or [0.003] * len(times), strict=True):
        health.heard = time + delay
        health.count(time, time + delay)
    return health


@pytest.mark.parametrize("rate", [10, 50, 100, 200])
def test_the_rate_is_that_of_the_last_two_seconds(rate):
    health = heard([10 + k / rate for k in range(10 * rate)])

    assert health.rate(20.0) == pytest.approx(rate, rel=0.03)


def test_a_young_sensor_has_its_rate_at_once():
    assert heard([10 + k * 0.02 for k in range(10)]).rate(10.19) == pytest.approx(50, rel=0.08)


def test_the_rate_falls_when_the_sensor_falls_silent():
    health = heard([10 + k * 0.02 for k in range(500)])

    assert health.rate(21.0) == pytest.approx(25, rel=0.03)
    assert health.rate(23.0) == 0.0


def test_silence_is_counted_from_the_last_packet():
    health = heard([10.0, 10.02])

    assert health.silent_for(12.5) == pytest.approx(2.477)
    assert SensorHealth(SENSOR).silent_for(1.0) == math.inf


def test_an_even_transport_has_no_jitter_and_an_uneven_one_its_own():
    times = [10 + k * 0.02 for k in range(500)]

    assert heard(times).jitter == pytest.approx(0.0, abs=1e-9)
    assert heard(times, [0.003, 0.013] * 250).jitter == pytest.approx(0.01, rel=0.01)


def test_a_snapshot_stays_as_it_was():
    health = heard([10.0, 10.02])
    health.lost = 2
    health.refused, health.inconsistent = 3, 1

    before = health.snapshot(10.03)
    health.count(10.04, 10.043)

    assert (before.received, before.lost, before.malformed) == (2, 2, 4)
    assert before.loss == pytest.approx(0.5)
    assert math.isnan(before.battery)
