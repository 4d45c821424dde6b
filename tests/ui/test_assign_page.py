"""The assign page: real clicks and keys on the body, tags in the list, names for who cannot see it."""

import json
from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible, QFont
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLabel, QListWidget, QPushButton

from studio.core.body import PLACES, Place
from studio.core.sample import SensorId
from studio.core.take import Assignment
from studio.ui.models.assignment_model import AssignmentModel, KnownSensor, SensorState
from studio.ui.models.place_words import place_words
from studio.ui.style_sheet import dress
from studio.ui.theme import Theme
from studio.ui.views.assign_page import AssignPage

PLACES_FILE = Path(__file__).resolve().parents[2] / "resources" / "places.json"
WORDS = place_words(json.loads(PLACES_FILE.read_text(encoding="utf-8")))
LEFT = Qt.MouseButton.LeftButton
# Without a screen Qt says so whenever a window with a smallest size is shown.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")


def sensor(number, name="", state=SensorState.GOOD):
    return KnownSensor(SensorId(f"tag:{number:08x}"), (number - 1) % 15 + 1, name or f"tag {number:02d}", state)


@pytest.fixture
def theme(qapp):
    return Theme()


@pytest.fixture
def opened(qtbot, theme):
    def build(tags=15, worn=0, size=(1080, 640)):
        model = AssignmentModel()
        model.set_sensors([sensor(number) for number in range(1, tags + 1)])
        model.adopt(Assignment({PLACES[n]: sensor(n + 1).sensor for n in range(worn)}))
        page = AssignPage(theme, model, WORDS)
        qtbot.addWidget(page)
        page.resize(*size)
        page.show()
        qtbot.waitExposed(page)
        return page, model

    return build


def click_tag(qtbot, page, row):
    place = page.tags.visualItemRect(page.tags.item(row)).center()
    qtbot.mouseClick(page.tags.viewport(), LEFT, pos=place)


def test_a_click_on_a_place_and_a_click_on_a_tag_assign(qtbot, opened):
    page, model = opened()

    qtbot.mouseClick(page.map.marks[Place.LEFT_FOREARM], LEFT)
    assert "Left forearm" in page.hint.text()
    assert "Wrist band" in page.strap.text()
    assert "Abduction/adduction" in page.measurand.text()
    click_tag(qtbot, page, 4)

    assert model.worn_at(Place.LEFT_FOREARM) == sensor(5)
    assert page.map.marks[Place.LEFT_FOREARM].accessibleName() == "Left forearm, tag 05, good"


def test_a_click_on_a_tag_and_a_click_on_a_place_assign(qtbot, opened):
    page, model = opened()

    click_tag(qtbot, page, 0)
    assert page.hint.text().startswith("tag 01")
    qtbot.mouseClick(page.map.marks[Place.PELVIS], LEFT)

    assert model.worn_at(Place.PELVIS) == sensor(1)
    assert page.tags.count() == 14


def test_fifteen_places_are_named_buttons_of_at_least_32_pixels(opened):
    page, _ = opened(worn=4)
    figure = QAccessible.queryAccessibleInterface(page.map.figure)

    children = [figure.child(row) for row in range(figure.childCount())]

    assert len(children) == 15
    assert {child.role() for child in children} == {QAccessible.Role.CheckBox}
    names = [child.text(QAccessible.Text.Name) for child in children]
    assert names[0] == "Head, tag 01, good"
    assert names[4] == "Left forearm, no tag"
    assert all(
        child.text(QAccessible.Text.Description) == WORDS[place].measurand
        for child, place in zip(children, PLACES, strict=True)
    )
    for mark in page.map.marks.values():
        assert min(mark.width(), mark.height()) >= 32
        assert WORDS[mark.place].measurand in mark.toolTip()


@pytest.mark.parametrize("size", [(1080, 640), (960, 600)])
def test_no_two_places_lie_on_each_other(opened, size):
    page, _ = opened(size=size)
    marks = list(page.map.marks.values())

    for row, one in enumerate(marks):
        for other in marks[row + 1 :]:
            apart = (one.geometry().center() - other.geometry().center()).manhattanLength()
            assert apart >= 32, (one.place, other.place)


def test_arrows_move_between_places_and_enter_chooses(qtbot, opened):
    page, model = opened()
    marks = page.map.marks
    chosen: list[Place] = []
    page.map.place_chosen.connect(chosen.append)
    page.map.focus_place(Place.HEAD)

    for key in (Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Left):
        qtbot.keyClick(page.focusWidget(), key)
    reached = page.focusWidget()
    qtbot.keyClick(reached, Qt.Key.Key_Return)

    assert reached.place.value.startswith("left")  # seen from behind, left is left
    assert chosen == [reached.place]
    assert model.place is reached.place
    tab_stops = [mark for mark in marks.values() if mark.focusPolicy() & Qt.FocusPolicy.TabFocus.value]
    assert tab_stops == [reached]


def test_every_place_can_be_reached_by_arrows(qtbot, opened):
    page, _ = opened()
    reached, frontier = {Place.HEAD}, [Place.HEAD]
    while frontier:
        here = frontier.pop()
        for key in (Qt.Key.Key_Left, Qt.Key.Key_Right, Qt.Key.Key_Up, Qt.Key.Key_Down):
            page.map.focus_place(here)
            qtbot.keyClick(page.map.marks[here], key)
            there = page.focusWidget().place
            if there not in reached:
                reached.add(there)
                frontier.append(there)

    assert reached == set(PLACES)


def test_face_to_face_the_performers_left_is_on_our_right(qtbot, opened):
    page, _ = opened()
    left, right = page.map.marks[Place.LEFT_HAND], page.map.marks[Place.RIGHT_HAND]
    assert left.x() < right.x()

    qtbot.mouseClick(page.map.face_me, LEFT)

    assert left.x() > right.x()


def test_a_tag_that_is_moved_goes_to_the_place_that_pulses(qtbot, opened):
    page, model = opened(worn=2)
    qtbot.mouseClick(page.move_one, LEFT)
    assert "waits for a tag" in page.map.marks[Place.LEFT_UPPER_ARM].accessibleName()

    page.moved(sensor(9).sensor)
    page.tick(1.0)

    assert model.worn_at(Place.LEFT_UPPER_ARM) == sensor(9)
    assert model.waiting is Place.RIGHT_UPPER_ARM
    assert page.move_one.isChecked()


def test_the_pulse_moves_with_time_unless_motion_is_reduced(qtbot, opened, theme):
    page, model = opened()
    model.begin_moving()
    page.tick(0.1)
    early = page.map.figure.grab().toImage()
    page.tick(0.7)
    assert page.map.figure.grab().toImage() != early

    theme.reduced_motion = True
    page.tick(0.1)
    early = page.map.figure.grab().toImage()
    page.tick(0.7)
    assert page.map.figure.grab().toImage() == early


def test_the_tools_act_on_the_assignment(qtbot, opened):
    page, model = opened(worn=0)

    qtbot.mouseClick(page.by_number, LEFT)
    assert len(model.assignment.sensors) == 15
    qtbot.mouseClick(page.cross, LEFT)
    assert model.worn_at(Place.LEFT_FOOT) == sensor(12)
    qtbot.mouseClick(page.undo, LEFT)
    assert model.worn_at(Place.LEFT_FOOT) == sensor(14)
    qtbot.mouseClick(page.clear, LEFT)
    assert not model.assignment.sensors
    qtbot.keyClick(page, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    page.preset.setCurrentIndex(2)
    assert model.preset == "lower"


def test_a_place_is_taken_off_and_exchanged_from_its_card(qtbot, opened):
    page, model = opened(worn=15)
    qtbot.mouseClick(page.map.marks[Place.HEAD], LEFT)
    qtbot.mouseClick(page.exchange, LEFT)
    assert "exchange with" in page.hint.text()
    qtbot.mouseClick(page.map.marks[Place.CHEST], LEFT)
    assert model.worn_at(Place.HEAD) == sensor(2)

    qtbot.mouseClick(page.map.marks[Place.CHEST], LEFT)
    qtbot.mouseClick(page.take_off, LEFT)

    assert model.worn_at(Place.CHEST) is None


def test_without_tags_the_page_says_where_they_come_from(opened):
    page, _ = opened(tags=0)

    assert not page.tags.isVisible()
    assert "Connect" in page.no_tags.text()
    assert not page.move_one.isEnabled()


def test_a_weak_tag_is_told_by_word_and_not_by_colour_alone(opened):
    page, model = opened(worn=1)
    model.set_sensors([sensor(1, state=SensorState.WEAK)])

    assert page.map.marks[Place.HEAD].accessibleName() == "Head, tag 01, weak"


def test_thirty_tags_with_long_names_fit(opened):
    page, model = opened(tags=30, worn=5, size=(960, 600))
    model.set_sensors([sensor(n, f"Prototype of the north laboratory with a long name {n}") for n in range(1, 31)])

    assert page.tags.count() == 25
    assert page.tags.horizontalScrollBar().maximum() == 0 or not page.tags.horizontalScrollBar().isVisible()


def test_every_control_has_a_name(opened):
    page, _ = opened(worn=3)

    controls = [w for kind in (QAbstractButton, QComboBox, QListWidget) for w in page.findChildren(kind)]

    assert [w for w in controls if not w.accessibleName() and w.focusPolicy() != Qt.FocusPolicy.NoFocus] == []


@pytest.fixture
def dressed(qapp, theme):
    """Dress the application for the theme; it looks as before afterwards."""
    before = qapp.palette(), QFont(qapp.font())
    yield lambda: dress(qapp, theme)
    qapp.setStyleSheet("")
    qapp.setPalette(before[0])
    qapp.setFont(before[1])


@pytest.mark.parametrize("scale", [0.8, 1.0, 1.5, 2.0])
@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_text_of_any_size_is_not_cut(qtbot, opened, theme, dressed, scale, scheme):
    theme.text_scale, theme.scheme = scale, scheme
    dressed()
    page, model = opened(worn=3, size=(960, 600))
    model.choose_place(Place.LEFT_FOREARM)
    page.restyle()

    def nothing_is_cut():
        for label in page.findChildren(QLabel):
            if label.isVisible() and label.wordWrap():
                assert label.height() >= label.heightForWidth(label.width()), label.text()
        for button in page.findChildren(QPushButton):
            if button.isVisible():
                assert button.width() >= button.sizeHint().width(), button.text()

    qtbot.waitUntil(nothing_is_cut)
