"""A tag, its clock or its receiver starts anew: another epoch where the orientation did, none where a clock did."""

from dataclasses import replace
from itertools import pairwise

import pytest

from studio.acquisition.dialects import tag_advert
from studio.core.sample import Flag
from tests.acquisition.tracked_tags import SENSOR, Tag, bursty, frames, kinds, link, samples


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
