"""The strip: one word, its facts, and the record button; it never moves while numbers change."""

from dataclasses import replace

import pytest
from PySide6.QtCore import Qt

from studio.ui.models.readiness import Problem, ReadinessState, StripPhase, clock, clock_seconds
from tests.ui.shell_window import shell

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

GOOD = ReadinessState(StripPhase.READY, 15, 15, 240.0, 0.003, 41 * 3600.0, 0.01, "take 004 walk")
PROBLEMS = (
    Problem("Left forearm has not been heard for 4 s.", "Show it", "show_sensor"),
    Problem("The body is not calibrated.", "Calibrate", "calibrate"),
    Problem("Somebody must switch the receiver on.", "", ""),
)
WORDS = {
    StripPhase.READY: "READY",
    StripPhase.CHECK: "CHECK 3 items",
    StripPhase.COUNTDOWN: "STARTS IN 3",
    StripPhase.RECORDING: "REC 00:02.4",
    StripPhase.SAVING: "SAVING…",
    StripPhase.SAVED: "SAVED ✓ verified",
    StripPhase.PROBLEM: "PROBLEM",
}


@pytest.fixture
def shown(qtbot):
    with shell(qtbot) as made:
        made.strip.show_state(GOOD)
        yield made


@pytest.mark.parametrize("phase", StripPhase)
def test_each_phase_has_its_word_and_its_shape(shown, phase):
    shown.strip.show_state(replace(GOOD, phase=phase, elapsed=2.4, problems=PROBLEMS))

    assert shown.strip.state.text() == WORDS[phase]
    assert not shown.strip.state.icon().isNull()
    assert shown.strip.state.property("state") == phase.value


def test_the_facts_are_numbers_with_units(shown):
    strip = shown.strip

    assert strip.sensors.value == "✔ 15/15"
    assert strip.calibrated.value == "✔ 4 min ago"
    assert strip.loss.value == "0.3 %"
    assert strip.disk.value == "41 h"
    assert strip.buffer.value == "1.0 %"
    assert strip.next_take.value == "take 004 walk"
    assert strip.sensors.accessibleName() == "sensors: 15/15"


def test_what_is_amiss_has_a_mark_and_not_only_a_colour(shown):
    shown.strip.show_state(ReadinessState(StripPhase.CHECK, 14, 15, None, 0.12, 500.0, 0.8))
    strip = shown.strip

    values = [strip.sensors.value, strip.calibrated.value, strip.loss.value, strip.disk.value, strip.buffer.value]
    assert values == ["▲ 14/15", "▲ no", "▲ 12.0 %", "▲ 8 min", "▲ 80.0 %"]


def test_what_is_not_known_is_not_invented(shown):
    shown.strip.show_state(ReadinessState(StripPhase.PROBLEM))

    assert (shown.strip.loss.value, shown.strip.disk.value, shown.strip.next_take.value) == ("–", "–", "–")


def test_a_click_on_check_opens_the_list_and_fix_says_what(qtbot, shown):
    asked: list[str] = []
    shown.window.fix_requested.connect(asked.append)
    shown.strip.show_state(replace(GOOD, phase=StripPhase.CHECK, problems=PROBLEMS))
    qtbot.mouseClick(shown.strip.state, Qt.MouseButton.LeftButton)
    listed = shown.strip.problems

    assert listed.isVisible()
    assert [button.text() for button in listed.buttons] == ["Show it", "Calibrate"]
    assert listed.buttons[0].hasFocus()
    qtbot.mouseClick(listed.buttons[1], Qt.MouseButton.LeftButton)
    assert asked == ["calibrate"]
    assert not listed.isVisible()


def test_esc_closes_the_list(qtbot, shown):
    shown.strip.show_state(replace(GOOD, phase=StripPhase.CHECK, problems=PROBLEMS))
    qtbot.mouseClick(shown.strip.state, Qt.MouseButton.LeftButton)
    qtbot.keyClick(shown.window.focusWidget(), Qt.Key.Key_Escape)

    assert not shown.strip.problems.isVisible()


def test_the_list_closes_when_everything_is_mended(qtbot, shown):
    shown.strip.show_state(replace(GOOD, phase=StripPhase.CHECK, problems=PROBLEMS))
    qtbot.mouseClick(shown.strip.state, Qt.MouseButton.LeftButton)
    shown.strip.show_state(GOOD)

    assert not shown.strip.problems.isVisible()


def test_problems_during_a_recording_stand_beside_the_clock(qtbot, shown):
    shown.strip.show_state(replace(GOOD, phase=StripPhase.RECORDING, elapsed=12.4, problems=PROBLEMS[:1]))

    assert shown.strip.state.text() == "REC 00:12.4"
    assert shown.strip.items.isVisible()
    assert shown.strip.items.text() == "1 item"
    qtbot.mouseClick(shown.strip.items, Qt.MouseButton.LeftButton)
    assert shown.strip.problems.isVisible()


@pytest.mark.parametrize("scale", [1.0, 1.5])
def test_the_strip_never_moves_while_numbers_and_phases_change(qtbot, scale):
    with shell(qtbot, text_scale=scale) as made:
        strip = made.window.strip
        places = set()
        for phase in StripPhase:
            for elapsed, loss, disk in ((0.0, 0.0, 200.0), (2.9, 0.111, 88 * 60.0), (59.8, 0.888, 1e6)):
                age = None if elapsed == 0 else elapsed * 60
                strip.show_state(
                    replace(GOOD, phase=phase, elapsed=elapsed, loss=loss, disk_left=disk, calibrated_for=age)
                )
                for widget in (made.window, strip):
                    layout = widget.layout()
                    assert layout is not None
                    layout.activate()
                parts = (strip.state, strip.sensors, strip.loss, strip.disk, strip.buffer, strip.record)
                places.add(tuple((part.x(), part.width()) for part in parts))

        assert len(places) == 1


def test_the_record_button_asks_and_says_what_it_does(qtbot, shown):
    asked: list[bool] = []
    shown.window.record_requested.connect(lambda: asked.append(True))
    qtbot.mouseClick(shown.strip.record, Qt.MouseButton.LeftButton)
    assert asked == [True]
    assert shown.strip.record.accessibleName() == "Record"
    assert shown.strip.record.height() >= 44

    shown.strip.show_state(replace(GOOD, phase=StripPhase.RECORDING))
    assert shown.strip.record.accessibleName() == "Stop"
    shown.strip.show_state(replace(GOOD, phase=StripPhase.SAVING))
    assert not shown.strip.record.isEnabled()


def test_a_long_name_is_cut_in_the_middle_and_whole_in_its_tip(shown):
    name = "take 1004 walking up the long stairs with the left crutch"
    shown.strip.show_state(replace(GOOD, next_take=name))

    assert shown.strip.next_take.toolTip() == name
    assert shown.strip.next_take.width() <= 160


@pytest.mark.parametrize(
    ("seconds", "shown_as"), [(0.0, "00:00.0"), (12.44, "00:12.4"), (59.99, "00:59.9"), (3725.5, "1:02:05.5")]
)
def test_the_clock_counts_tenths_and_never_ahead(seconds, shown_as):
    assert clock(seconds) == shown_as
    assert clock_seconds(seconds) == shown_as.partition(".")[0]
