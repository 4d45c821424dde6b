"""Painting stays in the thread of the window: spreading a limb over other threads costs more than painting it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PAINTS = """
import os
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication
from studio.ui.theme import Theme
from studio.ui.views.stage import Stage
from tests.ui.stage_poses import standing

application = QApplication(["studio"])
before = len(os.listdir("/proc/self/task"))
stage = Stage(Theme())
stage.resize(1000, 700)
stage.show_pose(standing("t"))
stage.render(QImage(1000, 700, QImage.Format.Format_RGB32))
print(len(os.listdir("/proc/self/task")) - before)
"""


@pytest.mark.skipif(not Path("/proc/self/task").is_dir(), reason="only Linux lists the threads of a process here")
def test_painting_the_figure_starts_no_thread():
    environment = {name: value for name, value in os.environ.items() if name != "QT_NO_GUI_THREADPOOL"}

    run = subprocess.run([sys.executable, "-c", PAINTS], env=environment, capture_output=True, text=True, check=True)

    assert run.stdout.strip() == "0"
