"""The timeline: where a take is, what was marked, what is missing; worked by mouse, keys and screen readers."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QAccessible, QColor

from studio.core.take import Mark
from studio.ui.models.playhead import Playhead
from studio.ui.style_sheet import mixed
from studio.ui.theme import Theme
from studio.ui.views.timeline import LINE, Timeline
from tests.ui.reviewed import review

KNEE = "left_knee_flexion"


@pytest.fixture
def theme():
    made = Theme()
    made.scheme = "dark"
    return made


@pytest.fixture
def head():
    return Playhead()


@pytest.fixture
def timeline(qtbot, head, theme):
    view = Timeline(theme, head)
    qtbot.addWidget(view)
    view.resize(800, view.sizeHint().height())
    view.scrubbed.connect(head.seek)
    view.show()
    return view


def open_take(timeline, head, take, angle=KNEE):
    head.open(take.duration, take.motion.frame_s)
    timeline.show_take(take, angle)


def on(timeline, time, y=None):
    return QPoint(round(timeline.x_of(time)), round(timeline.area().center().y() if y is None else y))


def colours(timeline, rows=slice(None)):
    """Return the set of colours in the band of the envelope."""
    picture, area = timeline.grab().toImage(), timeline.area().toRect()
    lines = range(area.top() + 2, area.bottom())[rows]
    return {picture.pixelColor(x, y).name() for x in range(area.left() + 2, area.right() - 2) for y in lines}


def test_a_click_goes_there(timeline, head, qtbot):
    open_take(timeline, head, review())
    qtbot.mouseClick(timeline, Qt.MouseButton.LeftButton, pos=on(timeline, 3.5))

    assert head.time == pytest.approx(3.5, abs=0.01)


def test_dragging_goes_along_and_stays_within_the_take(timeline, head, qtbot):
    open_take(timeline, head, review())
    times: list[object] = []
    head.moved.connect(times.append)
    qtbot.mousePress(timeline, Qt.MouseButton.LeftButton, pos=on(timeline, 1.0))
    for time in (1.5, 2.0, 2.5):
        qtbot.mouseMove(timeline, on(timeline, time))
    qtbot.mouseMove(timeline, QPoint(5000, 40))
    qtbot.mouseRelease(timeline, Qt.MouseButton.LeftButton, pos=QPoint(5000, 40))

    assert times == pytest.approx([1.0, 1.5, 2.0, 2.5, head.duration], abs=0.01)
    qtbot.mouseMove(timeline, on(timeline, 1.0))
    assert head.time == head.duration


def test_a_click_on_a_flag_goes_to_its_very_time(timeline, head, qtbot):
    open_take(timeline, head, review(marks=(Mark(4.123, "marker", "turn"),)))
    timeline.grab()
    qtbot.mouseClick(timeline, Qt.MouseButton.LeftButton, pos=on(timeline, 4.123, y=6) + QPoint(4, 0))

    assert head.time == 4.123


def test_a_flag_that_is_pointed_at_is_named(timeline, head, qtbot):
    marks = (Mark(1.0, "marker"), Mark(2.0, "marker", "turn"), Mark(3.0, "pose", "n", 4.0), Mark(5.0, "record"))
    open_take(timeline, head, review(marks=marks))
    timeline.grab()
    said = []
    for time in (1.0, 2.0, 3.5, 5.0, 4.5):
        qtbot.mouseMove(timeline, on(timeline, time, y=6))
        said.append(timeline.toolTip())

    assert said == ["Marker 1 at 00:01.00", "turn at 00:02.00", "N-pose at 00:03.00", "Record at 00:05.00", ""]


@pytest.mark.parametrize(
    ("key", "frames"),
    [(Qt.Key.Key_Right, 1), (Qt.Key.Key_Left, -1), (Qt.Key.Key_PageDown, 10), (Qt.Key.Key_PageUp, -10)],
)
def test_keys_step_by_frames(timeline, head, qtbot, key, frames):
    open_take(timeline, head, review())
    head.seek(2.0)
    qtbot.keyClick(timeline, key)

    assert head.frame == 100 + frames


def test_shift_steps_by_ten_and_home_and_end_go_to_the_ends(timeline, head, qtbot):
    open_take(timeline, head, review())
    head.seek(2.0)
    qtbot.keyClick(timeline, Qt.Key.Key_Right, Qt.KeyboardModifier.ShiftModifier)
    assert head.frame == 110
    qtbot.keyClick(timeline, Qt.Key.Key_End)
    assert head.time == head.duration
    qtbot.keyClick(timeline, Qt.Key.Key_Home)
    assert head.time == 0.0


def test_a_screen_reader_hears_and_sets_the_frame(timeline, head):
    open_take(timeline, head, review())
    head.seek(2.0)
    spoken = QAccessible.queryAccessibleInterface(timeline)

    assert spoken.role() == QAccessible.Role.Slider
    assert spoken.text(QAccessible.Text.Name) == "Time in the take"
    assert spoken.text(QAccessible.Text.Description) == "00:02.00 of 00:05.98"
    assert (spoken.valueInterface().currentValue(), spoken.valueInterface().maximumValue()) == (100, 299)
    spoken.valueInterface().setCurrentValue(150)
    assert head.time == pytest.approx(3.0)


def test_while_it_plays_the_playhead_is_not_pulled_to_whole_frames(timeline, head):
    open_take(timeline, head, review())
    head.seek(2.0071)

    assert head.time == 2.0071


def test_the_envelope_has_the_colour_of_its_side(timeline, head, theme):
    open_take(timeline, head, review())
    left = QColor(mixed(theme.tokens.panel, theme.tokens.left, LINE)).name()
    right = QColor(mixed(theme.tokens.panel, theme.tokens.right, LINE)).name()
    assert left in colours(timeline)

    timeline.show_take(review(), "right_knee_flexion")
    assert right in colours(timeline)
    assert left not in colours(timeline)


def test_what_is_missing_is_marked_and_long_gaps_over_the_whole_height(timeline, head, theme):
    bad, upper = QColor(theme.tokens.bad).name(), slice(0, 20)
    open_take(timeline, head, review())
    assert bad not in colours(timeline)

    single = np.zeros(300, bool)
    single[[50, 100, 150]] = True
    open_take(timeline, head, review(left_shank=single))
    assert bad in colours(timeline)
    assert bad not in colours(timeline, upper)

    open_take(timeline, head, review(left_shank=slice(100, 160)))
    assert bad in colours(timeline, upper)


@pytest.mark.parametrize(
    "marks", [(), (Mark(-3.0, "pose", "n", -1.0),), (Mark(1e6, "marker"),), (Mark(2.0, "custom"),)]
)
def test_takes_with_no_marks_or_marks_outside_are_drawn(timeline, head, marks):
    open_take(timeline, head, review(marks=marks))

    assert not timeline.grab().isNull()


def test_a_range_and_an_angle_that_was_never_measured_are_drawn(timeline, head):
    take = review()
    nothing = {name: np.full_like(values, np.nan) for name, values in take.degrees.items()}
    open_take(timeline, head, replace(take, degrees=nothing))
    head.seek(2.0)
    head.range_starts_here()

    assert not timeline.grab().isNull()


def test_without_a_take_it_cannot_be_worked(timeline, head):
    assert not timeline.isEnabled()
    assert not timeline.grab().isNull()
    open_take(timeline, head, review())
    assert timeline.isEnabled()
    timeline.show_take(None, "")
    assert not timeline.isEnabled()


def test_it_grows_with_the_text(timeline, theme):
    before = timeline.sizeHint().height()
    theme.text_scale = 2.0
    timeline.restyle()

    assert timeline.sizeHint().height() > before
