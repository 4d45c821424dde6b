"""Photographs every page in its states into ``resources/manual/pictures``, from the running studio.

``python -m tests.ui.photographs [FOLDER]`` takes about two minutes and needs no screen.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PySide6.QtGui import QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from studio.core.errors import PoseMissing
from studio.ui.models.recorder import Phase
from studio.ui.studio_window import StudioWindow
from tests.ui.running_studio import WALKS, running_studio

PICTURES = Path(__file__).resolve().parents[2] / "resources" / "manual" / "pictures"
PAGES = ("connect", "assign", "calibrate", "settings")
"""Diagnostics is left out: it tells of the computer it was photographed on."""
PATIENCE = 60.0  # s
SMALLEST = 0  # of a PNG: the most compression
LONG = "Gait after total knee arthroplasty, second visit, without shoes, slow"


class Camera:
    """Keeps pictures of one window under a common ending."""

    def __init__(self, studio: StudioWindow, folder: Path, ending: str) -> None:
        self._studio, self._folder, self._ending = studio, folder, ending

    def shoot(self, name: str, wait: int = 300) -> None:
        """Let the window settle for ``wait`` ms and keep a picture."""
        QTest.qWait(wait)
        file = self._folder / f"{name}-{self._ending}.png"
        picture = self._studio.window.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
        assert picture.save(str(file), quality=SMALLEST), file
        sys.stdout.write(f"{file.name}\n")


def until(what: Callable[[], object]) -> None:
    """Wait until something is so."""
    end = time.perf_counter() + PATIENCE
    while not what():
        assert time.perf_counter() < end, "the studio did not get there"
        QTest.qWait(20)


def walks(studio: StudioWindow) -> None:
    """Wait until somebody walks, and the first samples are left behind."""
    until(lambda: studio.model.alignment is not None and studio.model.buffer.newest()[1] is not None)
    until(lambda: studio.model.health and all(told.silent_for < 0.5 for told in studio.model.health.values()))
    QTest.qWait(1500)


def with_a_take(studio: StudioWindow, camera: Camera) -> None:
    """Record one, look at it, and export it."""
    studio.go_to("capture")
    camera.shoot("capture", 1500)
    studio.capture.press()
    until(lambda: studio.recorder.phase is Phase.RECORDING)
    camera.shoot("capture-recording", 2500)
    studio.capture.press()
    until(studio.window.toast.isVisible)
    camera.shoot("capture-saved")
    studio.traces.kinds.button(1).click()
    camera.shoot("capture-sensors", 1500)
    studio.review_take(studio.review_page.takes.model.newest()[0].folder)
    until(studio.review_page.transport.play.isEnabled)
    studio.review_page.playhead.seek(2.4)
    camera.shoot("review")
    studio.review_page.measures.export.click()
    studio.export_page.cards["blender"].click()
    camera.shoot("export")
    studio.export_page.start.click()
    until(studio.export_page.result.show_file.isVisible)
    camera.shoot("export-done")


@contextmanager
def photographed(
    folder: Path, ending: str, *, source: str = WALKS, **preferences: Any
) -> Iterator[tuple[StudioWindow, Camera]]:
    """Start a studio with folders that are gone afterwards."""
    with tempfile.TemporaryDirectory() as place:
        os.environ["HOME"] = place  # folders are shown as ``~/…``
        with running_studio(Path(place), source, **preferences) as studio:
            yield studio, Camera(studio, folder, ending)


def everything(folder: Path, ending: str, **preferences: Any) -> None:
    """Photograph the way from the first start to the file."""
    with photographed(folder, ending, **preferences) as (studio, camera):
        walks(studio)
        camera.shoot("home")
        for page in PAGES:
            studio.go_to(page)
            camera.shoot(page, 1200)
        with_a_take(studio, camera)
        studio.window.show_keys()
        camera.shoot("keys")


def exceptions(folder: Path, ending: str, **preferences: Any) -> None:
    """Photograph pages without anything, with too much, and with what went wrong."""
    with photographed(folder, ending, source="", **preferences) as (studio, camera):
        for page in ("connect", "assign", "calibrate", "capture", "review", "export"):
            studio.go_to(page)
            camera.shoot(f"{page}-empty")
        studio.model.open("serial:COM5")
        studio.go_to("connect")
        until(studio.connect_page.retry.isVisible)
        camera.shoot("connect-refused")
        studio.go_to("review")
        studio.review_page.show_refusal(Path("take"), PoseMissing(6.0))
        camera.shoot("review-refused")
        studio.window.show_safe_start()
        studio.go_to("home")
        camera.shoot("home-safe-start")
    with photographed(folder, ending, source="synthetic:walk?loss=0.2&battery=low", take_name=LONG, **preferences) as (
        studio,
        camera,
    ):
        until(lambda: len(studio.model.infos) == 15 and not studio.model.connecting)
        studio.people.choose("PATIENT123456789"[:16])
        for page in ("connect", "assign", "calibrate", "capture"):
            studio.go_to(page)
            camera.shoot(f"{page}-trouble", 1500)
        studio.window.strip.items.click()
        camera.shoot("problems")


def main() -> None:
    """Take all pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else PICTURES
    folder.mkdir(parents=True, exist_ok=True)
    application = QApplication([])
    application.setQuitOnLastWindowClosed(False)
    everything(folder, "dark", scheme="dark", coach_marks_done=True)
    everything(folder, "light", scheme="light", vocabulary="studio")
    everything(folder, "light-150", scheme="light", text_scale=1.5, coach_marks_done=True)
    exceptions(folder, "dark", scheme="dark", coach_marks_done=True)
    exceptions(folder, "light-150", scheme="light", text_scale=1.5, coach_marks_done=True)


if __name__ == "__main__":
    main()
