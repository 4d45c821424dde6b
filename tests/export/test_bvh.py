"""A BVH holds the motion: where every joint was, in the axes, units and words animation programs know.

Read by the studio's own importer, which shares nothing with the writer but the format.
"""

import re
from dataclasses import replace

import numpy as np
import pytest

from studio.core import body, rotation
from studio.core.body import Segment
from studio.core.errors import ReadBackDiffers
from studio.export.bvh import PRESETS, RATES, bvh_blocks, rate_name
from studio.export.bvh_check import compare_with_motion
from studio.export.resampling import BLOCK, timing_of, unfinished
from studio.importers.bvh import joint_positions, read_bvh
from tests.export.moving_body import motion_of, moving_body, standing, turned

A_THOUSANDTH_CENTIMETRE = 1e-5  # m
RIGHT_ARM = list(body.RIGHT_ARM)


def exported(folder, motion, preset="blender", fps=None):
    path = folder / "motion.bvh"
    path.write_bytes(b"".join(bvh_blocks(motion, PRESETS[preset], fps)))
    return path


def in_bvh_axes(world):
    """y up, z forward, x left, of world x forward, y left, z up."""
    return world[..., [1, 2, 0]]


@pytest.mark.parametrize(("preset", "unit"), [("blender", 1.0), ("motionbuilder", 100.0)])
def test_every_joint_of_every_frame_stands_where_the_motion_has_it(tmp_path, preset, unit):
    motion = moving_body(BLOCK + 200, swing=1.5)

    found = joint_positions(read_bvh(exported(tmp_path, motion, preset))) / unit

    assert np.abs(found - in_bvh_axes(motion.joint_positions())).max() < A_THOUSANDTH_CENTIMETRE


def test_the_ends_of_head_hands_and_toes_are_where_they_were(tmp_path):
    motion = standing("t")

    read = read_bvh(exported(tmp_path, motion))

    for segment, end in motion.skeleton.ends.items():
        meant = in_bvh_axes(rotation.rotate(body.reference_pose("t")[segment], end))
        np.testing.assert_allclose(read.ends[segment], meant, atol=A_THOUSANDTH_CENTIMETRE)
    assert set(read.ends) == set(motion.skeleton.ends)


def test_zero_rotation_is_the_t_pose(tmp_path):
    read = read_bvh(exported(tmp_path, standing("t")))

    np.testing.assert_allclose(read.values[:, 3:], 0, atol=1e-6)
    np.testing.assert_allclose(read.values[:, :3], [[0, 0.53 * 1.75, 0]] * 3, atol=1e-9)


def test_in_the_rest_pose_arms_are_level_and_the_body_is_as_tall_as_the_person(tmp_path):
    read = read_bvh(exported(tmp_path, standing("n", stature=1.83)))
    rest = joint_positions(replace(read, values=np.zeros((1, read.values.shape[1]))))[0]
    tips = {segment: rest[segment] + end for segment, end in read.ends.items()}

    left, right = rest[list(body.LEFT_ARM)], rest[RIGHT_ARM]
    np.testing.assert_allclose(np.ptp(left[:, 1:], axis=0), 0, atol=A_THOUSANDTH_CENTIMETRE)
    assert (np.diff(left[:, 0]) > 0.2).all()
    np.testing.assert_allclose(right, left * [-1, 1, 1], atol=A_THOUSANDTH_CENTIMETRE)
    soles = min(tips[Segment.LeftToeBase][1], tips[Segment.RightToeBase][1])
    assert tips[Segment.Head][1] - soles == pytest.approx(1.83, abs=0.001)
    assert (np.linalg.norm(read.offsets[1:], axis=1) > 0.02).all()


@pytest.mark.parametrize("preset", PRESETS)
def test_the_text_has_none_of_the_pitfalls_of_other_readers(tmp_path, preset):
    data = exported(tmp_path, moving_body(40), preset, 30).read_bytes()
    read = read_bvh(exported(tmp_path, moving_body(40), preset, 30))

    assert data.isascii()
    assert b"\r" not in data
    assert b"\t" not in data
    assert data.endswith(b"\n")
    assert b"nan" not in data.lower()
    assert read.names == tuple(segment.name for segment in Segment)
    assert all(re.fullmatch(r"[A-Za-z0-9_]{1,63}", name) for name in read.names)
    assert read.parents == body.PARENTS
    np.testing.assert_array_equal(read.offsets[0], 0)
    assert read.channels[0] == ("Xposition", "Yposition", "Zposition", "Zrotation", "Xrotation", "Yrotation")
    assert set(read.channels[1:]) == {("Zrotation", "Xrotation", "Yrotation")}
    assert read.notes == ()


@pytest.mark.parametrize("fps", RATES)
def test_a_rate_on_offer_has_its_exact_frame_time_and_count(tmp_path, fps):
    """10 s at 50 Hz and the first frame of the eleventh second."""
    read = read_bvh(exported(tmp_path, moving_body(501), fps=fps))

    assert len(read.values) == int(10 * fps) + 1
    assert read.frame_time == pytest.approx(1 / fps, rel=1e-11)
    # Blender counts frames a second from the text: nine digits make them whole.
    assert 1 / read.frame_time == pytest.approx(fps, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "frame_time"), [("23.976", "0.0417083333333"), ("29.97", "0.0333666666667"), ("24", "0.0416666666667")]
)
def test_rates_of_television_are_fractions_of_1001(tmp_path, name, frame_time):
    """1001/24000 s and 1001/30000 s: 23.976 would be off by a frame after 12 hours, 24 after a minute."""
    (fps,) = [rate for rate in RATES if rate_name(rate) == name]

    assert f"Frame Time: {frame_time}\n" in exported(tmp_path, moving_body(51), fps=fps).read_text()


def test_the_motions_own_rate_writes_its_own_frames(tmp_path):
    motion = moving_body(77, frame_s=1 / 51.2)

    read = read_bvh(exported(tmp_path, motion, fps=None))

    assert len(read.values) == 77
    assert read.frame_time == pytest.approx(1 / 51.2, rel=1e-9)


def test_resampling_halves_a_turn_instead_of_dropping_rows(tmp_path):
    """Hips turning at a constant rate: any rate reads the angle of its own time."""
    frames, rate = 101, np.radians(200)  # 2 s at 50 Hz
    still = standing("t", frames=frames)
    spun = rotation.multiply(rotation.about(2, rate * 0.02 * np.arange(frames))[:, None], still.world_from_segment)
    motion = motion_of(spun, still.hips)

    read = read_bvh(exported(tmp_path, motion, fps=120))

    heading = read.values[:, 5]  # Yrotation of the Hips
    np.testing.assert_allclose(heading, np.degrees(rate) * np.arange(241) / 120, atol=1e-5)


def test_rotations_run_on_from_frame_to_frame_across_blocks(tmp_path):
    motion = moving_body(2 * BLOCK + 50, swing=0.5)

    steps = np.abs(np.diff(read_bvh(exported(tmp_path, motion)).values[:, 3:], axis=0))

    assert steps.max() < 30  # degrees in 20 ms; a change over ±180 would be 360


def test_the_fiftieth_turn_of_a_dancer_stays_within_3600_degrees(tmp_path):
    frames = 2000
    still = standing("t", frames=frames)
    turns = rotation.about(2, np.linspace(0, 50 * 2 * np.pi, frames))
    motion = motion_of(rotation.multiply(turns[:, None], still.world_from_segment), still.hips)

    values = read_bvh(exported(tmp_path, motion)).values[:, 3:]

    assert np.abs(values).max() <= 3600
    np.testing.assert_allclose(np.mod(values[-1, 2] + 1e-5, 360), 1e-5, atol=2e-5)


def test_a_pose_that_is_not_finite_is_held_from_the_frame_before_and_counted(tmp_path):
    """Never expected of a solver; programs accept NaN silently, so it must not reach the file."""
    motion = moving_body(60)
    broken = motion.world_from_segment.copy()
    broken[20:25, Segment.LeftHand] = np.nan
    broken[0, Segment.Head] = np.nan
    hips = motion.hips.copy()
    hips[30] = np.inf
    motion = replace(motion, world_from_segment=broken, hips=hips)

    read = read_bvh(exported(tmp_path, motion))

    assert unfinished(motion) == 7
    assert np.isfinite(read.values).all()
    held = joint_positions(read)
    meant = in_bvh_axes(moving_body(60).hips)
    np.testing.assert_allclose(held[30, 0], meant[29], atol=A_THOUSANDTH_CENTIMETRE)
    np.testing.assert_allclose(held[31, 0], meant[31], atol=A_THOUSANDTH_CENTIMETRE)


def test_a_motion_of_one_frame_is_a_file_of_one_frame(tmp_path):
    motion = moving_body(1)

    assert len(read_bvh(exported(tmp_path, motion, fps=60)).values) == 1


def test_blocks_come_one_at_a_time_and_promise_the_right_count():
    motion = moving_body(3 * BLOCK)

    blocks = list(bvh_blocks(motion, PRESETS["blender"], None))

    assert len(blocks) == 4
    assert f"Frames: {3 * BLOCK}\n".encode() in blocks[0]
    assert sum(block.count(b"\n") for block in blocks[1:]) == 3 * BLOCK


class TestReadingBack:
    """The check before a file takes its place."""

    def check(self, folder, motion, meant=None, preset="blender", fps=60, change=lambda read: read):
        read = change(read_bvh(exported(folder, motion, preset, fps)))
        compare_with_motion(read, "motion.bvh", meant or motion, PRESETS[preset], fps)

    @pytest.mark.parametrize("preset", PRESETS)
    @pytest.mark.parametrize("fps", [None, *RATES])
    def test_what_was_written_is_accepted(self, tmp_path, preset, fps):
        self.check(tmp_path, moving_body(120, swing=1.5), preset=preset, fps=fps)

    def test_a_hand_turned_by_a_tenth_of_a_degree_is_found_through_its_elbow(self, tmp_path):
        motion = moving_body(120)
        other = turned(motion, [Segment.LeftForeArm], rotation.about(0, np.radians(0.1)))

        with pytest.raises(ReadBackDiffers, match="cm apart"):
            self.check(tmp_path, other, meant=motion)

    def test_hips_moved_by_a_fiftieth_of_a_millimetre_are_found(self, tmp_path):
        motion = moving_body(120)
        moved = replace(motion, hips=motion.hips + np.array([0, 0, 2e-5]))

        with pytest.raises(ReadBackDiffers, match="cm apart"):
            self.check(tmp_path, moved, meant=motion)

    def test_the_wrong_unit_is_found(self, tmp_path):
        motion = moving_body(50)
        read = read_bvh(exported(tmp_path, motion, "motionbuilder", 60))

        with pytest.raises(ReadBackDiffers, match="cm apart"):
            compare_with_motion(read, "motion.bvh", motion, PRESETS["blender"], 60)

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            (lambda read: replace(read, values=read.values[:-1]), "frames instead of"),
            (lambda read: replace(read, frame_time=0.016667), "frame time"),
            (lambda read: replace(read, names=(*read.names[:-1], "Toe")), "joints"),
            (lambda read: replace(read, parents=(*read.parents[:-1], 0)), "hang together"),
            (lambda read: replace(read, notes=("60 frames are promised, 59 are there",)), "promised"),
            (lambda read: replace(read, values=np.where(read.values > 1e9, 0, np.nan)), "cm apart"),
        ],
    )
    def test_a_damaged_file_is_refused(self, tmp_path, change, words):
        with pytest.raises(ReadBackDiffers, match=words):
            self.check(tmp_path, moving_body(50), change=change)


@pytest.mark.parametrize("fps", [None, 60])
def test_a_live_motion_keeps_its_time_although_its_rows_are_uneven(tmp_path, fps):
    """Frames of a live motion come when sensors sent; those that never came leave time and no rows."""
    even = moving_body(frames=301)
    rows = np.setdiff1d(np.arange(301), [*range(40, 60), 100, 101, 250])
    rng = np.random.default_rng(3)
    late = np.sort(np.concatenate([[0.0, 6.0], even.time[rows[1:-1]] + rng.uniform(-4e-3, 4e-3, len(rows) - 2)]))
    walked = np.outer(late, [1.0, 2.0, 0.0]) + even.hips[0]
    uneven = replace(even, time=late, world_from_segment=even.world_from_segment[rows], hips=walked)

    written = read_bvh(exported(tmp_path, uneven, fps=fps))

    step = 1 / (fps or 50)
    assert written.frame_time == pytest.approx(step)
    assert len(written.values) == round(6.0 / step) + 1
    forward = written.values[:, 2]  # of the file: world x
    assert np.ptp(np.diff(forward)) < 1e-6  # who walks evenly does so in the file
    assert forward[-1] - forward[0] == pytest.approx(6.0, abs=1e-6)


def test_the_last_frame_of_a_resampled_motion_is_within_it():
    motion = moving_body(1000)

    for fps in RATES:
        timing = timing_of(motion, fps)
        last = (timing.frames - 1) * timing.frame_s
        assert last <= motion.time[-1] + 1e-9 < last + timing.frame_s + 1e-6
