"""The figure: what covers what, what is known of each limb, and which way it faces: judged by pixels."""

import math

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QImage

from studio.core import rotation
from studio.core.body import PLACES, Place, Segment, Skeleton
from studio.ui.models.stage_pose import StagePose
from studio.ui.theme import DARK, LIGHT, contrast
from studio.ui.views.stage.body_parts import Body, body_parts
from studio.ui.views.stage.camera import standing as camera_of
from studio.ui.views.stage.figure_painter import FigurePainter
from studio.ui.views.stage.side_letters import hidden_letters
from tests.ui.stage_poses import SKELETON, changed, picture, stage, standing, walking

BODY = Body(SKELETON)
NAMES = [part.name for part in BODY.parts]
ARMS_OUT = {"left": Segment.LeftHand, "right": Segment.RightHand}

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")


def order(pose, view, *, from_behind=False):
    """The painting order as places in it, by name and place."""
    target = pose.joints[Segment.Hips] * (1.0, 1.0, 0.95)
    camera = camera_of(view, SKELETON.stature, 0.0, from_behind, target)
    seen = FigurePainter(BODY).project(camera, pose)
    return {(BODY.parts[row].name, BODY.parts[row].place): turn for turn, row in enumerate(seen.order)}


def colour(widget, point):
    x, y = widget.camera.project(np.asarray(point)).round().astype(int)
    return picture(widget)[y, x]


def is_bluish(rgb):
    return rgb[2] > rgb[0] + 30


def is_orange(rgb):
    return rgb[0] > rgb[2] + 30


@pytest.mark.parametrize("dark", [True, False])
@pytest.mark.parametrize("mirrored", [False, True])
def test_the_left_hand_is_blue_and_the_right_one_orange_on_both_sides_of_the_body(qtbot, dark, mirrored):
    widget, pose = stage(qtbot, dark=dark), standing("t")
    widget.mirrored = mirrored
    widget.show_pose(pose)
    widget.view("front")
    palms = {side: pose.joints[hand] * (1.0, 1.08, 1.0) for side, hand in ARMS_OUT.items()}

    assert is_bluish(colour(widget, palms["left"]))
    assert is_orange(colour(widget, palms["right"]))
    assert (widget.camera.project(palms["left"])[0] > widget.camera.project(palms["right"])[0]) is not mirrored


def test_the_nearer_hand_is_painted_over_the_farther_one(qtbot):
    """From the side both arms of a T-pose fall on one line: only the near hand is seen at its place."""
    widget, pose = stage(qtbot), standing("t")
    widget.show_pose(pose)
    widget.view("side")
    near = pose.joints[Segment.RightHand] + (-0.02, -0.08, 0.0)

    assert is_orange(colour(widget, near))

    widget.mirrored = True
    near = pose.joints[Segment.LeftHand] + (-0.02, 0.08, 0.0)

    assert is_bluish(colour(widget, near))


def test_an_arm_in_front_of_the_chest_covers_it_and_one_behind_is_covered():
    pose = standing()
    for reach, is_over in ((90.0, True), (-60.0, False)):
        world = pose.world_from_segment.copy()
        arm = [Segment.RightArm, Segment.RightForeArm, Segment.RightHand]
        across = rotation.about(2, math.radians(reach * 0.7))
        forward = rotation.about(1, math.radians(-reach))
        world[arm] = rotation.multiply(across, rotation.multiply(forward, world[arm]))
        turned = StagePose(world, SKELETON.joint_positions(world, pose.joints[0]), frozenset(PLACES))
        turns = order(turned, "front")

        assert (turns["forearm", Place.RIGHT_FOREARM] > turns["chest", Place.CHEST]) is is_over


def test_in_every_step_of_a_walk_the_near_leg_covers_the_far_one():
    """The camera stands at the right side of a body that faces the world's x."""
    for pose in walking(1.2, rate=20.0):
        turns = order(pose, "side")

        assert turns["thigh", Place.RIGHT_THIGH] > turns["thigh", Place.LEFT_THIGH]
        assert turns["upper_arm", Place.RIGHT_UPPER_ARM] > turns["chest", Place.CHEST]
        assert turns["chest", Place.CHEST] > turns["upper_arm", Place.LEFT_UPPER_ARM]


@pytest.mark.parametrize("view", ["front", "side", "free"])
def test_joints_of_a_standing_body_lie_on_both_limbs_that_they_join(view):
    turns = order(standing(), view)
    for side in ("left", "right"):
        knee, thigh, shank = (
            turns[name, Place(f"{side}_{place}")]
            for name, place in (("knee", "shank"), ("thigh", "thigh"), ("shank", "shank"))
        )

        assert knee > max(thigh, shank)


def test_the_nose_is_seen_from_the_front_and_the_side_but_not_from_behind():
    nose, head = ("nose", Place.HEAD), ("head", Place.HEAD)
    front, side, behind = (
        order(standing(), "front"),
        order(standing(), "side"),
        order(standing(), "front", from_behind=True),
    )

    assert front[nose] > front[head]
    assert side[nose] > side[head]
    assert behind[nose] < behind[head]


def test_the_face_is_darker_only_on_the_side_that_faces(qtbot):
    widget, pose = stage(qtbot), standing()
    widget.show_pose(pose)
    widget.view("front")
    eyes = pose.joints[Segment.Head] + (0.07, 0.04, 0.103)
    face = colour(widget, eyes)
    widget.mirrored = True
    back = colour(widget, eyes)

    assert face.sum() < 0.6 * back.sum()


def test_unmeasured_limbs_are_hatched_and_silent_ones_hollow(qtbot):
    widget = stage(qtbot)
    pictures = []
    for pose in (
        standing(),
        standing(measured=[place for place in PLACES if place is not Place.LEFT_THIGH]),
        standing(silent={Place.LEFT_THIGH: "Left thigh: silent for 3 s"}),
    ):
        widget.show_pose(pose)
        widget.view("front")
        pictures.append(picture(widget))
    solid, hatched, hollow = pictures

    assert changed(solid, hatched) > 500
    assert changed(solid, hollow) > 500
    assert changed(hatched, hollow) > 500


def test_a_hatched_limb_has_lines_and_a_hollow_one_the_ground(qtbot):
    widget = stage(qtbot, size=(1000, 700))
    along = np.linspace(0.35, 0.75, 60)  # below the pelvis
    brightness = {}
    for name, pose in {
        "solid": standing(),
        "hatched": standing(measured=[]),
        "hollow": standing(silent={Place.LEFT_THIGH: "silent"}),
    }.items():
        widget.show_pose(pose)
        widget.view("front")
        hip, knee = pose.joints[Segment.LeftUpLeg], pose.joints[Segment.LeftLeg]
        # beside the line to the name, which begins in the middle of the limb
        points = widget.camera.project(hip + along[:, None] * (knee - hip) + (0.0, -0.02, 0.0)).round().astype(int)
        brightness[name] = picture(widget)[points[:, 1], points[:, 0]].sum(axis=1)

    assert np.ptp(brightness["solid"]) < 90
    assert np.ptp(brightness["hatched"]) > 120
    assert brightness["hollow"].mean() < 0.4 * brightness["solid"].mean()


def test_limbs_without_numbers_are_left_out_and_the_rest_is_painted(qtbot):
    widget, whole = stage(qtbot), standing()
    widget.show_pose(whole)
    with_arm = picture(widget)
    world, joints = whole.world_from_segment.copy(), whole.joints.copy()
    world[Segment.LeftForeArm], joints[Segment.LeftHand] = np.nan, np.inf
    widget.show_pose(StagePose(world, joints, whole.measured))

    assert changed(with_arm, picture(widget)) > 100
    assert changed(picture(stage(qtbot)), picture(widget)) > 5000


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_body_without_numbers_is_not_painted(qtbot, value):
    widget = stage(qtbot)
    empty = picture(widget)
    widget.show_pose(StagePose(np.full((23, 4), value), np.full((23, 3), value), frozenset(PLACES)))
    widget.tick(1.0)

    assert changed(empty, picture(widget)) == 0


@pytest.mark.parametrize("dark", [True, False])
def test_the_ghost_is_an_outline_behind_the_figure(qtbot, dark):
    widget = stage(qtbot, dark=dark)
    widget.show_pose(standing())
    alone = picture(widget)
    widget.show_ghost(standing(at=(0.0, 0.6)))
    both = picture(widget)
    widget.show_ghost(None)

    assert changed(alone, both) > 500
    assert changed(alone, picture(widget)) == 0
    assert np.abs(both - alone).sum() < 0.4 * np.abs(alone - picture(stage(qtbot, dark=dark))).sum()


def test_a_taller_person_has_a_taller_figure(qtbot):
    heights = []
    for stature in (1.2, 1.9):
        seen = FigurePainter(Body(Skeleton.from_stature(stature))).project(
            camera_of("front", 1.75, 0.0, False, np.array([0.0, 0.0, 0.9])), posed(stature)
        )
        heights.append(np.ptp(seen.edges[..., 1]))

    assert heights[1] / heights[0] == pytest.approx(1.9 / 1.2, rel=0.05)


def posed(stature):
    skeleton, world = Skeleton.from_stature(stature), standing().world_from_segment
    joints = skeleton.joint_positions(world, np.array([0.0, 0.0, skeleton.hips_height()]))
    return StagePose(world, joints, frozenset(PLACES))


def test_the_body_is_as_tall_as_the_person_and_stands_on_the_floor():
    pose = standing()
    centres, _ = BODY.posed(pose.world_from_segment, pose.joints)

    assert (centres[..., 2] - BODY.radii).min() == pytest.approx(0.0, abs=0.01)
    assert (centres[..., 2] + BODY.radii).max() == pytest.approx(SKELETON.stature, abs=0.02)


def test_the_body_is_the_same_on_both_sides_and_so_is_the_axis_of_each_part():
    pose = standing()
    _, ends = BODY.posed(pose.world_from_segment, pose.joints)
    middle = [
        row for row, part in enumerate(BODY.parts) if part.tone not in ("left", "right") and "_" not in part.place.value
    ]

    assert ends[middle][..., 1] == pytest.approx(0.0, abs=1e-12)


def test_every_place_has_its_part_and_both_sides_are_alike():
    assert {part.place for part in body_parts()} == set(PLACES)
    assert [p.name for p in body_parts() if p.place.value.startswith("left_")] == [
        p.name for p in body_parts() if p.place.value.startswith("right_")
    ]


@pytest.mark.parametrize("pose", ["n", "t"])
@pytest.mark.parametrize("from_behind", [False, True])
def test_feet_and_free_hands_have_their_letters_whole(qtbot, from_behind, pose):
    """A letter is a disc or a square of the side's own colour, which nothing else has: gloves and shoes are mixed."""
    widget = stage(qtbot, size=(1000, 700))
    widget.mirrored = from_behind
    widget.show_pose(standing(pose))
    widget.view("front")

    assert badges(widget, DARK.left) == pytest.approx(2, abs=0.2)
    assert badges(widget, DARK.right) == pytest.approx(2, abs=0.2)


def test_a_hand_behind_the_body_has_no_letter(qtbot):
    widget = stage(qtbot, size=(1000, 700))
    world = standing().world_from_segment.copy()
    arm = [Segment.LeftArm, Segment.LeftForeArm, Segment.LeftHand]
    world[arm[0]] = rotation.multiply(rotation.about(1, math.radians(35)), world[arm[0]])
    world[arm[1:]] = rotation.multiply(rotation.about(0, math.radians(-30)), world[arm[1:]])
    widget.show_pose(StagePose(world, SKELETON.joint_positions(world, standing().joints[0]), frozenset(PLACES)))
    widget.view("front")

    assert badges(widget, DARK.left) == pytest.approx(1, abs=0.2)
    assert badges(widget, DARK.right) == pytest.approx(2, abs=0.2)


def badges(widget, token):
    """How many letters of a colour are seen, by their area: a disc or a square, less the ink of the letter."""
    size = round(widget._theme.pixels("caption") * 1.5)  # noqa: SLF001
    whole = size**2 * (math.pi / 4 if token == DARK.left else 1.0)
    rgb = np.array([int(token[i : i + 2], 16) for i in (1, 3, 5)])
    return (np.abs(picture(widget) - rgb).max(axis=2) < 4).sum() / (0.75 * whole)


@pytest.mark.parametrize("dark", [True, False])
def test_the_figure_stands_out_from_its_ground(qtbot, dark):
    """Graphics need a contrast of 3: limbs in the dark theme, their rims in the light one, where limbs are bright."""
    widget, pose = stage(qtbot, dark=dark, size=(1000, 700)), standing()
    widget.show_pose(pose)
    widget.view("front")
    ground = (DARK if dark else LIGHT).window
    hip, knee = pose.joints[Segment.RightUpLeg], pose.joints[Segment.RightLeg]
    x, y = widget.camera.project((hip + knee) / 2).round().astype(int)
    row = picture(widget)[y, x - 40 : x + 1]
    best = max(contrast("#" + bytes(rgb.tolist()).hex(), ground) for rgb in row)

    assert best >= 3.0


@pytest.mark.parametrize("tokens", [DARK, LIGHT])
def test_words_are_readable_on_every_ground_of_the_stage(tokens):
    for ground in (tokens.window, tokens.raised):
        assert contrast(tokens.muted, ground) >= 4.5
        assert contrast(tokens.text, ground) >= 4.5
    for side in (tokens.left, tokens.right):
        assert contrast(tokens.on_accent, side) >= 4.5


@pytest.mark.parametrize("ratio", [1, 2, 3])
def test_screens_of_every_density_get_the_same_picture(qtbot, ratio):
    widget = stage(qtbot, size=(320, 240))
    widget.show_pose(standing("t", silent={Place.HEAD: "Head: silent"}))
    widget.show_ghost(standing(at=(0.0, 0.4)))
    image = QImage(320 * ratio, 240 * ratio, QImage.Format.Format_RGB32)
    image.setDevicePixelRatio(ratio)
    widget.render(image)
    once = widget.grab().toImage()
    small = image.scaled(320, 240, Qt.AspectRatioMode.IgnoreAspectRatio, Qt.TransformationMode.SmoothTransformation)
    apart = [
        abs(small.pixelColor(x, y).lightness() - once.pixelColor(x, y).lightness())
        for x in range(0, 320, 5)
        for y in range(0, 240, 5)
    ]

    assert np.mean(apart) < 6


def test_a_letter_does_not_lie_on_the_glove_of_the_other_side():
    """From the right side: an L that lay on the right hand, which is nearer, would call it the left one."""
    camera = camera_of("side", SKELETON.stature, 0.0, False, np.array([0.0, 0.0, 0.9]))
    seen = FigurePainter(BODY).project(camera, standing("t", turned=0.5))
    left, right = (
        next(row for row, part in enumerate(BODY.parts) if (part.name, part.tone) == ("hand", side))
        for side in ("left", "right")
    )
    on_left, on_right = seen.middles[[left]], seen.middles[[right]]
    below = on_right + np.array([0.0, 300.0])

    assert seen.order.index(right) > seen.order.index(left)
    assert hidden_letters(BODY, seen, [left], on_right, 4.0).tolist() == [True]
    assert hidden_letters(BODY, seen, [left], below, 4.0).tolist() == [False]
    assert hidden_letters(BODY, seen, [right], on_left, 4.0).tolist() == [False]


@pytest.mark.parametrize("from_behind", [False, True])
@pytest.mark.parametrize("view", ["front", "side", "free"])
def test_while_walking_the_pelvis_covers_both_thighs_and_nothing_leaps_to_the_front(view, from_behind):
    thighs = [("thigh", Place.LEFT_THIGH), ("thigh", Place.RIGHT_THIGH)]
    for pose in walking(3.0, rate=20.0):
        turns = order(pose, view, from_behind=from_behind)

        assert all(turns["pelvis", Place.PELVIS] > turns[thigh] for thigh in thighs)


def test_the_hand_at_the_near_side_covers_the_pelvis():
    turns = order(standing(), "side")

    assert turns["hand", Place.RIGHT_HAND] > turns["pelvis", Place.PELVIS]
    assert turns["forearm", Place.RIGHT_FOREARM] > turns["pelvis", Place.PELVIS]
