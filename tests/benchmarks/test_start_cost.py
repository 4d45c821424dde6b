"""How long from starting the studio until a figure moves in its window: first with cold caches of Python, then warm."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytestmark = pytest.mark.benchmark

ROOT = Path(__file__).resolve().parents[2]
STARTED = """
import sys
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication
from studio.ui import application, studio_window

class Watched(studio_window.StudioWindow):
    def on_tick(self, now):
        super().on_tick(now)
        if self.model.buffer.newest()[1] is not None and self.show.has_body():
            self.window.grab()
            self.window.close_now()

application.StudioWindow = Watched
sys.exit(application.run())
"""


def started(folder):
    """Return the seconds until the figure moves and the window is closed again."""
    environment = {**os.environ, "HOME": str(folder), "QT_QPA_PLATFORM": "offscreen", "PYTHONPATH": str(ROOT)}
    environment |= {f"XDG_{kind}_HOME": str(folder / kind) for kind in ("CONFIG", "DATA", "STATE")}
    environment["PYTHONPYCACHEPREFIX"] = str(folder / "caches")
    before = time.perf_counter()
    run = subprocess.run(
        [sys.executable, "-c", STARTED], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert run.returncode == 0, run.stderr
    return time.perf_counter() - before


def test_from_start_to_moving_figure(tmp_path):
    cold, *warmed = [started(tmp_path) for _ in range(4)]
    warm = min(warmed)
    print(f"\nstart to moving figure: {cold:.1f} s without any of Python's caches, {warm:.1f} s with them")
    assert warm > 0
