"""The stage as a widget: turned by hand, following, telling in words what it shows."""

import math

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QAccessible, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication

from studio.core.body import PLACES, Place, Segment
from studio.ui.models.stage_pose import StagePose
from studio.ui.views.stage import Stage
from studio.ui.views.stage.cameraman import SWING
from studio.ui.views.stage.walked_path import JUMP, KEPT, WalkedPath
from tests.ui.stage_poses import FRAME, changed, picture, stage, standing, walking

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")
MIDDLE = QPoint(320, 240)


def drag(qtbot, widget, by, button=Qt.MouseButton.LeftButton, modifier=Qt.KeyboardModifier.NoModifier):
    qtbot.mousePress(widget, button, modifier, MIDDLE)
    # QTest moves the pointer without buttons: the event that a person's hand makes is sent as it is
    place = QPointF(MIDDLE + QPoint(*by))
    moved = QMouseEvent(
        QEvent.Type.MouseMove, place, widget.mapToGlobal(place), Qt.MouseButton.NoButton, button, modifier
    )
    QApplication.sendEvent(widget, moved)
    qtbot.mouseRelease(widget, button, modifier, MIDDLE + QPoint(*by))


def wheel(widget, notches):
    place = QPointF(MIDDLE)
    event = QWheelEvent(
        place,
        widget.mapToGlobal(place),
        QPoint(),
        QPoint(0, 120 * notches),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(widget, event)
    return event.isAccepted()


class Counting(Stage):
    """Counts how often it is painted."""

    painted = 0

    def paintEvent(self, event):  # noqa: N802 (Qt's name)
        self.painted += 1
        super().paintEvent(event)


def test_a_left_drag_orbits_and_leaves_the_target(qtbot):
    widget = stage(qtbot)
    before = widget.camera
    drag(qtbot, widget, (80, 20))

    assert widget.camera.azimuth < before.azimuth
    assert widget.camera.elevation > before.elevation
    assert widget.camera.target == before.target
    assert widget.camera.distance == before.distance


@pytest.mark.parametrize(
    ("button", "modifier"),
    [
        (Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.NoModifier),
        (Qt.MouseButton.LeftButton, Qt.KeyboardModifier.ShiftModifier),
    ],
)
def test_a_middle_or_shift_drag_pans(qtbot, button, modifier):
    widget = stage(qtbot)
    widget.show_pose(standing())
    hips = standing().joints[Segment.Hips]
    before = widget.camera.project(hips)
    drag(qtbot, widget, (60, -40), button, modifier)

    assert widget.camera.project(hips) - before == pytest.approx([60, -40], abs=2.0)


def test_the_wheel_zooms_towards_and_away_within_limits(qtbot):
    widget = stage(qtbot)
    before = widget.camera.distance

    assert wheel(widget, 1)
    assert widget.camera.distance < before
    wheel(widget, -1)
    assert widget.camera.distance == pytest.approx(before)
    wheel(widget, 1000)
    assert widget.camera.distance > 0.5


def test_arrow_keys_and_plus_and_minus_do_what_the_mouse_does(qtbot):
    widget = stage(qtbot)
    before = widget.camera
    qtbot.keyClick(widget, Qt.Key.Key_Left)
    qtbot.keyClick(widget, Qt.Key.Key_Up)
    qtbot.keyClick(widget, Qt.Key.Key_Plus)

    assert widget.camera.azimuth != before.azimuth
    assert widget.camera.elevation > before.elevation
    assert widget.camera.distance < before.distance


def test_other_keys_are_left_to_the_window(qtbot):
    widget = stage(qtbot)
    before = widget.camera
    qtbot.keyClick(widget, Qt.Key.Key_R)

    assert widget.camera == before


def test_it_is_reached_by_tab_and_shows_that_it_has_the_keys(qtbot):
    widget = stage(qtbot)
    without = picture(widget)
    widget.activateWindow()
    widget.setFocus(Qt.FocusReason.TabFocusReason)
    qtbot.waitUntil(widget.hasFocus)

    assert widget.focusPolicy() & Qt.FocusPolicy.TabFocus
    assert changed(without, picture(widget)) > 1000


def test_next_view_goes_round_and_says_where_it_is(qtbot):
    widget = stage(qtbot)
    told: list[str] = []
    widget.view_changed.connect(told.append)
    for _ in range(5):
        widget.next_view()

    assert told == ["front", "side", "top", "free", "front"]


def test_a_double_click_undoes_what_the_hand_did(qtbot):
    widget = stage(qtbot)
    before = widget.camera
    drag(qtbot, widget, (100, 30))
    wheel(widget, 3)
    qtbot.mouseDClick(widget, Qt.MouseButton.LeftButton, pos=MIDDLE)

    assert widget.camera == before


def test_views_are_swung_to_unless_motion_is_reduced(qtbot):
    for reduced in (False, True):
        widget = stage(qtbot, reduced_motion=reduced)
        widget.show_pose(standing())
        widget.tick(0.0)
        before = widget.camera.azimuth
        widget.view("side")

        assert (widget.camera.azimuth == before) is not reduced
        widget.tick(SWING + FRAME)
        assert widget.camera.azimuth == pytest.approx(-math.pi / 2)


def test_mirroring_changes_the_side_of_the_camera_and_nothing_else(qtbot):
    widget, pose = stage(qtbot), standing()
    widget.show_pose(pose)
    world, joints, camera = pose.world_from_segment.copy(), pose.joints.copy(), widget.camera
    widget.mirrored = True

    assert widget.mirrored
    assert math.remainder(widget.camera.azimuth - camera.azimuth - math.pi, math.tau) == pytest.approx(0.0)
    assert (widget.camera.elevation, widget.camera.distance) == (camera.elevation, camera.distance)
    assert np.array_equal(pose.world_from_segment, world)
    assert np.array_equal(pose.joints, joints)


def test_mirroring_twice_in_mid_swing_ends_where_it_began(qtbot):
    widget = stage(qtbot)
    widget.show_pose(standing())
    widget.tick(0.0)
    before = widget.camera
    widget.mirrored = True
    widget.tick(SWING / 3)
    widget.mirrored = False
    widget.tick(2 * SWING)

    assert math.remainder(widget.camera.azimuth - before.azimuth, math.tau) == pytest.approx(0.0, abs=1e-9)


def test_following_keeps_a_walking_body_in_the_middle_third(qtbot):
    widget = stage(qtbot)
    places = []
    for frame, pose in enumerate(walking(6.0)):
        widget.show_pose(pose)
        widget.tick(frame * FRAME)
        places.append(widget.camera.project(pose.joints[Segment.Hips])[0])

    assert min(places) > 640 / 3
    assert max(places) < 640 * 2 / 3


def test_without_following_it_walks_out_of_the_picture(qtbot):
    widget = stage(qtbot)
    told: list[bool] = []
    widget.follow_changed.connect(told.append)
    poses = walking(6.0)
    widget.show_pose(poses[0])
    widget.toggle_follow()
    for frame, pose in enumerate(poses):
        widget.show_pose(pose)
        widget.tick(frame * FRAME)

    x, _ = widget.camera.project(poses[-1].joints[Segment.Hips])
    assert told == [False]
    assert not widget.follow
    assert not 0 < x < 640


def test_a_tick_repaints_only_when_something_changed(qtbot):
    widget = Counting(stage(qtbot)._theme)  # noqa: SLF001 (a theme like any other)
    qtbot.addWidget(widget)
    widget.resize(320, 240)
    widget.show()
    pose = standing()
    widget.show_pose(pose)
    widget.tick(0.0)
    QApplication.processEvents()
    widget.painted = 0
    for frame in range(1, 20):
        widget.show_pose(pose)
        widget.tick(frame * FRAME)
        QApplication.processEvents()
    assert widget.painted == 0

    widget.show_pose(standing())
    widget.tick(1.0)
    QApplication.processEvents()
    assert widget.painted == 1


def test_the_path_is_collected_while_following_and_can_be_forgotten(qtbot):
    """From above, with the body beyond the picture: what differs is the path."""
    widget = stage(qtbot)
    for pose in walking(3.0):
        widget.show_pose(pose)
    walked = picture(widget)
    widget.clear_path()

    assert changed(walked, picture(widget)) > 50


def test_a_path_that_is_given_is_shown_and_no_other(qtbot):
    widget = stage(qtbot)
    without = picture(widget)
    widget.set_path(np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]]))

    assert changed(without, picture(widget)) > 50


def test_a_path_keeps_steps_parts_at_jumps_and_forgets_the_oldest():
    path = WalkedPath()
    for x in np.arange(0.0, 0.15, 0.001):
        path.add(np.array([x, 0.0]))
    assert len(path.points) == 2
    path.add(np.array([5 * JUMP, 0.0]))
    assert np.isnan(path.points[2]).all()

    path.add(np.array([np.nan, 0.0]))
    for step in range(2 * KEPT):
        path.add(np.array([5 * JUMP + 0.12 * step, 0.0]))
    assert len(path.points) <= KEPT
    assert path.points[-1, 0] == pytest.approx(5 * JUMP + 0.12 * (2 * KEPT - 1))


def test_with_no_body_it_says_the_empty_words(qtbot):
    widget = stage(qtbot)
    blank = picture(widget)
    widget.set_empty_text("No figure yet. Put the sensors on.")

    assert widget.describe() == "No figure yet. Put the sensors on."
    assert changed(blank, picture(widget)) > 100
    widget.show_pose(standing())
    widget.show_pose(None)
    assert changed(blank, picture(widget)) > 100


@pytest.mark.parametrize(
    ("turned", "words"), [(0, "facing you"), (90, "facing right"), (-90, "facing left"), (180, "seen from behind")]
)
def test_it_says_which_way_the_figure_faces(qtbot, turned, words):
    widget = stage(qtbot)
    widget.view("front")
    widget.show_pose(standing(turned=math.radians(turned)))

    assert words in widget.describe()


def test_facing_in_words_is_where_the_nose_points_on_the_picture(qtbot):
    widget = stage(qtbot)
    widget.view("front")
    pose = standing(turned=math.radians(90))
    widget.show_pose(pose)
    head = pose.joints[Segment.Head]

    assert "right" in widget.describe()
    assert widget.camera.project(head + np.array([0.0, 0.3, 0.0]))[0] > widget.camera.project(head)[0]


def test_the_description_tells_caption_silent_sensors_and_what_is_not_measured(qtbot):
    widget = stage(qtbot)
    widget.show_pose(
        standing(
            measured=PLACES[8:],
            silent={Place.LEFT_SHANK: "Left shank: silent for 3 s"},
            caption="Right knee 61 degrees",
        )
    )

    said = widget.describe()
    assert "Right knee 61 degrees" in said
    assert "Left shank: silent for 3 s" in said
    assert "limbs not measured: 8" in said


def test_screen_readers_hear_the_description_at_most_once_a_second(qtbot):
    widget = stage(qtbot)
    widget.show_pose(standing(caption="knee 10"))
    widget.tick(10.0)
    assert widget.accessibleName() == "Figure"
    assert "knee 10" in QAccessible.queryAccessibleInterface(widget).text(QAccessible.Text.Description)

    widget.show_pose(standing(caption="knee 20"))
    widget.tick(10.5)
    assert "knee 10" in widget.accessibleDescription()
    widget.tick(11.0)
    assert "knee 20" in widget.accessibleDescription()


@pytest.mark.parametrize("size", [(240, 180), (320, 900), (1000, 700), (3840, 2160)])
@pytest.mark.parametrize("scale", [0.8, 2.0])
def test_every_size_and_text_size_paints_all_states(qtbot, size, scale):
    widget = stage(qtbot, size=size, scale=scale)
    silent = {place: f"{place.value}: silent for a rather long while by now" for place in PLACES}
    for pose in (standing(), standing(silent=silent, caption="A caption " * 20), standing(measured=[]), None):
        widget.show_pose(pose)
        widget.show_ghost(pose)
        assert picture(widget).std() > 0  # something stands out from the ground


def test_names_of_silent_limbs_stand_beside_the_limbs_or_in_a_list_where_it_is_narrow(qtbot):
    for width, is_listed in ((1000, False), (300, True)):
        widget = stage(qtbot, size=(width, 500))
        widget.show_pose(standing(silent={Place.LEFT_FOREARM: ""}))
        without = picture(widget)
        widget.show_pose(standing(silent={Place.LEFT_FOREARM: "Left forearm: silent"}))
        ys, xs = np.nonzero(np.abs(picture(widget) - without).max(axis=2) > 8)

        assert len(xs) > 100
        assert (ys.max() < 60) == is_listed


def test_restyling_changes_the_colours_at_once(qtbot):
    widget = stage(qtbot)
    widget.show_pose(standing())
    dark = picture(widget)
    widget._theme.scheme = "light"  # noqa: SLF001 (the application owns the theme)
    widget.restyle()

    assert picture(widget).mean() > dark.mean() + 100


def test_a_pose_is_compared_by_identity():
    pose = standing()
    same = pose

    assert pose == same
    assert pose != StagePose(pose.world_from_segment, pose.joints, pose.measured)


def test_a_floor_that_was_kept_looks_like_one_that_was_painted_and_goes_with_the_camera(qtbot):
    widget = stage(qtbot)
    widget.show_pose(standing())
    painted = picture(widget)
    kept, again = picture(widget), picture(widget)
    widget._cameraman.orbit(40.0, 10.0)  # noqa: SLF001 (a drag without its events)
    turned = picture(widget)

    assert changed(painted, kept) == changed(painted, again) == 0
    assert changed(painted, turned) > 1000
    assert changed(turned, picture(widget)) == 0


def test_a_path_between_two_places_beside_the_picture_is_seen_where_it_crosses_it(qtbot):
    widget = stage(qtbot)
    widget.view("front")
    without = picture(widget)
    widget.set_path(np.array([[0.0, -4.0], [0.0, 4.0], [0.0, 4.1]]))
    _, xs = np.nonzero(np.abs(picture(widget) - without).max(axis=2) > 8)

    assert len(np.unique(xs)) == 640
