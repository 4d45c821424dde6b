"""The rows of the library: newest first, found by words, judged by people."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtTest import QAbstractItemModelTester

from studio.core.errors import NotATake
from studio.ui.models.take_list_model import SUMMARY, TakeListModel, length
from tests.ui.reviewed import summary


@pytest.fixture
def model(qtbot):
    model = TakeListModel()
    tester = QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Fatal, model)
    assert tester is not None
    model.set_takes([summary(number, name) for number, name in enumerate(["walk", "reach left", "sit to stand"], 1)])
    return model


def names(model):
    return [model.index(row).data() for row in range(model.rowCount())]


def test_the_newest_take_is_on_top(model):
    assert names(model) == ["sit to stand", "reach left", "walk"]


def test_a_new_take_takes_its_place(model):
    model.put(summary(9, "turn"))
    model.put(summary(0, "first"))

    assert names(model) == ["turn", "sit to stand", "reach left", "walk", "first"]


@pytest.mark.parametrize(
    ("words", "found"),
    [
        ("REACH", ["reach left"]),
        ("left p014", ["reach left"]),
        ("11-02", ["walk"]),
        ("2026-11-02", ["walk"]),
        ("x", []),
    ],
)
def test_takes_are_found_by_all_words_in_any_letters(model, words, found):
    model.set_takes([summary(1, "walk"), summary(2, "reach left")])
    model.set_filter(words)

    assert names(model) == found


def test_starred_takes_alone(model):
    model.put(summary(1, "walk", verdict="star"))
    model.set_starred_only(True)
    assert names(model) == ["walk"]

    model.put(summary(1, "walk"))
    assert names(model) == []
    assert model.total == 3
    assert model.is_filtered

    model.put(summary(2, "reach left", verdict="star"))
    assert names(model) == ["reach left"]


def test_a_name_is_asked_for_and_not_changed_by_itself(model, qtbot):
    asked = []
    model.rename_asked.connect(lambda take, name: asked.append((take.name, name)))

    assert model.setData(model.index(0), "  stand \n up ")
    assert not model.setData(model.index(0), "   ")
    assert not model.setData(model.index(0), "sit to stand")
    assert asked == [("sit to stand", "stand up")]
    assert names(model)[0] == "sit to stand"


def test_a_take_that_cannot_be_read_is_not_renamed(model):
    broken = summary(20, "broken", refusal=NotATake("/x"))
    model.put(broken)

    assert not model.index(0).flags() & Qt.ItemFlag.ItemIsEditable
    assert model.index(0).data(Qt.ItemDataRole.AccessibleTextRole) == "broken, cannot be read"
    assert model.index(0).data(SUMMARY) is broken


def test_a_row_is_read_out_whole(model):
    model.put(summary(1, "walk", verdict="star", recovered=True, lost=0.0))
    said = model.index(2).data(Qt.ItemDataRole.AccessibleTextRole)

    assert said.startswith("walk, 0:06, 0 % lost, ")
    assert said.endswith("P014, starred, recovered")


@pytest.mark.parametrize(
    ("lost", "said"), [(0.0, "0 % lost"), (0.0004, "under 0.1 % lost"), (0.0526, "5.3 % lost"), (float("nan"), "")]
)
def test_loss_is_said_as_exactly_as_it_matters(model, lost, said):
    assert model.loss(summary(1, lost=lost)) == said


def test_a_recording_that_does_not_tell_its_time_shows_its_session(model):
    assert model.when(summary(1, started="")) == summary(1).session


@pytest.mark.parametrize(("seconds", "said"), [(0.4, "0:00"), (42.2, "0:42"), (724, "12:04"), (3727, "1:02:07")])
def test_lengths(seconds, said):
    assert length(seconds) == said
