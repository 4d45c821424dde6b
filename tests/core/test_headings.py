"""The heading of every stretch of every sensor, from further holds and from a calibration made before the take."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PRESETS, SEGMENT_OF, Place
from studio.core.errors import HeadingsUnknown, MovedDuringHold
from studio.core.headings import turn_between
from studio.core.live_solver import Solver, samples_of
from studio.core.solver import SolveOptions, solve, solve_tracks
from studio.core.take import Alignment, CarriedAlignment, Mark
from studio.core.track import attitude_at
from tests.core.altered_takes import changed, cut, restarted, rested, silent
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, sensor_of, worn_take

LOWER = PRESETS["lower"]
TURN = np.radians(70.0)
AGAIN = Mark(13.0, "pose", "n", 16.0)
SECONDS = 24.0
METHODS = pytest.mark.parametrize("method", ["offline", "live"])


def turned_body(places=LOWER, wobble=None):
    """N-pose, a bow, then standing again, 70° further to the left: held again from 13 to 16 s, then walking.

    ``wobble`` is (place, from, to): that limb waves meanwhile.
    """
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    stretched = np.where(time < 10, time, np.maximum(time - 7.0, 10.0))
    turn = rotation.about(2, TURN * np.clip((time - 10.0) / 1.5, 0, 1))
    motion = {}
    for place in places:
        moving = procedure(place, stretched)
        if wobble is not None and place == wobble[0]:
            waving = np.radians(12) * np.sin(2 * np.pi * 0.8 * time) * ((time >= wobble[1]) & (time < wobble[2]))
            moving = rotation.multiply(moving, rotation.about(2, waving))
        motion[place] = rotation.multiply(turn, moving)
    return motion


def turned_take(places=LOWER, poses=(N_HOLD, BOW_HOLD, AGAIN), wobble=None):
    return worn_take(places, SECONDS, motion=turned_body(places, wobble), poses=poses)


def error_of(motion, truth, place, from_s, to_s):
    """Return the largest error of a segment in the world, degrees."""
    rows = np.flatnonzero((motion.time >= from_s) & (motion.time < to_s))
    true = truth[place][np.round(motion.time[rows] * RATE).astype(int)]
    return float(np.degrees(rotation.angle_between(motion.world_from_segment[rows, SEGMENT_OF[place]], true)).max())


@METHODS
def test_whoever_repeats_a_pose_need_not_face_as_before(method):
    """The limbs whose heading went on tell how far the wearer turned: 70 degrees."""
    take, truth = turned_take()
    again = restarted(take, Place.LEFT_SHANK, 12.0)

    motion = solve(again, SolveOptions(method=method)).motion

    assert motion.measured[Place.LEFT_SHANK][motion.time > 12.1].all()
    for place in (Place.LEFT_SHANK, Place.RIGHT_SHANK):
        assert error_of(motion, truth, place, 13.0, 24.0) < 2.0, place


@METHODS
def test_when_every_tag_started_anew_nothing_tells_where_the_wearer_faced_in_the_second_hold(method):
    take, _ = turned_take()
    for place in LOWER:
        take = restarted(take, place, 12.0)

    motion = solve(take, SolveOptions(method=method)).motion

    for place in LOWER:
        assert motion.measured[place][motion.time < 11.9].all()
        assert not motion.measured[place][motion.time > 12.1].any()


def test_a_limb_that_moves_in_the_second_hold_is_not_told_a_heading_by_it():
    take, _ = turned_take(wobble=(Place.LEFT_SHANK, 12.5, 17.0))
    again = restarted(take, Place.LEFT_SHANK, 12.0)

    motion = solve(again).motion

    assert not motion.measured[Place.LEFT_SHANK][motion.time > 12.1].any()


def test_a_hold_in_which_a_limb_stood_otherwise_tells_it_nothing_and_is_noted():
    take, _ = worn_take(LOWER, 20.0, poses=(N_HOLD, BOW_HOLD, Mark(6.2, "pose", "n", 7.8)))
    again = restarted(take, Place.LEFT_THIGH, 5.8)

    motion = solve(again).motion

    assert not motion.measured[Place.LEFT_THIGH][motion.time > 6.0].any()
    (note,) = [note for note in motion.notes if "n at 6.2 s" in note]
    assert "left thigh" in note  # lifted by 50 degrees; the shank tips by 35 only


def test_the_turn_between_two_holds_is_the_median_of_the_limbs_and_knows_no_half_turns():
    near_half = {Place.LEFT_THIGH: 3.1, Place.RIGHT_THIGH: 3.1, Place.PELVIS: 3.1}
    after = {Place.LEFT_THIGH: 0.0, Place.RIGHT_THIGH: 0.05 + 2 * np.pi, Place.PELVIS: 1.5}

    turn = turn_between(near_half, after)

    assert turn is not None
    assert np.remainder(turn, 2 * np.pi) == pytest.approx(3.05)
    assert turn_between(near_half, {Place.LEFT_FOOT: 1.0}) is None


def test_a_reference_in_which_somebody_moved_is_replaced_by_its_repetition():
    take, truth = turned_take(wobble=(Place.LEFT_FOOT, 0.0, 4.5), poses=(N_HOLD, BOW_HOLD, AGAIN))

    motion = solve(take).motion

    assert motion.alignment.from_s == AGAIN.time
    facing = rotation.multiply(rotation.about(2, -TURN), truth[Place.LEFT_FOOT][800])
    assert np.degrees(rotation.angle_between(motion.world_from_segment[800, SEGMENT_OF[Place.LEFT_FOOT]], facing)) < 1


def test_when_somebody_moved_in_every_reference_the_last_is_told():
    take, _ = turned_take(wobble=(Place.LEFT_FOOT, 0.0, 20.0), poses=(N_HOLD, Mark(13.0, "pose", "t", 16.0)))

    with pytest.raises(MovedDuringHold) as refusal:
        solve(take)

    assert refusal.value.pose == "t"
    assert refusal.value.places == ("left_foot",)


def test_a_limb_that_moved_in_the_bow_is_named_and_takes_nothing_from_it():
    take, _ = turned_take(wobble=(Place.LEFT_FOOT, 5.5, 8.5), poses=(N_HOLD, BOW_HOLD))

    motion = solve(take).motion

    assert motion.alignment.limbs[Place.LEFT_FOOT].source == "unknown"
    assert motion.alignment.limbs[Place.RIGHT_FOOT].source == "bow"
    assert "Moved in the hold bow, so that it tells nothing: left foot." in motion.notes


def test_a_repeated_bow_stands_in_for_the_limb_that_moved_in_the_first():
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    body = {}
    for place in LOWER:
        moving = procedure(place, np.where(time < 10, time, np.minimum(time - 5.0, 9.9)))
        waving = np.radians(12) * np.sin(2 * np.pi * 0.8 * time) * ((time > 5.5) & (time < 8.5))
        body[place] = rotation.multiply(moving, rotation.about(2, waving)) if place is Place.LEFT_FOOT else moving
    take, _ = worn_take(LOWER, SECONDS, motion=body, poses=(N_HOLD, BOW_HOLD, Mark(11.0, "pose", "bow", 13.0)))

    alignment = solve(take).motion.alignment

    assert alignment.limbs[Place.LEFT_FOOT].source == "bow"


def carrying(began=11.0, places=LOWER):
    """A take that begins at 11 s, in motion, and what of the calibration at its start must be known."""
    take, truth = worn_take(places, SECONDS)
    alignment = solve(take).motion.alignment
    seen = {}
    for place in places:
        segment_from_sensor = rotation.inverse(np.array(alignment.limbs[place].sensor_from_segment))
        seen[place] = tuple(rotation.multiply(truth[place][round(began * RATE)], segment_from_sensor).tolist())
    moved = replace(alignment, from_s=N_HOLD.time - began, to_s=N_HOLD.end - began)
    carried = CarriedAlignment(moved, 0.0, seen)
    late = rested(cut(take, began))  # nobody rests in a take that begins in motion
    late = replace(late, setup=replace(late.setup, carried=carried))
    return late, {place: true[round(began * RATE) :] for place, true in truth.items()}


@METHODS
def test_a_take_that_carries_its_calibration_needs_no_pose(method):
    take, truth = carrying()

    motion = solve(take, SolveOptions(method=method)).motion

    # Live, a filter that starts in the middle of a swing finds its tilt by and by.
    for place in LOWER:
        assert error_of(motion, truth, place, 6.0, 13.0) < 4.0, place
        assert motion.measured[place][1:-1].all()
    assert motion.alignment is take.setup.carried.alignment
    assert not any("first second" in note for note in motion.notes)
    assert any("7 s before the take began" in note for note in motion.notes)


def test_the_carried_heading_is_that_of_the_tracks_own_filter():
    """By geometry: turn the track as found, and the attitude in the wearer's world comes out."""
    take, truth = carrying()
    assert take.setup.carried is not None
    motion = solve(take).motion

    for place in LOWER:
        track = solve_tracks(take, SolveOptions())[sensor_of(place)]
        wearer = rotation.multiply(
            motion.world_from_segment[0, SEGMENT_OF[place]],
            rotation.inverse(np.array(motion.alignment.limbs[place].sensor_from_segment)),
        )
        turn = rotation.multiply(wearer, rotation.inverse(attitude_at(track, np.array([0.0]))[0]))
        assert abs(turn[1]) + abs(turn[2]) < 1e-9  # about z alone
        assert error_of(motion, truth, place, 0.0, 0.01) < 3.0


def test_a_sensor_that_was_silent_when_the_take_began_is_unknown():
    take, _ = carrying()

    motion = solve(silent(take, Place.LEFT_FOOT, -1.0, 0.5)).motion

    assert not motion.measured[Place.LEFT_FOOT].any()
    assert any("left foot" in note for note in motion.notes)


def test_a_tag_that_starts_anew_in_a_take_that_carries_its_calibration_is_told_by_a_hold():
    """There is no reference hold in the take; the turn comes from the limbs whose heading was carried into it."""
    take, truth = turned_take()
    alignment = solve(take).motion.alignment
    began = 9.0
    seen = {}
    for place in LOWER:
        segment_from_sensor = rotation.inverse(np.array(alignment.limbs[place].sensor_from_segment))
        seen[place] = tuple(rotation.multiply(truth[place][round(began * RATE)], segment_from_sensor).tolist())
    moved = replace(alignment, from_s=N_HOLD.time - began, to_s=N_HOLD.end - began)
    late = restarted(cut(take, began), Place.LEFT_SHANK, 3.0)
    waving = turned_body(wobble=(Place.PELVIS, 12.0, 17.0))  # so that the pose is no reference of its own
    pelvis = worn_take(LOWER, SECONDS, motion=waving)[0]
    late = changed(late, Place.PELVIS, lambda _: cut(pelvis, began).stream(sensor_of(Place.PELVIS)))
    hold = Mark(AGAIN.time - began, "pose", "n", AGAIN.end - began)
    late = replace(late, marks=(hold,), setup=replace(late.setup, carried=CarriedAlignment(moved, 0.0, seen)))

    motion = solve(late).motion

    assert motion.alignment is moved
    assert any("could not be used" in note for note in motion.notes)
    assert motion.measured[Place.LEFT_SHANK][motion.time > 3.1].all()
    shank = {place: true[round(began * RATE) :] for place, true in truth.items()}
    assert error_of(motion, shank, Place.LEFT_SHANK, 4.0, 15.0) < 3.0


def test_poses_held_in_the_take_win_over_what_it_carries():
    take, _ = worn_take(LOWER)
    alignment = solve(take).motion.alignment
    nonsense = replace(alignment, pose="t", from_s=-9.0, to_s=-6.0)
    seen = dict.fromkeys(LOWER, (1.0, 0.0, 0.0, 0.0))
    carrying_too = replace(take, setup=replace(take.setup, carried=CarriedAlignment(nonsense, 0.0, seen)))

    assert solve(carrying_too).motion.alignment == alignment


def test_a_carried_calibration_of_sensors_that_were_all_silent_is_refused():
    take, _ = carrying()
    assert take.setup.carried is not None
    nobody = replace(take.setup.carried, wearer_from_sensor={})

    with pytest.raises(HeadingsUnknown):
        solve(replace(take, setup=replace(take.setup, carried=nobody)))


def test_live_the_headings_in_force_belong_to_the_groups_they_are_given_for():
    take, truth = worn_take(LOWER)
    again = restarted(take, Place.LEFT_SHANK, 9.0)
    alignment: Alignment = solve(take).motion.alignment
    solver = Solver(take.setup, "vqf", {})
    for stream in again.streams:
        solver.add_sensor(stream.info)
    frames = [frame for sample in samples_of(again) for frame in solver.push(sample)]
    tracks = solver.tracks()
    headings = {}
    for place in LOWER:
        track, limb = tracks[sensor_of(place)], alignment.limbs[place]
        sensor = rotation.multiply(truth[place][480], rotation.inverse(np.array(limb.sensor_from_segment)))
        turn = rotation.multiply(sensor, rotation.inverse(track.attitude[480]))
        headings[place] = {int(track.group[480]): float(rotation.twist_about(turn, 2))}

    solver.use(alignment, headings)
    poses = [pose for frame in frames if (pose := solver.pose(frame)) is not None]

    assert len(poses) == len(frames)
    assert headings[Place.LEFT_SHANK].keys() == {1}
    for row, pose in enumerate(poses):
        assert (Place.LEFT_SHANK in pose.measured) == (row >= 450), row
    late = poses[480]
    assert late is not None
    last = late.world_from_segment[SEGMENT_OF[Place.LEFT_SHANK]]
    assert np.degrees(rotation.angle_between(last, truth[Place.LEFT_SHANK][480])) < 2.0


@METHODS
@pytest.mark.parametrize("mounting", ["unknown", "strapped"])
def test_a_pose_held_again_in_a_take_that_carries_its_calibration_does_not_spoil_it(method, mounting):
    """N-pose alone tells nothing, or the strap rule's guess, of what N-pose and bow had told before the take."""
    began = 9.0
    take, truth = turned_take()
    alignment = solve(take).motion.alignment
    seen = {}
    for place in LOWER:
        segment_from_sensor = rotation.inverse(np.array(alignment.limbs[place].sensor_from_segment))
        seen[place] = tuple(rotation.multiply(truth[place][round(began * RATE)], segment_from_sensor).tolist())
    moved = replace(alignment, from_s=N_HOLD.time - began, to_s=N_HOLD.end - began)
    late = rested(cut(take, began))
    hold = Mark(AGAIN.time - began, "pose", "n", AGAIN.end - began)
    setup = replace(late.setup, carried=CarriedAlignment(moved, 0.0, seen), mounting=mounting)

    motion = solve(replace(late, marks=(hold,), setup=setup), SolveOptions(method=method)).motion

    assert motion.alignment is moved
    after = {place: true[round(began * RATE) :] for place, true in truth.items()}
    for place in LOWER:
        assert motion.measured[place][1:-1].all()
        assert error_of(motion, after, place, 8.0, 14.0) < 4.0, place


@METHODS
def test_a_heading_that_drifted_until_a_further_hold_is_named_with_its_degrees(method):
    """By geometry: the shank's tag turns about the vertical by 20° between the holds; the others keep theirs."""
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    body = turned_body()
    drift = rotation.about(2, np.radians(20.0) * np.clip((time - 9.0) / 2.0, 0, 1))
    off = {p: rotation.multiply(drift, m) if p is Place.LEFT_SHANK else m for p, m in body.items()}
    poses = (N_HOLD, BOW_HOLD, AGAIN)

    notes = solve(worn_take(LOWER, SECONDS, motion=off, poses=poses)[0], SolveOptions(method=method)).motion.notes
    steady = solve(worn_take(LOWER, SECONDS, motion=body, poses=poses)[0], SolveOptions(method=method)).motion

    (note,) = (note for note in notes if "drifted" in note)
    assert any(f"left shank by {degrees}°." in note for degrees in (19, 20, 21))
    assert "," not in note.partition(":")[2]
    assert not any("drifted" in note for note in steady.notes)
