"""How the sensors sit on the body, out of held poses."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.alignment import from_bow
from studio.core.body import PLACES, PRESETS, SEGMENT_OF, Place, reference_pose
from studio.core.errors import HeadingsUnknown, PoseTooShort
from studio.core.facing import facing_from_hinges
from studio.core.hold import stillest_second
from studio.core.sample import SensorInfo
from studio.core.solver import SolveOptions, solve
from studio.core.strapping import strap_rule
from studio.core.take import Mark
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, sensor_of, stream, worn_take

LOWER = PRESETS["lower"]


def test_a_bow_gives_the_mounting_of_every_tag():
    take, _truth = worn_take(PLACES)

    alignment = solve(take).motion.alignment

    for row, place in enumerate(PLACES):
        limb = alignment.limbs[place]
        assert limb.source == "bow", place
        # Up in sensor axes is the segment's y axis in N-pose.
        up = take.streams[row].acceleration[100] / np.linalg.norm(take.streams[row].acceleration[100])
        np.testing.assert_allclose(rotation.rotate(limb.sensor_from_segment, [0, 1, 0]), up, atol=2e-3)


def test_a_limb_that_hardly_tilts_is_not_given_a_heading_by_the_bow():
    upright = np.array([0.0, 1.0, 0.0])
    for degrees, known in ((19.0, False), (21.0, True)):
        tilted = np.array([np.sin(np.radians(degrees)), np.cos(np.radians(degrees)), 0.0])
        sensor_from_segment, _ = from_bow(upright, tilted, upright, lifted=False)
        assert (sensor_from_segment is not None) == known


def test_a_bow_tells_forwards_from_backwards():
    # Tipping forwards turns the segment by -θ about its right axis, so "up" turns by +θ as seen from it.
    theta = np.radians(40)
    up = np.array([0.0, 1.0, 0.0])
    forwards = rotation.rotate(rotation.inverse(rotation.about(2, -theta)), up)
    lifted = rotation.rotate(rotation.inverse(rotation.about(2, theta)), up)

    for seen, lifting in ((forwards, False), (lifted, True)):
        sensor_from_segment, _ = from_bow(up, seen, up, lifting)
        assert sensor_from_segment is not None
        assert rotation.angle_between(sensor_from_segment, rotation.IDENTITY) < 1e-7


def t_pose_take():
    """Arms: T-pose from 1 to 4 s, N-pose from 6 to 9 s."""
    time = np.arange(round(12 * RATE) + 1) / RATE
    arms = PRESETS["upper"]
    share = np.clip((time - 4.5) / 1.0, 0, 1)
    share = share * share * (3 - 2 * share)
    motion = {
        place: rotation.slerp(
            np.tile(reference_pose("t")[SEGMENT_OF[place]], (len(time), 1)),
            reference_pose("n")[SEGMENT_OF[place]],
            share,
        )
        for place in arms
    }
    return worn_take(arms, 12.0, motion=motion, poses=(Mark(1.0, "pose", "t", 4.0), Mark(6.5, "pose", "n", 9.0)))


def test_two_poses_give_the_arms_their_mounting_without_a_bow():
    take, _truth = t_pose_take()

    alignment = solve(take).motion.alignment

    assert alignment.limbs[Place.LEFT_FOREARM].source == "two poses"
    assert alignment.limbs[Place.CHEST].source == "unknown"  # the trunk looks alike in both
    solved = solve(take).motion
    elbow = solved.parent_from_child(SEGMENT_OF[Place.LEFT_UPPER_ARM], SEGMENT_OF[Place.LEFT_FOREARM])
    assert np.degrees(rotation.angle_between(elbow, np.tile(rotation.IDENTITY, (len(solved), 1)))).max() < 0.5


def sitting_take(poses):
    """Standing from 1 to 4 s, sitting from 6.5 to 9 s."""
    time = np.arange(round(12 * RATE) + 1) / RATE
    share = np.clip((time - 4.5) / 1.0, 0, 1)
    share = share * share * (3 - 2 * share)
    motion = {
        place: rotation.slerp(
            np.tile(reference_pose("n")[SEGMENT_OF[place]], (len(time), 1)),
            reference_pose("sit")[SEGMENT_OF[place]],
            share,
        )
        for place in LOWER
    }
    return worn_take(LOWER, 12.0, motion=motion, poses=poses)


def test_sitting_after_standing_tells_of_the_thighs():
    take, truth = sitting_take((Mark(1.0, "pose", "n", 4.0), Mark(6.5, "pose", "sit", 9.0)))

    motion = solve(take).motion

    assert motion.alignment.limbs[Place.LEFT_THIGH].source == "two poses"
    assert motion.alignment.limbs[Place.LEFT_SHANK].source == "unknown"
    thigh = motion.world_from_segment[:, SEGMENT_OF[Place.LEFT_THIGH]]
    assert np.degrees(rotation.angle_between(thigh, truth[Place.LEFT_THIGH])).max() < 0.5


def test_while_sitting_the_knees_are_in_front_of_the_hips():
    held = reference_pose("sit")[SEGMENT_OF[Place.LEFT_THIGH]]

    np.testing.assert_allclose(rotation.rotate(held, [0, -1, 0]), [1, 0, 0], atol=1e-12)
    np.testing.assert_allclose(rotation.rotate(held, [0, 0, 1]), [0, -1, 0], atol=1e-12)


def test_who_cannot_stand_may_be_aligned_sitting():
    take, truth = sitting_take((Mark(6.5, "pose", "sit", 9.0),))
    streams = [
        stream(
            sensor_of(place),
            rotation.multiply(truth[place], rotation.inverse(strap_rule()[place])),
            take.streams[0].time,
        )
        for place in LOWER
    ]
    seated = replace(take, streams=tuple(streams), setup=replace(take.setup, mounting="strapped"))

    motion = solve(seated).motion

    assert motion.alignment.pose == "sit"
    held = motion.world_from_segment[int(8 * RATE)]
    assert np.degrees(rotation.angle_between(held, reference_pose("sit"))).max() < 0.2


def strapped_take(off):
    """Tags put on by the pictures, each turned by up to ``off`` rad about the limb."""
    take, truth = worn_take(LOWER, poses=(N_HOLD,))
    rng = np.random.default_rng(5)
    streams = []
    for place in LOWER:
        twist = rotation.about(1, off * (2 * rng.random() - 1))
        segment_from_sensor = rotation.multiply(twist, rotation.inverse(strap_rule()[place]))
        streams.append(
            stream(sensor_of(place), rotation.multiply(truth[place], segment_from_sensor), take.streams[0].time)
        )
    return replace(take, streams=tuple(streams), setup=replace(take.setup, mounting="strapped")), truth


def test_the_strap_rule_stands_in_and_is_worth_15_degrees():
    take, _truth = strapped_take(np.radians(10))

    motion = solve(take).motion

    knee = motion.alignment.limbs[Place.LEFT_SHANK]
    assert knee.source == "strap rule"
    assert np.degrees(knee.heading_sigma) == pytest.approx(15)
    held = motion.world_from_segment[int(2 * RATE)]
    assert np.degrees(rotation.angle_between(held, reference_pose("n"))).max() < 0.1


def test_a_tag_that_hangs_upside_down_does_not_follow_the_strap_rule():
    take, truth = strapped_take(0.0)
    flipped = rotation.multiply(
        truth[Place.LEFT_THIGH],
        rotation.multiply(rotation.inverse(strap_rule()[Place.LEFT_THIGH]), rotation.about(2, np.pi)),
    )
    row = LOWER.index(Place.LEFT_THIGH)
    streams = list(take.streams)
    streams[row] = stream(sensor_of(Place.LEFT_THIGH), flipped, take.streams[0].time)

    motion = solve(replace(take, streams=tuple(streams))).motion

    assert motion.alignment.limbs[Place.LEFT_THIGH].source == "unknown"
    assert not motion.measured[Place.LEFT_THIGH].any()


def bending_legs(heading):
    """Sensors with a common heading; the wearer faces ``heading`` in it and walks with bending knees."""
    time = np.arange(round(20 * RATE) + 1) / RATE
    walk = np.clip(time - 6, 0, 1)
    motion = {}
    for place in LOWER:
        bend = np.zeros(len(time))
        if place.value.endswith(("shank", "foot")):
            bend = -np.radians(50) * walk * (0.5 - 0.5 * np.cos(2 * np.pi * time + place.number))
        motion[place] = rotation.multiply(reference_pose("n")[SEGMENT_OF[place]], rotation.about(2, bend))
    take, _ = worn_take(LOWER, poses=(N_HOLD,), motion=motion)
    rng = np.random.default_rng(7)
    streams = []
    for place in LOWER:
        world_from_sensor = rotation.multiply(
            rotation.about(2, heading), rotation.multiply(motion[place], rotation.normalise(rng.normal(size=4)))
        )
        info = SensorInfo(sensor_of(place), 1 / RATE, orientation="world", common_world=True)
        made = stream(sensor_of(place), world_from_sensor, time, info=info)
        streams.append(replace(made, orientation=world_from_sensor))
    return replace(take, streams=tuple(streams)), motion


@pytest.mark.parametrize("heading", [0.0, 2.0, -3.0])
def test_a_common_heading_and_bending_knees_tell_where_the_wearer_faced(heading):
    take, truth = bending_legs(heading)

    motion = solve(take, SolveOptions(attitude="vqf")).motion

    assert motion.alignment.limbs[Place.LEFT_SHANK].source == "common world"
    knee = motion.parent_from_child(SEGMENT_OF[Place.LEFT_THIGH], SEGMENT_OF[Place.LEFT_SHANK])
    true = rotation.multiply(rotation.inverse(truth[Place.LEFT_THIGH]), truth[Place.LEFT_SHANK])
    assert np.degrees(rotation.angle_between(knee, true)).max() < 1.5


def test_stiff_knees_do_not_tell_where_the_wearer_faced():
    take, _ = worn_take(LOWER, 9.0)  # a bow bends them by 85°, what comes before it not at all
    tracks = solve(take).tracks
    worn = {place: tracks[sensor_of(place)] for place in LOWER}
    standing = {
        place: replace(t, **{n: getattr(t, n)[: int(4 * RATE)] for n in ("time", "attitude", "run")})
        for place, t in worn.items()
    }
    turns = dict.fromkeys(LOWER, 0.0)

    assert facing_from_hinges(standing, turns, 1.0) is None
    assert facing_from_hinges(worn, turns, 1.0) is not None


def test_the_stillest_second_avoids_the_moment_in_which_the_wearer_sways():
    take, _ = worn_take((Place.PELVIS,), 12.0, poses=(N_HOLD, BOW_HOLD))
    track = next(iter(solve(take).tracks.values()))
    swaying = replace(track, speed=np.where((track.time > 1.0) & (track.time < 2.4), 0.3, 0.0))

    assert 2.4 <= stillest_second([swaying], N_HOLD) <= 3.0


def test_a_pose_outside_the_take_is_refused_with_its_times():
    take, _ = worn_take(LOWER)

    with pytest.raises(PoseTooShort) as refusal:
        solve(take, SolveOptions(poses=(Mark(50.0, "pose", "n", 52.0),)))

    assert (refusal.value.from_s, refusal.value.to_s) == (50.0, 52.0)


def test_a_pose_may_be_a_single_moment():
    take, _truth = worn_take(LOWER)

    motion = solve(take, SolveOptions(poses=(Mark(2.0, "pose", "n", 2.0), BOW_HOLD))).motion

    assert all(limb.source == "bow" for limb in motion.alignment.limbs.values())


def test_the_procedure_of_these_tests_starts_upright():
    for place in PLACES:
        start = procedure(place, np.array([0.0, 2.0]))
        assert rotation.angle_between(start, reference_pose("n")[SEGMENT_OF[place]]).max() < 1e-12


def test_with_sitting_as_the_reference_the_bow_tells_nothing():
    take, _ = sitting_take((Mark(6.5, "pose", "sit", 9.0), Mark(1.0, "pose", "bow", 4.0)))

    with pytest.raises(HeadingsUnknown):
        solve(take)
