"""Readings become samples: numbered without a wrap, placed in time, each once, and nothing lost uncounted.

Faults F22 to F25 of the design's table: order, repeats, wraps, restarts, loss.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.acquisition.dialects import tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.tracker import MOST_SENSORS, LinkTracker
from studio.core.sample import Correction, Flag, Sample, SensorId
from tests.acquisition.wire_vectors import VECTORS

SENSOR = tag_advert.sensor_of(0x12345678)
TICK, CLOCKS = tag_advert.TRAITS.clock_tick, tag_advert.TRAITS.clock_modulus
ROWS = ((0.01, 0.02, -0.03), (1.02, 0.0, 0.0), (0.01, 0.98, 0.0), (0.0, 0.0, 1.01))


@dataclass(frozen=True)
class Tag:
    """A tag as the radio hears it."""

    sensor: SensorId = SENSOR
    number: int = 3
    frame_s: float = 0.02
    powered: float = 100.0
    """s on this computer's clock when its counter was 0."""
    clock: float = 0.0
    """s its clock shows at that moment."""
    skew_ppm: float = 0.0
    flags: int = 0
    delay: float = 0.003
    """s from measuring to arriving."""

    def reading(self, frame: int, **other: Any) -> Reading:
        stamp = self.clock + frame * self.frame_s * (1 + self.skew_ppm * 1e-6)
        clock = int(stamp / TICK) % CLOCKS
        fields: dict[str, Any] = {
            "orientation": (1.0, 0.0, 0.0, 0.0),
            "rate": (0.1, 0.2, 0.3),
            "acceleration": (0.0, 0.0, 9.8),
        }
        fields |= other
        return Reading(
            self.sensor,
            self.number,
            frame % 256,
            clock,
            fields["orientation"],
            fields["rate"],
            fields["acceleration"],
            self.flags,
            0.75,
            fields.get("temperature", float("nan")),
            -60.0,
            fields.get("facts"),
        )

    def measured(self, frame: int) -> float:
        """Return when a frame was measured, s on this computer's clock."""
        return self.powered + frame * self.frame_s

    def heard(self, frames: Iterable[int]) -> Iterator[tuple[Reading, float]]:
        for frame in frames:
            yield self.reading(frame), self.measured(frame) + self.delay


def link() -> LinkTracker:
    return LinkTracker("receiver", tag_advert.TRAITS)


def samples(tracker: LinkTracker, heard: Iterable[tuple[Reading, float]]) -> list[Sample]:
    accepted = (tracker.accept(reading, received) for reading, received in heard)
    return [sample for sample in accepted if sample is not None]


def frames(found: list[Sample]) -> list[int]:
    return [sample.frame for sample in found]


def kinds(tracker: LinkTracker) -> list[str]:
    return [kind for kind, _ in tracker.take_events()]


def bursty(n: int, loss: float, seed: int, mean_burst: float = 8.0) -> list[int]:
    """Return the frames of ``n`` that a channel with bursts of loss lets through (Gilbert)."""
    rng = np.random.default_rng(seed)
    leave, enter = 1 / mean_burst, loss / (1 - loss) / mean_burst
    bad, kept = False, []
    for frame, draw in enumerate(rng.random(n).tolist()):
        bad = draw >= leave if bad else draw < enter
        if not bad:
            kept.append(frame)
    return kept


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


@pytest.mark.parametrize("was_on", [0.5, 3.0, 77.7, 1100.0])
@pytest.mark.parametrize("was_off", [0.3, 2.0, 30.0])
@pytest.mark.parametrize("loss", [0.0, 0.3])
def test_a_restart_is_another_epoch_and_time_goes_on(was_on, was_off, loss):
    tracker, tag = link(), Tag()
    on = round(was_on / tag.frame_s)
    again = replace(tag, powered=tag.measured(on) + was_off)
    kept = bursty(200, loss, seed=9, mean_burst=2.0)

    before = samples(tracker, tag.heard(range(on)))
    after = samples(tracker, again.heard(kept))

    assert {s.epoch for s in before} == {0}
    assert {s.epoch for s in after} == {1}
    assert after[0].received - (again.measured(kept[0]) + again.delay) <= 0.5  # F24: found within half a second
    assert all(b.frame > a.frame and b.time > a.time for a, b in pairwise([*before, *after]))
    passed = after[0].time - before[-1].time
    assert (after[0].frame - before[-1].frame) * tag.frame_s == pytest.approx(passed, abs=0.5 * tag.frame_s)
    assert after[0].device_time - before[-1].device_time == pytest.approx(passed, abs=0.01)
    assert tracker.health[SENSOR].reboots == 1
    assert kinds(tracker).count("reboot") == 1


def test_a_restart_is_found_though_the_tag_is_hardly_heard():
    tracker, tag = link(), Tag()
    samples(tracker, tag.heard(range(5000)))

    after = samples(tracker, replace(tag, powered=205.0).heard(range(7, 1000, 100)))

    assert {s.epoch for s in after} == {1}
    assert len(after) == 8


@pytest.mark.parametrize("counter", range(3, 253, 7))
def test_a_synchronised_tag_that_restarted_unheard_is_told_by_its_counter(counter):
    """By the first packet heard it follows its receiver again, so only the counter jumped."""
    tracker, tag = link(), Tag(clock=50.0, flags=Flag.TIME_SYNCED)
    samples(tracker, tag.heard(range(512)))
    again = (
        (tag.reading(frame)._replace(sequence=(frame + counter) % 256), tag.measured(frame) + tag.delay)
        for frame in range(712, 800)
    )

    after = samples(tracker, again)

    assert {s.epoch for s in after} == {1}
    assert tracker.health[SENSOR].reboots == 1


@pytest.mark.parametrize("step", [-400.0, -0.9, -0.3, -0.05, 0.05, 0.3, 0.9, 400.0])
def test_a_clock_set_by_any_amount_on_hearing_a_receiver_is_no_restart(step):
    tracker, tag = link(), Tag(clock=450.0)
    synced = replace(tag, clock=tag.clock + step, flags=Flag.TIME_SYNCED)

    found = samples(tracker, [*tag.heard(range(100)), *synced.heard(range(100, 200))])

    assert frames(found) == list(range(200))
    assert {s.epoch for s in found} == {0}
    assert tracker.health[SENSOR].inconsistent == 0


def test_packets_of_a_restart_are_not_held_against_the_tag():
    tracker, tag = link(), Tag()
    samples(tracker, tag.heard(range(500)))

    after = samples(tracker, replace(tag, powered=111.0).heard(range(50)))

    health = tracker.health[SENSOR]
    assert frames(after) == list(range(after[0].frame, after[0].frame + len(after)))
    assert (health.inconsistent, health.lost) == (0, 0)


def test_one_packet_off_the_line_is_dropped_and_nothing_else():
    tracker, tag = link(), Tag()
    stray = tag.reading(3)._replace(clock=9_000_000, sequence=77)
    heard = [*tag.heard(range(50)), (stray, 101.0), *tag.heard(range(50, 100))]

    found = samples(tracker, heard)

    assert frames(found) == list(range(100))
    assert (tracker.health[SENSOR].inconsistent, tracker.health[SENSOR].reboots) == (1, 0)


def test_becoming_synchronised_sets_the_clock_and_is_no_restart():
    tracker, tag = link(), Tag()
    synced = replace(tag, clock=3000.0, flags=Flag.TIME_SYNCED)

    found = samples(tracker, [*tag.heard(range(100)), *synced.heard(range(100, 200))])

    assert frames(found) == list(range(200))
    assert {s.epoch for s in found} == {0}
    assert all(0 < b.device_time - a.device_time < 0.03 for a, b in pairwise(found))
    assert [s.time for s in found] == pytest.approx([tag.measured(k) + tag.delay for k in range(200)], abs=1e-3)
    assert kinds(tracker) == ["found", "clock stepped"]


def test_a_receiver_pulled_out_and_plugged_in_is_no_restart_of_the_tags():
    """Its clock starts at 0 again; the tags ran on by themselves meanwhile."""
    tracker = link()
    tags = [
        Tag(tag_advert.sensor_of(n), number=n, clock=500.0 - 5.0 * n, powered=100.0 - 5.0 * n, flags=64)
        for n in (1, 2, 3)
    ]
    heard = [item for k in range(500) for tag in tags for item in tag.heard([k + 250 * tag.number])]
    later = [replace(tag, clock=tag.clock - 495.0 - 15.0) for tag in tags]
    heard += [item for k in range(1250, 1500) for tag in later for item in tag.heard([k + 250 * tag.number])]

    found = samples(tracker, heard)

    assert {s.epoch for s in found} == {0}
    for tag in tags:
        mine = [s for s in found if s.sensor == tag.sensor]
        assert [s.frame - mine[0].frame for s in mine] == [*range(500), *range(1250, 1500)]
        expected = [tag.powered + tag.delay + (s.frame - mine[0].frame + 250 * tag.number) * 0.02 for s in mine]
        assert [s.time for s in mine] == pytest.approx(expected, abs=2e-3)
        assert tracker.health[tag.sensor].lost == 750
    assert kinds(tracker).count("shared clock restarted") == 1


def test_synchronised_tags_have_one_time_for_one_instant():
    """The slot a tag sends in, 0 to 18 ms after measuring, is no part of its time."""
    tracker = link()
    tags = [Tag(tag_advert.sensor_of(n), number=n, delay=0.003 + 0.0012 * n, flags=64) for n in range(1, 16)]

    found = samples(tracker, (item for k in range(200) for tag in tags for item in tag.heard([k])))

    by_frame: dict[int, set[float]] = {}
    for sample in found[15 * 50 :]:
        by_frame.setdefault(sample.frame, set()).add(round(sample.time, 6))
    assert {len(times) for times in by_frame.values()} == {1}


def test_a_suspended_computer_is_no_restart():
    """Five minutes pass for the tag and none here; nine, half a turn of its clock, are the most that can be told."""
    tracker, tag = link(), Tag()
    woken = replace(tag, powered=tag.powered - 300.0)
    heard = [*tag.heard(range(500)), *woken.heard(range(15_500, 15_600))]

    found = samples(tracker, heard)

    assert {s.epoch for s in found} == {0}
    assert found[-1].frame - found[0].frame == 15_599
    assert all(b.time > a.time for a, b in pairwise(found))
    assert found[-1].time == pytest.approx(found[-1].received, abs=0.01)
    assert "clock stepped" in kinds(tracker)


@pytest.mark.parametrize(("before_s", "after_s"), [(0.02, 0.01), (0.01, 0.02), (0.02, 0.025), (0.02, 0.005)])
def test_another_frame_length_is_another_epoch(before_s, after_s):
    tracker, tag = link(), Tag(frame_s=before_s)
    change = 250 * before_s
    other = replace(tag, frame_s=after_s, powered=100.0 + change - 250 * after_s, clock=change - 250 * after_s)

    before = samples(tracker, tag.heard(range(250)))
    after = samples(tracker, other.heard(range(250, 400)))

    assert {s.epoch for s in (*before, *after)} == {0, 1}
    assert tracker.infos[SENSOR].frame_s == after_s
    assert (tracker.health[SENSOR].reboots, tracker.health[SENSOR].inconsistent) == (0, 0)
    assert kinds(tracker) == ["found", "frame length"]
    assert len(after) >= 147


def test_a_packet_in_place_of_a_sample_counts_and_is_flagged_for_filling():
    tracker, tag = link(), Tag()
    nothing = (float("nan"),) * 3
    facts = {"firmware": "1.0", "battery_volt": 3.7, "calibration_crc": 7, "serial": "12345678", "address": "c0:aa"}
    info = tag.reading(5, rate=nothing, acceleration=nothing, temperature=25.0, facts=facts)

    found = samples(tracker, [*tag.heard(range(5)), (info, tag.measured(5)), *tag.heard(range(6, 10))])

    assert frames(found) == list(range(10))
    assert [bool(s.flags & Flag.FILLED) for s in found] == [k == 5 for k in range(10)]
    assert np.isnan([*found[5].rate, *found[5].acceleration]).all()
    assert found[5].orientation == (1.0, 0.0, 0.0, 0.0)
    assert (tracker.health[SENSOR].lost, tracker.health[SENSOR].temperature) == (0, 25.0)
    assert tracker.infos[SENSOR].facts == {"link": "receiver", **facts}


def coefficient(tag: Tag, frame: int, index: int, crc: int = 99) -> tuple[Reading, float]:
    nothing = (float("nan"),) * 3
    x, y, z = ROWS[index]
    facts = {"coefficients": index, "coefficient_x": x, "coefficient_y": y, "coefficient_z": z, "calibration_crc": crc}
    reading = tag.reading(frame, orientation=(float("nan"),) * 4, rate=nothing, acceleration=nothing, facts=facts)
    return reading, tag.measured(frame)


def test_four_rows_with_one_crc_are_the_correction_in_force():
    tracker, tag = link(), Tag()

    samples(tracker, [coefficient(tag, k, index) for k, index in enumerate((2, 0, 0, 3))])
    assert tracker.infos[SENSOR].correction is None
    samples(tracker, [coefficient(tag, 4, 1)])

    assert tracker.infos[SENSOR].correction == Correction(ROWS[0], ROWS[1:])
    assert kinds(tracker) == ["found", "coefficients"]


def test_rows_of_two_calibrations_are_never_mixed():
    tracker, tag = link(), Tag()

    samples(tracker, [coefficient(tag, k, index, crc=k // 2) for k, index in enumerate((0, 1, 2, 3))])

    assert tracker.infos[SENSOR].correction is None


def test_a_tag_calibrated_again_makes_its_correction_unknown():
    tracker, tag = link(), Tag()
    samples(tracker, [coefficient(tag, k, k) for k in range(4)])

    samples(tracker, [(tag.reading(4, facts={"calibration_crc": 100}), tag.measured(4))])

    assert tracker.infos[SENSOR].correction is None
    assert kinds(tracker) == ["found", "coefficients", "coefficients outdated"]


def test_two_tags_with_one_number_are_told_once():
    tracker = link()
    twin = Tag(tag_advert.sensor_of(7))

    samples(tracker, [item for k in range(100) for tag in (Tag(), twin) for item in tag.heard([k])])

    told = [facts for kind, facts in tracker.take_events() if kind == "duplicate number"]
    assert told == [{"number": 3, "sensors": ["tag:00000007", "tag:12345678"]}]
    assert {tracker.health[s].lost for s in tracker.health} == {0}


def test_a_number_given_to_another_tag_after_the_first_fell_silent_is_no_conflict():
    tracker = link()
    samples(tracker, Tag().heard(range(10)))

    samples(tracker, Tag(tag_advert.sensor_of(7), powered=110.0).heard(range(10)))

    assert kinds(tracker) == ["found", "found"]


def test_a_tag_given_another_number_is_the_same_sensor():
    tracker, tag = link(), Tag()

    samples(tracker, [*tag.heard(range(5)), *replace(tag, number=9).heard(range(5, 10))])

    assert tracker.infos[SENSOR].number == 9
    events = tracker.take_events()
    assert events[-1] == ("number", {"sensor": SENSOR, "before": 3, "number": 9})


def test_silence_over_half_a_second_is_an_event_with_its_ends():
    tracker, tag = link(), Tag()

    samples(tracker, tag.heard([*range(50), *range(76, 100), *range(120, 150)]))

    (kind, facts), *rest = [event for event in tracker.take_events() if event[0] != "found"]
    assert (kind, rest) == ("gap", [])
    assert facts["frames"] == 26
    assert (facts["from"], facts["to"]) == pytest.approx((100.983, 101.523), abs=1e-3)


def test_a_stream_of_invented_serials_stays_bounded():
    tracker = link()

    for serial in range(2 * MOST_SENSORS):
        tracker.accept(Tag(tag_advert.sensor_of(serial), number=0).reading(0), 100.0)

    assert len(tracker.infos) == MOST_SENSORS
    assert tracker.ignored == MOST_SENSORS


def test_packets_a_dialect_refused_are_kept_with_their_sensor():
    tracker = link()
    samples(tracker, Tag().heard(range(3)))

    tracker.note_refused({SENSOR: 5, SensorId("tag:ffffffff"): 2})

    assert tracker.health[SENSOR].snapshot(101.0).malformed == 5
    assert list(tracker.health) == [SENSOR]
