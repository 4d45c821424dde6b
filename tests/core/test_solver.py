"""From samples to poses: what the whole chain promises, held against exact geometry."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import MEASURED_PARENT, PLACES, PRESETS, SEGMENT_OF, Place, Segment
from studio.core.errors import HeadingsUnknown, MovedDuringHold, NoSensorWorn, PoseMissing
from studio.core.live_solver import Solver, samples_of
from studio.core.root import put_under_hold
from studio.core.solver import SolveOptions, solve
from studio.core.take import Assignment, Mark
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, sensor_of, stream, worn_take

LOWER = PRESETS["lower"]


def worst_joint_error(motion, truth, rows=slice(None)):
    """Return the largest error in degrees over all joints between measured segments."""
    worst = 0.0
    for place in truth:
        parent = MEASURED_PARENT.get(place)
        if parent is None or parent not in truth:
            continue
        found = motion.parent_from_child(SEGMENT_OF[parent], SEGMENT_OF[place])[rows]
        true = rotation.multiply(rotation.inverse(truth[parent]), truth[place])[rows]
        worst = max(worst, float(np.degrees(rotation.angle_between(found, true)).max()))
    return worst


@pytest.mark.parametrize("method", ["offline", "live"])
@pytest.mark.parametrize("attitude", ["vqf", "gyro"])
def test_joints_of_exact_sensors_come_out_whatever_their_mountings_and_headings(attitude, method):
    take, truth = worn_take(PLACES)

    motion = solve(take, SolveOptions(attitude=attitude, method=method)).motion

    # The filters' own transients (low-passed gravity while swinging) are what is left.
    assert worst_joint_error(motion, truth) < (0.7 if attitude == "vqf" else 0.05)


def test_the_wearer_faces_x_at_the_hold():
    take, _ = worn_take(PLACES)

    motion = solve(take).motion

    held = motion.world_from_segment[int(2 * RATE)]
    off = np.degrees(rotation.angle_between(held, np.tile([0.5**0.5, 0.5**0.5, 0, 0], (23, 1))))
    assert off.max() < 0.1


def test_a_constant_offset_of_the_gyroscope_is_found_in_the_hold_and_taken_out():
    take, truth = worn_take(LOWER)
    # A raw MPU-6050 may be off by 20 °/s; the tag integrates it into its quaternion.
    offset = (0.2, -0.3, 0.15)
    worn = [
        stream(
            sensor_of(place), rotation.multiply(truth[place], [0.5, 0.5, -0.5, 0.5]), take.streams[0].time, bias=offset
        )
        for place in LOWER
    ]
    solution = solve(replace(take, streams=tuple(worn)))

    for track in solution.tracks.values():
        np.testing.assert_allclose(track.offset, offset, atol=np.radians(0.02))
    assert worst_joint_error(solution.motion, truth) < 1.5


def test_lost_samples_cost_little_because_the_tag_integrates():
    take, truth = worn_take(LOWER)
    whole = worst_joint_error(solve(take).motion, truth)
    rng = np.random.default_rng(1)
    thinned = []
    for sent in take.streams:
        kept = np.flatnonzero(rng.random(len(sent)) > 0.05)
        names = [n for n in sent.__slots__ if n != "info"]
        thinned.append(replace(sent, **{name: getattr(sent, name)[kept] for name in names}))

    motion = solve(replace(take, streams=tuple(thinned))).motion

    assert worst_joint_error(motion, truth) < whole + 5.0  # slerp across up to 80 ms of 30° swings at 1 Hz
    assert any(lost.any() for lost in motion.lost.values())
    assert all(measured.all() for measured in motion.measured.values())


def test_live_is_the_solver_stepped_sample_by_sample():
    take, _ = worn_take(LOWER)
    replayed = solve(take, SolveOptions(method="live"))

    solver = Solver(take.setup, "vqf", {})
    for sent in take.streams:
        solver.add_sensor(sent.info)
    solver_frames = [frame for sample in samples_of(take) for frame in solver.push(sample)]
    solver.use(replayed.motion.alignment)
    poses = [pose for frame in solver_frames if (pose := solver.pose(frame)) is not None]

    assert len(poses) == len(replayed.motion)
    worlds = np.array([pose.world_from_segment for pose in poses])
    assert np.abs(worlds - replayed.motion.world_from_segment).max() < 1e-9
    hips = np.array([pose.hips for pose in poses])
    put_under_hold(hips, replayed.motion.time, replayed.motion.alignment)
    assert np.abs(hips - replayed.motion.hips).max() < 1e-9


def test_a_restarted_tag_is_not_measured_until_its_heading_is_known_again():
    take, _truth = worn_take(LOWER, 24.0)
    row = LOWER.index(Place.LEFT_SHANK)
    shank = take.streams[row]
    restart = int(14 * RATE)
    start = shank.orientation[restart]
    orientation = shank.orientation.copy()
    orientation[restart:] = rotation.multiply(rotation.inverse(start), orientation[restart:])
    epoch = shank.epoch.copy()
    epoch[restart:] = 1
    streams = list(take.streams)
    streams[row] = replace(shank, orientation=orientation, epoch=epoch)
    restarted = replace(take, streams=tuple(streams))

    motion = solve(restarted).motion

    measured = motion.measured[Place.LEFT_SHANK]
    assert measured[: restart - 1].all()
    assert not measured[restart + 1 :].any()
    assert motion.measured[Place.RIGHT_SHANK].all()


def test_a_second_hold_gives_a_restarted_tag_its_heading_back():
    still = np.arange(round(24 * RATE) + 1) / RATE
    motion_of = {place: procedure(place, np.where(still > 16, 2.0, still)) for place in LOWER}
    take, truth = worn_take(LOWER, 24.0, motion=motion_of)
    row = LOWER.index(Place.LEFT_SHANK)
    shank = take.streams[row]
    restart = int(17 * RATE)
    orientation = shank.orientation.copy()
    orientation[restart:] = rotation.multiply(rotation.inverse(shank.orientation[restart]), orientation[restart:])
    epoch = shank.epoch.copy()
    epoch[restart:] = 1
    streams = list(take.streams)
    streams[row] = replace(shank, orientation=orientation, epoch=epoch)
    again = Mark(19.0, "pose", "n", 22.0)
    restarted = replace(take, streams=tuple(streams), marks=(N_HOLD, BOW_HOLD, again))

    motion = solve(restarted).motion

    assert motion.measured[Place.LEFT_SHANK][restart + 2 :].all()
    assert worst_joint_error(motion, truth, slice(int(20 * RATE), int(22 * RATE))) < 1.5


def test_a_silent_second_is_bridged_and_a_longer_silence_is_not():
    take, _ = worn_take(LOWER)
    row = LOWER.index(Place.RIGHT_THIGH)
    thigh = take.streams[row]
    kept = np.ones(len(thigh), bool)
    kept[int(12 * RATE) : int(12.8 * RATE)] = False
    kept[int(15 * RATE) : int(17 * RATE)] = False
    names = [n for n in thigh.__slots__ if n != "info"]
    streams = list(take.streams)
    streams[row] = replace(thigh, **{name: getattr(thigh, name)[kept] for name in names})

    motion = solve(replace(take, streams=tuple(streams))).motion

    measured, lost = motion.measured[Place.RIGHT_THIGH], motion.lost[Place.RIGHT_THIGH]
    assert measured[int(12.1 * RATE) : int(12.7 * RATE)].all()
    assert lost[int(12.1 * RATE) : int(12.7 * RATE)].all()
    assert not measured[int(15.1 * RATE) : int(16.9 * RATE)].any()
    # The tag went on integrating: its heading is carried across.
    assert measured[int(17.1 * RATE) :].all()


def raw(take, truth, offset):
    """Return the take as tags would send it whose offset nobody has measured."""
    worn = [
        stream(
            sensor_of(place), rotation.multiply(truth[place], [0.5, 0.5, -0.5, 0.5]), take.streams[0].time, bias=offset
        )
        for place in LOWER
    ]
    return replace(take, streams=tuple(worn))


def test_a_raw_offset_is_not_taken_for_moving_while_the_pose_is_held_live():
    take, truth = worn_take(LOWER)

    motion = solve(raw(take, truth, (0.2, -0.25, 0.15)), SolveOptions(method="live")).motion

    assert worst_joint_error(motion, truth, slice(int(6 * RATE), int(9 * RATE))) < 5.0  # found in 2 s of standing


@pytest.mark.parametrize("method", ["offline", "live"])
def test_across_a_long_silence_a_raw_offset_leaves_the_heading_unknown(method):
    take, truth = worn_take(LOWER)
    loose = raw(take, truth, (0.2, -0.25, 0.15))
    row = LOWER.index(Place.RIGHT_THIGH)
    thigh = loose.streams[row]
    kept = np.ones(len(thigh), bool)
    kept[int(15 * RATE) : int(17 * RATE)] = False
    names = [n for n in thigh.__slots__ if n != "info"]
    streams = list(loose.streams)
    streams[row] = replace(thigh, **{name: getattr(thigh, name)[kept] for name in names})

    motion = solve(replace(loose, streams=tuple(streams)), SolveOptions(method=method)).motion

    measured = motion.measured[Place.RIGHT_THIGH]
    assert measured[motion.time < 14.9].all()
    assert not measured[motion.time > 17.1].any()


def test_without_a_marked_pose_the_first_second_is_taken_and_the_motion_says_so():
    take, _ = worn_take(LOWER, poses=(BOW_HOLD,))

    motion = solve(take).motion

    assert any("first second" in note for note in motion.notes)


def test_a_take_that_begins_in_the_middle_of_moving_asks_for_a_pose():
    time = np.arange(round(8 * RATE) + 1) / RATE + 11.0
    take, _ = worn_take(LOWER, 8.0, poses=(), motion={place: procedure(place, time) for place in LOWER})

    with pytest.raises(PoseMissing):
        solve(take)


def test_without_a_second_fact_no_heading_is_known_and_no_pose_is_made_up():
    take, _ = worn_take(LOWER, poses=(N_HOLD,))

    with pytest.raises(HeadingsUnknown) as refusal:
        solve(take)

    assert set(refusal.value.places) == {place.value for place in LOWER}


def test_a_take_whose_sensors_sit_nowhere_says_so():
    take, _ = worn_take(LOWER)
    loose = replace(take, setup=replace(take.setup, assignment=Assignment()))

    with pytest.raises(NoSensorWorn) as refusal:
        solve(loose)

    assert refusal.value.sensors == 7


def test_a_sensor_that_was_silent_during_the_hold_is_named_and_not_measured():
    take, _ = worn_take(LOWER)
    row = LOWER.index(Place.LEFT_FOOT)
    late = take.streams[row]
    names = [n for n in late.__slots__ if n != "info"]
    streams = list(take.streams)
    streams[row] = replace(late, **{name: getattr(late, name)[int(9 * RATE) :] for name in names})

    motion = solve(replace(take, streams=tuple(streams))).motion

    assert not motion.measured[Place.LEFT_FOOT].any()
    assert any("left foot" in note for note in motion.notes)


def test_limbs_that_moved_during_the_hold_are_named():
    time = np.arange(round(20 * RATE) + 1) / RATE
    wobble = rotation.about(2, np.radians(12) * np.sin(2 * np.pi * 0.8 * time))
    motion_of = {place: procedure(place, time) for place in LOWER}
    motion_of[Place.LEFT_FOOT] = rotation.multiply(motion_of[Place.LEFT_FOOT], wobble)
    take, _ = worn_take(LOWER, motion=motion_of)

    with pytest.raises(MovedDuringHold) as refusal:
        solve(take)

    assert refusal.value.places == ("left_foot",)


def test_unmeasured_segments_follow_the_stated_rules():
    take, _truth = worn_take((Place.PELVIS, Place.CHEST, Place.LEFT_FOREARM))

    motion = solve(take).motion

    hips, chest = motion.world_from_segment[:, Segment.Hips], motion.world_from_segment[:, Segment.Spine3]
    for spine, fraction in ((Segment.Spine, 0.25), (Segment.Spine1, 0.5), (Segment.Spine2, 0.75)):
        between = rotation.slerp(hips, chest, np.full(len(motion), fraction))
        assert rotation.angle_between(between, motion.world_from_segment[:, spine]).max() < 1e-9
    for rigid in (Segment.Neck, Segment.Head, Segment.LeftArm, Segment.RightHand):
        assert rotation.angle_between(chest, motion.world_from_segment[:, rigid]).max() < 1e-9
    assert rotation.angle_between(hips, motion.world_from_segment[:, Segment.RightFoot]).max() < 1e-9
    forearm = motion.world_from_segment[:, Segment.LeftForeArm]
    assert rotation.angle_between(forearm, motion.world_from_segment[:, Segment.LeftHand]).max() < 1e-9
