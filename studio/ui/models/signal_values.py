"""What a plot shows, as a table: newest value, mean, deviation, least and most of each axis."""

from enum import Enum
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt

from studio.capture.live_buffer import Window
from studio.core import rotation
from studio.core.euler import roll_pitch_yaw

STANDARD_GRAVITY = 9.80665  # m/s², by definition (CGPM 1901)
LEAST_FORCE = 1.0  # m/s²; a mean below it tells nothing of where up is
UP = np.array([0.0, 0.0, 1.0])

Index = QModelIndex | QPersistentModelIndex


class Signal(Enum):
    """What of a sensor is looked at."""

    TURNING = "turning"
    """Gyroscope, °/s."""
    FORCE = "force"
    """Accelerometer, m/s²."""
    FORCE_G = "force_g"
    """Accelerometer in multiples of standard gravity."""
    ORIENTATION = "orientation"
    """Roll, pitch and yaw, °: equation 4 of paper 003."""


UNITS = {Signal.TURNING: "°/s", Signal.FORCE: "m/s²", Signal.FORCE_G: "g", Signal.ORIENTATION: "°"}
DECIMALS = {Signal.TURNING: 2, Signal.FORCE: 3, Signal.FORCE_G: 4, Signal.ORIENTATION: 1}


def values_of(signal: Signal, window: Window) -> NDArray[np.float64]:
    """Return what a plot of ``signal`` shows, (n, 3), in its unit; NaN where the sensor does not send it."""
    if signal is Signal.TURNING:
        return np.asarray(np.degrees(window.rate))
    if signal is Signal.FORCE:
        return window.acceleration
    if signal is Signal.FORCE_G:
        return window.acceleration / STANDARD_GRAVITY
    return np.asarray(np.degrees(roll_pitch_yaw(levelled(window))))


def levelled(window: Window) -> NDArray[np.float64]:
    """Return the orientations (n, 4) with z up.

    A tag counts from the attitude it was switched on in. The mean specific force of the window, turned into that
    frame, points up; the yaw stays the tag's own. A device that knows up by itself is left as it is: the two agree.
    """
    known = np.isfinite(window.orientation).all(axis=1) & np.isfinite(window.acceleration).all(axis=1)
    if not known.any():
        return window.orientation
    up = rotation.rotate(window.orientation[known], window.acceleration[known]).mean(axis=0)
    length = float(np.linalg.norm(up))
    if length < LEAST_FORCE:
        return window.orientation
    axis = np.cross(up / length, UP)
    sine, cosine = float(np.linalg.norm(axis)), float(up[2] / length)
    if sine < 1e-9:  # level already, or upside down about any level axis
        tilt = np.zeros(3) if cosine > 0 else np.array([np.pi, 0.0, 0.0])
    else:
        tilt = axis / sine * np.arctan2(sine, cosine)
    return rotation.multiply(rotation.from_rotation_vector(tilt), window.orientation)


class _Line(NamedTuple):
    name: str
    numbers: tuple[float, ...]


class SignalValues(QAbstractTableModel):
    """Three rows, x y z or roll pitch yaw; readable by a screen reader, which a plot is not."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._signal = Signal.TURNING
        self._rows = self._lines(np.empty((0, 3)))

    def show_window(self, signal: Signal, window: Window) -> None:
        """Take the values of a window."""
        fresh = signal is not self._signal
        self._signal = signal
        self._rows = self._lines(values_of(signal, window))
        if fresh:
            self.headerDataChanged.emit(Qt.Orientation.Horizontal, 0, self.columnCount() - 1)
        self.dataChanged.emit(self.index(0, 0), self.index(2, self.columnCount() - 1))

    def text(self) -> str:
        """Return the table with tabs between its cells, numbers with a dot: for another program."""
        heads = [self.heading(column) for column in range(self.columnCount())]
        lines = [heads, *([row.name, *(self._number(n) for n in row.numbers)] for row in self._rows)]
        return "\n".join("\t".join(line) for line in lines)

    def sentence(self) -> str:
        """Return the newest values as words."""
        unit = UNITS[self._signal]
        return ", ".join(f"{row.name} {self._number(row.numbers[0])} {unit}" for row in self._rows)

    def heading(self, column: int) -> str:
        """Return the words above a column."""
        unit = UNITS[self._signal]
        names = (self.tr("newest"), self.tr("mean"), self.tr("deviation"), self.tr("least"), self.tr("most"))
        return self.tr("axis") if column == 0 else f"{names[column - 1]} {unit}"

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 (Qt's name and default)
        """Return the number of axes."""
        return 0 if parent.isValid() else len(self._rows)

    def columnCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 (Qt's name and default)
        """Return axis, newest, mean, deviation, least, most."""
        return 0 if parent.isValid() else 6

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return a cell."""
        if not index.isValid():
            return None
        row, column = self._rows[index.row()], index.column()
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.AccessibleTextRole):
            return row.name if column == 0 else self._number(row.numbers[column - 1])
        if role == Qt.ItemDataRole.TextAlignmentRole and column:
            return Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter
        return None

    def headerData(  # noqa: N802 (Qt's name)
        self, section: int, orientation: Qt.Orientation, role: int = Qt.ItemDataRole.DisplayRole
    ) -> Any:
        """Return the words above a column, with the unit."""
        if orientation != Qt.Orientation.Horizontal:
            return None
        if role == Qt.ItemDataRole.DisplayRole:
            return self.heading(section)
        if role == Qt.ItemDataRole.TextAlignmentRole:
            side = Qt.AlignmentFlag.AlignRight if section else Qt.AlignmentFlag.AlignLeft
            return side | Qt.AlignmentFlag.AlignVCenter
        return None

    def _lines(self, values: NDArray[np.float64]) -> tuple[_Line, ...]:
        turned = self._signal is Signal.ORIENTATION
        names = (self.tr("roll"), self.tr("pitch"), self.tr("yaw")) if turned else ("x", "y", "z")
        known = values[np.isfinite(values).all(axis=1)]
        if len(known) == 0:
            return tuple(_Line(name, (np.nan,) * 5) for name in names)
        spread = np.unwrap(known, axis=0, period=360.0) if turned else known
        least, most = spread.min(axis=0), spread.max(axis=0)
        table = np.stack([known[-1], spread.mean(axis=0), spread.std(axis=0), least, most], axis=1)
        return tuple(_Line(name, tuple(numbers)) for name, numbers in zip(names, table.tolist(), strict=True))

    def _number(self, value: float) -> str:
        decimals = DECIMALS[self._signal]
        # Adding zero makes nothing of a minus before nothing.
        return f"{round(value, decimals) + 0.0:.{decimals}f}" if np.isfinite(value) else "–"
