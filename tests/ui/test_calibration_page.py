"""The calibration page: a hold from the press to the result, for who wears the tags and who runs them."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QAbstractButton, QComboBox

from studio.capture.procedures.held_pose import Cue, Kind, Phase
from studio.capture.procedures.judged_hold import Judged
from studio.capture.procedures.sitting_rest import Readings
from studio.core.body import PLACES, Place
from studio.core.errors import HeadingsUnknown, MovedDuringHold
from studio.core.frames import GRAVITY, UP
from studio.core.rest import Rest
from studio.core.sample import SensorId
from studio.core.take import Alignment, LimbAlignment, Mark
from studio.ui.models.hold_model import HoldModel
from studio.ui.models.place_words import place_words
from studio.ui.theme import Theme
from studio.ui.views.calibration_page import CalibrationPage
from studio.ui.views.hold_display import FLASH, HoldDisplay
from studio.ui.views.limb_table import DEGREES, GRADE, HEADING, LIMB

PLACES_FILE = Path(__file__).resolve().parents[2] / "resources" / "places.json"
WORDS = place_words(json.loads(PLACES_FILE.read_text(encoding="utf-8")))
LEFT = Qt.MouseButton.LeftButton
# Without a screen Qt says so whenever a window with a smallest size is shown.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")
ONE = SensorId("tag:00000001")


def alignment(source="bow", unknown=()):
    limbs = {
        place: LimbAlignment(
            (1.0, 0.0, 0.0, 0.0),
            0.0,
            "unknown" if place in unknown else source,
            math.radians(3),
            math.radians(0.3 + 0.1 * row),
        )
        for row, place in enumerate(PLACES)
    }
    return Alignment("n", 0.0, 3.0, limbs)


FOREARM_MOVED = MovedDuringHold("n", (Place.LEFT_FOREARM.value,), (6.3,))


class Bench:
    """Page, model and the time that passes for both."""

    def __init__(self, page, model):
        self.page, self.model = page, model
        self.now = 0.0
        self.cues: list[Cue] = []
        self.ended: list[tuple[Mark, frozenset[Place]]] = []
        model.cued.connect(self.cues.append)
        model.hold_ended.connect(lambda mark, only: self.ended.append((mark, only)))
        self.pass_time(0.0)

    def pass_time(self, seconds):
        for _ in range(max(1, round(seconds / 0.05))):
            self.now += 0.05 if seconds else 0.0
            self.model.tick(self.now)
            self.page.tick(self.now)

    def until_asked(self):
        while not self.ended:
            self.pass_time(0.05)
        return self.ended.pop()

    def hold(self, answer):
        asked = self.until_asked()
        self.model.answer(answer)
        self.pass_time(0.05)
        return asked


@pytest.fixture
def theme(qapp):
    return Theme()


@pytest.fixture
def bench(qtbot, theme):
    model = HoldModel()
    model.set_assigned(PLACES)
    page = CalibrationPage(theme, model, WORDS)
    qtbot.addWidget(page)
    page.resize(1080, 640)
    page.show()
    qtbot.waitExposed(page)
    return Bench(page, model)


def steps(page):
    return [label.text() for label in page.step_labels]


def test_without_an_assignment_nothing_starts_and_the_page_says_why(qtbot, bench):
    bench.model.set_assigned(())

    assert not bench.page.start.isEnabled()
    assert "Assign" in bench.page.headline.text()
    qtbot.keyClick(bench.page, Qt.Key.Key_Space)
    assert bench.model.hold.phase is Phase.IDLE


def test_silent_sensors_are_named(bench):
    bench.model.set_assigned(PLACES, (Place.LEFT_FOOT,))

    assert "Left foot" in bench.page.explanation.text()


def test_space_counts_down_and_the_wearer_sees_what_is_heard(qtbot, bench):
    requested: list[str] = []
    bench.page.start_requested.connect(requested.append)

    qtbot.keyClick(bench.page, Qt.Key.Key_Space)
    bench.pass_time(0.5)

    assert requested == ["n"]
    assert bench.cues == [Cue(Kind.COUNT, 3)]
    assert bench.page.display.accessibleName().startswith("3.")
    assert not bench.page.start.isVisible()
    bench.pass_time(2.7)
    assert bench.page.display.accessibleName().startswith("HOLD")


def test_esc_calls_off_the_countdown(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.pass_time(1.0)

    qtbot.keyClick(bench.page, Qt.Key.Key_Escape)

    assert bench.model.hold.phase is Phase.IDLE
    assert bench.page.start.isVisible()
    bench.pass_time(10.0)
    assert bench.ended == []


def test_from_n_pose_over_the_bow_to_accepted(qtbot, bench):
    accepted: list[Alignment] = []
    bench.model.accepted.connect(accepted.append)
    qtbot.mouseClick(bench.page.start, LEFT)
    mark, only = bench.hold(Judged(alignment("strap rule"), None))
    assert (mark.label, only) == ("n", frozenset())
    assert steps(bench.page)[1] == "✔ N-pose"
    assert "Bow" in bench.page.start.text()

    qtbot.keyClick(bench.page, Qt.Key.Key_Space)
    mark, _ = bench.hold(Judged(alignment(), None))
    assert mark.label == "bow"
    assert "calibrated" in bench.page.headline.text()
    qtbot.mouseClick(bench.page.accept, LEFT)

    assert accepted == [bench.model.hold.alignment]


def test_each_limb_has_its_degrees_a_word_and_its_heading(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment(), None))
    table = bench.page.table

    rows = {table.item(row, LIMB).text(): row for row in range(table.rowCount())}
    assert table.rowCount() == 15
    row = rows["●  Left forearm"]
    assert table.item(row, DEGREES).text() == "0.7"
    assert table.item(row, GRADE).text() == "good"
    assert table.item(row, HEADING).text() == "bow ±3°"
    assert table.item(0, GRADE).text() == "fair"  # the worst first


def test_one_limb_that_moved_is_offered_to_be_repeated_alone(qtbot, bench):
    asked: list[tuple[Place, ...]] = []
    bench.page.repeat_requested.connect(asked.append)
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment(), FOREARM_MOVED))
    assert bench.page.repeat_some.text() == "Repeat only Left forearm"
    assert bench.page.table.item(0, GRADE).text() == "▲ moved"
    assert bench.page.table.item(0, DEGREES).text() == "6.3"

    qtbot.mouseClick(bench.page.repeat_some, LEFT)
    mark, only = bench.hold(Judged(alignment(), None))

    assert asked == [(Place.LEFT_FOREARM,)]
    assert (mark.label, only) == ("n", {Place.LEFT_FOREARM})
    assert bench.model.hold.done == ("n",)


def test_space_after_a_refused_hold_repeats_it_and_never_accepts(qtbot, bench):
    accepted: list[bool] = []
    bench.page.accepted.connect(lambda: accepted.append(True))
    bench.page.activateWindow()
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(None, MovedDuringHold("n", ("head",), (4.0,))))

    assert bench.page.focusWidget() is bench.page.repeat
    qtbot.keyClick(bench.page.focusWidget(), Qt.Key.Key_Space)

    assert bench.model.hold.phase is Phase.COUNTDOWN
    assert accepted == []


def test_unknown_headings_are_told_as_what_the_bow_is_for(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    unknown = HeadingsUnknown(tuple(place.value for place in PLACES))
    bench.hold(Judged(alignment("unknown"), unknown))

    assert "next pose tells" in bench.page.explanation.text()
    assert bench.page.table.item(0, HEADING).text() == "▲ unknown"


def test_limbs_without_heading_after_the_bow_are_named(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment("strap rule"), None))
    qtbot.keyClick(bench.page, Qt.Key.Key_Space)
    bench.hold(Judged(alignment(unknown=(Place.LEFT_FOOT,)), None))

    assert "Left foot" in bench.page.explanation.text()


def test_a_missing_rest_is_asked_first_and_found_by_sitting_still(qtbot, bench):
    found: list[tuple[SensorId, Rest]] = []
    wanted: list[tuple[tuple[SensorId, ...], float]] = []
    bench.model.rest_found.connect(lambda sensor, rest: found.append((sensor, rest)))
    bench.model.readings_wanted.connect(lambda sensors, seconds: wanted.append((sensors, seconds)))
    bench.model.set_rest_missing({ONE: 0.02})
    assert "rest is missing" in bench.page.headline.text()

    qtbot.mouseClick(bench.page.sit, LEFT)
    bench.pass_time(5.5)
    assert wanted == [((ONE,), 5.0)]
    still = Readings(np.full((250, 3), 0.02), np.tile(UP * GRAVITY, (250, 1)))
    bench.model.judge_rest({ONE: still})

    assert [sensor for sensor, _ in found] == [ONE]
    assert steps(bench.page)[0] == "✔ Rest"
    assert not bench.page.sit.isVisible()


def test_another_first_pose_begins_anew(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment(), None))

    qtbot.mouseClick(bench.page.poses["t"], LEFT)

    assert bench.model.hold.sequence == ("t", "bow")
    assert bench.model.hold.done == ()
    assert "T-pose" in bench.page.start.text()


def test_flashes_stay_below_three_a_second(qtbot, theme):
    display = HoldDisplay(theme)
    qtbot.addWidget(display)
    began: list[float] = []
    lit = False
    for step in range(400):
        now = step * 0.01
        display.tick(now)
        display.cue(Cue(Kind.COUNT, 1))
        if display.is_lit and not lit:
            began.append(now)
        lit = display.is_lit

    gaps = np.diff(began)
    assert len(began) > 5
    assert gaps.min() > 1 / 3
    display.tick(began[-1] + 2 * FLASH)
    assert not display.is_lit


def test_another_assignment_begins_anew(qtbot, bench):
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment(), None))

    bench.model.set_assigned(PLACES[:8])

    assert bench.model.outcome is None
    assert not bench.page.table.isVisible()


def test_every_control_has_a_name(bench):
    bench.model.set_rest_missing({ONE: 0.02})
    controls = [w for kind in (QAbstractButton, QComboBox) for w in bench.page.findChildren(kind)]
    shown = [w for w in controls if w.isVisible() and w.focusPolicy() != Qt.FocusPolicy.NoFocus]

    assert [w for w in shown if not w.accessibleName()] == []


@pytest.mark.parametrize("scale", [0.8, 1.5, 2.0])
def test_large_text_leaves_the_names_of_the_limbs_whole(qtbot, bench, theme, scale):
    theme.text_scale = scale
    bench.page.setFont(theme.font("body"))
    bench.page.restyle()
    qtbot.mouseClick(bench.page.start, LEFT)
    bench.hold(Judged(alignment(), None))

    table = bench.page.table
    room = table.columnWidth(LIMB)
    assert table.isColumnHidden(HEADING) or room >= table.fontMetrics().horizontalAdvance("●  Left forearm")


def test_large_text_shortens_the_steps_that_are_not_now(bench, theme):
    for label in bench.page.step_labels:
        label.setFont(theme.font("figure"))
    bench.page.resize(600, 600)

    bench.model.changed.emit()

    assert [label.text() for label in bench.page.step_labels] == ["✔", "2  N-pose", "3", "4"]
    assert bench.page.step_labels[3].accessibleName() == "4  Check"
