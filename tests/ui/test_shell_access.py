"""Everybody can use the shell: names for all controls, a closed way for the keyboard, large text uncut."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QApplication, QWidget

from studio.ui.models.readiness import Problem, ReadinessState, StripPhase
from studio.ui.theme import Theme
from studio.ui.views.crash_dialog import CrashDialog
from studio.ui.views.notices import Action
from tests.ui.access import controls, cut_texts
from tests.ui.shell_window import shell

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

PAGES = ["home", "connect", "capture", "settings", "diagnostics"]
STATE = ReadinessState(StripPhase.CHECK, 14, 15, None, 0.12, 500.0, 0.8, "take 004 walk", 0.0)
PROBLEMS = (Problem("The body calibration is 47 min old. Angles may have drifted.", "Repeat the pose", "pose"),) * 3


def busy(made) -> None:
    """Let everything be shown that can be."""
    window = made.window
    window.show_state(replace(STATE, problems=PROBLEMS))
    window.banner.put("a", "About 9 minutes of space left.", "The disk fills up.", "Free space.", (Action("x", "Go"),))
    QApplication.processEvents()


@pytest.mark.parametrize("page", PAGES)
def test_every_control_has_a_name(qtbot, page):
    with shell(qtbot) as made:
        made.window.show_page(page)
        busy(made)
        made.window.toast.say("Saved", (Action("review", "Review"),))
        made.window.strip.problems.toggle(above=made.window.strip)
        made.window.show_keys()
        made.window.ask_before_close()
        found = controls(made.window)

        assert len(found) > 20
        assert [(type(c).__name__, c.objectName(), c.parent()) for c in found if not c.accessibleName()] == []


def test_every_control_of_the_crash_report_has_a_name(qtbot):
    dialog = CrashDialog(Theme(), "~/log/crash-1.txt", "Traceback")
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose, False)
    qtbot.addWidget(dialog)
    dialog.show()

    assert [c for c in controls(dialog) if not c.accessibleName()] == []


@pytest.mark.parametrize("page", PAGES)
def test_tab_visits_every_control_and_comes_back(qtbot, page):
    with shell(qtbot) as made:
        made.window.show_page(page)
        busy(made)
        # Of a group of which one is chosen, Tab visits the chosen one and arrows the others.
        all_of_them = {c for c in controls(made.window) if c.isEnabled()}
        grouped = {c for c in all_of_them if isinstance(c, QAbstractButton) and c.group() and not c.isChecked()}
        visited: list[QWidget] = []
        for _ in range(3 * len(all_of_them)):
            qtbot.keyClick(made.window.focusWidget() or made.window, Qt.Key.Key_Tab)
            focused = made.window.focusWidget()
            if focused is None or focused in visited:
                break
            visited.append(focused)

        missed = all_of_them - grouped - set(visited)
        assert [(type(c).__name__, c.accessibleName()) for c in missed] == []
        assert focused is visited[0]


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("page", PAGES)
def test_no_text_is_cut(qtbot, page, scale):
    with shell(qtbot, "light", scale) as made:
        made.window.show_page(page)
        busy(made)
        made.window.toast.say("Take 004 saved and verified · 00:42 · loss 0.1 %", (Action("review", "Review"),))
        for _ in range(3):
            QApplication.processEvents()
        cut = cut_texts(made.window)

        assert cut == []
        assert (made.window.width(), made.window.height()) == (1280, 800)


def test_in_a_low_window_large_words_stay_and_icons_go(qtbot):
    with shell(qtbot, text_scale=2.0) as made:
        made.window.resize(1024, 640)
        QApplication.processEvents()
        cut = [b.text() for b in made.window.rail.buttons.values() if b.height() < b.sizeHint().height()]

        assert cut == []


@pytest.mark.parametrize("page", PAGES)
def test_targets_are_large_enough(qtbot, page):
    with shell(qtbot, text_scale=0.8) as made:
        made.window.show_page(page)
        busy(made)
        small = [(type(c).__name__, c.accessibleName(), c.height()) for c in controls(made.window) if c.height() < 24]

        assert small == []
        assert made.window.strip.record.height() >= 44


def test_names_do_not_depend_on_icons(qtbot):
    with shell(qtbot) as made:
        for button in (made.window.header.help, made.window.header.menu_button, made.window.banner.close_button):
            assert button.accessibleName()
            assert button.toolTip() == button.accessibleName()
