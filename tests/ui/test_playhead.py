"""The playhead: a time that runs when it is told the time."""

import pytest

from studio.ui.models.playhead import FASTEST, SLOWEST, Playhead, clock


@pytest.fixture
def head():
    playhead = Playhead()
    playhead.open(10.0, 0.02)
    return playhead


def run(head, seconds, start=100.0, fps=60):
    for frame in range(round(seconds * fps) + 1):
        head.tick(start + frame / fps)


def test_it_stands_until_it_plays(head):
    run(head, 1.0)

    assert head.time == 0.0


@pytest.mark.parametrize("speed", [0.1, 1.0, 4.0])
def test_it_runs_as_fast_as_was_chosen(head, speed):
    head.set_speed(speed)
    head.play()
    run(head, 2.0)

    assert head.time == pytest.approx(2.0 * speed)


def test_speeds_stay_within_what_is_on_offer(head):
    head.set_speed(100)
    assert head.speed == FASTEST
    head.faster()
    assert head.speed == FASTEST
    for _ in range(20):
        head.slower()
    assert head.speed == SLOWEST
    head.faster()
    assert head.speed == 0.25


def test_at_the_end_it_stands_and_plays_again_from_the_start(head):
    head.seek(9.9)
    head.play()
    run(head, 1.0)
    assert (head.time, head.is_playing) == (10.0, False)

    head.play()
    assert head.time == 0.0
    assert head.is_playing


def test_a_loop_goes_round_within_its_range(head):
    head.seek(4.0)
    head.range_starts_here()
    head.seek(6.0)
    head.range_ends_here()
    head.set_loop(True)
    head.play()
    assert head.time == 4.0
    run(head, 5.0)

    assert head.time == pytest.approx(5.0)
    assert head.is_playing


def test_an_end_before_the_start_forgets_the_start(head):
    head.seek(6.0)
    head.range_starts_here()
    head.seek(2.0)
    head.range_ends_here()

    assert (head.begin, head.end) == (0.0, 2.0)
    head.whole_take()
    assert (head.begin, head.end) == (0.0, 10.0)


def test_steps_stand_on_frames_and_stay_within_the_take(head):
    head.play()
    head.seek(1.013)
    head.step(1)
    assert head.time == pytest.approx(1.04)
    assert not head.is_playing
    head.step(-1000)
    assert (head.time, head.frame) == (0.0, 0)
    head.step(10_000)
    assert (head.time, head.frame, head.frames) == (10.0, 500, 501)


def test_home_and_end_go_to_the_range_first_and_then_to_the_take(head):
    head.seek(4.0)
    head.range_starts_here()
    head.seek(6.0)
    head.range_ends_here()
    head.seek(5.0)

    head.home()
    assert head.time == 4.0
    head.home()
    assert head.time == 0.0
    head.to_end()
    assert head.time == 6.0
    head.to_end()
    assert head.time == 10.0


def test_it_tells_only_when_it_moved(head):
    told: list[object] = []
    head.moved.connect(told.append)
    head.seek(2.0)
    head.seek(2.0)

    assert told == [2.0]


def test_another_take_begins_at_its_start_with_the_same_speed(head):
    head.set_speed(0.5)
    head.seek(4.0)
    head.range_starts_here()
    head.play()
    head.open(3.0, 0.01)

    assert (head.time, head.begin, head.end, head.speed, head.is_playing) == (0.0, 0.0, 3.0, 0.5, False)


def test_an_empty_take_does_not_play(head):
    head.open(0.0, 0.01)
    head.play()

    assert not head.is_playing


def test_a_stall_of_the_window_loses_no_time(head):
    head.play()
    head.tick(100.0)
    head.tick(100.5)

    assert head.time == 0.5


@pytest.mark.parametrize(
    ("seconds", "said"), [(0, "00:00.00"), (7.424, "00:07.42"), (59.999, "01:00.00"), (3727.42, "1:02:07.42")]
)
def test_times_are_written_as_on_a_clock(seconds, said):
    assert clock(seconds) == said
