"""The true motion: a body of known geometry that does what the script says, smoothly, with its feet on the floor."""

import numpy as np
import pytest

from studio.acquisition.synthetic.body_truth import Performer
from studio.acquisition.synthetic.gait import COURSE_SWING, course
from studio.acquisition.synthetic.scripts import PRELUDE_CUES, SCRIPT_BEGINS, WORN_SCRIPTS
from studio.acquisition.synthetic.suit import make_scene
from studio.acquisition.synthetic.unworn import FIRST_REST, REST_TIME, TURN_AXES, TURN_TIME
from studio.acquisition.synthetic.words import read_words
from studio.core import frames, rotation
from studio.core.body import PLACES, SEGMENT_OF, Segment, reference_pose

N_HOLD, BOW_HOLD = (np.arange(cue.time, cue.end, 0.01) for cue in PRELUDE_CUES)
MEASURED = [int(SEGMENT_OF[place]) for place in PLACES]
SWAY = 3.0  # degrees; six deviations of the lean


def performer(script: str, seed: int = 1, stature: float = 1.75) -> Performer:
    return Performer(WORN_SCRIPTS[script], stature, np.random.default_rng(seed))


def joint_vector(pose: np.ndarray, parent: Segment, child: Segment) -> np.ndarray:
    """Return the rotation vectors of a joint in degrees."""
    joint = rotation.multiply(rotation.inverse(pose[:, parent]), pose[:, child])
    return np.degrees(rotation.to_rotation_vector(joint))


def foot_points(body: Performer, times: np.ndarray) -> np.ndarray:
    """Return both heels and balls, (n, 4, 3), world."""
    pose, hips = body.true_pose(times)
    joints = body.skeleton.joint_positions(pose, hips)
    return np.stack(
        [
            joints[:, foot] + rotation.rotate(pose[:, foot], point)
            for foot in (Segment.LeftFoot, Segment.RightFoot)
            for point in body.skeleton.foot_points()
        ],
        axis=1,
    )


@pytest.mark.parametrize("script", WORN_SCRIPTS)
def test_every_worn_script_begins_with_the_n_pose(script):
    pose, hips = performer(script).true_pose(N_HOLD)

    off = np.degrees(rotation.angle_between(pose, reference_pose("n")))
    assert off.max() < SWAY
    assert off[:, Segment.Hips].mean() > 0.2  # the performer is no statue
    assert hips[:, 2] == pytest.approx(0.53 * 1.75, abs=0.005)


def test_the_lean_of_quiet_standing_is_half_a_degree():
    # Sixteen performers for ten minutes each: the deviation of the deviation is below 10 %.
    times = np.arange(0.0, 600.0, 0.5) + SCRIPT_BEGINS
    leans = []
    for seed in range(16):
        pose, _ = performer("n", seed).true_pose(times)
        leans.append(np.degrees(rotation.angle_between(pose[:, Segment.Spine3], frames.N_POSE)))

    assert np.sqrt(np.mean(np.square(leans))) == pytest.approx(0.56, abs=0.06)  # 0.45, 0.22, and 0.14 about each axis


def test_in_the_bow_all_fifteen_segments_tilt_by_more_than_25_degrees_about_their_right_axis():
    body = performer("bow")
    ups = [
        rotation.rotate(rotation.inverse(body.true_pose(hold)[0][:, MEASURED]), frames.UP).mean(axis=0)
        for hold in (N_HOLD, BOW_HOLD)
    ]

    before, after = (up / np.linalg.norm(up, axis=-1, keepdims=True) for up in ups)
    tilt = np.degrees(np.arccos((before * after).sum(axis=-1)))
    axis = np.cross(before, after)
    assert tilt.min() > 25.0
    assert np.degrees(np.arcsin(np.linalg.norm(axis[:, :2], axis=-1) / np.linalg.norm(axis, axis=-1))).max() < 6.0


def test_the_t_pose_is_held_when_its_mark_says_so():
    cue = WORN_SCRIPTS["t"].cues[-1]
    pose, _ = performer("t").true_pose(np.arange(cue.time, cue.end, 0.01))

    assert cue.label == "t"
    assert np.degrees(rotation.angle_between(pose, reference_pose("t"))).max() < SWAY


def test_walking_has_the_knee_of_walking_and_its_speed():
    times = np.arange(15.0, 45.0, 0.01)
    pose, hips = performer("walk").true_pose(times)

    for upper, lower in ((Segment.LeftUpLeg, Segment.LeftLeg), (Segment.RightUpLeg, Segment.RightLeg)):
        flexion = -joint_vector(pose, upper, lower)[:, 2]
        assert flexion.max() == pytest.approx(60.0, abs=2.0)
        assert flexion.min() > 0.0
    way = np.linalg.norm(np.diff(hips[:, :2], axis=0), axis=1).sum()
    assert way / 30.0 == pytest.approx(1.3, abs=0.03)


def test_walking_keeps_the_feet_on_the_floor_and_the_standing_foot_still():
    times = np.arange(13.0, 30.0, 0.01)
    points = foot_points(performer("walk"), times)

    low = points[..., 2].min(axis=1)
    assert low.min() > -0.025
    assert low.max() < 0.01
    # where the ball is within 12 mm of the floor and lower than the heel, the foot pushes: it must not slide
    right_heel, right_ball = points[:-1, 2], points[:-1, 3]
    stands = (right_ball[:, 2] < 0.012) & (right_heel[:, 2] < 0.05)
    speed = np.linalg.norm(np.diff(points[:, 3, :2], axis=0), axis=1) / 0.01
    assert np.median(speed[stands]) < 0.15  # m/s; a swinging foot makes 3 to 4


def test_arms_swing_against_the_legs():
    times = np.arange(15.0, 30.0, 0.01)
    pose, _ = performer("walk").true_pose(times)

    arm = joint_vector(pose, Segment.Spine3, Segment.RightArm)[:, 2]
    leg = joint_vector(pose, Segment.Hips, Segment.RightUpLeg)[:, 2]
    assert np.corrcoef(arm, leg)[0, 1] < -0.7
    assert np.ptp(arm) > 30.0


def test_the_course_is_walked_at_the_speed_of_its_distance():
    distance = np.linspace(0.0, 40.0, 40_001)
    heading, place = course(distance)

    step = np.diff(place, axis=0)
    assert np.linalg.norm(step, axis=1) == pytest.approx(np.diff(distance), rel=1e-4)
    between = 0.5 * (heading[1:] + heading[:-1])
    assert np.arctan2(step[:, 1], step[:, 0]) == pytest.approx(between, abs=1e-3)
    assert np.abs(heading).max() == pytest.approx(COURSE_SWING, abs=1e-6)


def test_sitting_down_brings_the_pelvis_to_the_height_of_a_chair():
    times = np.arange(SCRIPT_BEGINS, SCRIPT_BEGINS + 8.0, 0.01)
    body = performer("sit")
    pose, hips = body.true_pose(times)

    assert 0.4 < hips[:, 2].min() < 0.55
    flexion = -joint_vector(pose, Segment.RightUpLeg, Segment.RightLeg)[:, 2]
    assert flexion.max() == pytest.approx(88.0, abs=3.0)
    assert flexion[0] < 3.0
    assert np.abs(foot_points(body, times)[..., 2]).max() < 0.02


@pytest.mark.parametrize("script", [*WORN_SCRIPTS, "turns"])
def test_motion_is_smooth_through_every_transition(script):
    # A jump of the acceleration would be as large at half the step; a smooth one halves.
    scene = make_scene(read_words(script), np.random.default_rng(1))

    def largest_jump(step: float) -> float:
        times = np.arange(0.0, 25.0, step)
        position = scene.carried(times).position
        position = position + rotation.rotate(scene.carried(times).orientation, np.array([0.1, 0.1, 0.1]))
        return float(np.abs(np.diff(position, 3, axis=0)).max() / step**2)

    assert largest_jump(0.005) < 0.65 * largest_jump(0.01)


def test_unmeasured_segments_follow_the_rule_that_the_solver_follows():
    times = np.arange(0.0, 20.0, 0.1)
    pose, _ = performer("reach").true_pose(times)

    for segment, share in ((Segment.Spine, 0.25), (Segment.Spine1, 0.5), (Segment.Spine2, 0.75)):
        between = rotation.slerp(pose[:, Segment.Hips], pose[:, Segment.Spine3], share)
        assert rotation.angle_between(pose[:, segment], between).max() < 1e-7
    for rigid, carrier in (
        (Segment.Neck, Segment.Spine3),
        (Segment.LeftShoulder, Segment.Spine3),
        (Segment.RightShoulder, Segment.Spine3),
        (Segment.LeftToeBase, Segment.LeftFoot),
        (Segment.RightToeBase, Segment.RightFoot),
    ):
        assert (pose[:, rigid] == pose[:, carrier]).all()


def test_elbows_and_knees_are_no_perfect_hinges():
    pose, _ = performer("walk").true_pose(np.arange(15.0, 25.0, 0.01))

    vector = joint_vector(pose, Segment.RightUpLeg, Segment.RightLeg)
    bent = vector[np.argmin(vector[:, 2])]
    axis_off = np.degrees(np.arctan2(np.hypot(bent[0], bent[1]), -bent[2]))
    assert 1.0 < axis_off < 5.0


def test_the_box_makes_whole_turns_about_spread_axes_with_rests_between():
    scene = make_scene(read_words("turns"), np.random.default_rng(1))
    starts = FIRST_REST + np.arange(TURN_AXES) * (TURN_TIME + REST_TIME)
    axes, shortfalls = [], []
    for start in starts:
        box = scene.carried(np.linspace(start, start + TURN_TIME, 200)).orientation[:, 0]
        steps = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(box[:-1]), box[1:]))
        axes.append(steps[len(steps) // 2] / np.linalg.norm(steps[len(steps) // 2]))
        shortfalls.append(abs(np.degrees(np.linalg.norm(steps, axis=1).sum()) - 360.0))
        rest = scene.carried(start + TURN_TIME + np.linspace(0.0, REST_TIME, 50)).orientation[:, 0]
        assert rotation.angle_between(rest[0], rest).max() < 1e-9

    assert max(shortfalls) < 5.0
    # The six unknowns of A^T A are determined when the squares of the axes are (accuracy.md, section 2).
    x, y, z = np.array(axes).T
    design = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z], axis=1)
    assert np.linalg.cond(design) < 5.0
