"""Diagnostics: versions, what runs, counts of every sensor, and the last events."""

import math
import platform
import time
from collections import deque
from collections.abc import Mapping
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version

from PySide6.QtCore import QObject, qVersion
from PySide6.QtGui import QGuiApplication

import studio
from studio.storage.crash_report import crash_folder
from studio.ui.models.studio_model import StudioModel
from studio.ui.presenters.folders import show_folder
from studio.ui.views.diagnostics_page import DiagnosticsPage

EVERY = 1.0  # s
EVENTS = 200
PACKAGES = ("PySide6-Essentials", "pyqtgraph", "numpy", "vqf", "pyserial", "mcap")


class DiagnosticsPresenter(QObject):
    """Shows what would be sent along, once a second while the page is looked at."""

    def __init__(self, model: StudioModel, page: DiagnosticsPage) -> None:
        super().__init__(page)
        self._model, self._page = model, page
        self._at = -math.inf
        self._events: deque[tuple[str, str]] = deque(maxlen=EVENTS)
        self._versions = _versions()
        page.crash_folder_requested.connect(self._on_folder)
        model.noted.connect(self._on_noted)

    def note(self, what: str) -> None:
        """Keep something that happened, for the list of events."""
        self._events.append((datetime.now(UTC).isoformat(timespec="milliseconds"), what))

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass."""
        if shown and now - self._at >= EVERY:
            self._at = now
            self._page.show_rows(self._rows())

    def _rows(self) -> list[tuple[str, str]]:
        model = self._model
        rows = [*self._versions, (self.tr("Running"), ""), (self.tr("source"), model.source or self.tr("none"))]
        rows.append((self.tr("queue to the disk"), f"{100 * model.queue_fill:.0f} %"))
        rows.append((self.tr("body calibrated"), model.aligned_at.isoformat() if model.aligned_at else self.tr("no")))
        rows.append((self.tr("Sensors"), ""))
        words = self.tr(
            "{rate:.1f} Hz · received {received} · lost {lost} · malformed {malformed} · duplicates {duplicates} · "
            "late {late} · reboots {reboots} · silent for {silent:.1f} s"
        )
        for sensor, told in sorted(model.health.items()):
            facts = words.format(
                rate=told.rate, received=told.received, lost=told.lost, malformed=told.malformed,
                duplicates=told.duplicates, late=told.late, reboots=told.reboots, silent=told.silent_for,
            )  # fmt: skip
            rows.append((str(sensor), facts))
        rows.append((self.tr("Last events, newest first"), ""))
        rows.extend(reversed(self._events))
        return rows

    def _on_noted(self, kind: str, facts: Mapping[str, object]) -> None:
        self.note(f"{kind} {', '.join(f'{name}={value}' for name, value in facts.items())}".strip())

    def _on_folder(self) -> None:
        crash_folder().mkdir(parents=True, exist_ok=True)
        show_folder(crash_folder())


def _versions() -> list[tuple[str, str]]:
    clock = time.get_clock_info("perf_counter")
    screen = QGuiApplication.primaryScreen()
    rows = [
        ("Versions", ""),
        ("Kinetag Studio", studio.__version__),
        ("Python", f"{platform.python_version()} ({platform.machine()})"),
        ("System", f"{platform.system()} {platform.release()}"),
        ("Qt", f"{qVersion()} ({QGuiApplication.platformName()})"),
    ]
    for package in PACKAGES:
        try:
            rows.append((package, version(package)))
        except PackageNotFoundError:
            rows.append((package, "not installed as a package"))
    rows.append(("Clock resolution", f"{clock.resolution * 1e9:.0f} ns, {clock.implementation}"))
    rows.append(("Screen", f"{screen.size().width()}×{screen.size().height()}, ×{screen.devicePixelRatio():g}"))
    return rows
