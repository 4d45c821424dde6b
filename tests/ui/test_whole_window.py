"""The running studio, page by page: everybody can use it, at any text size, in both themes."""

from contextlib import contextmanager

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QAbstractSpinBox, QApplication, QHeaderView

from studio.ui.keys import TABLE
from studio.ui.views.place_mark import PlaceMark
from tests.ui.access import controls, cut_texts
from tests.ui.running_studio import running_studio

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

PAGES = ["home", "connect", "assign", "calibrate", "capture", "review", "export", "settings", "diagnostics"]
SLOW = 30_000  # ms


@contextmanager
def walking(qtbot, folder, **preferences):
    with running_studio(folder, **preferences) as studio:
        buffer = studio.model.buffer
        qtbot.waitUntil(lambda: studio.model.alignment is not None and buffer.newest()[1] is not None, timeout=SLOW)
        studio.window.activateWindow()
        yield studio


def is_one_of_several(control):
    if isinstance(control, PlaceMark) or isinstance(control.parent(), QAbstractSpinBox):
        return True
    return isinstance(control, QAbstractButton) and bool(control.group() or control.autoExclusive())


def settle(qtbot):
    qtbot.wait(350)


def test_every_control_of_every_page_has_a_name_and_room_for_a_finger(qtbot, tmp_path):
    with walking(qtbot, tmp_path, text_scale=0.8) as studio:
        for page in PAGES:
            studio.go_to(page)
            settle(qtbot)
            found = controls(studio.window)
            assert [(page, type(c).__name__, c.parent()) for c in found if not c.accessibleName()] == []
            pressed = [c for c in found if not isinstance(c, QHeaderView)]
            assert [(page, c.accessibleName(), c.height()) for c in pressed if c.height() < 24] == []


@pytest.mark.parametrize("scale", [1.0, 2.0])
def test_no_text_of_any_page_is_cut(qtbot, tmp_path, scale):
    with walking(qtbot, tmp_path, text_scale=scale, scheme="light") as studio:
        for page in PAGES:
            studio.go_to(page)
            settle(qtbot)
            assert (page, cut_texts(studio.window)) == (page, [])
            assert (studio.window.width(), studio.window.height()) == (1280, 800)


@pytest.mark.parametrize("page", PAGES)
def test_tab_visits_every_control_of_a_page_and_comes_back(qtbot, tmp_path, page):
    with walking(qtbot, tmp_path) as studio:
        studio.go_to(page)
        settle(qtbot)
        window = studio.window
        wanted = {c for c in controls(window) if c.isEnabled() and c.focusPolicy() & Qt.FocusPolicy.TabFocus}
        # Of several that belong together Tab visits one, and arrows the others.
        grouped = {c for c in wanted if is_one_of_several(c)}
        visited = []
        focused = None
        for _ in range(3 * len(wanted)):
            qtbot.keyClick(window.focusWidget() or window, Qt.Key.Key_Tab)
            focused = window.focusWidget()
            if focused is None or focused in visited:
                break
            visited.append(focused)
        missed = wanted - grouped - set(visited)
        assert not grouped or grouped & set(visited)
        assert [(type(c).__name__, c.accessibleName()) for c in missed] == []
        assert focused is visited[0]


def test_every_key_that_is_offered_does_something_somewhere(qtbot, tmp_path):
    with walking(qtbot, tmp_path) as studio:
        offered = {key.action for key in studio.window.keys.offered}
        assert offered <= {key.action for key in TABLE}
        assert {"connect", "record", "marker", "cancel", "go", "follow", "views", "undo", "export_again"} <= offered
        assert not {"compare", "origin", "yaw_reset", "safe_restart"} & offered, "their functions do not exist yet"


def test_a_theme_and_a_text_size_come_into_force_at_once_and_stay(qtbot, tmp_path):
    with walking(qtbot, tmp_path, scheme="dark") as studio:
        dark = studio.window.grab().toImage().pixelColor(5, 400)
        studio.go_to("settings")
        studio.settings.set("scheme", "light")
        studio.settings.set("text_scale", 1.5)
        QApplication.processEvents()
        assert studio.window.grab().toImage().pixelColor(5, 400) != dark
        assert studio.theme.text_scale == 1.5
        studio.settings.flush()
        assert "light" in (tmp_path / "settings.ini").read_text()


def test_clinic_and_studio_name_the_same_things_otherwise(qtbot, tmp_path):
    with walking(qtbot, tmp_path) as studio:
        assert "trial" in studio.capture.take_title()
        studio.window.header.vocabulary_changed.emit("studio")
        assert "motion" in studio.capture.take_title()
        assert studio.window.header.words.person == "Performer"


def test_a_broken_settings_file_does_not_stop_a_start(qtbot, tmp_path):
    (tmp_path / "settings.ini").write_bytes(b"\xff\xfe\x00 not settings")
    with running_studio(tmp_path) as studio:
        assert studio.settings.put_aside
        assert studio.window.isVisible()


def test_after_two_crashes_the_last_source_is_offered_and_not_opened(qtbot, tmp_path):
    with running_studio(tmp_path, source="") as studio:
        studio.offer_last("synthetic:walk?calibrated=1&ahead=9")
        assert studio.model.source == ""
        qtbot.wait(50)
        studio.window.banner.acted.emit("open_last")
        qtbot.waitUntil(lambda: len(studio.model.infos) == 15, timeout=SLOW)
