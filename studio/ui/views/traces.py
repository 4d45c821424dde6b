"""Ten seconds of what is captured: the chosen angles in one plot, or every sensor in a plot of its own."""

from collections.abc import Mapping, Sequence

from PySide6.QtCore import Signal as QtSignal
from PySide6.QtWidgets import (
    QButtonGroup,
    QGridLayout,
    QPushButton,
    QScrollArea,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from studio.capture.live_buffer import Window
from studio.core.sample import SensorId
from studio.ui.models.signal_values import Signal
from studio.ui.theme import GAP, GRID, Theme
from studio.ui.views.flow import FlowLayout
from studio.ui.views.plots.angle_plot import AngleCurve, AnglePlot
from studio.ui.views.plots.signal_plot import SignalPlot

COLUMNS = 3
PLOT_HEIGHT = 124  # px at 100 % text


class Traces(QWidget):
    """One row of choices, and the plots below."""

    shown_changed = QtSignal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._plots: dict[SensorId, SignalPlot] = {}
        self._names: dict[SensorId, str] = {}
        self.angles = AnglePlot(theme, self)
        self.kinds = QButtonGroup(self)
        self._signal = Signal.TURNING
        self._stack = QStackedWidget(self)
        self._area = QScrollArea(self)
        self._inside = QWidget(self._area)
        self._grid = QGridLayout(self._inside)
        self._build()
        self.restyle()

    @property
    def shows_sensors(self) -> bool:
        """Whether sensors are shown instead of angles."""
        return self._stack.currentIndex() == 1

    def set_sensors(self, names: Mapping[SensorId, str]) -> None:
        """Have a plot for each of these sensors, in this order."""
        if list(names) != list(self._plots):
            for plot in self._plots.values():
                self._grid.removeWidget(plot)
                plot.deleteLater()
            self._plots = {sensor: SignalPlot(self._theme, self._inside) for sensor in names}
            for row, plot in enumerate(self._plots.values()):
                plot.set_signal(self._signal)
                self._grid.addWidget(plot, row // COLUMNS, row % COLUMNS)
            self._fit()
        self._names = dict(names)
        self._entitle()

    def visible_sensors(self) -> tuple[SensorId, ...]:
        """Return the sensors whose plots can be seen now."""
        return tuple(sensor for sensor, plot in self._plots.items() if plot.is_seen())

    def show_windows(self, windows: Mapping[SensorId, Window], now: float) -> None:
        """Show the newest samples of the visible sensors; ``now`` in s is the right end."""
        for sensor, window in windows.items():
            self._plots[sensor].show_window(window, now)

    def show_angles(self, curves: Sequence[AngleCurve], now: float) -> None:
        """Show the last seconds of the chosen angles."""
        self.angles.show_live(curves, now)

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.angles.restyle()
        for plot in self._plots.values():
            plot.restyle()
        self._fit()

    def _build(self) -> None:
        words = (self.tr("Angles"), self.tr("Turning"), self.tr("Acceleration"), self.tr("Orientation"))
        choices = QWidget(self)
        row = FlowLayout(choices, gap=GRID, line_gap=GRID)
        for number, said in enumerate(words):
            button = QPushButton(said, self)
            button.setCheckable(True)
            button.setProperty("kind", "segment")
            button.setAccessibleName(self.tr("Traces: {what}").format(what=said))
            self.kinds.addButton(button, number)
            row.addWidget(button)
        self.kinds.button(0).setChecked(True)
        self.kinds.idClicked.connect(self._choose)
        self._grid.setContentsMargins(0, 0, 0, 0)
        self._grid.setSpacing(GAP)
        self._area.setWidgetResizable(True)
        self._area.setWidget(self._inside)
        self._area.setAccessibleName(self.tr("Signals of the sensors"))
        self._stack.addWidget(self.angles)
        self._stack.addWidget(self._area)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GAP)
        column.addWidget(choices)
        column.addWidget(self._stack, 1)

    def _choose(self, number: int) -> None:
        self._stack.setCurrentIndex(1 if number else 0)
        if number:
            self._signal = (Signal.TURNING, Signal.FORCE, Signal.ORIENTATION)[number - 1]
            for plot in self._plots.values():
                plot.set_signal(self._signal)
            self._entitle()
        self.shown_changed.emit()

    def _entitle(self) -> None:
        """Write above each plot whose it is: what is plotted stands above all of them."""
        for sensor, name in self._names.items():
            self._plots[sensor].set_sensor(name)
            self._plots[sensor].set_title(name)

    def _fit(self) -> None:
        height = round(PLOT_HEIGHT * max(self._theme.text_scale, 1.0))
        for plot in self._plots.values():
            plot.setMinimumHeight(height)
