"""The judge of the simulated suit: what it compares, and what it tells about what it cannot compare."""

from dataclasses import replace

import numpy as np
import pytest

from studio.acquisition.synthetic.truth import decode_truth
from studio.capture.truth import judge
from studio.core import rotation
from studio.core.body import MEASURED_PARENT, PLACES, SEGMENT_OF, Place
from studio.core.solver import solve
from studio.storage.take_reader import read_attachment, read_take, take_zero
from tests.journeys.command_line import recorded, say


@pytest.fixture(scope="module")
def walked(tmp_path_factory):
    """A short walk of a calibrated suit: its folder, its motion, and the truth."""
    folder = recorded("synthetic:walk?speed=max&calibrated=1", 13, tmp_path_factory.mktemp("walk"))
    attached = read_attachment(folder, "truth")
    assert attached is not None
    return folder, solve(read_take(folder)[0]).motion, decode_truth(attached)


def true_motion(motion, truth, zero, later):
    """Return the motion with the true segments in place of the found ones, as measured ``later`` s before."""
    world = motion.world_from_segment.copy()
    at = motion.time + zero - later
    after = np.searchsorted(truth.time, at).clip(1, len(truth.time) - 1)
    share = (at - truth.time[after - 1]) / (truth.time[after] - truth.time[after - 1])
    for place in PLACES:
        column = truth.world_from_segment[:, PLACES.index(place)]
        world[:, SEGMENT_OF[place]] = rotation.slerp(column[after - 1], column[after], share)
    return replace(motion, world_from_segment=world)


def test_the_true_motion_has_no_error_and_its_delay_is_found(walked):
    folder, motion, truth = walked
    zero = take_zero(folder)

    for delay in (0.0, 0.02):
        report = judge(true_motion(motion, truth, zero, delay), truth, zero)

        assert report.shift_s == pytest.approx(delay, abs=1e-9)
        assert report.worst() < 0.1
        assert set(report.joint_rms_deg) == set(report.measured_share) == set(MEASURED_PARENT)


def test_an_error_of_one_segment_is_one_of_its_joints_alone(walked):
    folder, motion, truth = walked
    zero = take_zero(folder)
    true = true_motion(motion, truth, zero, 0.0)
    off = true.world_from_segment.copy()
    foot = SEGMENT_OF[Place.LEFT_FOOT]
    off[:, foot] = rotation.multiply(off[:, foot], rotation.about(0, np.radians(7.0)))

    before, after = (judge(one, truth, zero) for one in (true, replace(true, world_from_segment=off)))

    assert after.joint_rms_deg[Place.LEFT_FOOT] == pytest.approx(7.0, abs=0.3)
    assert after.joint_rms_deg[Place.RIGHT_FOOT] == before.joint_rms_deg[Place.RIGHT_FOOT]


def test_what_is_not_measured_is_not_judged_and_told(walked):
    folder, motion, truth = walked
    half = np.arange(len(motion)) % 2 == 0
    never = np.zeros(len(motion), bool)
    measured = {**motion.measured, Place.LEFT_FOOT: half, Place.RIGHT_HAND: never}

    report = judge(replace(motion, measured=measured), truth, take_zero(folder))

    assert report.measured_share[Place.LEFT_FOOT] == pytest.approx(0.5, abs=0.01)
    assert report.measured_share[Place.RIGHT_HAND] == 0.0
    assert Place.RIGHT_HAND not in report.joint_rms_deg
    assert len(report.measured_share) == len(MEASURED_PARENT)


def test_a_person_is_told_how_many_joints_were_judged_over_how_much_time_and_how_shifted(walked):
    folder, *_ = walked

    said = say("inspect", folder, "--truth").out

    assert "over 14 of 14 joints" in said
    assert said.count("% measured") == 14
    assert "ms earlier than the studio believes" in said
