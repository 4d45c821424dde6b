"""The table of sensors: what each cell says, its states, and that nothing jumps."""

import math
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPersistentModelIndex, Qt
from PySide6.QtTest import QAbstractItemModelTester

from studio.core.body import Place
from studio.core.rest import Rest
from studio.ui.models.rest_watch import RestProgress
from studio.ui.models.sensor_motion import shaken, speed_of
from studio.ui.models.sensor_table import (
    MOVED_ROLE,
    SHARE_ROLE,
    SIDE_ROLE,
    STATE_ROLE,
    Column,
    SensorTableModel,
    State,
)
from tests.ui.sensor_windows import health, info, sensor, window


@pytest.fixture
def model(qtbot):
    model = SensorTableModel()
    tester = QAbstractItemModelTester(model, QAbstractItemModelTester.FailureReportingMode.Fatal, model)
    assert tester.model() is model
    return model


def show(model, *healths, infos=None, places=None, now=100.0):
    numbers = {one.sensor: int(one.sensor[4:], 16) for one in healths}
    known = {one: info(number) for one, number in numbers.items()}
    model.show_sensors({one.sensor: one for one in healths}, known | (infos or {}), places or {}, now)


def cell(model, number, column, role=Qt.ItemDataRole.DisplayRole):
    return model.index(model.row_of(sensor(number)), column).data(role)


def numbers(model):
    return [model.index(row, Column.NUMBER).data() for row in range(model.rowCount())]


def test_sensors_stand_by_their_number():
    model = SensorTableModel()

    show(model, health(7), health(2), health(12))

    assert numbers(model) == ["2", "7", "12"]


def test_sensors_without_a_number_stand_last(model):
    show(model, health(9), health(4), infos={sensor(4): replace(info(4), number=0)})

    assert numbers(model) == ["9", "–"]


def test_a_selection_stays_with_its_sensor_while_others_come_and_go(model):
    show(model, health(3), health(5))
    kept = QPersistentModelIndex(model.index(model.row_of(sensor(5)), Column.NAME))

    show(model, health(1), health(3), health(5))
    show(model, health(1), health(5))

    assert kept.row() == 1
    assert kept.data() == "tag 05"


def test_a_selection_moves_along_when_a_number_is_learnt_late(model):
    show(model, health(3), health(5), infos={sensor(3): replace(info(3), number=0)})
    kept = QPersistentModelIndex(model.index(model.row_of(sensor(3)), Column.NAME))
    before = kept.row()

    show(model, health(3), health(5))

    assert (before, kept.row()) == (1, 0)
    assert kept.data() == "tag 03"


@pytest.mark.parametrize(
    ("silent", "words", "state"),
    [
        (0.1, "now", State.PLAIN),
        (0.7, "▲ 0.7 s ago", State.WARN),
        (2.0, "✖ 2 s ago", State.BAD),
        (150.0, "✖ 2 min ago", State.BAD),
        (math.inf, "✖ never", State.BAD),
    ],
)
def test_a_silent_sensor_turns_amber_then_red(model, silent, words, state):
    show(model, health(1, silent_for=silent))

    assert cell(model, 1, Column.HEARD) == words
    assert cell(model, 1, Column.HEARD, STATE_ROLE) is state


def test_a_slow_sensor_is_marked_once_its_rate_can_be_known(model):
    show(model, health(1, rate=12.1), health(2, rate=45.0), now=100.0)
    young = cell(model, 1, Column.RATE)

    show(model, health(1, rate=12.1), health(2, rate=45.0), now=103.0)

    assert young == "12.1"
    assert cell(model, 1, Column.RATE) == "▲ 12.1"
    assert cell(model, 1, Column.RATE, STATE_ROLE) is State.WARN
    assert cell(model, 2, Column.RATE) == "45.0"


def test_loss_is_that_of_the_last_ten_seconds(model):
    show(model, health(1, received=1000, lost=900), now=100.0)
    show(model, health(1, received=1500, lost=905), now=109.0)
    lately = cell(model, 1, Column.LOSS)

    show(model, health(1, received=1510, lost=995), now=118.0)

    assert lately == "1.0"
    assert cell(model, 1, Column.LOSS) == "▲ 90.0"
    assert "995 of 2505" in cell(model, 1, Column.LOSS, Qt.ItemDataRole.ToolTipRole)


def test_what_is_not_known_is_a_dash(model):
    show(model, health(1))

    for column in (Column.BATTERY, Column.TEMPERATURE, Column.LINK, Column.STILL):
        assert cell(model, 1, column) == "–"


def test_battery_and_signal_warn_by_shape_and_colour(model):
    show(model, health(1, battery=0.08, rssi=-95.0), health(2, battery=0.8, rssi=-50.0))

    assert (cell(model, 1, Column.BATTERY), cell(model, 2, Column.BATTERY)) == ("▲ 8", "80")
    assert cell(model, 1, Column.LINK, STATE_ROLE) is State.WARN
    assert len(cell(model, 1, Column.LINK)) < len(cell(model, 2, Column.LINK))


def test_places_are_named_with_their_side(model):
    model.set_place_words({Place.LEFT_FOREARM: "Left wrist"})

    show(model, health(1), health(2), places={sensor(1): Place.LEFT_FOREARM})

    assert cell(model, 1, Column.PLACE) == "Left wrist"
    assert cell(model, 1, Column.PLACE, SIDE_ROLE) == "left"
    assert cell(model, 2, Column.PLACE) == "not assigned"
    assert cell(model, 2, Column.PLACE, SIDE_ROLE) == ""
    assert model.title_of(sensor(1)) == "1  tag 01  Left wrist"


def test_rest_counts_its_seconds_and_then_says_how_sure_it_is(model):
    show(model, health(1), health(2), health(3))
    measured = Rest(0, 500, np.zeros(3), np.radians([0.004, 0.002, 0.003]))
    states = {
        sensor(1): RestProgress(0.0, None),
        sensor(2): RestProgress(6.0, None),
        sensor(3): RestProgress(10.0, measured),
    }

    model.show_rest(states.__getitem__, lambda one: one != sensor(1))

    assert [cell(model, n, Column.OFFSET) for n in (1, 2, 3)] == ["waits for rest", "6 of 10 s", "✔ ±0.004"]
    assert [cell(model, n, Column.OFFSET, SHARE_ROLE) for n in (1, 2, 3)] == [0.0, 0.6, None]
    assert cell(model, 3, Column.OFFSET, STATE_ROLE) is State.GOOD
    assert [cell(model, n, Column.STILL) for n in (1, 2)] == ["moves", "still"]


def test_names_can_be_changed_where_the_source_lets_them(model):
    asked = []
    model.renamed.connect(lambda one, name: asked.append((one, name)))
    show(model, health(1))
    name = model.index(0, Column.NAME)
    fixed = model.flags(name)

    model.can_rename = True
    assert model.setData(name, "  Anna's wrist ")
    assert not model.setData(name, "   ")

    assert not fixed & Qt.ItemFlag.ItemIsEditable
    assert model.flags(name) & Qt.ItemFlag.ItemIsEditable
    assert asked == [(sensor(1), "Anna's wrist")]
    assert name.data() == "tag 01", "the name stands there once the sensor has it"


def test_a_screen_reader_hears_the_heading_with_each_cell(model):
    show(model, health(1))

    assert cell(model, 1, Column.RATE, Qt.ItemDataRole.AccessibleTextRole) == "Rate Hz: 50.0"


def test_the_tag_that_somebody_shakes_lights_up(model):
    show(model, health(1), health(2))
    windows = {sensor(1): window(5.0, rate=200.0), sensor(2): window(5.0, rate=3.0)}

    model.show_moved(shaken({one: speed_of(w) for one, w in windows.items()}))

    assert cell(model, 1, Column.NAME, MOVED_ROLE)
    assert cell(model, 1, Column.STILL) == "this one"
    assert not cell(model, 2, Column.NAME, MOVED_ROLE)


def test_nobody_is_meant_when_all_move_or_none():
    assert shaken({sensor(1): 200.0, sensor(2): 150.0}) is None
    assert shaken({sensor(1): 5.0, sensor(2): 0.1}) is None
    assert shaken({}) is None


def test_the_offset_of_a_gyroscope_is_no_movement():
    lying = window(5.0)

    assert speed_of(lying._replace(rate=lying.rate + 0.3)) < 0.1
    assert speed_of(replace_nan(lying)) == 0.0


def replace_nan(lying):
    return lying._replace(rate=np.full_like(lying.rate, np.nan))


def test_thirty_sensors_are_kept_apart(model):
    show(model, *(health(n) for n in range(1, 31)), infos={sensor(20): replace(info(20), label="x" * 200)})

    assert model.rowCount() == 30
    assert cell(model, 20, Column.NAME, Qt.ItemDataRole.ToolTipRole).startswith("x" * 200)
