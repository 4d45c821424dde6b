"""The list of takes: chosen by click and key, searched, renamed and judged; empty for a reason."""

from typing import Any

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLineEdit

from studio.core.errors import NotATake
from studio.ui.models.take_list_model import SUMMARY
from studio.ui.theme import Theme
from studio.ui.views.take_list import TakeList
from tests.ui.reviewed import summary

LONG = "a very long name that somebody typed while the patient was already walking up and down"


@pytest.fixture
def takes(qtbot):
    view = TakeList(Theme())
    qtbot.addWidget(view)
    view.resize(260, 600)
    view.show()
    return view


@pytest.fixture
def filled(takes):
    takes.model.set_takes([summary(n, name) for n, name in enumerate(["walk", "reach", LONG], 1)])
    return takes


def click(qtbot, view, row):
    place = view.view.visualRect(view.model.index(row)).center()
    qtbot.mouseClick(view.view.viewport(), Qt.MouseButton.LeftButton, pos=place)


def nothing_said(view):
    return view._nothing.text() if view._nothing.isVisible() else ""  # noqa: SLF001 (what is seen)


def test_an_empty_library_says_what_to_do(takes):
    assert "No takes yet. Record one with R" in nothing_said(takes)
    assert not takes.search.isEnabled()
    assert not takes.rename.isEnabled()
    assert not takes.show_all.isVisible()


def test_a_library_that_is_being_read_says_so(takes):
    takes.set_loading(True)
    assert nothing_said(takes) == "Reading the library…"
    takes.set_loading(False)
    assert "No takes yet" in nothing_said(takes)


def test_a_click_chooses_a_take_once(filled, qtbot):
    chosen: list[Any] = []
    filled.take_chosen.connect(chosen.append)
    click(qtbot, filled, 1)
    click(qtbot, filled, 1)

    assert chosen == [summary(2, "reach").folder]


def test_arrow_keys_go_through_the_takes(filled, qtbot):
    chosen: list[Any] = []
    filled.take_chosen.connect(chosen.append)
    click(qtbot, filled, 0)
    qtbot.keyClick(filled.view, Qt.Key.Key_Down)
    qtbot.keyClick(filled.view, Qt.Key.Key_Down)

    assert [folder.name for folder in chosen] == [f"take-003_{LONG}", "take-002_reach", "take-001_walk"]


def test_several_takes_can_be_selected_without_opening_each(filled, qtbot):
    chosen: list[Any] = []
    selected: list[Any] = []
    click(qtbot, filled, 0)
    filled.take_chosen.connect(chosen.append)
    filled.selection_changed.connect(selected.append)
    place = filled.view.visualRect(filled.model.index(2)).center()
    shift = Qt.KeyboardModifier.ShiftModifier
    qtbot.mouseClick(filled.view.viewport(), Qt.MouseButton.LeftButton, shift, place)

    assert chosen == []
    assert len(selected[-1]) == 3
    assert filled.selected() == selected[-1]


def test_choosing_from_outside_asks_for_nothing(filled):
    chosen: list[Any] = []
    filled.take_chosen.connect(chosen.append)
    filled.choose(summary(1, "walk").folder)

    assert chosen == []
    assert filled.selected() == (summary(1, "walk").folder,)
    assert filled.current() == summary(1, "walk")


def test_typing_filters_and_one_button_shows_all_again(filled, qtbot):
    qtbot.keyClicks(filled.search, "reach")
    assert filled.model.rowCount() == 1
    assert filled.count.text() == "1 of 3 takes"
    qtbot.keyClicks(filled.search, "xyz")
    assert nothing_said(filled) == "No take matches “reachxyz”."
    qtbot.mouseClick(filled.show_all, Qt.MouseButton.LeftButton)

    assert filled.model.rowCount() == 3
    assert filled.count.text() == "3 takes"


def test_the_chosen_take_stays_chosen_while_others_come_and_the_filter_changes(filled, qtbot):
    chosen: list[Any] = []
    click(qtbot, filled, 1)
    filled.take_chosen.connect(chosen.append)
    filled.model.put(summary(9, "new"))
    assert filled.selected() == (summary(2, "reach").folder,)
    qtbot.keyClicks(filled.search, "walk")
    filled.search.clear()

    assert filled.selected() == (summary(2, "reach").folder,)
    assert chosen == []


def test_f2_renames_in_place(filled, qtbot):
    asked = []
    filled.rename_requested.connect(lambda folder, name: asked.append((folder.name, name)))
    click(qtbot, filled, 2)
    qtbot.keyClick(filled.view, Qt.Key.Key_F2)
    editor = filled.view.findChild(QLineEdit)
    assert editor.accessibleName() == "New name of the take"
    editor.selectAll()
    qtbot.keyClicks(editor, "slow walk")
    with qtbot.waitSignal(filled.rename_requested):
        qtbot.keyClick(editor, Qt.Key.Key_Return)

    assert asked == [("take-001_walk", "slow walk")]


def test_a_star_is_asked_for_and_taken_back(filled, qtbot):
    asked = []
    filled.verdict_requested.connect(lambda folder, verdict: asked.append(verdict))
    click(qtbot, filled, 0)
    qtbot.mouseClick(filled.star, Qt.MouseButton.LeftButton)
    assert asked == ["star"]
    assert not filled.star.isChecked()

    filled.model.put(summary(3, LONG, verdict="star"))
    assert filled.star.isChecked()
    qtbot.mouseClick(filled.star, Qt.MouseButton.LeftButton)
    qtbot.mouseClick(filled.bad, Qt.MouseButton.LeftButton)
    assert asked == ["star", "none", "bad"]


def test_a_take_that_cannot_be_read_can_be_chosen_but_not_changed(filled, qtbot):
    chosen: list[Any] = []
    filled.model.put(summary(20, "broken", refusal=NotATake("/x")))
    filled.take_chosen.connect(chosen.append)
    click(qtbot, filled, 0)

    assert len(chosen) == 1
    assert not any(button.isEnabled() for button in (filled.rename, filled.star, filled.bad))
    filled.toggle_star()
    filled.begin_rename()
    assert filled.view.findChild(QLineEdit) is None


@pytest.mark.parametrize("scheme", ["dark", "light"])
@pytest.mark.parametrize("scale", [0.8, 2.0])
def test_every_kind_of_row_is_painted_and_rows_grow_with_the_text(qtbot, scheme, scale):
    theme = Theme()
    theme.scheme, theme.text_scale = scheme, scale
    view = TakeList(theme)
    qtbot.addWidget(view)
    kinds: list[dict[str, Any]] = [
        {},
        {"verdict": "star"},
        {"verdict": "bad"},
        {"recovered": True},
        {"refusal": NotATake("/x")},
    ]
    view.model.set_takes([summary(n, LONG, **kind) for n, kind in enumerate(kinds)])
    view.restyle()
    view.resize(220, 700)
    view.show()

    assert not view.grab().isNull()
    row = view.view.visualRect(view.model.index(0)).height()
    assert row >= 2 * theme.pixels("caption") + theme.pixels("body")
    assert row >= 24


def test_five_thousand_takes_have_rows_of_one_height_and_the_last_can_be_reached(takes, qtbot):
    takes.model.set_takes([summary(n % 28, f"take {n}", folder=summary().folder / str(n)) for n in range(5000)])
    click(qtbot, takes, 0)
    qtbot.keyClick(takes.view, Qt.Key.Key_End)

    assert takes.view.uniformItemSizes()
    assert takes.view.currentIndex().row() == 4999
    assert takes.view.currentIndex().data(SUMMARY).name
    assert takes.count.text() == "5,000 takes"
