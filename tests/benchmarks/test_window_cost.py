"""What the window costs while fifteen tags are live: from packet to paint, and the share of one core."""

import time

import numpy as np
import pytest
from PySide6.QtCore import QEvent, QObject, QTimer

from studio.core.live_frames import Pose
from studio.core.take import Mark
from tests.journeys.test_receiver_on_a_cable import suit
from tests.ui.running_studio import running_studio

pytestmark = pytest.mark.benchmark

SECONDS = 15
SLOW = 60_000  # ms


class Watch(QObject):
    """Notes how old the newest sample of a body is when it has been painted."""

    def __init__(self, studio, page):
        super().__init__()
        self.ages: list[float] = []
        self._studio = studio
        self._shown: Pose | None = None
        self._painted: Pose | None = None
        studio.tick.ticked.connect(self.note_shown)
        studio.stages.stage(page).installEventFilter(self)

    def note_shown(self, _):
        _, self._shown = self._studio.model.buffer.newest()

    def eventFilter(self, watched, event):  # noqa: N802 (Qt's name)
        if event.type() == QEvent.Type.Paint and self._shown is not self._painted:
            self._painted = self._shown
            QTimer.singleShot(0, self.note_painted)
        return False

    def note_painted(self):
        assert self._painted is not None
        self.ages.append(time.perf_counter() - self._painted.time)


@pytest.mark.parametrize("traces", ["figure alone", "angles", "fifteen plots"])
def test_packet_to_paint(qtbot, tmp_path, traces):
    with (
        suit("walk?seed=1&calibrated=1", SECONDS + 60) as port,
        running_studio(tmp_path, source="") as studio,
    ):
        studio.model.open(f"serial:{port}")
        qtbot.waitUntil(lambda: len(studio.model.infos) == 15 and not studio.model.connecting, timeout=SLOW)
        hold_by_words(qtbot, studio)
        qtbot.waitUntil(lambda: studio.model.buffer.newest()[1] is not None, timeout=SLOW)
        page = "home" if traces == "figure alone" else "capture"
        studio.go_to(page)
        if traces == "fifteen plots":
            studio.window.resize(1600, 1400)
            studio.traces.kinds.button(1).click()
        qtbot.wait(2000)
        shown = len(studio.traces.visible_sensors()) if page == "capture" else 0
        watch = Watch(studio, page)
        wall, used = time.perf_counter(), time.process_time()
        qtbot.wait(SECONDS * 1000)
        share = (time.process_time() - used) / (time.perf_counter() - wall)
        ages = 1000 * np.array(watch.ages)
        print(
            f"\n{traces} ({shown} plots): packet to paint median {np.median(ages):.1f} ms, "
            f"p95 {np.percentile(ages, 95):.1f} ms; {share:.0%} of one core for everything; {len(ages)} frames"
        )
        assert len(ages) > SECONDS * 30
        assert sum(told.lost for told in studio.model.health.values()) == 0


def hold_by_words(qtbot, studio):
    """Tell the session when the poses were held, as soon as they have been (resources/manual/synthetic-suit.md)."""
    sensors = tuple(studio.model.infos)
    first = min(float(w.time[0]) for w in studio.model.buffer.snapshot(sensors, 60).values())
    qtbot.wait(9000)
    studio.model.hold(Mark(first + 1.2, "pose", "n", first + 4.0))
    qtbot.wait(500)
    studio.model.hold(Mark(first + 5.7, "pose", "bow", first + 7.7))
