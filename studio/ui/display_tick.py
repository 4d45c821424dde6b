"""The one timer of the window: sixty times a second everything that shows something looks at what there is."""

import time

from PySide6.QtCore import QObject, Qt, QTimer, Signal

PERIOD = 16  # ms


class DisplayTick(QObject):
    """Tells the time to whoever is connected."""

    ticked = Signal(float)
    """s, ``time.perf_counter``: the clock of the samples."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._timer = QTimer(self)
        self._timer.setTimerType(Qt.TimerType.PreciseTimer)
        self._timer.setInterval(PERIOD)
        self._timer.timeout.connect(self._tell)

    def start(self) -> None:
        """Begin."""
        self._timer.start()

    def stop(self) -> None:
        """End."""
        self._timer.stop()

    def _tell(self) -> None:
        self.ticked.emit(time.perf_counter())
