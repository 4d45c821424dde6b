"""Judging holds: who moved is named, the others are aligned; a repeated limb joins the body it belongs to."""

from dataclasses import replace

import numpy as np
import pytest

from studio.capture.procedures.judged_hold import BodyHolds, limb_results
from studio.core import rotation
from studio.core.body import PRESETS, SEGMENT_OF, Place, reference_pose
from studio.core.errors import HeadingsUnknown, MovedDuringHold
from studio.core.solver import SolveOptions, solve_tracks
from studio.core.take import Mark
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, procedure, worn_take

UPPER = PRESETS["upper"]
RESTLESS = Place.LEFT_FOREARM
TURN = np.radians(70.0)
AGAIN = Mark(12.0, "pose", "n", 15.0)
SECONDS = 24.0


def restless_take():
    """N-pose in which the left forearm waves, a bow, and another N-pose facing 70° further to the left."""
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    motion = {place: procedure(place, time, walking=0.0) for place in UPPER}
    waving = np.radians(12.0) * np.sin(2 * np.pi * 0.8 * time) * (time < 4.4)
    motion[RESTLESS] = rotation.multiply(motion[RESTLESS], rotation.about(2, waving))
    turn = rotation.about(2, TURN * np.clip((time - 10.0) / 1.5, 0, 1))
    motion = {place: rotation.multiply(turn, moving) for place, moving in motion.items()}
    take, truth = worn_take(UPPER, SECONDS, motion=motion)
    return replace(take, marks=()), truth


@pytest.fixture(scope="module")
def worn():
    take, truth = restless_take()
    return take, solve_tracks(take, SolveOptions()), truth


def judged(holds, worn):
    take, tracks, _ = worn
    return holds.judge(tracks, take.setup.assignment, take.setup.mounting, SECONDS)


def error_of(alignment, place, worn, time):
    """Return how far a limb is from the truth at a time, degrees."""
    take, tracks, truth = worn
    limb = alignment.limbs[place]
    track = tracks[take.setup.assignment.sensors[place]]
    row = int(np.searchsorted(track.time, time))
    headed = rotation.multiply(rotation.about(2, limb.heading), track.attitude[row])
    found = rotation.multiply(headed, np.array(limb.sensor_from_segment))
    return float(np.degrees(rotation.angle_between(found, truth[place][row])))


def test_who_moved_is_named_and_the_others_are_aligned(worn):
    holds = BodyHolds()
    holds.add(N_HOLD)
    holds.add(BOW_HOLD)

    alignment, error = judged(holds, worn)

    assert isinstance(error, MovedDuringHold)
    assert error.places == (RESTLESS.value,)
    assert set(alignment.limbs) == set(UPPER) - {RESTLESS}
    results = {limb.place: limb.grade for limb in limb_results(alignment, error)}
    assert results[RESTLESS] == "moved"
    assert set(results.values()) == {"good", "moved"}


def test_a_limb_repeated_alone_follows_the_body_although_the_wearer_faced_elsewhere(worn):
    holds = BodyHolds()
    holds.add(N_HOLD)
    holds.add(BOW_HOLD)
    holds.add(AGAIN, (RESTLESS,))

    alignment, error = judged(holds, worn)

    assert error is None
    assert alignment.limbs[RESTLESS].source == "bow"
    # The bow is exact here; what is left is how level and how still the filters found the holds.
    for time in (7.0, 13.0, 20.0):
        assert error_of(alignment, RESTLESS, worn, time) < 2.0
        assert error_of(alignment, Place.CHEST, worn, time) < 2.0


def test_a_limb_held_before_the_bow_keeps_its_own_hold_when_the_bow_comes(worn):
    late_bow = BOW_HOLD  # the order of adding is what matters, not the order of time
    holds = BodyHolds()
    holds.add(N_HOLD)
    holds.add(AGAIN, (RESTLESS,))
    before = judged(holds, worn)
    assert isinstance(before.error, HeadingsUnknown)

    holds.add(late_bow)
    alignment, error = judged(holds, worn)

    assert error is None
    assert error_of(alignment, RESTLESS, worn, 13.0) < 2.0


def test_a_new_reference_of_the_whole_body_begins_anew(worn):
    holds = BodyHolds()
    holds.add(N_HOLD)
    holds.add(BOW_HOLD)

    holds.add(AGAIN)

    assert holds.poses == (AGAIN,)
    alignment, _ = judged(holds, worn)
    assert set(alignment.limbs) == set(UPPER)


def test_nobody_else_is_blamed_while_one_limb_is_repeated(worn):
    holds = BodyHolds()
    holds.add(AGAIN)
    holds.add(N_HOLD, (Place.RIGHT_HAND,))  # the left forearm waves meanwhile

    alignment, error = judged(holds, worn)

    assert not isinstance(error, MovedDuringHold)
    assert set(alignment.limbs) == set(UPPER)


def test_who_moved_in_the_bow_is_named_with_the_bow_and_keeps_the_others():
    time = np.arange(round(SECONDS * RATE) + 1) / RATE
    motion = {place: procedure(place, time, walking=0.0) for place in UPPER}
    waving = np.radians(12.0) * np.sin(2 * np.pi * 0.8 * time) * ((time > 5.5) & (time < 8.5))
    motion[RESTLESS] = rotation.multiply(motion[RESTLESS], rotation.about(2, waving))
    take, truth = worn_take(UPPER, SECONDS, motion=motion)
    holds = BodyHolds()
    holds.add(N_HOLD)
    holds.add(BOW_HOLD)

    alignment, error = judged(holds, (take, solve_tracks(take, SolveOptions()), truth))

    assert isinstance(error, MovedDuringHold)
    assert (error.pose, error.places) == ("bow", (RESTLESS.value,))
    sources = {place: limb.source for place, limb in alignment.limbs.items()}
    assert sources.pop(RESTLESS) == "unknown"
    assert set(sources.values()) == {"bow"}


def test_the_procedure_of_these_tests_is_upright_in_both_holds(worn):
    _, _, truth = worn
    row = round(13.0 * RATE)
    turned = rotation.multiply(rotation.about(2, TURN), reference_pose("n")[SEGMENT_OF[Place.CHEST]])
    np.testing.assert_allclose(rotation.angle_between(truth[Place.CHEST][row], turned), 0.0, atol=1e-6)
