"""Paper 001: from absolute to relative rotations, to the frames of an animation, without jumps."""

import numpy as np
import pytest

from studio.core import euler, rotation
from studio.core.body import Segment
from studio.export.bvh import PRESETS, RATES, SEQUENCE, bvh_blocks
from studio.importers.bvh import read_bvh
from tests.export.moving_body import moving_body
from tests.journeys.command_line import say

# Error of subtracting Euler angles, median and 95th percentile in degrees, for angles within ± the first column: the
# errata of the acceptance list.
BY_SUBTRACTION = ((10, 0.9, 2.6), (30, 8, 22), (60, 32, 79), (90, 64, 146))


@pytest.mark.parametrize(("within", "median", "largest"), BY_SUBTRACTION)
def test_1_09_erratum_subtracting_euler_angles_is_no_relative_rotation(within, median, largest):
    """Equations 14 to 16 against parent⁻¹ · child, which is exact."""
    parent, child = np.radians(np.random.default_rng(9).uniform(-within, within, (2, 20_000, 3)))
    world_from_parent, world_from_child = euler.from_roll_pitch_yaw(parent), euler.from_roll_pitch_yaw(child)

    exact = rotation.multiply(rotation.inverse(world_from_parent), world_from_child)

    back = rotation.angle_between(rotation.multiply(world_from_parent, exact), world_from_child)
    wrong = np.degrees(rotation.angle_between(euler.from_roll_pitch_yaw(child - parent), exact))
    assert back.max() < 1e-12
    assert np.median(wrong) == pytest.approx(median, rel=0.15)
    assert np.percentile(wrong, 95) == pytest.approx(largest, rel=0.15)


def test_1_09_about_one_common_axis_the_difference_is_right():
    angles = np.radians(np.random.default_rng(9).uniform(-170, 170, (2, 1000)))

    relative = rotation.multiply(rotation.inverse(rotation.about(2, angles[0])), rotation.about(2, angles[1]))

    assert rotation.angle_between(relative, rotation.about(2, angles[1] - angles[0])).max() < 1e-7


@pytest.mark.parametrize("fps", RATES)
def test_1_12_a_frame_stands_at_its_time_between_the_samples(tmp_path, fps):
    """Equations 12 and 13: frame = t / δt. What turns evenly has turned by k / fps times its rate at frame k."""
    rate = 2.1  # rad/s about z, and as fast about the file's y
    motion = moving_body(151)
    upright = motion.world_from_segment[0]
    turned = rotation.multiply(rotation.about(2, rate * motion.time)[:, None], upright)
    even = type(motion)(**{**vars(motion), "world_from_segment": turned})
    (tmp_path / "even.bvh").write_bytes(b"".join(bvh_blocks(even, PRESETS["blender"], fps)))

    written = read_bvh(tmp_path / "even.bvh")

    time = np.arange(len(written.values)) / fps
    assert written.frame_time == pytest.approx(1 / fps, rel=1e-11)
    assert time[-1] == pytest.approx(3.0, abs=1 / fps)
    hips = euler.from_euler(np.radians(written.values[:, 3:6]), SEQUENCE)
    since_start = rotation.multiply(hips, rotation.inverse(hips[:1]))
    assert rotation.angle_between(since_start, rotation.about(1, rate * time)).max() < 1e-6


def test_1_12_frames_that_fall_on_samples_are_the_samples(walk_take, tmp_path):
    for fps in ("native", "25", "60"):
        done = say("export", walk_take, "--format", "bvh", "--fps", fps, "-o", tmp_path / f"{fps}.bvh")
        assert done.code == 0

    native, half, more = (read_bvh(tmp_path / f"{fps}.bvh").values for fps in ("native", "25", "60"))

    for sampled, again in ((native[::2], half), (native[::5], more[::6])):
        rows = min(len(sampled), len(again))
        away = np.radians(sampled[:rows, 3:].reshape(rows, len(Segment), 3)), again[:rows, 3:]
        first = euler.from_euler(away[0], SEQUENCE)
        second = euler.from_euler(np.radians(away[1].reshape(rows, len(Segment), 3)), SEQUENCE)
        assert rotation.angle_between(first, second).max() < 1e-6  # 1e-6 degrees are written
        assert np.abs(sampled[:rows, :3] - again[:rows, :3]).max() < 1e-8


def test_1_13_half_a_turn_about_all_three_axes_is_no_turn():
    """Figure 8: (0, 0, 0) and (180, 180, 180) are one rotation."""
    turned = euler.from_roll_pitch_yaw(np.radians([180.0, 180.0, 180.0]))

    assert rotation.angle_between(turned, rotation.IDENTITY) < 1e-7
    unwrapped = euler.unwrap_continuous(np.radians([[0.0, 0.0, 0.0], [180.0, 180.0, 180.0]]), "ZYX")
    np.testing.assert_allclose(unwrapped[1], 0, atol=1e-12)


def test_1_13_turning_round_and_round_runs_on_without_jumps():
    """Three turns about z while nodding: angles wrapped to ±180° jump, the filtered ones go on to 1080°."""
    turn = np.radians(np.linspace(0, 1080, 400))
    angles = np.stack([turn, 0.5 * np.sin(3 * turn), 0.4 * np.cos(2 * turn)], axis=1)
    wrapped = euler.wrap(angles)
    assert np.abs(np.diff(wrapped, axis=0)).max() > np.radians(300)

    filtered = euler.unwrap_continuous(wrapped, "ZXY")

    np.testing.assert_allclose(filtered, angles, atol=1e-9)


def test_1_13_no_angle_in_a_written_walk_jumps(walk_take, tmp_path):
    assert say("export", walk_take, "--format", "bvh", "-o", tmp_path / "walk.bvh").code == 0

    steps = np.abs(np.diff(read_bvh(tmp_path / "walk.bvh").values[:, 3:], axis=0))

    assert steps.max() < 20  # degrees in a sixtieth of a second
