"""Tags on a table are measured by themselves; tags on a person never are."""

import math

import numpy as np
import pytest

from studio.capture.live_buffer import LiveBuffer
from studio.core.rest import Rest
from studio.core.sample import SensorId, SensorInfo
from studio.ui.models.rest_watch import MOST_LOOKS, NEEDED, RestWatch
from tests.acquisition.synthetic_suit import listen
from tests.ui.sensor_windows import info, sensor, window

EVERY = 0.25  # s


def watch_suit(words, seconds):
    """Return the watch, what it measured (moment and rest of each sensor), and the longest it held any, s."""
    samples = sorted((s for part in listen(words, seconds).samples.values() for s in part), key=lambda s: s.received)
    infos = {s.sensor: SensorInfo(s.sensor, 0.02) for s in samples}
    watch, buffer, longest, now = RestWatch(), LiveBuffer(), 0.0, 0.0
    measured: dict[SensorId, tuple[float, Rest]] = {}
    watch.rested.connect(lambda sensor, rest: measured.setdefault(sensor, (now, rest)))
    for now in np.arange(EVERY, seconds, EVERY):
        while samples and samples[0].received <= now:
            buffer.add(samples.pop(0))
        watch.feed(buffer.snapshot(list(infos), 11.0), infos)
        longest = max(longest, *(watch.progress(s).held for s in infos))
    return infos, measured, longest


def lying(watch, numbers, since, until, moved=()):
    """Let sensors lie from one moment to another; those that are ``moved`` are turned to and fro."""
    infos = {sensor(n): info(n) for n in numbers}
    for now in np.arange(since, until + 1e-9, EVERY):
        watch.feed({sensor(n): window(now, rate=20.0 if n in moved else 0.0) for n in numbers}, infos)


@pytest.mark.parametrize("loss", [0.0, 0.1, 0.5])
def test_tags_on_a_table_are_measured_in_ten_seconds_however_many_packets_are_lost(loss):
    infos, measured, _ = watch_suit(f"rest?seed=1&loss={loss}", 11.0)

    assert measured.keys() == infos.keys()
    assert all(NEEDED <= moment <= NEEDED + 2 * EVERY for moment, _ in measured.values())


def test_the_offset_is_what_the_gyroscope_says_at_rest():
    infos, measured, _ = watch_suit("rest?seed=1", 11.0)
    heard = listen("rest?seed=1", 11.0).samples

    for one in infos:
        moment, rest = measured[one]
        said = [sample.rate for sample in heard[one] if moment - NEEDED <= sample.time <= moment]
        # The same ten seconds, but for some samples at their ends; the offsets themselves are up to 20 °/s.
        np.testing.assert_allclose(np.degrees(rest.offset), np.degrees(np.nanmean(said, axis=0)), atol=0.005)
        assert 0 < math.degrees(rest.sigma.max()) < 0.02


@pytest.mark.parametrize("words", ["n?seed=3", "sit?seed=1", "walk?seed=1"])
def test_a_person_who_wears_the_tags_is_never_taken_for_a_table(words):
    _, measured, longest = watch_suit(words, 25.0)

    assert measured == {}
    assert longest < NEEDED / 4


def test_a_tag_that_moves_starts_anew_and_only_that_one(qtbot):
    watch = RestWatch()
    lying(watch, [1, 2], 2.0, 7.0)
    both = watch.progress(sensor(1)).held, watch.progress(sensor(2)).held

    lying(watch, [1, 2], 7.25, 7.75, moved=[2])

    assert both[0] == both[1] > 4.0
    assert watch.progress(sensor(1)).held == pytest.approx(both[0] + 0.75)
    assert watch.progress(sensor(2)).held == 0.0
    assert watch.is_still(sensor(1)) is True
    assert watch.is_still(sensor(2)) is False


def test_what_was_measured_stays_when_the_tag_is_put_on():
    watch = RestWatch()
    told = []
    watch.rested.connect(lambda one, rest: told.append(one))
    lying(watch, [1], 2.0, 13.0)

    lying(watch, [1], 13.25, 20.0, moved=[1])
    lying(watch, [1], 20.25, 40.0)

    assert told == [sensor(1)]
    assert watch.progress(sensor(1)).share == 1.0
    assert watch.done() == 1


def test_a_measurement_can_be_repeated_and_forgotten():
    watch = RestWatch()
    told = []
    watch.rested.connect(lambda one, rest: told.append(one))
    lying(watch, [1], 2.0, 13.0)

    watch.repeat(sensor(1))
    assert watch.progress(sensor(1)).rest is None
    lying(watch, [1], 13.25, 24.0)
    watch.forget()

    assert told == [sensor(1), sensor(1)]
    assert watch.done() == 0
    assert watch.is_still(sensor(1)) is None


def test_a_pause_in_the_samples_starts_anew():
    watch = RestWatch()
    lying(watch, [1], 2.0, 8.0)

    watch.feed({sensor(1): window(8.25, missing=range(450, 500))}, {sensor(1): info(1)})

    assert watch.progress(sensor(1)).held < 1.5


def test_a_sensor_without_a_gyroscope_is_left_out():
    watch = RestWatch()
    watch.feed({sensor(1): window(12.0)}, {sensor(1): info(1, has_rate=False)})

    assert watch.is_still(sensor(1)) is None


def test_many_sensors_are_looked_at_in_turn():
    watch = RestWatch()
    numbers = range(1, 2 * MOST_LOOKS - 1)

    lying(watch, numbers, 2.0, 14.0)

    assert watch.done() == len(numbers)
