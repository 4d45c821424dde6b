"""Review: choose a take, see it computed, play it, read its numbers; refusals in sentences."""

from typing import Any

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSlider,
    QComboBox,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QScrollBar,
    QWidget,
)

from studio.core.body import Place
from studio.core.errors import Damaged, HeadingsUnknown
from studio.ui.keys import TABLE
from studio.ui.models.playhead import Playhead
from studio.ui.models.pose_source import MotionSource
from studio.ui.style_sheet import style_sheet
from studio.ui.theme import Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.plots.angle_plot import AnglePlot
from studio.ui.views.review_page import PAGE_SECONDS, ReviewPage
from studio.ui.views.stage.stage import Stage
from tests.ui.reviewed import review, summary

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

CONTROLS = (QAbstractButton, QAbstractItemView, QAbstractSlider, QComboBox, QLineEdit, QPlainTextEdit)
LONG = "a very long name that somebody typed while the patient was already walking up and down"
KNEES = ("left_knee_flexion", "right_knee_flexion")


class WatchedStage(Stage):
    """A stage that tells which body it was given."""

    pose = None

    def show_pose(self, pose):
        self.pose = pose
        super().show_pose(pose)


@pytest.fixture
def theme():
    return Theme()


@pytest.fixture
def page(qtbot, theme):
    made = ReviewPage(theme, Playhead(), AnglePlot(theme))
    seen = WatchedStage(theme)
    made.seen = seen  # type: ignore[attr-defined]
    made.set_stage(seen)
    qtbot.addWidget(made)
    made.setStyleSheet(style_sheet(theme))
    made.resize(1184, 720)
    made.show()
    made.takes.model.set_takes([summary(1), summary(2, LONG), summary(3, "reach")])
    return made


def show(page, take=None, chosen=(), **facts):
    shown = take or review(**facts)
    page.show_take(shown, MotionSource(shown.motion, {place: place.value for place in Place}), chosen)
    return shown


def visible_texts(page):
    return [label.text() for label in page.findChildren(QLabel) if label.isVisible() and label.text()]


def test_an_empty_library_says_how_to_fill_it(page):
    page.takes.model.set_takes([])

    assert page.state.text().startswith("Nothing has been recorded yet.")
    assert not page.transport.isVisible()


def test_with_takes_it_says_to_choose_one(page):
    assert page.state.text().startswith("Choose a take on the left.")


def test_choosing_a_take_is_a_wish(page, qtbot):
    with qtbot.waitSignal(page.take_chosen) as asked:
        place = page.takes.view.visualRect(page.takes.model.index(2)).center()
        qtbot.mouseClick(page.takes.view.viewport(), Qt.MouseButton.LeftButton, pos=place)

    assert asked.args == [summary(1).folder]


def test_computing_is_shown_with_what_is_done(page):
    page.show_loading(summary(1).folder, "read", 0.0)
    assert page.state.text() == "Reading the take…"
    page.show_loading(summary(1).folder, "solve", 0.4)

    assert page.state.text() == "Computing the motion…"
    assert page.takes.selected() == (summary(1).folder,)


def test_a_refusal_says_what_why_and_what_to_do_and_can_be_tried_again(page, qtbot):
    page.show_refusal(summary(1).folder, HeadingsUnknown(("left_hand",)))

    assert page.state.text().startswith("▲ Headings unknown: left hand. Without them")
    assert "Record a bow" in page.state.text()
    with qtbot.waitSignal(page.solve_requested) as asked:
        qtbot.mouseClick(page.state.button, Qt.MouseButton.LeftButton)
    assert asked.args == [summary(1).folder]


def test_what_trying_again_cannot_mend_has_no_button(page):
    page.show_refusal(summary(1).folder, Damaged("/x/take.mcap", 0.0))

    assert not page.state.button.isVisible()


def test_a_take_is_shown_with_figure_plot_and_numbers(page):
    take = show(page)

    assert page.seen.pose is not None
    assert page.plot.shown_range == (0.0, take.duration)
    texts = visible_texts(page)
    values = take.degrees["left_knee_flexion"][100:]
    for number in (values.min(), values.max(), np.ptp(values), values[0]):
        assert f"{number:.1f}°".replace("-", "−") in texts
    assert "degrees, 00:02.00 to 00:05.98" in texts, "what came before R is not what was asked for"
    page.transport.whole.click()
    assert "degrees, over the whole take" in visible_texts(page)
    assert any("Angles are relative to the held N-pose" in text for text in texts)


def test_playing_moves_figure_cursor_and_numbers(page):
    take = show(page)
    page.transport.whole.click()
    page.playhead.seek(0.0)
    before = page.seen.pose
    page.act("go")
    for frame in range(61):
        page.tick(10.0 + frame / 60)

    assert page.playhead.time == pytest.approx(1.0)
    assert page.seen.pose is not before
    now = f"{take.degrees['left_knee_flexion'][50]:.1f}°".replace("-", "−")
    assert now in visible_texts(page)


def test_plot_and_timeline_scrub(page):
    show(page)
    page.plot.time_picked.emit(2.0)
    assert page.playhead.time == 2.0
    page.timeline.scrubbed.emit(3.0)
    assert page.playhead.time == 3.0


def test_a_range_changes_what_is_measured(page):
    take = show(page)
    page.playhead.seek(1.0)
    page.act("trim_in")
    page.playhead.seek(2.0)
    page.act("trim_out")
    values = take.degrees["left_knee_flexion"][50:101]

    assert "degrees, 00:01.00 to 00:02.00" in visible_texts(page)
    assert f"{np.ptp(values):.1f}°" in visible_texts(page)


def test_a_long_take_turns_pages_in_the_plot(page):
    show(page, frames=3000)
    assert page.plot.shown_range == (0.0, PAGE_SECONDS)
    page.playhead.seek(45.0)
    low, high = page.plot.shown_range
    assert low <= 45.0 <= high
    assert high - low == pytest.approx(PAGE_SECONDS)
    page.playhead.seek(46.0)
    assert page.plot.shown_range == (low, high)


def test_angles_are_added_changed_and_taken_away(page):
    show(page)
    told: list[Any] = []
    page.chosen_angles_changed.connect(told.append)
    rows = page.measures.rows
    assert [row.isVisible() for row in rows] == [True, True, True, False]

    rows[2].choice.setCurrentIndex(rows[2].choice.findData("trunk_flexion"))
    assert told[-1] == (*KNEES, "trunk_flexion")
    assert rows[3].isVisible()
    rows[0].choice.setCurrentIndex(0)
    assert told[-1] == ("right_knee_flexion", "trunk_flexion")
    rows[1].choice.setCurrentIndex(rows[1].choice.findData("right_knee_flexion"))
    assert told[-1] == ("right_knee_flexion",)


def test_angles_that_were_chosen_before_are_shown_again_where_the_take_has_them(page):
    show(page, chosen=("left_elbow_flexion", "tail_flexion"))

    assert page.measures.rows[0].name == "left_elbow_flexion"
    assert page.measures.rows[1].name == ""


def test_an_angle_below_what_sensors_can_tell_says_so(page):
    show(page, chosen=("left_knee_varus",))

    assert any("read it as a hint" in text for text in visible_texts(page))


def test_a_note_is_kept_when_it_is_left(page, qtbot):
    show(page)
    page.measures.note.setFocus()
    qtbot.keyClicks(page.measures.note, "limps")
    with qtbot.waitSignal(page.note_requested) as asked:
        page.show_loading(summary(3, "reach").folder, "read", 0.0)

    assert asked.args == [summary(1).folder, "limps"]


def test_a_note_is_kept_when_something_else_gets_the_focus(page, qtbot):
    show(page)
    page.activateWindow()
    page.measures.note.setFocus()
    qtbot.keyClicks(page.measures.note, "limps")
    with qtbot.waitSignal(page.note_requested) as asked:
        page.takes.search.setFocus()

    assert asked.args == [summary(1).folder, "limps"]


def test_the_note_of_a_take_is_shown_and_not_told_back(page):
    told: list[Any] = []
    page.note_requested.connect(lambda folder, text: told.append(text))
    show(page, review(summary(1, notes="limps")))
    assert page.measures.note.toPlainText() == "limps"
    page.show_nothing()

    assert told == []


def test_export_is_asked_for_the_take_that_is_shown(page, qtbot):
    show(page)
    with qtbot.waitSignal(page.export_requested) as asked:
        qtbot.mouseClick(page.measures.export, Qt.MouseButton.LeftButton)

    assert asked.args == [(summary(1).folder,)]


def test_the_same_take_computed_anew_stays_where_it_was(page):
    show(page)
    page.playhead.seek(2.0)
    show(page)

    assert page.playhead.time == 2.0
    show(page, review(summary(3, "reach")))
    assert page.playhead.time == 2.0, "another take begins where R was pressed"


def test_every_key_of_review_is_answered_but_those_without_a_function(page):
    show(page)
    offered = page.key_actions()
    known = {key.action for key in TABLE}

    assert set(offered) <= known
    for action in offered:
        assert page.act(action), action
    assert not page.act("compare")


def test_without_a_take_only_the_list_answers_keys(page):
    assert not page.act("go")
    assert page.act("star")


@pytest.mark.parametrize("scale", [0.8, 1.0, 1.5, 2.0])
def test_every_control_has_a_name_and_no_text_is_cut(page, theme, scale, qtbot):
    theme.text_scale = scale
    page.setStyleSheet(style_sheet(theme))
    show(page, review(summary(2, LONG, recovered=True)))
    page.restyle()
    qtbot.wait(50)

    for child in page.findChildren(QWidget):
        if isinstance(child, CONTROLS) and child.isVisible() and not isinstance(child, QScrollBar):
            assert child.accessibleName(), child
        if isinstance(child, QLabel) and not isinstance(child, ElidedLabel) and child.isVisible() and child.text():
            needed = child.heightForWidth(child.width()) if child.wordWrap() else child.sizeHint().height()
            assert child.height() >= needed, child.text()
            assert child.wordWrap() or child.width() >= child.sizeHint().width(), child.text()


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_it_fits_the_smallest_window(page, theme, scheme):
    theme.scheme = scheme
    page.setStyleSheet(style_sheet(theme))
    page.restyle()
    show(page)
    page.resize(960, 600)

    assert page.minimumSizeHint().width() <= 960
    assert page.minimumSizeHint().height() <= 600
    assert not page.grab().isNull()
