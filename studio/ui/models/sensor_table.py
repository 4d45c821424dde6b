"""The sensors as a table: how each is heard, and how its rest measurement goes."""

import math
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from typing import Any

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt, Signal

from studio.acquisition.health import HealthSnapshot
from studio.core.body import Place
from studio.core.sample import SensorId, SensorInfo
from studio.ui.models.rest_watch import NEEDED, RestProgress

SLOW = 0.8  # of the nominal rate
SETTLED = 2.0  # s over which the rate is counted: a younger sensor is not called slow
QUIET, SILENT = 0.5, 2.0  # s without a packet: amber, red
LOW_BATTERY = 0.2
LOSS_WINDOW = 10.0  # s
MUCH_LOST = 0.05  # share of the frames of the last ten seconds
STRENGTHS = (-90.0, -75.0, -60.0)  # dBm: one, two, three bars and more
BARS = ("▂", "▂▄", "▂▄▆", "▂▄▆█")

NOTHING_YET = RestProgress(0.0, None)

Index = QModelIndex | QPersistentModelIndex


class Column(IntEnum):
    """In their order on the screen."""

    NUMBER = 0
    NAME = 1
    PLACE = 2
    RATE = 3
    LOSS = 4
    BATTERY = 5
    TEMPERATURE = 6
    STILL = 7
    HEARD = 8
    LINK = 9
    OFFSET = 10


class State(IntEnum):
    """How a cell is meant; words or a shape say the same."""

    PLAIN = 0
    MUTED = 1
    GOOD = 2
    WARN = 3
    BAD = 4


STATE_ROLE = Qt.ItemDataRole.UserRole + 1
"""State of a cell."""
SIDE_ROLE = Qt.ItemDataRole.UserRole + 2
"""``left``, ``right`` or empty, of the place."""
SHARE_ROLE = Qt.ItemDataRole.UserRole + 3
"""How much of the rest was measured, 0…1, while it is; else None."""
MOVED_ROLE = Qt.ItemDataRole.UserRole + 4
"""Whether this sensor is the one somebody moves."""
SENSOR_ROLE = Qt.ItemDataRole.UserRole + 5
"""The SensorId."""

NUMBERS = frozenset({Column.NUMBER, Column.RATE, Column.LOSS, Column.BATTERY, Column.TEMPERATURE, Column.HEARD})


@dataclass
class _Row:
    sensor: SensorId
    info: SensorInfo
    health: HealthSnapshot
    place: Place | None = None
    rest: RestProgress = NOTHING_YET
    is_still: bool | None = None
    counts: deque[tuple[float, int, int]] = field(default_factory=deque)
    """Time, samples received and lost until then."""

    @property
    def order(self) -> tuple[bool, int, str, str]:
        return (self.info.number == 0, self.info.number, self.info.label, self.sensor)

    def loss(self) -> float:
        """Return the share of frames lost lately; NaN before any came."""
        received = self.health.received - (self.counts[0][1] if self.counts else 0)
        lost = self.health.lost - (self.counts[0][2] if self.counts else 0)
        return lost / (lost + received) if lost + received > 0 else math.nan


class SensorTableModel(QAbstractTableModel):
    """Rows by number; updated in place, so that a selection stays where it is."""

    renamed = Signal(str, str)
    """A sensor and its new name."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.can_rename = False
        self.is_worn = False
        """Whether the body is calibrated: nobody waits for the tags to lie still."""
        self._rows: list[_Row] = []
        self._place_words: dict[Place, str] = {place: place.value.replace("_", " ") for place in Place}
        self._moved: SensorId | None = None
        self._texts: dict[Column, Callable[[_Row], tuple[str, State]]] = {
            Column.NUMBER: self._number,
            Column.NAME: self._name,
            Column.PLACE: self._place,
            Column.RATE: self._rate,
            Column.LOSS: self._loss,
            Column.BATTERY: self._battery,
            Column.TEMPERATURE: self._temperature,
            Column.STILL: self._still,
            Column.HEARD: self._heard,
            Column.LINK: self._link,
            Column.OFFSET: self._offset,
        }

    def set_place_words(self, words: Mapping[Place, str]) -> None:
        """Use these names of places."""
        self._place_words.update(words)
        self._tell_all()

    def show_sensors(
        self,
        health: Mapping[SensorId, HealthSnapshot],
        infos: Mapping[SensorId, SensorInfo],
        places: Mapping[SensorId, Place],
        now: float,
    ) -> None:
        """Take the newest counts of all sensors; those that are not among them leave the table."""
        shown = {sensor for sensor in health if sensor in infos}
        for at in reversed(range(len(self._rows))):
            if self._rows[at].sensor not in shown:
                self.beginRemoveRows(QModelIndex(), at, at)
                del self._rows[at]
                self.endRemoveRows()
        known = {row.sensor: row for row in self._rows}
        for sensor in sorted(shown, key=lambda one: (infos[one].number or math.inf, infos[one].label, one)):
            row = known.get(sensor) or self._insert(_Row(sensor, infos[sensor], health[sensor]))
            row.info, row.health, row.place = infos[sensor], health[sensor], places.get(sensor)
            row.counts.append((now, row.health.received, row.health.lost))
            while row.counts[0][0] < now - LOSS_WINDOW:
                row.counts.popleft()
        self._sort()
        self._tell_all()

    def show_rest(self, progress: Callable[[SensorId], RestProgress], still: Callable[[SensorId], bool | None]) -> None:
        """Take how far each sensor's rest is."""
        for row in self._rows:
            row.rest, row.is_still = progress(row.sensor), still(row.sensor)
        self._tell_all()

    def show_moved(self, sensor: SensorId | None) -> None:
        """Light up the sensor that somebody moves."""
        if sensor != self._moved:
            self._moved = sensor
            self._tell_all()

    def sensor_at(self, row: int) -> SensorId:
        """Return the sensor of a row."""
        return self._rows[row].sensor

    def row_of(self, sensor: SensorId) -> int:
        """Return the row of a sensor, -1 when it is not there."""
        return next((row for row, known in enumerate(self._rows) if known.sensor == sensor), -1)

    def title_of(self, sensor: SensorId) -> str:
        """Return number, name and place of a sensor as one line."""
        row = self._rows[self.row_of(sensor)]
        place = "" if row.place is None else self._place_words[row.place]
        parts = (self._number(row)[0] if row.info.number else "", self._name(row)[0], place)
        return "  ".join(part for part in parts if part)

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 (Qt's name and default)
        """Return the number of sensors."""
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 (Qt's name and default)
        """Return the number of columns."""
        return 0 if parent.isValid() else len(Column)

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Names can be edited where the source lets them be."""
        if not index.isValid():
            return Qt.ItemFlag.NoItemFlags
        flags = Qt.ItemFlag.ItemIsSelectable | Qt.ItemFlag.ItemIsEnabled
        if self.can_rename and index.column() == Column.NAME:
            flags |= Qt.ItemFlag.ItemIsEditable
        return flags

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return a cell."""
        if not index.isValid():
            return None
        row, column = self._rows[index.row()], Column(index.column())
        if role == Qt.ItemDataRole.DisplayRole:
            return self._texts[column](row)[0]
        if role == Qt.ItemDataRole.EditRole:
            return row.info.label if column is Column.NAME else None
        if role == Qt.ItemDataRole.TextAlignmentRole:
            side = Qt.AlignmentFlag.AlignRight if column in NUMBERS else Qt.AlignmentFlag.AlignLeft
            return side | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._tip(row, column)
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return f"{self.headerData(column, Qt.Orientation.Horizontal)}: {self._texts[column](row)[0]}"
        return self._painted(row, column, role)

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:  # noqa: N802 (Qt's name)
        """Ask for another name; it stands in the table once the sensor has it."""
        name = str(value).strip()
        if role != Qt.ItemDataRole.EditRole or not name or name == self._rows[index.row()].info.label:
            return False
        self.renamed.emit(self._rows[index.row()].sensor, name)
        return True

    def headerData(  # noqa: N802 (Qt's name)
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Return the words above a column, with the unit."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        column = Column(section)
        if role == Qt.ItemDataRole.DisplayRole:
            return self._heading(column)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            side = Qt.AlignmentFlag.AlignRight if column in NUMBERS else Qt.AlignmentFlag.AlignLeft
            return side | Qt.AlignmentFlag.AlignVCenter
        if role == Qt.ItemDataRole.ToolTipRole:
            return self._explained(column)
        return None

    def _insert(self, fresh: _Row) -> _Row:
        at = sum(row.order < fresh.order for row in self._rows)
        self.beginInsertRows(QModelIndex(), at, at)
        self._rows.insert(at, fresh)
        self.endInsertRows()
        return fresh

    def _sort(self) -> None:
        """Put the rows in order when a sensor told its number late; selections move along."""
        wanted = sorted(self._rows, key=_order)
        if wanted == self._rows:
            return
        self.layoutAboutToBeChanged.emit()
        before = self.persistentIndexList()
        place = {row.sensor: at for at, row in enumerate(wanted)}
        after = [self.index(place[self._rows[index.row()].sensor], index.column()) for index in before]
        self._rows = wanted
        self.changePersistentIndexList(before, after)
        self.layoutChanged.emit()

    def _tell_all(self) -> None:
        if self._rows:
            self.dataChanged.emit(self.index(0, 0), self.index(len(self._rows) - 1, len(Column) - 1))

    def _painted(self, row: _Row, column: Column, role: int) -> Any:
        if role == STATE_ROLE:
            return self._texts[column](row)[1]
        if role == SIDE_ROLE:
            side = row.place.value.partition("_")[0] if column is Column.PLACE and row.place is not None else ""
            return side if side in ("left", "right") else ""
        if role == SHARE_ROLE:
            return row.rest.share if column is Column.OFFSET and row.rest.rest is None else None
        if role == MOVED_ROLE:
            return row.sensor == self._moved
        return row.sensor if role == SENSOR_ROLE else None

    def _heading(self, column: Column) -> str:
        return {
            Column.NUMBER: self.tr("No."),
            Column.NAME: self.tr("Name"),
            Column.PLACE: self.tr("Place"),
            Column.RATE: self.tr("Rate Hz"),
            Column.LOSS: self.tr("Lost %"),
            Column.BATTERY: self.tr("Battery %"),
            Column.TEMPERATURE: self.tr("Temp. °C"),
            Column.STILL: self.tr("Still"),
            Column.HEARD: self.tr("Heard"),
            Column.LINK: self.tr("Signal"),
            Column.OFFSET: self.tr("Offset °/s"),
        }[column]

    def _explained(self, column: Column) -> str:
        return {
            Column.NUMBER: self.tr("The number on the tag"),
            Column.NAME: self.tr("What the tag is called"),
            Column.PLACE: self.tr("Where it is worn"),
            Column.RATE: self.tr("Samples that arrive each second; ▲ less than it should send"),
            Column.LOSS: self.tr("Samples lost in the last 10 s"),
            Column.BATTERY: self.tr("Charge of the tag's battery"),
            Column.TEMPERATURE: self.tr("Temperature of the sensor"),
            Column.STILL: self.tr("Lies as still as on a table"),
            Column.HEARD: self.tr("Time since the last packet"),
            Column.LINK: self.tr("Strength of the radio signal"),
            Column.OFFSET: self.tr("What the gyroscope says at rest is measured within 10 s; here: how sure it is"),
        }[column]

    def _tip(self, row: _Row, column: Column) -> str:
        if column is Column.NAME:
            return f"{row.info.label or row.sensor}\n{row.sensor}"
        if column is Column.PLACE:
            return self._place(row)[0]
        if column is Column.LOSS:
            said = self.tr("{lost} of {all} samples lost since it was switched on, {bad} packets unreadable")
            return said.format(
                lost=row.health.lost, all=row.health.lost + row.health.received, bad=row.health.malformed
            )
        if column is Column.LINK and math.isfinite(row.health.rssi):
            return f"{row.health.rssi:.0f} dBm"
        return self._explained(column)

    def _number(self, row: _Row) -> tuple[str, State]:
        return (str(row.info.number), State.PLAIN) if row.info.number else ("–", State.MUTED)

    def _name(self, row: _Row) -> tuple[str, State]:
        return row.info.label or row.sensor, State.PLAIN

    def _place(self, row: _Row) -> tuple[str, State]:
        return (
            (self.tr("not assigned"), State.MUTED)
            if row.place is None
            else (
                self._place_words[row.place],
                State.PLAIN,
            )
        )

    def _rate(self, row: _Row) -> tuple[str, State]:
        rate = row.health.rate
        young = not row.counts or row.counts[-1][0] - row.counts[0][0] < SETTLED
        if row.health.silent_for < QUIET and not young and rate < SLOW / row.info.frame_s:
            return self.tr("▲ {n:.1f}").format(n=rate), State.WARN
        return f"{rate:.1f}", State.PLAIN if rate > 0 else State.MUTED

    def _loss(self, row: _Row) -> tuple[str, State]:
        loss = row.loss()
        if math.isnan(loss):
            return "–", State.MUTED
        return (f"▲ {loss * 100:.1f}", State.WARN) if loss > MUCH_LOST else (f"{loss * 100:.1f}", State.PLAIN)

    def _battery(self, row: _Row) -> tuple[str, State]:
        battery = row.health.battery
        if math.isnan(battery):
            return "–", State.MUTED
        words = f"{battery * 100:.0f}"
        return (f"▲ {words}", State.WARN) if battery < LOW_BATTERY else (words, State.PLAIN)

    def _temperature(self, row: _Row) -> tuple[str, State]:
        warmth = row.health.temperature
        return ("–", State.MUTED) if math.isnan(warmth) else (f"{warmth:.0f}", State.PLAIN)

    def _still(self, row: _Row) -> tuple[str, State]:
        if row.sensor == self._moved:
            return self.tr("this one"), State.PLAIN
        if row.is_still is None or row.health.silent_for >= QUIET:
            return "–", State.MUTED
        return (self.tr("still"), State.PLAIN) if row.is_still else (self.tr("moves"), State.MUTED)

    def _heard(self, row: _Row) -> tuple[str, State]:
        silent = row.health.silent_for
        if silent < QUIET:
            return self.tr("now"), State.PLAIN
        if silent < SILENT:
            return self.tr("▲ {n:.1f} s ago").format(n=silent), State.WARN
        if math.isinf(silent):
            return self.tr("✖ never"), State.BAD
        if silent < 60:
            return self.tr("✖ {n:.0f} s ago").format(n=silent), State.BAD
        return self.tr("✖ {n:.0f} min ago").format(n=silent // 60), State.BAD

    def _link(self, row: _Row) -> tuple[str, State]:
        strength = row.health.rssi
        if math.isnan(strength):
            return "–", State.MUTED
        bars = sum(strength >= limit for limit in STRENGTHS)
        return BARS[bars], State.WARN if bars == 0 else State.PLAIN

    def _offset(self, row: _Row) -> tuple[str, State]:
        if row.rest.rest is not None:
            sigma = math.degrees(float(row.rest.rest.sigma.max()))
            return self.tr("✔ ±{n:.3f}").format(n=sigma), State.GOOD
        if not row.info.has_rate:
            return "–", State.MUTED
        if row.rest.held <= 0:
            return ("–" if self.is_worn else self.tr("waits for rest")), State.MUTED
        return self.tr("{n:.0f} of {all:.0f} s").format(n=row.rest.held, all=NEEDED), State.PLAIN


def _order(row: _Row) -> tuple[bool, int, str, str]:
    return row.order
