"""One sensor from near: its signals as plot or table, and roll, pitch and yaw as large numbers."""

import math

import numpy as np
from PySide6.QtCore import Qt
from PySide6.QtCore import Signal as QtSignal
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import (
    QAbstractItemView,
    QButtonGroup,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QPushButton,
    QSizePolicy,
    QStackedWidget,
    QTableView,
    QVBoxLayout,
    QWidget,
)

from studio.capture.live_buffer import Window
from studio.ui.models.signal_values import Signal, values_of
from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.plots.signal_plot import SignalPlot

TABLE_EVERY = 0.25  # s between two states of the table
SIGNALS = (Signal.TURNING, Signal.FORCE, Signal.FORCE_G, Signal.ORIENTATION)


class SensorPanel(QFrame):
    """Follows the selection of the table."""

    rename_asked = QtSignal()
    blink_asked = QtSignal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._table_at = -math.inf
        self.plot = SignalPlot(theme, self)
        self.signals = QButtonGroup(self)
        self.as_table = QPushButton(self.tr("As table"), self)
        self.copy = QPushButton(self.tr("Copy values"), self)
        self.rename = QPushButton(self.tr("Rename  (F2)"), self)
        self.blink = QPushButton(self.tr("Let it blink"), self)
        self.table = QTableView(self)
        self.angles = [QLabel(self) for _ in range(3)]
        self._title = ElidedLabel(self)
        self._stack = QStackedWidget(self)
        self._build()
        self._connect()
        self.restyle()

    def set_sensor(self, title: str) -> None:
        """Show another sensor."""
        self._title.set_words(title)
        self.plot.set_sensor(title)
        self._show_angles(np.full(3, np.nan))

    def set_title(self, title: str) -> None:
        """Call the sensor otherwise."""
        self._title.set_words(title)

    def offer(self, *, rename: bool, blink: bool) -> None:
        """Show the buttons for what the source can do."""
        self.rename.setVisible(rename)
        self.blink.setVisible(blink)

    def show_window(self, window: Window, now: float) -> None:
        """Show the newest samples of the sensor."""
        self.plot.show_window(window, now)
        if self.table.isVisible() and now - self._table_at >= TABLE_EVERY:
            self._table_at = now
            self.plot.values.show_window(self.plot.signal, window)
        turned = values_of(Signal.ORIENTATION, window)
        self._show_angles(turned[-1] if len(turned) else np.full(3, np.nan))

    def restyle(self) -> None:
        """Take over colours and text size."""
        font = self._theme.font("figure")
        font.setPixelSize(round(self._theme.pixels("figure") * 0.9))
        for angle in self.angles:
            angle.setFont(font)
            angle.setMinimumWidth(QFontMetrics(font).horizontalAdvance("−180.0°"))
        self.table.setFont(self._theme.font("body"))
        self.table.verticalHeader().setDefaultSectionSize(QFontMetrics(self._theme.font("body")).height() + 2 * GAP)
        self.plot.restyle()

    def _build(self) -> None:
        self.setProperty("ground", "panel")
        self._title.setProperty("role", "section")
        self._title.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.table.setModel(self.plot.values)
        self.table.setAccessibleName(self.tr("Values of the last 10 s"))
        self.table.setShowGrid(False)
        self.table.setTabKeyNavigation(False)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.table.verticalHeader().hide()
        self.table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Stretch)
        self.table.horizontalHeader().setHighlightSections(False)
        self._stack.addWidget(self.plot)
        self._stack.addWidget(self.table)
        body = QHBoxLayout()
        body.setSpacing(GAP_WIDE)
        body.addWidget(self._stack, 1)
        body.addLayout(self._build_angles())
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_WIDE, GAP, GAP_WIDE, GAP)
        column.setSpacing(GAP)
        column.addLayout(self._build_head())
        column.addLayout(self._build_choice())
        column.addLayout(body, 1)

    def _build_head(self) -> QHBoxLayout:
        self.rename.setAccessibleName(self.tr("Rename the sensor"))
        self.blink.setAccessibleName(self.tr("Let the sensor blink"))
        head = QHBoxLayout()
        head.setSpacing(GAP)
        head.addWidget(self._title, 1)
        for button in (self.rename, self.blink):
            button.setProperty("kind", "quiet")
            button.hide()
            head.addWidget(button)
        return head

    def _build_choice(self) -> QHBoxLayout:
        words = (self.tr("Gyroscope"), self.tr("Accelerometer"), self.tr("in g"), self.tr("Orientation"))
        names = (
            self.tr("Plot the gyroscope"),
            self.tr("Plot the accelerometer in m/s²"),
            self.tr("Plot the accelerometer in g"),
            self.tr("Plot roll, pitch and yaw"),
        )
        choice = QHBoxLayout()
        choice.setSpacing(GRID)
        for number, (said, name) in enumerate(zip(words, names, strict=True)):
            button = QPushButton(said, self)
            button.setCheckable(True)
            button.setProperty("kind", "segment")
            button.setAccessibleName(name)
            button.setChecked(number == 0)
            self.signals.addButton(button, number)
            choice.addWidget(button)
        choice.addStretch(1)
        self.as_table.setCheckable(True)
        self.as_table.setAccessibleName(self.tr("Show the values as a table instead of the plot"))
        self.copy.setAccessibleName(self.tr("Copy the values of the last 10 s"))
        for button in (self.as_table, self.copy):
            button.setProperty("kind", "quiet")
            choice.addWidget(button)
        return choice

    def _build_angles(self) -> QGridLayout:
        grid = QGridLayout()
        grid.setHorizontalSpacing(GAP_WIDE)
        grid.setVerticalSpacing(0)
        names = (self.tr("Roll"), self.tr("Pitch"), self.tr("Yaw"))
        grid.setRowStretch(0, 1)
        for row, (said, angle) in enumerate(zip(names, self.angles, strict=True)):
            name = QLabel(said, self)
            name.setProperty("role", "muted")
            angle.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            angle.setAccessibleName(said)
            grid.addWidget(name, row + 1, 0, Qt.AlignmentFlag.AlignVCenter)
            grid.addWidget(angle, row + 1, 1)
        grid.setRowStretch(4, 1)
        return grid

    def _connect(self) -> None:
        self.signals.idClicked.connect(self._choose)
        self.as_table.toggled.connect(self._show_table)
        self.copy.clicked.connect(self.plot.copy_values)
        self.rename.clicked.connect(self.rename_asked)
        self.blink.clicked.connect(self.blink_asked)

    def _choose(self, number: int) -> None:
        self.plot.set_signal(SIGNALS[number])
        self._table_at = -math.inf

    def _show_table(self, shown: bool) -> None:
        self._table_at = -math.inf
        self._stack.setCurrentIndex(int(shown))

    def _show_angles(self, degrees: "np.typing.NDArray[np.float64]") -> None:
        for label, value in zip(self.angles, degrees.tolist(), strict=True):
            words = f"{round(value, 1) + 0.0:.1f}°".replace("-", "−") if math.isfinite(value) else "–"
            if words != label.text():
                label.setText(words)
                label.setAccessibleDescription(words)
