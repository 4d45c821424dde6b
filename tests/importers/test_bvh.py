"""BVH: which files are read and how they are understood, and which are refused with their line.

The rules are contracts §9; what other readers make of the same variants is biomechanics-and-formats §4.1.
"""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from studio.core.errors import RecordingUnreadable
from studio.importers.bvh import joint_positions, read_bvh

DATA = Path(__file__).parents[1] / "data" / "bvh"
# joints, channels, frames promised, rows, frame time: counted with grep and wc in the files
REAL = {
    "animated-drawings/dab.bvh": (27, 84, 339, 339, 0.0333333),
    "animated-drawings/jesse_dance.bvh": (60, 183, 1007, 120, 0.01),
    "animated-drawings/jumping_jacks.bvh": (31, 96, 125, 125, 0.03333),
    "bvh-python/test_freebvh.bvh": (55, 168, 69, 69, 0.0333333),
    "bvh-python/test_mocapbank.bvh": (19, 60, 455, 455, 0.033333),
    "bvhio/example.bvh": (18, 57, 2, 2, 0.033333),
    "fairmotion/01_01.bvh": (31, 96, 2752, 200, 0.0083333),
    "fairmotion/pfnn_hierarchy.bvh": (31, 96, 60, 60, 0.0333333),
    "fairmotion/sinusoidal.bvh": (4, 15, 120, 120, 0.016666666666666666),
    "wspr-arena/louise.bvh": (18, 57, 2998, 200, 0.01),
    "wspr-arena/walk.bvh": (31, 96, 344, 344, 0.0083333),
    "xia/example.bvh": (31, 96, 278, 278, 0.0083333),
    "xia/neutral_01_000.bvh": (31, 96, 327, 327, 0.008333),
    "xia/raw.bvh": (31, 96, 48, 48, 0.033333),
    "xia/rest.bvh": (31, 96, 1, 1, 0.041667),
}

SMALL = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Spine
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.02
1 2 3 0 0 0 0 0 0
1 2 3 90 0 0 0 0 0
"""
FIRST_ROW = 19  # its 1-based line in SMALL


@pytest.fixture
def read(tmp_path):
    def write_and_read(text):
        path = tmp_path / "motion.bvh"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_bvh(path)

    return write_and_read


def refused(read, text):
    with pytest.raises(RecordingUnreadable) as refusal:
        read(text)
    return refusal.value.line, refusal.value.reason


def test_every_real_file_of_the_test_data_is_expected_below():
    assert {path.relative_to(DATA).as_posix() for path in DATA.rglob("*.bvh")} == set(REAL)


@pytest.mark.parametrize("name", REAL)
def test_real_files_are_read_in_full(name):
    joints, channels, promised, rows, frame_time = REAL[name]

    bvh = read_bvh(DATA / name)

    assert (len(bvh.names), bvh.values.shape, bvh.frame_time) == (joints, (rows, channels), frame_time)
    last_row = (DATA / name).read_text(encoding="utf-8").split("\n")[::-1]
    assert list(bvh.values[-1]) == [float(word) for word in next(row for row in last_row if row.strip()).split()]
    assert bool(bvh.notes) == (promised != rows)


@pytest.mark.parametrize("name", REAL)
def test_joint_positions_agree_with_rotation_matrices_of_another_library(name):
    from scipy.spatial.transform import Rotation

    bvh = read_bvh(DATA / name)
    frame = len(bvh.values) // 2
    row, start = bvh.values[frame], 0
    place: dict[int, NDArray[np.float64]] = {}
    turn: dict[int, NDArray[np.float64]] = {}
    for joint, channels in enumerate(bvh.channels):
        told = dict(zip(channels, row[start : start + len(channels)], strict=True))
        start += len(channels)
        order = "".join(channel[0] for channel in channels if channel.endswith("rotation"))
        angles = [angle for channel, angle in told.items() if channel.endswith("rotation")]
        local = Rotation.from_euler(order, angles, degrees=True).as_matrix()
        step = [told.get(f"{axis}position", bvh.offsets[joint][i]) for i, axis in enumerate("XYZ")]
        parent = bvh.parents[joint]
        place[joint] = place[parent] + turn[parent] @ step if parent >= 0 else np.array(step)
        turn[joint] = turn[parent] @ local if parent >= 0 else local

    # 1e-9 of the file's unit: both use double precision, numbers are below 1000 and chains below 12 joints
    assert joint_positions(bvh)[frame] == pytest.approx(np.array([place[joint] for joint in place]), abs=1e-9)


def test_a_quarter_turn_about_z_lays_an_upright_bone_to_the_side(read):
    positions = joint_positions(read(SMALL))

    assert positions == pytest.approx(np.array([[[1, 2, 3], [1, 12, 3]], [[1, 2, 3], [-9, 2, 3]]]))


def test_rotations_apply_in_the_order_of_their_channels(read):
    turned = SMALL.replace("1 2 3 90 0 0", "0 0 0 90 90 0").replace("OFFSET 0 10 0", "OFFSET 0 0 10")

    # Z then X, intrinsic: Rz(90) Rx(90) takes z to Rz(90)(-y) = x
    assert joint_positions(read(turned))[1, 1] == pytest.approx([10, 0, 0])


def test_position_channels_of_the_root_replace_its_offset(read):
    doubled = SMALL.replace("OFFSET 0 0 0", "OFFSET 0 90 0", 1)

    assert joint_positions(read(doubled))[0, 0] == pytest.approx([1, 2, 3])


def test_position_channels_of_a_joint_replace_its_offset(read):
    moved = SMALL.replace("CHANNELS 3 Zrotation", "CHANNELS 6 Xposition Yposition Zposition Zrotation")
    moved = moved.replace("0 0 0 0 0 0\n", "0 0 0 7 0 0 0 0 0\n").replace("90 0 0 0 0 0\n", "90 0 0 7 0 0 0 0 0\n")

    assert joint_positions(read(moved))[:, 1] == pytest.approx(np.array([[8, 2, 3], [1, 9, 3]]))


def test_a_joint_may_have_one_channel_or_none(read):
    hinge = SMALL.replace("CHANNELS 3 Zrotation Xrotation Yrotation", "CHANNELS 1 Xrotation")
    hinge = hinge.replace("0 0 0 0 0 0\n", "0 0 0 30\n").replace("90 0 0 0 0 0\n", "90 0 0 30\n")
    rigid = hinge.replace("CHANNELS 1 Xrotation", "CHANNELS 0").replace(" 30\n", "\n")

    assert read(hinge).values[:, 6] == pytest.approx([30, 30])
    assert joint_positions(read(rigid)) == pytest.approx(joint_positions(read(SMALL)))


@pytest.mark.parametrize(
    "same",
    [
        "\ufeff" + SMALL,
        SMALL.replace("\n", "\r\n"),
        SMALL.replace("\n", "\r"),
        SMALL.replace(" ", "\t").replace("Frame\tTime", "Frame Time"),
        SMALL.replace(" ", "  ").replace("Frame  Time", "Frame Time").replace("\n", "  \n"),
        SMALL.replace("MOTION\n", "MOTION\n\n").replace("0.02\n", "2e-02\n\n") + "\n\n",
        SMALL.replace("Hips\n{", "Hips {").replace("End Site", "end site").replace("Xposition", "XPOSITION"),
        SMALL.replace("1 2 3 0 0", "1.0E0 +2 3. .0 0"),
    ],
    ids=["BOM", "CRLF", "CR", "tabs", "blanks", "blank lines", "braces and case", "ways to write numbers"],
)
def test_ways_of_writing_the_same_file_make_no_difference(read, same):
    plain, other = read(SMALL), read(same)

    assert (other.names, other.parents, other.channels) == (plain.names, plain.parents, plain.channels)
    assert np.array_equal(other.values, plain.values)
    assert other.frame_time == plain.frame_time
    assert other.notes == ()
    assert np.array_equal(other.ends[1], [0, 5, 0])


@pytest.mark.parametrize("promised", [0, 1, 3])
def test_rows_count_when_the_header_promises_another_number(read, promised):
    bvh = read(SMALL.replace("Frames: 2", f"Frames: {promised}"))

    assert len(bvh.values) == 2
    assert bvh.notes == (f"{promised} frames are promised, 2 are there",)


def test_a_skeleton_without_frames_is_a_motion_of_no_frames(read):
    bvh = read(SMALL[: SMALL.index("1 2 3")].replace("Frames: 2", "Frames: 0"))

    assert joint_positions(bvh).shape == (0, 2, 3)


@pytest.mark.parametrize("name", ["mixamorig:Spine", "Lower Back", "Wirbelsäule", "Spine.L", "x" * 100])
def test_names_are_kept_as_written(read, name):
    assert read(SMALL.replace("Spine", name)).names == ("Hips", name)


def test_joints_of_one_name_are_read_and_said(read):
    bvh = read(SMALL.replace("Spine", "Hips"))

    assert bvh.names == ("Hips", "Hips")
    assert bvh.notes == ("several joints are called Hips",)


def test_a_second_end_of_a_joint_is_left_out_and_said(read):
    end = "    End Site\n    {\n      OFFSET 0 5 0\n    }\n"
    bvh = read(SMALL.replace(end, end + end.replace("5", "6")))

    assert np.array_equal(bvh.ends[1], [0, 5, 0])
    assert bvh.notes == ("Spine has more than one End Site, the first holds",)


@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("1 2 3 nan 0 0 0 0 0", "'nan' is no finite number"),
        ("1 2 3 -Inf 0 0 0 0 0", "'-Inf' is no finite number"),
        ("1 2 3 1e999 0 0 0 0 0", "'1e999' is too large"),
        ("1 2 3 90,5 0 0 0 0 0", "'90,5' has a decimal comma"),
        ("1 2 3 90 0 0 0 0", "there are 8 values for 9 channels"),
        ("1 2 3 90 0 0 0 0 0 0", "there are 10 values for 9 channels"),
        ("1 2 3 9_0 0 0 0 0 0", "'9_0' is no number"),
        ("1 2 3 9O 0 0 0 0 0", "'9O' is no number"),
        ("1 2 3 ٣ 0 0 0 0 0", "'٣' is no number"),
    ],
)
def test_a_row_that_cannot_be_believed_is_refused_with_its_line(read, row, reason):
    text = SMALL.replace("1 2 3 90 0 0 0 0 0", row)

    assert refused(read, text) == (FIRST_ROW + 1, reason)


def test_rows_that_all_have_one_value_too_many_are_refused_at_the_first(read):
    text = SMALL.replace("0 0 0 0 0\n", "0 0 0 0 0 0\n")

    assert refused(read, text) == (FIRST_ROW, "there are 10 values for 9 channels")


def test_blank_lines_do_not_shift_the_line_that_is_named(read):
    text = SMALL.replace("1 2 3 90 0 0 0 0 0", "\n\n1 2 3 90")

    assert refused(read, text)[0] == FIRST_ROW + 3


@pytest.mark.parametrize(
    ("written", "instead", "line", "reason"),
    [
        ("HIERARCHY\n", "", 1, "it does not begin with HIERARCHY"),
        ("MOTION", "MOTIONS", 16, "'MOTIONS' has no place here"),
        (SMALL[SMALL.index("MOTION") :], "", 16, "there is no MOTION"),
        ("Frames: 2\n", "", 17, "Frames: is missing"),
        ("Frames: 2", "Frames: two", 17, "'two' is no number of frames"),
        ("Frames: 2", f"Frames: {'9' * 5000}", 17, f"'{'9' * 24}…' is no number of frames"),
        ("Frame Time: 0.02\n", "", 18, "Frame Time: is missing"),
        ("0.02", "0", 18, "the frame time is not above zero"),
        ("0.02", "-0.02", 18, "the frame time is not above zero"),
        ("0.02", "0,02", 18, "'0,02' has a decimal comma"),
        ("0.02", "NaN", 18, "'NaN' is no finite number"),
        ("OFFSET 0 10 0", "OFFSET 0 10", 8, "OFFSET has fewer than three numbers"),
        ("OFFSET 0 10 0", "OFFSET 0 nan 0", 8, "'nan' is no finite number"),
        ("    OFFSET 0 10 0\n", "", 13, "the joint 'Spine' has no OFFSET"),
        ("JOINT Spine", "JOINT", 6, "a joint has no name"),
        ("JOINT Spine", "ROOT Spine", 6, "ROOT has no place here"),
        ("ROOT Hips", "JOINT Hips", 2, "JOINT has no place here"),
        ("CHANNELS 3 ", "CHANNELS 4 ", 9, "CHANNELS does not name as many different channels as it counts"),
        ("CHANNELS 3 Z", "CHANNELS 3 X", 9, "CHANNELS does not name as many different channels as it counts"),
        ("CHANNELS 3 Z", "CHANNELS 3 W", 9, "CHANNELS does not name as many different channels as it counts"),
        ("CHANNELS 3 ", "CHANNELS -3 ", 9, "CHANNELS does not name as many different channels as it counts"),
        ("}\nMOTION", "MOTION", 15, "1 braces are still open"),
        ("}\nMOTION", "}\n}\nMOTION", 16, "stray brace"),
        ("ROOT Hips\n{\n", "ROOT Hips\n", 3, "'OFFSET' stands where a brace opens"),
    ],
)
def test_a_broken_skeleton_is_refused_with_its_line(read, written, instead, line, reason):
    assert written in SMALL

    assert refused(read, SMALL.replace(written, instead, 1)) == (line, reason)


def test_a_file_without_channels_or_joints_is_refused(read):
    assert refused(read, "HIERARCHY\nMOTION\n") == (2, "there is no joint")
    assert refused(read, "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}\nMOTION\nFrames: 0\nFrame Time: 1\n")[1] == (
        "no joint has a channel"
    )
    assert refused(read, b"")[1] == "there is no MOTION"


def test_a_folder_or_a_missing_file_is_refused_as_a_whole(tmp_path):
    for path in (tmp_path, tmp_path / "nothing.bvh"):
        with pytest.raises(RecordingUnreadable) as refusal:
            read_bvh(path)
        assert refusal.value.line == 0


def test_a_skeleton_may_be_deep_but_not_without_bound(read):
    deep = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n"
    link = "JOINT b\n{\nOFFSET 0 1 0\n"
    motion = "MOTION\nFrames: 1\nFrame Time: 1\n90\n"

    chain = read(deep + link * 1999 + "}\n" * 2000 + motion)

    assert joint_positions(chain)[0, -1] == pytest.approx([0, 0, 1999])
    assert refused(read, deep + link * 100_000)[1] == "there are more than 2000 joints"


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    edits=st.lists(
        st.tuples(st.integers(0, len(SMALL) - 1), st.integers(0, 12), st.binary(max_size=6)), min_size=1, max_size=4
    )
)
def test_whatever_is_done_to_a_file_it_is_read_or_refused(read, edits):
    text = bytearray(SMALL.encode())
    for at, length, instead in edits:
        text[at : at + length] = instead
    try:
        bvh = read(bytes(text))
    except RecordingUnreadable:
        return

    assert np.isfinite(joint_positions(bvh)).all()
    assert bvh.values.shape[1] == sum(map(len, bvh.channels))


_WORDS = st.sampled_from([word for line in SMALL.splitlines() for word in (*line.split(), "\n")])


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(_WORDS, max_size=80), st.sampled_from(["", SMALL, SMALL[: SMALL.index("MOTION")]]))
def test_words_in_any_order_are_read_or_refused(read, words, before):
    try:
        bvh = read(before + " ".join(words))
    except RecordingUnreadable:
        return

    assert np.isfinite(joint_positions(bvh)).all()
