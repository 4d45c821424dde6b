"""The window: pages, frame, title, closing, and what is never modal."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication

from studio.ui.models.readiness import ReadinessState, StripPhase
from studio.ui.views.main_window import FRAME
from studio.ui.views.rail import PAGES
from tests.ui.shell_window import shell

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

RECORDING = ReadinessState(StripPhase.RECORDING, 15, 15, 60.0, 0.0, 3600.0, 0.0, "take 004", 12.4)


@pytest.fixture
def shown(qtbot):
    with shell(qtbot) as made:
        yield made


@pytest.mark.parametrize("name", PAGES)
def test_a_click_in_the_rail_asks_for_the_page(qtbot, shown, name):
    qtbot.mouseClick(shown.window.rail.buttons[name], Qt.MouseButton.LeftButton)

    assert shown.window.shown_page == name
    assert [page for page, button in shown.window.rail.buttons.items() if button.isChecked()] == [name]


def test_the_rail_marks_only_what_is_shown(qtbot, shown):
    shown.window.page_requested.disconnect(shown.window.show_page)
    qtbot.mouseClick(shown.window.rail.buttons["review"], Qt.MouseButton.LeftButton)

    assert shown.window.rail.buttons["capture"].isChecked()
    assert not shown.window.rail.buttons["review"].isChecked()


@pytest.mark.parametrize(("key", "name"), [(Qt.Key.Key_1, "connect"), (Qt.Key.Key_6, "export")])
def test_digits_choose_pages(qtbot, shown, key, name):
    qtbot.keyClick(shown.window, key)

    assert shown.window.shown_page == name


@pytest.mark.parametrize("name", ["home", "settings", "diagnostics"])
def test_the_menu_opens_the_other_pages(shown, name):
    action = next(action for action in shown.window.header.menu.actions() if action.data() == name)
    action.trigger()

    assert shown.window.shown_page == name
    assert not any(button.isChecked() for button in shown.window.rail.buttons.values())


def test_the_inspector_belongs_to_the_page(shown):
    assert shown.window.inspector.isVisible()

    shown.window.show_page("review")

    assert not shown.window.inspector.isVisible()


def test_pages_have_the_room_they_were_promised(shown):
    shown.window.show_page("review")
    QApplication.processEvents()

    assert shown.window.stack.width() >= 960
    assert shown.window.stack.height() >= 600


def test_recording_is_told_by_frame_word_and_title(shown):
    assert "●" not in shown.window.windowTitle()
    shown.window.show_state(RECORDING)

    assert shown.window.windowTitle() == "● 00:12 take 004"
    assert shown.window.strip.state.text().startswith("REC")
    corner = shown.window.grab().toImage().pixelColor(FRAME // 2, 400)
    assert corner.name().upper() == shown.theme.tokens.rec


def test_the_frame_takes_no_room_when_it_comes(shown):
    before = shown.window.stack.geometry()
    shown.window.show_state(RECORDING)
    QApplication.processEvents()

    assert shown.window.stack.geometry() == before


def test_nothing_is_modal_during_a_recording(qtbot, shown):
    shown.window.show_state(RECORDING)
    shown.window.ask_before_close()
    shown.window.banner.put("a", "What.", "Why.", "Do.")
    shown.window.toast.say("Saved")
    shown.window.show_keys()

    assert QApplication.activeModalWidget() is None
    qtbot.mouseClick(shown.window.rail.buttons["review"], Qt.MouseButton.LeftButton)
    assert shown.window.shown_page == "review"


def test_esc_never_asks_to_stop(qtbot, shown):
    asked: list[str] = []
    shown.window.record_requested.connect(lambda: asked.append("record"))
    shown.window.key_pressed.connect(asked.append)
    shown.window.show_state(RECORDING)
    qtbot.keyClick(shown.window, Qt.Key.Key_Escape)

    assert asked == ["cancel"]  # which calls off a countdown and nothing else


def test_r_asks_to_record(qtbot, shown):
    with qtbot.waitSignal(shown.window.record_requested, timeout=1000):
        qtbot.keyClick(shown.window, Qt.Key.Key_R)


def test_the_window_asks_whether_it_may_close(qtbot, shown):
    asked: list[bool] = []
    shown.window.close_requested.connect(lambda: asked.append(True))
    shown.window.close()

    assert asked == [True]
    assert shown.window.isVisible()
    shown.window.close_now()
    assert not shown.window.isVisible()


def test_closing_while_recording_asks_once_and_keeping_is_the_safe_answer(qtbot, shown):
    answers: list[str] = []
    shown.window.close_confirmed.connect(lambda: answers.append("close"))
    shown.window.close_refused.connect(lambda: answers.append("keep"))
    shown.window.close_requested.connect(shown.window.ask_before_close)
    shown.window.show_state(RECORDING)
    shown.window.close()
    shown.window.close()

    assert shown.window.sheet.isVisible()
    assert shown.window.sheet.no.hasFocus()
    qtbot.keyClick(shown.window.sheet.no, Qt.Key.Key_Escape)
    assert answers == ["keep"]
    assert not shown.window.sheet.isVisible()

    shown.window.close()
    qtbot.mouseClick(shown.window.sheet.yes, Qt.MouseButton.LeftButton)
    assert answers == ["keep", "close"]
    assert shown.window.isVisible()


def test_the_question_goes_when_the_recording_ended_by_itself(shown):
    shown.window.show_state(RECORDING)
    shown.window.ask_before_close()
    shown.window.show_state(replace(RECORDING, phase=StripPhase.SAVING))

    assert not shown.window.sheet.isVisible()


def test_the_switch_changes_words_only(qtbot, shown):
    told: list[str] = []
    shown.window.vocabulary_changed.connect(told.append)
    qtbot.mouseClick(shown.window.header.switch.buttons["studio"], Qt.MouseButton.LeftButton)
    assert told == ["studio"]

    shown.window.show_vocabulary("studio")
    assert shown.window.header.person.accessibleName() == "Performer: P014"
    shown.window.show_vocabulary("clinic")
    assert shown.window.header.person.accessibleName() == "Person: P014"


def test_a_person_is_chosen_or_added_by_a_code(qtbot, shown):
    told: list[str] = []
    shown.window.person_chosen.connect(told.append)
    shown.window.person_created.connect(told.append)
    menu = shown.window.header.person.menu()
    menu.actions()[0].trigger()
    assert told == ["P001"]

    menu.actions()[-1].trigger()
    assert shown.window.sheet.line.hasFocus()
    assert not shown.window.sheet.yes.isEnabled()
    qtbot.keyClicks(shown.window.sheet.line, "p014r")
    qtbot.keyClick(shown.window.sheet.line, Qt.Key.Key_Return)
    assert told == ["P001", "p014r"]
    assert not shown.window.sheet.isVisible()


def test_nobody_is_said_to_be_captured_when_nobody_is(shown):
    shown.window.show_people((), "")

    assert shown.window.header.person.accessibleName() == "Person: none"


def test_question_mark_opens_the_keys_and_esc_closes_them(qtbot, shown):
    qtbot.keyClick(shown.window, Qt.Key.Key_F1)
    assert shown.window.overlay.isVisible()
    assert ("R", "Start or stop recording") in [row[1:] for row in shown.window.overlay.rows]

    qtbot.keyClick(shown.window.focusWidget(), Qt.Key.Key_Escape)
    assert not shown.window.overlay.isVisible()


def test_the_keys_lead_to_their_settings(qtbot, shown):
    shown.window.show_keys()
    qtbot.mouseClick(shown.window.overlay.change_button, Qt.MouseButton.LeftButton)

    assert shown.window.shown_page == "settings"
    assert not shown.window.overlay.isVisible()


def test_size_and_place_are_found_again(qtbot, shown):
    shown.window.resize(1100, 700)
    kept = shown.window.geometry_state()
    shown.window.resize(1280, 800)
    shown.window.restore_geometry_state(kept)

    # Qt keeps a window on its screen, and the screen of this test is small.
    assert shown.window.height() == 700


def test_a_geometry_that_means_nothing_gives_the_usual_size(shown):
    shown.window.resize(1100, 700)
    shown.window.restore_geometry_state(b"nonsense")

    assert (shown.window.width(), shown.window.height()) == (1280, 800)


def test_a_safe_start_says_so_and_offers_the_way_back(qtbot, shown):
    told: list[str] = []
    shown.window.notice_acted.connect(told.append)
    shown.window.show_safe_start()
    button = next(b for b in shown.window.banner.findChildren(type(shown.window.strip.record)) if b.property("action"))
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)

    assert told == ["open_last"]
    assert not shown.window.banner.isVisible()
