"""Notices: short ones leave when nobody attends to them, lasting ones stay until they are answered."""

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QPushButton

from studio.ui.views import announcement
from studio.ui.views.notices import SHOWN_FOR, Action
from tests.ui.shell_window import shell

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

SAVED = "Take 004 saved and verified · 00:42 · loss 0.1 %"
ACTIONS = (Action("review", "Review"), Action("rename", "Rename"), Action("bad", "Bad take"))


@pytest.fixture
def shown(qtbot):
    with shell(qtbot) as made:
        yield made


def button(parent, action):
    return next(found for found in parent.findChildren(QPushButton) if found.property("action") == action)


def test_a_toast_leaves_after_two_seconds(shown):
    toast = shown.window.toast
    toast.say(SAVED)
    shown.window.tick(10.0)
    shown.window.tick(10.0 + SHOWN_FOR - 0.1)
    assert toast.isVisible()

    shown.window.tick(10.0 + SHOWN_FOR)
    assert not toast.isVisible()


def test_a_toast_stays_while_it_has_the_focus(shown):
    toast = shown.window.toast
    toast.say(SAVED, ACTIONS)
    shown.window.tick(10.0)
    button(toast, "review").setFocus()
    shown.window.tick(30.0)
    assert toast.isVisible()

    shown.window.setFocus()
    shown.window.tick(30.0 + SHOWN_FOR)
    assert not toast.isVisible()


def test_a_toast_stays_while_it_is_pointed_at(shown):
    toast = shown.window.toast
    toast.say(SAVED)
    shown.window.tick(10.0)
    toast.setAttribute(Qt.WidgetAttribute.WA_UnderMouse, True)
    shown.window.tick(30.0)

    assert toast.isVisible()


def test_the_actions_of_a_toast_are_told(qtbot, shown):
    told: list[str] = []
    shown.window.notice_acted.connect(told.append)
    shown.window.toast.say(SAVED, ACTIONS)
    qtbot.mouseClick(button(shown.window.toast, "rename"), Qt.MouseButton.LeftButton)

    assert told == ["rename"]
    assert not shown.window.toast.isVisible()


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_a_toast_never_lies_on_a_record_button(qtbot, scale):
    with shell(qtbot, text_scale=scale) as made:
        page = made.pages["capture"]
        record = QPushButton("Record", page)
        record.setGeometry(10, page.height() - 60, 200, 48)
        record.show()
        made.window.toast.keep_clear_of(record)
        made.window.toast.say(SAVED, ACTIONS)
        toast = made.window.toast
        lies = QRect(toast.mapToGlobal(QPoint(0, 0)), toast.size())

        for other in (record, made.window.strip.record):
            assert not lies.intersects(QRect(other.mapToGlobal(QPoint(0, 0)), other.size()))


def test_a_new_toast_takes_the_place_of_the_old(shown):
    toast = shown.window.toast
    toast.say(SAVED, ACTIONS)
    toast.say("Take 005 saved")
    visible = [found.text() for found in toast.findChildren(QPushButton) if found.isVisible()]

    assert toast.accessibleName() == "Take 005 saved"
    assert visible == []


def test_a_banner_stays_until_it_is_answered(qtbot, shown):
    told: list[str] = []
    shown.window.notice_acted.connect(told.append)
    banner = shown.window.banner
    banner.put("rec.disk_low", "About 9 minutes of space left.", "The disk fills up.", "Free space.", ACTIONS[:2])
    shown.window.tick(0.0)
    shown.window.tick(1000.0)
    assert banner.isVisible()
    assert banner.accessibleName() == "About 9 minutes of space left."
    assert banner.accessibleDescription() == "The disk fills up. Free space."

    qtbot.mouseClick(button(banner, "review"), Qt.MouseButton.LeftButton)
    assert told == ["review"]
    assert not banner.isVisible()


def test_banners_wait_behind_each_other(qtbot, shown):
    closed: list[str] = []
    banner = shown.window.banner
    banner.closed.connect(closed.append)
    banner.put("a", "First.", "", "")
    banner.put("b", "Second.", "", "")
    assert banner.shown == "b"
    qtbot.mouseClick(banner.close_button, Qt.MouseButton.LeftButton)
    assert (banner.shown, closed) == ("a", ["b"])

    banner.take_away("a")
    assert not banner.isVisible()


def test_the_same_message_is_not_shown_twice(shown):
    shown.window.banner.put("a", "First.", "", "")
    shown.window.banner.put("a", "First, again.", "", "")
    shown.window.banner.take_away("a")

    assert not shown.window.banner.isVisible()


def test_what_is_said_is_told_to_a_screen_reader(shown, monkeypatch):
    told = []
    monkeypatch.setattr(QAccessible, "isActive", staticmethod(lambda: True))
    monkeypatch.setattr(QAccessible, "updateAccessibility", staticmethod(lambda event: told.append(event.message())))
    announcement.announce(shown.window, "Recording")
    shown.window.toast.say(SAVED)

    assert told == ["Recording", SAVED]
