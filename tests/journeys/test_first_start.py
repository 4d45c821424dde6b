"""Somebody who never saw the studio starts it, records the figure that walks, and has a BVH; by clicks."""

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QPushButton

from studio.importers.bvh import read_bvh
from studio.storage.take_summary import summarise
from studio.ui.models.recorder import Phase
from tests.ui.running_studio import running_studio

SLOW = 30_000  # ms; a loaded machine is slow, not wrong


def click(widget):
    assert widget.isVisible(), f"{widget.accessibleName()} cannot be seen"
    assert widget.isEnabled(), f"{widget.accessibleName()} cannot be pressed"
    QTest.mouseClick(widget, Qt.MouseButton.LeftButton)


def button(parent, words):
    found = [b for b in parent.findChildren(QPushButton) if b.isVisible() and b.text().startswith(words)]
    assert found, f"no button {words}"
    return found[0]


def has_body(studio):
    return studio.model.alignment is not None and studio.model.buffer.newest()[1] is not None


def test_from_first_start_to_a_bvh_by_clicks_alone(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        window = studio.window
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        assert window.shown_page == "home"
        assert studio.home_page.caption.isVisible(), "nobody says that the performer is simulated"

        click(window.rail.buttons["capture"])
        click(studio.capture_page.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.wait(2000)
        click(studio.capture_page.record)
        qtbot.waitUntil(window.toast.isVisible, timeout=SLOW)

        click(button(window.toast, "Review"))
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)
        click(studio.review_page.transport.play)
        qtbot.waitUntil(lambda: studio.review_page.playhead.time > 0.3, timeout=SLOW)
        click(studio.review_page.transport.play)

        click(studio.review_page.measures.export)
        click(studio.export_page.cards["blender"])
        click(studio.export_page.start)
        qtbot.waitUntil(studio.export_page.result.show_file.isVisible, timeout=SLOW)

        files = list((tmp_path / "exports").glob("*.bvh"))
        assert len(files) == 1
        assert "checked" in studio.export_page.result.text()
        motion = read_bvh(files[0])
        assert len(motion.values) * motion.frame_time >= 3.5, "two seconds of pre-roll and two of recording"
        assert np.ptp(motion.values, axis=0).max() > 20, "nobody walks in it"


def test_the_record_key_works_on_home_and_the_take_waits_in_review(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        window = studio.window
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        window.activateWindow()
        QTest.keyClick(window, Qt.Key.Key_R)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.waitUntil(lambda: "REC" in window.strip.state.text(), timeout=SLOW)
        QTest.keyClick(window, Qt.Key.Key_Escape)
        qtbot.wait(600)
        assert studio.recorder.phase is Phase.RECORDING, "Esc stopped a recording"
        QTest.keyClick(window, Qt.Key.Key_M)
        QTest.keyClick(window, Qt.Key.Key_R)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        summary = studio.review_page.takes.model.newest()[0]
        assert summary.samples > 15 * 50
        assert summary.lost == 0.0


def test_closing_while_recording_asks_once_and_saves_first(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        window = studio.window
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        window.close()
        window.close()
        assert window.isVisible()
        click(window.sheet.yes)
        qtbot.waitUntil(lambda: not window.isVisible(), timeout=SLOW)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)


def test_nothing_is_lost_while_the_window_stands_still(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        QTest.qSleep(500)  # what a file dialog of a slow drive does to the Qt thread
        qtbot.wait(600)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        assert studio.review_page.takes.model.newest()[0].lost == 0.0


def test_without_sensors_the_record_key_says_why_and_makes_no_take(qtbot, tmp_path):
    with running_studio(tmp_path, source="") as studio:
        click(studio.window.strip.record)
        assert studio.window.banner.isVisible()
        assert studio.recorder.phase is Phase.IDLE
        qtbot.wait(50)  # buttons of a message are laid out after it is shown
        click(button(studio.window.banner, "Connect"))
        assert studio.window.shown_page == "connect"
        assert not (tmp_path / "takes").exists()


def test_the_sample_take_opens_by_one_click(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        click(studio.home_page.sample)
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=2 * SLOW)
        assert studio.review_page.takes.model.total == 1
        studio.go_to("home")
        click(studio.home_page.sample)
        qtbot.waitUntil(lambda: studio.window.shown_page == "review", timeout=SLOW)
        assert studio.review_page.takes.model.total == 1, "imported twice"


def test_while_recording_person_source_and_places_wait(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        waiting = (studio.window.header.person, studio.connect_page.choice, studio.assign_page)
        assert not any(part.isEnabled() for part in waiting)
        assert all("after it" in part.toolTip() for part in waiting)
        qtbot.wait(600)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        assert all(part.isEnabled() for part in waiting)


def test_a_note_that_is_being_written_when_the_window_closes_is_kept(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.wait(600)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        folder = studio.review_page.takes.model.newest()[0].folder
        studio.review_take(folder)
        qtbot.waitUntil(studio.review_page.measures.note.isEnabled, timeout=SLOW)
        studio.review_page.measures.note.setFocus()
        QTest.keyClicks(studio.review_page.measures.note, "pain on stairs")
    assert summarise(folder).notes == "pain on stairs"


def test_a_simulated_take_never_stands_among_those_of_a_person(qtbot, tmp_path):
    with running_studio(tmp_path, last_person="P014") as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.wait(600)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        assert studio.review_page.takes.model.newest()[0].person == "P000"


def test_a_window_without_a_recording_closes_at_the_first_press(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        studio.window.close()
        assert not studio.window.isVisible()


def test_a_star_and_what_follows_it_at_once_are_both_kept(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        click(studio.home_page.sample)
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=2 * SLOW)
        folder = studio.review_page.takes.model.newest()[0].folder
        for _ in range(5):
            studio.review.judge(folder, "star")
            studio.review.judge(folder, "bad")
        qtbot.waitUntil(lambda: summarise(folder).verdict == "bad", timeout=SLOW)
        qtbot.wait(300)
        assert summarise(folder).verdict == "bad"
        assert not studio.window.banner.isVisible()
