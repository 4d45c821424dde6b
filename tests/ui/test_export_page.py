"""Export: takes, a format, a place, and a file that was checked."""

from pathlib import Path

import pytest
from PySide6.QtCore import Qt
from PySide6.QtGui import QGuiApplication
from PySide6.QtWidgets import QAbstractButton, QComboBox, QLabel, QLineEdit, QPushButton, QWidget

from studio.core.errors import CannotWrite
from studio.export.bvh import RATES
from studio.ui.models.export_choice import ExportChoice
from studio.ui.style_sheet import style_sheet
from studio.ui.theme import Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.export_page import ExportPage
from tests.ui.reviewed import summary

pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

EXPORTS = Path("/data/exports")
LONG = "a very long name that somebody typed while the patient was already walking up and down"


@pytest.fixture
def theme():
    return Theme()


@pytest.fixture
def there():
    """The files that are there already."""
    return set()


@pytest.fixture
def page(qtbot, theme, there):
    choice = ExportChoice(there.__contains__)
    choice.set_folder(EXPORTS)
    made = ExportPage(theme, choice)
    qtbot.addWidget(made)
    made.setStyleSheet(style_sheet(theme))
    made.restyle()
    made.resize(1184, 720)
    made.show()
    choice.set_takes([summary(1)])
    return made


def press(qtbot, button):
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)


def texts(page):
    return [label.text() for label in page.findChildren(QLabel) if label.isVisible() and label.text()]


def test_without_a_take_nothing_can_be_exported(page, qtbot):
    page.choice.set_takes([])

    assert not page.start.isEnabled()
    assert "None yet. Choose one or several in Review." in texts(page)
    with qtbot.waitSignal(page.takes_requested):
        press(qtbot, page.takes.add)


def test_a_card_is_chosen_and_brings_its_options(page, qtbot):
    assert page.rate.isVisible()
    assert not page.excel.isVisible()
    press(qtbot, page.cards["joints"])

    assert page.choice.format.key == "joints"
    assert page.cards["joints"].isChecked()
    assert not page.cards["blender"].isChecked()
    assert page.excel.isVisible()
    assert not page.rate.isVisible()
    assert page.name.text().endswith("_joints.csv")


def test_cards_are_chosen_by_keys(page, qtbot):
    page.cards["blender"].setFocus()
    qtbot.keyClick(page.cards["motionbuilder"], Qt.Key.Key_Space)

    assert page.choice.format.key == "motionbuilder"


def test_every_rate_is_on_offer_and_that_of_the_recording(page):
    assert page.rate.currentData() == 60
    assert [page.rate.itemData(row) for row in range(page.rate.count())] == [0, *RATES]
    page.rate.setCurrentIndex(0)
    assert page.choice.rate is None


def test_the_estimate_follows_the_choice(page):
    assert any(text.startswith("359 frames, about 25") for text in texts(page))
    page.rate.setCurrentIndex(page.rate.findData(30))
    assert any(text.startswith("180 frames, about 1") for text in texts(page))
    page.choice.set_format("raw")
    assert "4,500 rows, about 936 kB: the whole take, also what came before R" in texts(page)
    page.choice.set_takes([summary(1), summary(2)])
    assert any(text.startswith("2 files from 0:12: 9,000 rows, about 1.9 MB") for text in texts(page))


def test_export_is_asked_for_with_all_that_was_chosen(page, qtbot):
    press(qtbot, page.cards["joints"])
    page.excel.click()
    page.name.selectAll()
    qtbot.keyClicks(page.name, "knee")
    with qtbot.waitSignal(page.export_requested) as asked:
        press(qtbot, page.start)
    (order,) = asked.args

    assert (order.exporter, order.wish.preset) == ("joints", "excel")
    assert [(item.take, item.target) for item in order.items] == [(summary(1).folder, EXPORTS / "knee.csv")]


def test_a_file_that_will_be_replaced_is_named(page, qtbot, there):
    there.add(EXPORTS / "knee.bvh")
    page.name.selectAll()
    qtbot.keyClicks(page.name, "knee")
    qtbot.keyClick(page.name, Qt.Key.Key_Return)

    assert "▲ knee.bvh is there already and will be replaced." in texts(page)
    page.name.clear()
    qtbot.keyClick(page.name, Qt.Key.Key_Return)
    assert page.name.text() == "P014_2026-11-02a_take-001_walk.bvh"
    assert not any("replaced" in text for text in texts(page))


def test_several_takes_are_named_after_themselves(page, qtbot):
    page.choice.set_takes([summary(n, LONG) for n in range(1, 4)])

    assert not page.name.isVisible()
    assert page.start.text() == "Export 3 takes"
    assert any("and 2 more, named after their takes" in text for text in texts(page))


def test_a_take_is_left_out_by_its_cross(page, qtbot):
    page.choice.set_takes([summary(1), summary(2, "reach")])
    crosses = page.takes.findChildren(QPushButton)
    press(qtbot, next(cross for cross in crosses if cross.accessibleName() == "Do not export reach"))

    assert [take.name for take in page.choice.takes] == ["walk"]


def test_another_folder_is_a_wish(page, qtbot):
    with qtbot.waitSignal(page.folder_requested):
        press(qtbot, page.choose_folder)
    page.choice.set_folder(Path("/elsewhere"))

    assert page.folder.text() == "/elsewhere"


def test_while_it_writes_nothing_can_be_changed(page):
    page.show_progress("solve", 0.5, 2, 3)

    assert page.result.text() == "File 2 of 3. Computing the motion…"
    assert not page.start.isEnabled()
    assert not any(card.isEnabled() for card in page.cards.values())
    page.choice.set_takes([summary(2)])
    assert not page.start.isEnabled()


def test_done_says_that_it_was_checked_and_where_it_is(page, qtbot):
    target = EXPORTS / "walk.bvh"
    page.show_progress("write", 1.0)
    page.show_done([target], ["Nobody entered a stature: 1.75 m is assumed for all lengths."])

    assert page.result.text().startswith("✔ Done, checked. The file was read again")
    assert "1.75 m is assumed" in page.result.text()
    assert str(target) in texts(page)
    assert page.start.isEnabled()
    with qtbot.waitSignal(page.show_requested) as asked:
        press(qtbot, page.result.show_file)
    assert asked.args == [target]
    press(qtbot, page.result.copy)
    assert QGuiApplication.clipboard().text() == str(target)
    assert page.result.copy.text() == "Copied"


def test_a_refusal_is_a_sentence_and_it_can_be_tried_again(page):
    page.show_progress("write", 0.2)
    page.show_refusal(CannotWrite("/data/exports/walk.bvh", "permission denied"))

    assert page.result.text().startswith("▲ /data/exports/walk.bvh cannot be written. The reason: permission denied.")
    assert page.start.isEnabled()
    assert not page.result.show_file.isVisible()


def test_another_format_clears_what_was_said_of_the_last(page, qtbot):
    page.show_done([EXPORTS / "walk.bvh"])
    press(qtbot, page.cards["raw"])

    assert not page.result.isVisible()


@pytest.mark.parametrize("scale", [0.8, 1.0, 1.5, 2.0])
def test_every_control_has_a_name_and_no_text_is_cut(page, theme, scale, qtbot):
    theme.text_scale = scale
    page.setStyleSheet(style_sheet(theme))
    page.restyle()
    page.choice.set_takes([summary(1, LONG)])
    page.show_done([EXPORTS / "walk.bvh"], ["Nobody entered a stature: 1.75 m is assumed for all lengths."])
    qtbot.wait(50)

    for child in page.findChildren(QWidget):
        if isinstance(child, (QAbstractButton, QComboBox, QLineEdit)) and child.isVisible():
            assert child.accessibleName(), child
        if isinstance(child, QLabel) and not isinstance(child, ElidedLabel) and child.isVisible() and child.text():
            needed = child.heightForWidth(child.width()) if child.wordWrap() else child.sizeHint().height()
            assert child.height() >= needed, child.text()


def test_all_cards_have_one_size(page):
    assert len({(card.width(), card.height()) for card in page.cards.values()}) == 1


def test_it_fits_the_smallest_window(page):
    assert page.minimumSizeHint().width() <= 960
    assert page.minimumSizeHint().height() <= 600
