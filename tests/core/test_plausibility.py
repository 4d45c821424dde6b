"""Poses that were not held as they are called: refused where gravity is certain, doubted where the motion tells."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PLACES, PRESETS, SEGMENT_OF, Place, reference_pose
from studio.core.errors import HeadingsUnknown, PoseNotHeld
from studio.core.solver import solve
from studio.core.strapping import strap_rule
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, sensor_of, stream, worn_take

EXCHANGED = (replace(N_HOLD, label="bow"), replace(BOW_HOLD, label="n"))
SECONDS = 20.0
LIFTED_ARMS = ("arm", "hand")
TIME = np.arange(round(SECONDS * RATE) + 1) / RATE


def from_pose_to_pose(first, second):
    """Both held for 3 s, then both again and again: world_from_segment of all places."""
    share = np.where(TIME < 5.0, 0.0, np.where(TIME < 10.0, np.clip(TIME - 5.0, 0, 1), 0.5 + 0.5 * np.cos(TIME - 10.0)))
    share = share * share * (3 - 2 * share)
    return {
        place: rotation.slerp(
            np.tile(reference_pose(first)[SEGMENT_OF[place]], (len(TIME), 1)),
            np.tile(reference_pose(second)[SEGMENT_OF[place]], (len(TIME), 1)),
            share,
        )
        for place in PLACES
    }


def strapped_take(places=PLACES, motion=None, poses=(N_HOLD, BOW_HOLD), off=15.0, seed=0):
    """Tags put on by the pictures, each off by up to ``off`` degrees about any axis."""
    take, truth = worn_take(places, SECONDS, motion=motion, poses=poses)
    rng = np.random.default_rng(seed)
    streams = []
    for place in places:
        axis = rng.normal(size=3)
        slip = rotation.from_rotation_vector(np.radians(off) * rng.random() * axis / np.linalg.norm(axis))
        segment_from_sensor = rotation.multiply(slip, rotation.inverse(strap_rule()[place]))
        streams.append(stream(sensor_of(place), rotation.multiply(truth[place], segment_from_sensor), TIME))
    return replace(take, streams=tuple(streams), setup=replace(take.setup, mounting="strapped"))


def test_a_t_pose_called_bow_is_refused_because_no_trunk_bows_without_tilting():
    take, _ = worn_take(PLACES, SECONDS, motion=from_pose_to_pose("n", "t"), poses=(N_HOLD, BOW_HOLD))

    with pytest.raises(PoseNotHeld) as refusal:
        solve(take)

    assert (refusal.value.pose, refusal.value.held) == ("bow", "t")
    assert set(refusal.value.places) == {place.value for place in PRESETS["upper"][2:]}


def test_arms_may_be_raised_high_while_the_trunk_bows():
    """The arms of a bow are held forwards, by some to the level: it is the trunk that tells a bow."""
    high = {
        place: rotation.multiply(
            procedure(place, TIME),
            rotation.about(2, np.radians(35) * ((TIME > 5.9) & (TIME < 8.1)) * place.value.endswith(LIFTED_ARMS)),
        )
        for place in PLACES
    }
    take, _ = worn_take(PLACES, SECONDS, motion=high)

    assert solve(take).motion.alignment.limbs[Place.LEFT_HAND].source == "bow"


@pytest.mark.parametrize(
    ("trunk", "legs"),
    [(Place.PELVIS, (40.0, 40.0)), (Place.CHEST, (40.0, 40.0)), (Place.CHEST, (0.0, 40.0)), (Place.PELVIS, (0.0, 0.0))],
)
def test_a_bow_out_of_the_hips_or_above_the_only_tag_of_the_trunk_is_no_t_pose(trunk, legs):
    angles = dict.fromkeys(PRESETS["upper"][2:], 85.0) | {trunk: -9.0}
    angles |= dict(zip((Place.LEFT_THIGH, Place.RIGHT_THIGH), legs, strict=True))
    ramp = np.clip((TIME - 4.5) / 1.5, 0, 1) - np.clip((TIME - 8.0) / 1.5, 0, 1)
    body = {
        place: rotation.multiply(reference_pose("n")[SEGMENT_OF[place]], rotation.about(2, np.radians(degrees) * ramp))
        for place, degrees in angles.items()
    }
    take, _ = worn_take(tuple(body), SECONDS, motion=body)

    assert solve(take).motion.alignment.limbs[Place.LEFT_UPPER_ARM].source == "bow"


def test_arms_alone_may_bow_as_they_like():
    arms = PRESETS["upper"][2:]
    motion = {place: m for place, m in from_pose_to_pose("n", "t").items() if place in arms}
    take, _ = worn_take(arms, SECONDS, motion=motion, poses=(N_HOLD, BOW_HOLD))

    assert all(limb.source == "bow" for limb in solve(take).motion.alignment.limbs.values())


@pytest.mark.parametrize(
    ("held", "named", "limbs"),
    [
        ("sit", "n", ("left_thigh", "right_thigh")),
        ("n", "sit", ("left_thigh", "right_thigh")),
        ("t", "n", tuple(place.value for place in PRESETS["upper"][2:])),
        ("n", "t", tuple(place.value for place in PRESETS["upper"][2:])),
    ],
)
def test_tags_strapped_on_as_shown_tell_one_reference_pose_from_another(held, named, limbs):
    take = strapped_take(motion=from_pose_to_pose(held, held), poses=(replace(N_HOLD, label=named),))

    with pytest.raises(PoseNotHeld) as refusal:
        solve(take)

    assert (refusal.value.pose, refusal.value.places, refusal.value.held) == (named, limbs, held)


def test_n_pose_and_bow_exchanged_are_refused_when_the_straps_are_known():
    with pytest.raises(PoseNotHeld) as refusal:
        solve(strapped_take(poses=EXCHANGED))

    assert (refusal.value.pose, refusal.value.held) == ("n", "bow")
    assert len(refusal.value.places) >= 12


@pytest.mark.parametrize("seed", range(10))
def test_straps_put_on_by_eye_never_make_the_right_poses_wrong(seed):
    body = {place: bending(place, 1.0) for place in PLACES}

    motion = solve(strapped_take(motion=body, seed=seed)).motion

    assert motion.notes == ()


def test_two_tags_upside_down_are_tags_and_no_pose():
    """Both thighs' tags hang the wrong way: no pose explains that, and the limbs fall to the next fact."""
    take = strapped_take(poses=(N_HOLD,), off=0.0)
    thighs = (Place.LEFT_THIGH, Place.RIGHT_THIGH)
    streams = list(take.streams)
    for place in thighs:
        upside_down = rotation.multiply(rotation.inverse(strap_rule()[place]), rotation.about(2, np.pi))
        streams[PLACES.index(place)] = stream(
            sensor_of(place), rotation.multiply(procedure(place, TIME), upside_down), TIME
        )

    alignment = solve(replace(take, streams=tuple(streams))).motion.alignment

    assert {place for place, limb in alignment.limbs.items() if limb.source == "unknown"} == set(thighs)


def test_exchanged_poses_of_tags_put_on_anyhow_are_doubted_because_nobody_walks_crouching():
    take, _ = worn_take(PLACES, SECONDS, poses=EXCHANGED)

    notes = solve(take).motion.notes

    assert any("exchanged" in note for note in notes)


def bending(place, sign):
    """Legs and arms that bend at knees and elbows from 10 s on, the right way with +1."""
    on = np.clip(TIME - 10.0, 0, 1)
    bend = np.zeros(len(TIME))
    if place.value.endswith(("shank", "foot")):
        bend = -sign * np.radians(50) * on * (0.5 - 0.5 * np.cos(2 * np.pi * TIME))
    if place.value.endswith(("forearm", "hand")):
        bend = sign * np.radians(50) * on * (0.5 - 0.5 * np.cos(2 * np.pi * TIME))
    return rotation.multiply(procedure(place, np.minimum(TIME, 9.9)), rotation.about(2, bend))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_knees_and_elbows_that_bend_the_wrong_way_are_named(sign):
    take, _ = worn_take(PLACES, SECONDS, motion={place: bending(place, sign) for place in PLACES})

    notes = [note for note in solve(take).motion.notes if note.startswith("Bent the wrong way")]

    if sign > 0:
        assert notes == []
    else:
        (note,) = notes
        assert all(f"{side} {joint} by up to 50°" in note for side in ("left", "right") for joint in ("knee", "elbow"))


def test_a_limb_that_tilted_half_as_far_as_between_two_poses_takes_nothing_from_them():
    """Arms raised forwards by 50 degrees are called T-pose: the axis they turned about is not the one of a T-pose."""
    arms = PRESETS["upper"]
    take, _ = worn_take(arms, SECONDS, poses=(N_HOLD, replace(BOW_HOLD, label="t")))

    with pytest.raises(HeadingsUnknown) as refusal:
        solve(take)

    assert "left_forearm" in refusal.value.places
