"""The Connect page, used by hand: sources, states, the table, one sensor from near, the rest."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLabel, QWidget

from studio.acquisition.driver import Found
from studio.core import errors
from studio.core.body import PLACES
from studio.ui.models.rest_watch import RestWatch
from studio.ui.models.sensor_table import MOVED_ROLE, Column
from studio.ui.models.signal_values import Signal
from studio.ui.style_sheet import style_sheet
from studio.ui.theme import Theme
from studio.ui.views.connect_page import MOVED_FOR, ConnectPage
from studio.ui.wording import sentences
from tests.ui.sensor_windows import health, info, sensor, window

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")  # the screenless platform

PORT = "serial:/dev/ttyACM0"


def shown(qtbot, theme, size=(1120, 700)):
    page = ConnectPage(theme)
    page.setStyleSheet(style_sheet(theme))
    page.restyle()
    qtbot.addWidget(page)
    page.resize(*size)
    page.show()
    qtbot.waitExposed(page)
    return page


@pytest.fixture
def page(qtbot):
    page = shown(qtbot, Theme())
    page.offer_ports([Found(PORT, "nRF52840 receiver")])
    return page


def connect(page, *numbers):
    page.show_connected(PORT)
    page.show_sensors(
        {sensor(n): health(n) for n in numbers},
        {sensor(n): info(n) for n in numbers},
        {sensor(n): PLACES[n - 1] for n in numbers if n <= len(PLACES)},
        100.0,
    )


def words(page):
    return " ".join(label.text() for label in page.findChildren(QLabel) if label.isVisible())


def click(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def kind(page, number):
    return page.choice.kinds.button(number)


def test_a_receiver_is_chosen_and_connected(page, qtbot):
    with qtbot.waitSignal(page.source_chosen) as told:
        click(qtbot, page.choice.go)

    assert told.args == [PORT]


def test_without_a_receiver_it_says_what_to_do(page, qtbot):
    page.offer_ports([])

    assert not page.choice.go.isEnabled()
    assert page.choice.ports.currentText() == "No receiver found: plug it in"
    with qtbot.waitSignal(page.refresh_requested):
        click(qtbot, page.choice.refresh)


def test_the_chosen_receiver_stays_chosen_when_another_is_plugged_in(page):
    page.offer_ports([Found("serial:/dev/ttyUSB0", "Arduino"), Found(PORT, "nRF52840 receiver")])

    assert page.choice.source() == PORT


def test_the_simulator_does_what_is_chosen(page, qtbot):
    click(qtbot, kind(page, 1))
    page.choice.scripts.setFocus()
    qtbot.keyClick(page.choice.scripts, Qt.Key.Key_Down)

    with qtbot.waitSignal(page.source_chosen) as told:
        click(qtbot, page.choice.go)
    assert told.args == ["synthetic:sit"]


def test_a_take_is_replayed(page, qtbot):
    page.offer_takes([("004 walk, today", "lib/P014/004"), ("003 sit", "lib/P014/003")])
    click(qtbot, kind(page, 2))

    with qtbot.waitSignal(page.source_chosen) as told:
        click(qtbot, page.choice.go)

    assert told.args == ["replay:lib/P014/004"]
    with qtbot.waitSignal(page.folder_requested):
        click(qtbot, page.choice.folder)


def test_a_take_from_another_folder_is_added_and_chosen(page):
    page.choose_source("replay:elsewhere/take")

    assert page.choice.source() == "replay:elsewhere/take"
    assert kind(page, 2).isChecked()


def test_connecting_counts_the_seconds_and_can_be_called_off(page, qtbot):
    page.show_connecting(PORT, 0.0)
    page.tick(4.2)

    assert "Connecting… 4 s" in words(page)
    assert not page.choice.ports.isEnabled()
    with qtbot.waitSignal(page.disconnect_requested):
        click(qtbot, page.choice.go)


def test_the_seconds_end_with_the_connection(page):
    page.show_connecting(PORT, 0.0)
    page.show_connected(PORT)
    page.tick(9.0)

    assert "Connecting" not in words(page)
    assert "Connected, and no sensor is heard" in words(page)


def test_at_first_it_says_what_to_do_and_offers_the_simulator(page, qtbot):
    assert "No sensors yet" in words(page)

    with qtbot.waitSignal(page.source_chosen) as told:
        click(qtbot, page.instead)
    assert told.args == ["synthetic:walk"]


def test_a_refusal_says_what_why_and_what_to_do(page, qtbot):
    page.show_connecting(PORT, 0.0)
    page.show_refusal(sentences(errors.PortForbidden("/dev/ttyACM0")))

    for said in ("does not let you open /dev/ttyACM0", "no right to use serial ports", "dialout"):
        assert said in words(page)
    assert "No sensors yet" not in words(page)
    with qtbot.waitSignal(page.source_chosen) as told:
        click(qtbot, page.retry)
    assert told.args == [PORT]

    page.show_connecting(PORT, 1.0)
    assert "dialout" not in words(page)


def test_a_lost_receiver_leaves_the_table_to_be_read(page):
    connect(page, 1, 2)

    page.show_refusal(sentences(errors.PortGone("/dev/ttyACM0")))

    assert page.list.isVisible()
    assert "is not there" in words(page)


def test_the_first_sensor_is_looked_at_at_once(page):
    connect(page, 3, 1, 2)

    assert page.selected() == sensor(1)
    assert "Connected, 3 sensors" in words(page)
    assert "1  tag 01  head" in words(page)


def test_another_sensor_is_chosen_with_the_mouse_or_the_arrow_keys(page, qtbot):
    connect(page, 1, 2, 3)
    told: list[str] = []
    page.select_changed.connect(told.append)

    row = page.list.visualRect(page.sensors.index(2, Column.NAME)).center()
    qtbot.mouseClick(page.list.viewport(), Qt.MouseButton.LeftButton, pos=row)
    qtbot.keyClick(page.list, Qt.Key.Key_Up)

    assert told == [sensor(3), sensor(2)]
    assert page.selected() == sensor(2)


def test_the_selection_stays_while_numbers_change_and_sensors_come(page):
    connect(page, 2, 3)
    page.list.select(sensor(3))

    connect(page, 1, 2, 3)

    assert page.selected() == sensor(3)
    assert page.panel.plot.accessibleName().endswith("3  tag 03  left upper arm")


def test_when_the_sensor_that_was_looked_at_leaves_another_takes_its_place(page):
    connect(page, 1, 2)
    page.list.select(sensor(2))

    connect(page, 1)
    assert page.selected() == sensor(1)

    connect(page)
    assert page.selected() is None
    assert "no sensor is heard" in words(page)


def test_the_plot_is_switched_between_the_signals(page, qtbot):
    connect(page, 1)
    seen = []
    for number in (1, 2, 3, 0):
        click(qtbot, page.panel.signals.button(number))
        seen.append(page.panel.plot.signal)

    assert seen == [Signal.FORCE, Signal.FORCE_G, Signal.ORIENTATION, Signal.TURNING]


def test_roll_pitch_and_yaw_are_large_numbers(page):
    connect(page, 1)

    page.show_signal(window(100.0, turned=(0.0, -37.4, 0.0)), 100.0)

    assert [label.text() for label in page.panel.angles] == ["0.0°", "−37.4°", "0.0°"]
    assert [label.accessibleName() for label in page.panel.angles] == ["Roll", "Pitch", "Yaw"]


def test_another_sensor_begins_without_angles(page):
    connect(page, 1, 2)
    page.show_signal(window(100.0), 100.0)

    page.list.select(sensor(2))

    assert [label.text() for label in page.panel.angles] == ["–", "–", "–"]


def test_the_values_are_shown_as_a_table_and_copied(page, qtbot):
    connect(page, 1)
    click(qtbot, page.panel.as_table)
    page.show_signal(window(100.0, rate=40.0), 100.0)

    model = page.panel.table.model()
    assert page.panel.table.isVisible()
    assert float(model.index(0, 5).data()) == pytest.approx(40.0, abs=0.2)

    click(qtbot, page.panel.copy)
    assert QGuiApplication.clipboard().text().startswith("axis\t")


def test_names_and_blinking_are_offered_where_the_source_can(page, qtbot):
    connect(page, 1)
    hidden = [page.panel.rename.isVisible(), page.panel.blink.isVisible()]

    page.offer(rename=True, blink=True)
    with qtbot.waitSignal(page.blink_requested) as blinked:
        click(qtbot, page.panel.blink)
    click(qtbot, page.panel.rename)
    editor = page.list.findChild(QWidget, "qt_editing") or QGuiApplication.focusObject()
    assert isinstance(editor, QWidget)
    with qtbot.waitSignal(page.rename_requested) as renamed:
        qtbot.keyClicks(editor, "Wrist")
        qtbot.keyClick(editor, Qt.Key.Key_Return)

    assert hidden == [False, False]
    assert blinked.args == [sensor(1)]
    assert renamed.args == [sensor(1), "Wrist"]


def test_rest_is_explained_counted_and_closed(page):
    connect(page, 1, 2)
    watch = RestWatch()
    infos = {sensor(n): info(n) for n in (1, 2)}
    said = []
    for now in np.arange(2.0, 13.0, 0.25):
        watch.feed({sensor(1): window(now), sensor(2): window(now, rate=20.0 if now < 4 else 0.0)}, infos)
        page.show_rest(watch)
        said.append(words(page))

    assert "Lay the tags down and don't touch them" in said[0]
    assert any("1 of 2 measured" in text for text in said)
    assert "Offsets measured. The tags can be put on." not in said[-5]
    page.sensors.show_rest(watch.progress, watch.is_still)

    for now in np.arange(13.0, 17.0, 0.25):
        watch.feed({sensor(n): window(now) for n in (1, 2)}, infos)
    page.show_rest(watch)
    assert "Offsets measured. The tags can be put on." in words(page)


def test_a_shaken_tag_lights_up_and_goes_out_again(page):
    connect(page, 1, 2)
    still = {sensor(n): window(100.0) for n in (1, 2)}

    page.show_motion(still | {sensor(2): window(100.0, rate=300.0)}, 100.0)
    lit = page.sensors.index(1, 0).data(MOVED_ROLE)
    page.show_motion(still, 100.5)
    kept = page.sensors.index(1, 0).data(MOVED_ROLE)
    page.show_motion(still, 100.1 + MOVED_FOR)

    assert (lit, kept) == (True, True)
    assert not page.sensors.index(1, 0).data(MOVED_ROLE)


def test_every_control_has_a_name_and_is_large_enough(page):
    connect(page, *range(1, 31))
    page.offer(rename=True, blink=True)

    controls = [w for w in page.findChildren(QWidget) if isinstance(w, QAbstractButton | QComboBox)]
    ours = [w for w in controls if w.parent() is not page.list and w.isVisible()]
    assert len(ours) > 10
    assert [w for w in ours if not w.accessibleName()] == []
    assert [w.accessibleName() for w in ours if min(w.width(), w.height()) < 24] == []


def test_the_keyboard_goes_through_the_page_and_comes_back(page, qtbot):
    connect(page, 1, 2)
    page.choice.go.setFocus()
    reached = []
    for _ in range(30):
        reached.append(page.focusWidget())
        qtbot.keyClick(page.focusWidget(), Qt.Key.Key_Tab)
        if page.focusWidget() is page.choice.go:
            break

    assert page.focusWidget() is page.choice.go
    assert {page.list, page.panel.plot, page.panel.as_table, page.panel.copy} <= set(reached)


@pytest.mark.parametrize("scale", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_no_text_is_cut_at_any_size(qtbot, scale, scheme):
    theme = Theme()
    theme.scheme, theme.text_scale = scheme, scale
    page = shown(qtbot, theme, (960, 600))
    page.setFont(theme.font("body"))
    connect(page, 1, 2, 3)
    page.restyle()
    page.grab()

    cut = [
        widget.accessibleName() or widget.text()
        for widget in page.findChildren(QAbstractButton) + page.panel.angles
        if widget.isVisible() and widget.text() and widget.height() < widget.minimumSizeHint().height()
    ]
    assert cut == []
    assert page.list.height() >= page.list.minimumHeight()
    assert page.panel.plot.height() >= page.panel.plot.minimumSizeHint().height()
