"""Keys: one table; what is typed into a field, or worked with, never starts a recording."""

from itertools import combinations

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QComboBox,
    QDoubleSpinBox,
    QLineEdit,
    QListWidget,
    QPlainTextEdit,
    QPushButton,
    QSlider,
    QVBoxLayout,
    QWidget,
)

from studio.ui.keys import CLICKER, TABLE, Keys, conflict, in_words, keys_in_force

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")


class Window(QWidget):
    """One of each kind of control."""

    def __init__(self):
        super().__init__()
        self.button, self.list, self.slider = QPushButton("press"), QListWidget(), QSlider(Qt.Orientation.Horizontal)
        self.line, self.text, self.spin = QLineEdit(), QPlainTextEdit(), QDoubleSpinBox()
        self.combo = QComboBox()
        self.combo.setEditable(True)
        self.list.addItems(["one", "two", "rest"])
        self.slider.setValue(50)
        column = QVBoxLayout(self)
        for part in (self.button, self.list, self.slider, self.line, self.text, self.spin, self.combo):
            column.addWidget(part)
        self.keys = Keys(self)
        self.keys.offer(key.action for key in TABLE)
        self.seen: list[str] = []
        self.keys.triggered.connect(self.seen.append)


@pytest.fixture
def window(qtbot):
    shown = Window()
    qtbot.addWidget(shown)
    with qtbot.waitActive(shown):
        shown.show()
        shown.activateWindow()
    shown.setFocus()
    return shown


def press(qtbot, window, key, modifier=Qt.KeyboardModifier.NoModifier):
    qtbot.keyClick(window.focusWidget() or window, key, modifier)


def test_no_key_means_two_things():
    keys = keys_in_force({}, clicker=True)

    assert [pair for pair in combinations(keys, 2) if set(keys[pair[0]]) & set(keys[pair[1]])] == []


def test_a_key_does_what_the_table_says(qtbot, window):
    press(qtbot, window, Qt.Key.Key_R)
    press(qtbot, window, Qt.Key.Key_4)
    press(qtbot, window, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)

    assert window.seen == ["record", "capture", "frames_back"]


@pytest.mark.parametrize("field", ["line", "text", "spin", "combo"])
def test_no_key_acts_while_something_is_typed(qtbot, window, field):
    getattr(window, field).setFocus()
    for key in (Qt.Key.Key_R, Qt.Key.Key_M, Qt.Key.Key_4, Qt.Key.Key_Space, Qt.Key.Key_Left, Qt.Key.Key_F2):
        press(qtbot, window, key)
    press(qtbot, window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    press(qtbot, window, Qt.Key.Key_E, Qt.KeyboardModifier.ControlModifier)

    assert window.seen == []


def test_what_is_typed_arrives(qtbot, window):
    window.line.setFocus()
    qtbot.keyClicks(window.line, "R4m jk")

    assert window.line.text() == "R4m jk"
    assert window.seen == []


def test_keys_act_again_when_the_field_is_left(qtbot, window):
    window.line.setFocus()
    window.button.setFocus()
    press(qtbot, window, Qt.Key.Key_R)

    assert window.seen == ["record"]


def test_space_presses_the_button_that_has_the_focus(qtbot, window):
    pressed: list[bool] = []
    window.button.clicked.connect(lambda: pressed.append(True))
    window.button.setFocus()
    press(qtbot, window, Qt.Key.Key_Space)

    assert len(pressed) == 1
    assert window.seen == []


def test_arrows_belong_to_the_list_and_the_slider_that_have_the_focus(qtbot, window):
    window.slider.setFocus()
    press(qtbot, window, Qt.Key.Key_Right)
    window.list.setFocus()
    window.list.setCurrentRow(0)
    press(qtbot, window, Qt.Key.Key_End)

    assert window.slider.value() == 51
    assert window.list.currentRow() == 2
    assert window.seen == []


def test_r_records_also_from_a_list(qtbot, window):
    window.list.setFocus()
    press(qtbot, window, Qt.Key.Key_R)

    assert window.seen == ["record"]


def test_a_key_whose_function_does_not_exist_is_neither_bound_nor_listed(qtbot):
    window = QWidget()
    qtbot.addWidget(window)
    keys = Keys(window)
    seen: list[str] = []
    keys.triggered.connect(seen.append)
    keys.offer(["record"])
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    qtbot.keyClick(window, Qt.Key.Key_M)
    qtbot.keyClick(window, Qt.Key.Key_R)

    assert seen == ["record"]
    assert [key.action for key in keys.offered] == ["record"]


def test_changed_keys_replace_those_of_the_table(qtbot, window):
    window.keys.use({"record": ("F9",)}, clicker=False)
    press(qtbot, window, Qt.Key.Key_R)
    press(qtbot, window, Qt.Key.Key_F9)

    assert window.seen == ["record"]


def test_a_clicker_records_when_it_is_wanted(qtbot, window):
    press(qtbot, window, Qt.Key.Key_PageDown)
    assert window.seen == []

    window.keys.use({}, clicker=True)
    press(qtbot, window, Qt.Key.Key_PageDown)
    press(qtbot, window, Qt.Key.Key_B)
    press(qtbot, window, Qt.Key.Key_F5)

    assert window.seen == ["record"] * len(CLICKER)


def test_a_clicker_takes_no_key_from_another_action():
    keys = keys_in_force({"marker": ("B",)}, clicker=True)

    assert keys["marker"] == ("B",)
    assert "B" not in keys["record"]


def test_a_conflict_names_the_other_action():
    keys = keys_in_force({})

    assert conflict("M", "record", keys) == "marker"
    assert conflict("R", "record", keys) == ""
    assert conflict("F9", "record", keys) == ""


def test_keys_are_written_as_the_system_writes_them():
    assert in_words(("R",)) == "R"
    assert " · " in in_words(("F1", "?"))
