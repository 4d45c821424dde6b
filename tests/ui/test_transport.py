"""The transport works the playhead and says in numbers where it is."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QPushButton

from studio.ui.models.playhead import SPEEDS, Playhead
from studio.ui.style_sheet import style_sheet
from studio.ui.theme import Theme
from studio.ui.views.transport import Transport


@pytest.fixture
def head():
    playhead = Playhead()
    playhead.open(42.1, 0.01)
    return playhead


@pytest.fixture
def transport(qtbot, head):
    view = Transport(Theme(), head)
    qtbot.addWidget(view)
    view.resize(900, 120)
    view.show()
    return view


def press(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def test_it_tells_the_time_and_the_frame(transport, head):
    head.seek(7.42)

    assert transport.time.text() == "00:07.42 / 00:42.10"
    assert transport.frame.text() == "frame 743 of 4,211"


def test_play_becomes_pause(transport, head, qtbot):
    assert transport.play.accessibleName() == "Play (Space)"
    press(qtbot, transport.play)
    assert head.is_playing
    assert transport.play.accessibleName() == "Pause (Space)"
    press(qtbot, transport.play)
    assert not head.is_playing


def test_each_step_button_steps_as_far_as_it_says(transport, head, qtbot):
    head.seek(20.0)
    for button, time in [
        (transport.frame_forward, 20.01),
        (transport.frames_forward, 20.11),
        (transport.frames_back, 20.01),
        (transport.frame_back, 20.0),
        (transport.to_end, 42.1),
        (transport.to_start, 0.0),
    ]:
        press(qtbot, button)
        assert head.time == pytest.approx(time), button.accessibleName()


def test_speed_is_chosen_and_shown(transport, head):
    assert transport.speed.currentText() == "1×"
    transport.speed.setCurrentIndex(SPEEDS.index(0.25))
    assert head.speed == 0.25
    head.faster()
    assert transport.speed.currentText() == "0.5×"


def test_loop_is_switched_and_shown(transport, head, qtbot):
    press(qtbot, transport.loop)
    assert head.loops
    head.set_loop(False)
    assert not transport.loop.isChecked()


def test_a_range_is_set_and_forgotten(transport, head, qtbot):
    assert not transport.whole.isEnabled()
    head.seek(4.0)
    press(qtbot, transport.range_in)
    head.seek(6.0)
    press(qtbot, transport.range_out)
    assert (head.begin, head.end) == (4.0, 6.0)
    press(qtbot, transport.whole)
    assert (head.begin, head.end) == (0.0, 42.1)


@pytest.mark.parametrize("scale", [0.8, 1.0, 2.0])
def test_every_control_is_named_and_large_enough(qtbot, head, scale):
    theme = Theme()
    theme.text_scale = scale
    view = Transport(theme, head)
    view.setStyleSheet(style_sheet(theme))
    qtbot.addWidget(view)
    view.show()

    for control in [*view.findChildren(QPushButton), *view.findChildren(QComboBox)]:
        assert control.accessibleName()
        assert control.toolTip()
        assert min(control.sizeHint().width(), control.sizeHint().height()) >= 24
