"""Somebody with 15 tags and a receiver: connect, assign, calibrate the body by holds, capture; by clicks.

The receiver is a pseudo-terminal behind which the synthetic suit stands and bows in real time.
"""

import sys
import time

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QTest

from studio.acquisition.driver import Found
from studio.capture.procedures.held_pose import Phase as HoldPhase
from studio.core.body import Place
from studio.ui.models.recorder import Phase
from tests.journeys.test_first_start import SLOW, button, click
from tests.journeys.test_receiver_on_a_cable import suit
from tests.ui.running_studio import running_studio

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")

AHEAD = 24.6  # s of the script "holds" that are over when the port opens: the wearer has just stood up again
BOWS = 33.8  # s, script time from which the bow is steady (9.4 + 16 + 8.4)


def hold(qtbot, studio, words):
    """Press Start and wait for the judgement."""
    click(button(studio.calibration_page, words))
    qtbot.waitUntil(lambda: studio.holds.is_running, timeout=SLOW)
    qtbot.waitUntil(lambda: studio.holds.hold.phase is HoldPhase.JUDGED, timeout=SLOW)


def moved(studio):
    """Return the limbs that did not hold still."""
    assert studio.holds.outcome is not None
    return studio.holds.outcome.moved


def connected(qtbot, studio, port):
    """Open the port by clicks; return when that was."""
    click(studio.home_page.sensors)
    page = studio.connect_page
    page.offer_ports((Found(f"serial:{port}", "Receiver"),))  # a pseudo-terminal is in no list of ports
    opened = time.perf_counter()
    click(page.choice.go)
    qtbot.waitUntil(lambda: len(studio.model.infos) == 15 and not studio.model.connecting, timeout=SLOW)
    qtbot.waitUntil(lambda: page.sensors.rowCount() == 15, timeout=SLOW)
    return opened


def exchanged_and_back(qtbot, studio):
    """Exchange shanks and feet, and think better of it."""
    click(studio.window.rail.buttons["assign"])
    assert len(studio.model.setup.assignment.sensors) == 15, "tag k belongs to place k until somebody says otherwise"
    swapped = studio.model.setup.assignment
    click(studio.assign_page.cross)
    qtbot.waitUntil(lambda: studio.model.setup.assignment != swapped, timeout=SLOW)
    click(studio.assign_page.undo)
    qtbot.waitUntil(lambda: studio.model.setup.assignment == swapped, timeout=SLOW)


def test_tags_are_connected_assigned_calibrated_and_captured(qtbot, tmp_path):
    with (
        suit(f"holds?seed=1&calibrated=1&ahead={AHEAD}", 60) as port,
        running_studio(tmp_path, source="", last_person="P014") as studio,
    ):
        opened = connected(qtbot, studio, port)
        exchanged_and_back(qtbot, studio)
        click(studio.window.rail.buttons["calibrate"])
        hold(qtbot, studio, "Start N-pose")
        assert moved(studio) == (), "the wearer stood still"
        qtbot.waitUntil(lambda: AHEAD + time.perf_counter() - opened > BOWS - 2.8, timeout=SLOW)
        hold(qtbot, studio, "Start")
        assert moved(studio) == ()
        alignment = studio.model.alignment
        assert alignment is not None
        assert [limb.source for limb in alignment.limbs.values()] == ["bow"] * 15
        QTest.keyClick(studio.window, Qt.Key.Key_4)

        qtbot.waitUntil(lambda: studio.model.buffer.newest()[1] is not None, timeout=SLOW)
        click(studio.capture_page.record)
        qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
        qtbot.wait(1500)
        click(studio.capture_page.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        summary = studio.review_page.takes.model.newest()[0]
        assert summary.person == "P014"
        assert summary.lost == 0.0
        assert Place.LEFT_FOOT in summary.places
        assert (tmp_path / "takes" / "P014" / "person.json").is_file(), "who wears what is remembered"

        studio.people.choose("P015")
        qtbot.waitUntil(lambda: studio.model.person == "P015", timeout=SLOW)
        qtbot.waitUntil(lambda: studio.model.buffer.newest()[1] is None, timeout=SLOW)
        assert studio.model.alignment is None, "somebody else's body calibration stayed in force"
        qtbot.waitUntil(lambda: studio.holds.outcome is None, timeout=SLOW)

        studio.review_take(summary.folder)
        qtbot.waitUntil(studio.review_page.transport.play.isEnabled, timeout=SLOW)


def test_a_port_that_is_pulled_out_is_told_and_the_take_is_kept(qtbot, tmp_path):
    with running_studio(tmp_path, source="") as studio:
        with suit("walk?seed=1&calibrated=1", 30) as port:
            studio.model.open(f"serial:{port}")
            qtbot.waitUntil(lambda: len(studio.model.infos) == 15 and not studio.model.connecting, timeout=SLOW)
            qtbot.waitUntil(lambda: studio.model.heard_at > 0, timeout=SLOW)
            click(studio.window.strip.record)
            qtbot.waitUntil(lambda: studio.recorder.phase is Phase.RECORDING, timeout=SLOW)
            qtbot.wait(1200)
        qtbot.waitUntil(lambda: not studio.window.strip.state.text().startswith("READY"), timeout=SLOW)
        if studio.recorder.phase is Phase.RECORDING:
            click(studio.window.strip.record)
        qtbot.waitUntil(lambda: studio.review_page.takes.model.total == 1, timeout=SLOW)
        assert studio.review_page.takes.model.newest()[0].samples > 15 * 40


def test_a_port_that_cannot_be_opened_is_refused_on_the_page(qtbot, tmp_path):
    with running_studio(tmp_path, source="") as studio:
        studio.go_to("connect")
        studio.model.open("serial:/dev/no-such-port")
        qtbot.waitUntil(studio.connect_page.retry.isVisible, timeout=SLOW)
        assert studio.model.source == "" or not studio.model.infos
