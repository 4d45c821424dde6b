"""What people do that nobody planned: sources leave, processes die, folders vanish, two things at once."""

import json
import os
import shutil
import signal
import sys

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.core.errors import StudioError
from studio.storage.take_summary import summarise
from studio.ui.models.recorder import Phase
from tests.journeys.test_first_start import SLOW, button, click, has_body
from tests.journeys.test_receiver_on_a_cable import suit
from tests.ui.running_studio import running_studio

needs_ports = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")


def recorded(qtbot, studio, takes=1):
    """Record for a moment, and wait until the take is listed."""
    click(studio.window.strip.record)
    qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
    qtbot.wait(600)
    click(studio.window.strip.record)
    qtbot.waitUntil(lambda: studio.review_page.takes.model.total == takes, timeout=SLOW)
    qtbot.waitUntil(lambda: studio.recorder.phase is Phase.IDLE, timeout=SLOW)
    return studio.review_page.takes.model.newest()[0]


def test_a_countdown_that_outlives_its_source_makes_no_take(qtbot, tmp_path):
    with running_studio(tmp_path, delay=3) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        assert "STARTS IN" in studio.window.strip.state.text() or studio.recorder.left == 3
        assert not studio.window.header.person.isEnabled(), "whose take it is stands from here on"
        studio.model.close_source()
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.IDLE, timeout=SLOW)
        assert studio.window.banner.isVisible()
        assert not (tmp_path / "takes").exists()


def test_use_my_sensors_ends_no_recording(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        click(studio.home_page.sensors)
        assert studio.window.shown_page == "connect"
        qtbot.wait(800)
        assert studio.model.source, "the source was closed under the recording"
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        assert studio.review_page.takes.model.newest()[0].duration_s > 2.5


def test_a_save_that_fails_while_closing_keeps_the_window_open_and_says_why(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.wait(600)
        studio.window.close()
        shutil.rmtree(tmp_path / "takes")
        click(studio.window.sheet.yes)
        qtbot.waitUntil(studio.window.banner.isVisible, timeout=SLOW)
        assert studio.window.isVisible()
        assert studio.recorder.phase is Phase.IDLE


@pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL is of POSIX")
@pytest.mark.parametrize("page", ["review", "export"])
def test_a_worker_that_is_killed_is_told_and_the_page_can_be_used_again(qtbot, tmp_path, page):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        take = recorded(qtbot, studio)
        studio.export.choose([take])
        ask = studio.export_page.start.click if page == "export" else lambda: studio.review_take(take.folder)
        studio.go_to(page)
        if page == "review":
            qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)
            shutil.rmtree(take.folder / "derived")
        ask()
        qtbot.waitUntil(lambda: worker_of(studio) is not None, timeout=SLOW)
        os.kill(worker_of(studio), signal.SIGKILL)
        said = studio.export_page.result.text if page == "export" else studio.review_page.state.accessibleName
        qtbot.waitUntil(lambda: "memory" in said() or "worked out" in said(), timeout=SLOW)

        ask()
        if page == "export":
            qtbot.waitUntil(studio.export_page.result.show_file.isVisible, timeout=SLOW)
        else:
            qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)


def worker_of(studio):
    """Return the number of the worker process; None before it was started."""
    process = studio.model.worker._process  # noqa: SLF001 (to be killed as a system without memory does)
    return None if process is None else process.pid


@needs_ports
def test_a_port_that_was_given_up_does_not_disturb_the_next(qtbot, tmp_path):
    master, slave = os.openpty()  # a device that never says anything
    try:
        with running_studio(tmp_path, source="") as studio, suit("walk?seed=1&calibrated=1", 40) as port:
            studio.model.open(f"serial:{os.ttyname(slave)}")
            qtbot.wait(1500)
            studio.model.close_source()
            studio.model.open(f"serial:{port}")
            qtbot.waitUntil(lambda: len(studio.model.infos) == 15 and not studio.model.connecting, timeout=SLOW)
            refusals: list[StudioError] = []
            studio.model.source_refused.connect(refusals.append)
            qtbot.wait(9500)  # the patience that the first port would have had
            assert refusals == []
            assert studio.model.source == f"serial:{port}"
    finally:
        os.close(master)
        os.close(slave)


def test_closing_during_an_export_asks_once(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        take = recorded(qtbot, studio)
        studio.export.choose([take])
        studio.go_to("export")
        click(studio.export_page.start)
        studio.window.close()
        assert studio.window.isVisible()
        click(studio.window.sheet.no)
        qtbot.waitUntil(studio.export_page.result.show_file.isVisible, timeout=SLOW)
        studio.window.close()
        assert not studio.window.isVisible()


def test_a_file_of_somebody_else_is_replaced_only_after_it_was_said(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        take = recorded(qtbot, studio)
        studio.export.choose([take])
        studio.go_to("export")
        click(studio.export_page.cards["joints"])
        theirs = tmp_path / "exports" / "report.csv"
        theirs.parent.mkdir()
        theirs.write_text("theirs")
        studio.export_page.name.selectAll()
        QTest.keyClicks(studio.export_page.name, "report")

        click(studio.export_page.start)
        assert studio.export_page.start.text() == "Replace and export"
        assert theirs.read_text() == "theirs"
        click(studio.export_page.cards["raw"])
        click(studio.export_page.cards["joints"])
        click(studio.export_page.start)
        assert theirs.read_text() == "theirs", "what was agreed to was for another order"

        click(studio.export_page.start)
        qtbot.waitUntil(studio.export_page.result.show_file.isVisible, timeout=SLOW)
        assert theirs.read_text() != "theirs"


def test_space_plays_the_take_that_was_chosen_in_the_list(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        take = recorded(qtbot, studio)
        studio.review_take(take.folder)
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)
        studio.window.activateWindow()
        studio.review_page.takes.view.setFocus()
        QTest.keyClick(studio.review_page.takes.view, Qt.Key.Key_Space)
        assert studio.review_page.playhead.is_playing


def test_the_star_key_pressed_twice_at_once_leaves_no_star(qtbot, tmp_path):
    with running_studio(tmp_path) as studio:
        qtbot.waitUntil(lambda: has_body(studio), timeout=SLOW)
        take = recorded(qtbot, studio)
        studio.review_take(take.folder)
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)
        studio.review_page.takes.toggle_star()
        studio.review_page.takes.toggle_star()
        qtbot.wait(500)
        assert summarise(take.folder).verdict == "none"


@needs_ports
def test_nothing_of_one_person_is_left_though_the_file_of_the_next_cannot_be_read(qtbot, tmp_path):
    newer = tmp_path / "takes" / "P015" / "person.json"
    newer.parent.mkdir(parents=True)
    newer.write_text(json.dumps({"schema": 99}))
    with running_studio(tmp_path, source="", last_person="P014") as studio, suit("walk?calibrated=1", 30) as port:
        studio.model.open(f"serial:{port}")
        qtbot.waitUntil(lambda: len(studio.model.infos) == 15 and not studio.model.connecting, timeout=SLOW)
        changes = []
        studio.model.person_changed.connect(lambda: changes.append(studio.model.person))
        studio.people.choose("P015")
        qtbot.waitUntil(studio.window.banner.isVisible, timeout=SLOW)
        assert changes == ["P015"]
        assert studio.model.alignment is None
        assert button(studio.window.strip, "CHECK")
