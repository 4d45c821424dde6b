"""Frames and poses while samples are coming in, and what is kept of them."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PRESETS, SEGMENT_OF, Place, reference_pose
from studio.core.live_frames import Frame, FrameLog, Rows
from studio.core.live_solver import Solver, samples_of
from studio.core.root import put_under_hold
from studio.core.sample import SensorId
from studio.core.solver import SolveOptions, solve
from studio.core.take import Mark
from tests.core.altered_takes import changed, kept, rested, silent
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, worn_take

LOWER = PRESETS["lower"]
THIGH = Place.RIGHT_THIGH
LIVE = SolveOptions(method="live")


def frames_of(take, samples=None):
    """Return a solver that has seen a take, and its frames."""
    solver = Solver(take.setup, "vqf", {})
    for sent in take.streams:
        solver.add_sensor(sent.info)
    return solver, [frame for sample in samples or samples_of(take) for frame in solver.push(sample)]


def test_measured_means_the_same_live_and_offline():
    """Single losses and silences up to a second are bridged, and longer ones are not."""
    take, _ = worn_take(LOWER)
    rng = np.random.default_rng(2)
    for place in LOWER:
        take = changed(take, place, lambda s: kept(s, (rng.random(len(s)) > 0.05) | (s.time > 19.9)))
    take = rested(silent(silent(take, THIGH, 12.0, 12.9), THIGH, 15.0, 17.0))

    offline, live = (solve(take, SolveOptions(method=method)).motion for method in ("offline", "live"))

    for place in LOWER:
        rows = np.searchsorted(live.time + 1e-6, offline.time[10:-10]).clip(0, len(live) - 1)
        there = np.abs(live.time[rows] - offline.time[10:-10]) < 1e-3
        differing = live.measured[place][rows] != offline.measured[place][10:-10]
        assert (differing & there).sum() <= 4, place  # the edges of the two silences
        assert live.measured[place][(live.time > 1) & (live.time < 11.9)].all()
        assert live.lost[place].mean() == pytest.approx(offline.lost[place].mean(), abs=0.02)
    assert not live.measured[THIGH][(live.time > 15.1) & (live.time < 16.9)].any()


def test_while_samples_come_in_a_sensor_is_measured_for_a_second_after_its_last():
    take, _ = worn_take(LOWER)
    alignment = solve(take, LIVE).motion.alignment
    solver, frames = frames_of(silent(take, THIGH, 15.0, 17.0))
    solver.use(alignment, {place: {0: limb.heading} for place, limb in alignment.limbs.items()})

    poses = [pose for frame in frames if (pose := solver.pose(frame)) is not None]

    seen = np.array([[pose.time, THIGH in pose.measured] for pose in poses])
    assert seen[seen[:, 0] < 15.9, 1].all()
    assert not seen[(seen[:, 0] > 16.05) & (seen[:, 0] < 16.95), 1].any()


def test_late_and_repeated_packets_make_no_frame():
    """Times of frames increase, whatever comes in whatever order; a replay of the same forms the same."""
    take, _ = worn_take(LOWER, 3.0, poses=(N_HOLD,))
    samples = list(samples_of(take))
    rng = np.random.default_rng(5)
    order = np.argsort(np.arange(len(samples)) + rng.uniform(0, 40, len(samples)), kind="stable")
    mixed = [samples[row] for row in order] + samples[-30:]

    _, frames = frames_of(take, mixed)

    times = np.array([frame.time for frame in frames])
    assert len(frames) > 75
    assert (np.diff(times) > 0).all()
    assert [frame.time for frame in frames_of(take, mixed)[1]] == times.tolist()


def test_a_sensor_that_has_not_sent_yet_is_shown_as_in_the_held_pose():
    take, _ = worn_take(LOWER)
    alignment = solve(take, LIVE).motion.alignment
    for pose in ("n", "sit"):
        late = silent(take, THIGH, -1.0, 2.0)
        solver, frames = frames_of(late)
        solver.use(replace(alignment, pose=pose), {p: {0: limb.heading} for p, limb in alignment.limbs.items()})

        first = solver.pose(frames[0])

        assert first is not None
        shown = first.world_from_segment[SEGMENT_OF[THIGH]]
        assert rotation.angle_between(shown, reference_pose(pose)[SEGMENT_OF[THIGH]]) < 1e-9
        assert THIGH not in first.measured


def wandering_take():
    """Legs that walk on before and after the hold: N-pose is held from 11 to 14 s, a metre and more away."""
    time = np.arange(round(24 * RATE) + 1) / RATE
    walk = np.clip(1.0 - np.abs(time - 5.0) / 5.0, 0, 1)  # swings that grow and die away
    body = {}
    for place in LOWER:
        side = -1.0 if "left" in place.value else 1.0
        leg = place.value.endswith(("thigh", "shank", "foot"))
        swing = side * np.radians(25) * walk * np.sin(2 * np.pi * 0.8 * time) if leg else np.zeros(len(time))
        bow = procedure(place, np.where(time < 14.0, 0.0, np.minimum(time - 10.0, 9.9)))
        body[place] = rotation.multiply(bow, rotation.about(2, swing))
    return worn_take(
        LOWER, 24.0, motion=body, poses=(Mark(11.0, "pose", "n", 14.0), replace(BOW_HOLD, time=16.0, end=18.0))
    )


@pytest.mark.parametrize("method", ["offline", "live"])
def test_the_origin_lies_under_the_pelvis_at_the_hold(method):
    take, _ = wandering_take()

    motion = solve(take, SolveOptions(method=method)).motion

    held = (motion.time >= 11.0) & (motion.time <= 14.0)
    assert np.abs(motion.hips[held, :2].mean(axis=0)).max() < 1e-9
    assert np.linalg.norm(motion.hips[0, :2]) > 0.1  # and it did not stand there when the take began


def test_a_hold_of_a_single_moment_and_one_before_the_take_have_an_origin_too():
    alignment = solve(worn_take(LOWER)[0]).motion.alignment
    time = np.arange(100) / RATE
    hips = np.outer(time, [1.0, 2.0, 0.0]) + 1.0

    moment = hips.copy()
    put_under_hold(moment, time, replace(alignment, from_s=1.004, to_s=1.004))
    before = hips.copy()
    put_under_hold(before, time, replace(alignment, from_s=-5.0, to_s=-2.0))

    assert np.abs(moment[50, :2]).max() < 1e-12
    assert np.array_equal(before, hips)


def test_a_log_of_frames_gives_them_back_column_by_column():
    one, two = SensorId("tag:1"), SensorId("tag:2")
    log = FrameLog((one, two))
    log.extend([Frame(0.5, {one: (1.0, 0.0, 0.0, 0.0)}, {one: 0.5}, {one: 0})])
    late = {one: (0.0, 1.0, 0.0, 0.0), two: (0.0, 0.0, 1.0, 0.0)}
    log.extend([Frame(0.6, late, {one: 0.6, two: 0.58}, {one: 1, two: 3}) for _ in range(2)])

    blocks = list(log.blocks((two, one), 2))

    assert len(log) == 3
    assert [len(block.time) for block in blocks] == [2, 1]
    assert np.isnan(blocks[0].attitude[0, 0]).all()
    assert blocks[0].attitude[1].tolist() == [[0, 0, 1, 0], [0, 1, 0, 0]]
    assert blocks[0].group.tolist() == [[-1, 0], [3, 1]]
    assert blocks[1].heard[0].tolist() == [0.58, 0.6]


def test_what_was_read_stays_as_it_was_while_more_comes_and_the_old_is_forgotten():
    rows = Rows(2)
    for value in range(10):
        rows.append(float(value), -1.0)
    before = rows.values()

    for value in range(10, 30):
        rows.append(float(value), -2.0)
        rows.forget(value - 15.0, 10)

    assert before[:, 0].tolist() == list(range(10))
    assert len(rows) == len(rows.values())
    assert rows.values()[-1].tolist() == [29.0, -2.0]
    assert 14.0 - 10 <= rows.values()[0, 0] <= 14.0


def test_half_an_hour_of_fifteen_sensors_is_kept_in_less_than_a_quarter_of_a_gigabyte():
    """1.35 million samples at 96 bytes and 90,000 frames of 15 sensors at 42."""
    sensors = [SensorId(f"tag:{n}") for n in range(15)]
    log, rows = FrameLog(sensors), Rows(12)
    attitudes = dict.fromkeys(sensors, (1.0, 0.0, 0.0, 0.0))
    frame = Frame(0.0, attitudes, dict.fromkeys(sensors, 0.0), dict.fromkeys(sensors, 0))
    log.extend([frame] * 100)
    for _ in range(100):
        rows.append(*([0.0] * 12))

    (block,) = log.blocks(sensors, 100)
    a_frame = sum(column.nbytes for column in block) / 100
    a_row = rows.values().nbytes / 100

    assert 90_000 * (a_frame + 15 * a_row) < 0.25e9
