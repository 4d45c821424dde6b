"""Home, settings, diagnostics and the crash report."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QPushButton, QWidget

from studio.ui.models.preferences import Preferences
from studio.ui.theme import Theme
from studio.ui.views.crash_dialog import CrashDialog
from studio.ui.views.home_page import Recovered
from studio.ui.views.look_controls import next_size
from tests.ui.shell_window import shell

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def shown(qtbot):
    with shell(qtbot) as made:
        yield made


@pytest.fixture
def home(shown):
    shown.window.show_page("home")
    return shown.home


@pytest.fixture
def settings(shown):
    shown.window.show_page("settings")
    return shown.settings


def named(parent, name):
    return next(b for b in parent.findChildren(QPushButton) if b.accessibleName() == name and b.isVisible())


def test_home_offers_three_ways_to_go_on(qtbot, home):
    told: list[str] = []
    home.sensors_requested.connect(lambda: told.append("sensors"))
    home.sample_requested.connect(lambda: told.append("sample"))
    home.take_requested.connect(lambda: told.append("take"))
    for button in (home.sensors, home.sample, home.open_take):
        qtbot.mouseClick(button, LEFT)

    assert told == ["sensors", "sample", "take"]
    assert home.sensors.property("kind") == "primary"


def test_the_stage_fills_the_left(home):
    stage = QWidget()
    home.set_stage(stage)
    home.layout().activate()
    QGuiApplication.processEvents()

    assert stage.width() > 600
    assert stage.height() > 400


def test_nobody_takes_the_simulated_performer_for_a_patient(home):
    assert home.caption.text() == "This is a simulated performer"
    home.show_simulated(False)
    assert not home.caption.isVisible()


def test_recovered_takes_are_reviewed_or_found(qtbot, home):
    told: list[str] = []
    home.take_opened.connect(lambda folder: told.append(f"review {folder}"))
    home.folder_requested.connect(lambda folder: told.append(f"show {folder}"))
    qtbot.mouseClick(named(home, "Review take 1"), LEFT)
    qtbot.mouseClick(named(home, "Show folder of take 1"), LEFT)

    assert told == ["review take-1", "show take-1"]


def test_many_recovered_takes_with_long_names_leave_the_page_in_its_width(home):
    long = "walking up the long stairs with the left crutch and down again " * 3
    home.show_recovered([Recovered(str(n), f"take {n} {long}", "12 min 04 s") for n in range(50)])
    QGuiApplication.processEvents()

    assert home.minimumSizeHint().width() <= 960
    assert named(home, f"Review take 0 {long}").isVisible()
    assert not [b for b in home.findChildren(QPushButton) if b.accessibleName() == "Review take 1" and b.isVisible()]


def test_hints_come_one_after_the_other_and_go_for_good(qtbot, home):
    gone: list[bool] = []
    home.coach_marks_dismissed.connect(lambda: gone.append(True))
    seen = {home.coach.text.text()}
    for _ in range(2):
        qtbot.mouseClick(home.coach.next, LEFT)
        seen.add(home.coach.text.text())
    assert len(seen) == 3
    assert not home.coach.next.isVisible()

    qtbot.mouseClick(home.coach.done, LEFT)
    assert gone == [True]
    assert not home.coach.isVisible()
    home.show_coach_marks(False)
    assert not home.coach.isVisible()


def test_text_size_and_theme_are_one_click_away(qtbot, home):
    told: list[object] = []
    home.text_scale_chosen.connect(told.append)
    home.scheme_chosen.connect(told.append)
    qtbot.mouseClick(home.text_size.larger, LEFT)
    qtbot.mouseClick(home.scheme.segments.buttons["light"], LEFT)

    assert told == [1.1, "light"]


def test_text_sizes_end_at_80_and_200_percent():
    assert [next_size(1.0, step) for step in (-1, 0, 1)] == [0.9, 1.0, 1.1]
    assert next_size(2.0, 1) == 2.0
    assert next_size(0.8, -1) == 0.8
    assert next_size(1.33, 1) == 1.5


def test_every_setting_acts_at_once(qtbot, settings):
    told: list[tuple[str, object]] = []
    settings.changed.connect(lambda name, value: told.append((name, value)))
    for control in (settings.reduced_motion, settings.clicker, settings.sound):
        control.setFocus()
        qtbot.keyClick(control, Qt.Key.Key_Space)
    qtbot.mouseClick(settings.scheme.segments.buttons["dark"], LEFT)
    qtbot.mouseClick(settings.text_size.smaller, LEFT)
    qtbot.mouseClick(settings.vocabulary.buttons["studio"], LEFT)
    qtbot.mouseClick(settings.seen_from.buttons["behind"], LEFT)
    settings.delay.setFocus()
    qtbot.keyClick(settings.delay, Qt.Key.Key_Down)

    assert told == [
        ("reduced_motion", True),
        ("clicker", True),
        ("sound", False),
        ("scheme", "dark"),
        ("text_scale", 0.9),
        ("vocabulary", "studio"),
        ("seen_from", "behind"),
        ("delay", 3),
    ]


def test_showing_preferences_changes_none(settings):
    told: list[str] = []
    settings.changed.connect(lambda name, value: told.append(name))
    chosen = Preferences(delay=10, sound=False, volume=0.2, clicker=True, reduced_motion=True, seen_from="behind")
    settings.show_preferences(chosen, "/data/takes")

    assert told == []
    assert settings.delay.currentText() == "after 10 s"
    assert settings.library.text() == "/data/takes"
    assert not settings.test_sound.isEnabled()


def test_the_sound_can_be_tested_and_the_folder_changed(qtbot, settings):
    told: list[str] = []
    settings.sound_test_wanted.connect(lambda: told.append("sound"))
    settings.library_wanted.connect(lambda: told.append("choose"))
    settings.library_shown.connect(lambda: told.append("show"))
    for button in (settings.test_sound, settings.choose_library, settings.show_library):
        qtbot.mouseClick(button, LEFT)

    assert told == ["sound", "choose", "show"]


def test_a_key_is_changed_by_pressing_it(qtbot, settings):
    told: list[object] = []
    settings.changed.connect(lambda name, value: told.append((name, value)))
    field = settings.keys.fields["record"]
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_F9)
    assert told == [("keys", {"record": ("F9",)})]
    assert field.text() == "F9"

    qtbot.mouseClick(named(settings, "Default key for: Start or stop recording"), LEFT)
    assert told[-1] == ("keys", {})
    assert field.text() == "R"


def test_a_key_that_means_something_else_is_refused_by_name(qtbot, settings):
    told: list[str] = []
    settings.changed.connect(lambda name, value: told.append(name))
    field = settings.keys.fields["record"]
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_M)

    assert told == []
    assert field.text() == "R"
    assert "M already means “Set a marker”" in settings.keys.told


def test_a_key_can_be_taken_away_and_tab_goes_on(qtbot, settings):
    told: list[object] = []
    settings.changed.connect(lambda name, value: told.append(value))
    field = settings.keys.fields["marker"]
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_Tab)
    assert not field.hasFocus()
    assert told == []

    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_Backspace)
    assert told == [{"marker": ()}]


def test_a_shifted_sign_is_taken_as_the_sign(qtbot, settings):
    told: list[object] = []
    settings.changed.connect(lambda name, value: told.append(value))
    field = settings.keys.fields["marker"]
    field.setFocus()
    qtbot.keyClick(field, Qt.Key.Key_Exclam, Qt.KeyboardModifier.ShiftModifier)

    assert told == [{"marker": ("!",)}]


def test_the_report_is_copied_as_it_is_read(qtbot, shown):
    shown.window.show_page("diagnostics")
    page = shown.diagnostics
    page.show_rows([("Versions", ""), ("studio", "0.2.0"), ("Link", ""), ("received", "1 234")])
    qtbot.mouseClick(page.copy, LEFT)

    assert QGuiApplication.clipboard().text() == page.report.toPlainText()
    assert page.report.toPlainText() == "Versions\nstudio    0.2.0\n\nLink\nreceived  1 234"


def test_new_figures_do_not_move_what_is_being_read(shown):
    shown.window.show_page("diagnostics")
    page = shown.diagnostics
    page.show_rows([(f"row {n}", "1") for n in range(500)])
    QGuiApplication.processEvents()
    page.report.verticalScrollBar().setValue(200)
    page.show_rows([(f"row {n}", "2") for n in range(500)])

    assert page.report.verticalScrollBar().value() == 200


def test_a_crash_report_blocks_nothing_and_can_be_copied(qtbot):
    dialog = CrashDialog(Theme(), "~/log/crash-1.txt", "Traceback: AssertionError")
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, False)
    qtbot.addWidget(dialog)
    dialog.show()
    asked: list[bool] = []
    dialog.folder_requested.connect(lambda: asked.append(True))
    qtbot.mouseClick(dialog.copy, LEFT)
    qtbot.mouseClick(dialog.folder, LEFT)

    assert not dialog.isModal()
    assert QGuiApplication.clipboard().text() == "Traceback: AssertionError"
    assert asked == [True]
    qtbot.mouseClick(dialog.close_button, LEFT)
    assert not dialog.isVisible()
