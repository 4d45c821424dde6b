"""Body calibration: what to do now, large enough for who wears the tags; and what came of it, limb by limb."""

from collections.abc import Mapping

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QKeyEvent, QResizeEvent
from PySide6.QtWidgets import (
    QButtonGroup,
    QComboBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from studio.capture.procedures.held_pose import DELAYS, Cue, Phase
from studio.core.body import Place
from studio.core.take import PoseName
from studio.ui.models.hold_model import SEQUENCES, HoldModel
from studio.ui.models.place_words import PlaceWords
from studio.ui.style_sheet import set_look
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.hold_display import HoldDisplay
from studio.ui.views.hold_words import HoldWords
from studio.ui.views.limb_table import LimbTable
from studio.ui.views.side_panel import SidePanel

PANEL = 460  # px at 100 % text
MOST_LIMBS = 2  # named on a button; more are counted
SHARE = 0.58  # of the page that the panel may take when text is large


class CalibrationPage(QWidget):
    """Renders the holds and their outcome; says what the operator wants."""

    start_requested = Signal(object)
    """The pose to hold, or None for the next one."""
    rest_requested = Signal()
    cancel_requested = Signal()
    accepted = Signal()
    repeat_requested = Signal(object)
    """Places (tuple) to repeat; empty for the whole body."""

    def __init__(
        self,
        theme: Theme,
        model: HoldModel,
        words: Mapping[Place, PlaceWords],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._theme = theme
        self._model = model
        self._said = HoldWords(words)
        self.display = HoldDisplay(theme, self)
        self.table = LimbTable(theme, self)
        self._build()
        self.start_requested.connect(model.start)
        self.rest_requested.connect(model.start_rest)
        self.cancel_requested.connect(model.cancel)
        self.accepted.connect(model.accept)
        self.repeat_requested.connect(model.repeat)
        model.changed.connect(self.refresh)
        model.cued.connect(self._cue)
        self.restyle()

    def set_words(self, words: Mapping[Place, PlaceWords]) -> None:
        """Name the places otherwise: for clinic or studio."""
        self._said = HoldWords(words)
        self.refresh()

    def tick(self, now: float) -> None:
        """Let the ring fill and the numbers count."""
        self.display.tick(now)
        if self._model.is_running:
            self._show_now()

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.display.restyle()
        self.table.restyle()
        self._panel.fit(self.width())
        self.refresh()

    def refresh(self) -> None:
        """Show what the model says."""
        self._show_steps()
        self._show_now()
        self._show_buttons()
        outcome = self._model.outcome
        self.table.show_limbs(outcome.limbs if outcome is not None else (), self._said)
        self.table.setVisible(bool(outcome is not None and outcome.limbs))
        self.explanation.setText(self._said.explanation(self._model))

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Space starts what comes next, Esc calls it off."""
        if event.key() == Qt.Key.Key_Escape and self._model.is_running:
            self.cancel_requested.emit()
        elif event.key() == Qt.Key.Key_Space and self.start.isEnabled() and not self._model.is_running:
            self._press_start()
        else:
            super().keyPressEvent(event)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Share the width anew."""
        self._panel.fit(self.width())
        self._shorten_steps()

    def _build(self) -> None:
        self._steps = QHBoxLayout()
        self._steps.setContentsMargins(GAP_PAGE, GAP_WIDE, GAP_PAGE, GAP)
        self._steps.setSpacing(GAP_WIDE)
        self.step_labels = [QLabel(self) for _ in range(4)]
        for label in self.step_labels:
            self._steps.addWidget(label)
        self._steps.addStretch(1)
        left = QVBoxLayout()
        left.setSpacing(0)
        left.addLayout(self._steps)
        left.addWidget(self.display, 1)
        page = QHBoxLayout(self)
        page.setContentsMargins(0, 0, 0, 0)
        page.setSpacing(0)
        page.addLayout(left, 1)
        page.addWidget(self._build_panel())

    def _build_panel(self) -> SidePanel:
        self._panel = SidePanel(self._theme, PANEL, SHARE, GAP_PAGE, self)
        column = self._panel.column
        self.headline = QLabel(self)
        self.headline.setProperty("role", "section")
        self.headline.setWordWrap(True)
        self.explanation = QLabel(self)
        self.explanation.setProperty("role", "muted")
        self.explanation.setWordWrap(True)
        column.addWidget(self.headline)
        column.addWidget(self.explanation)
        column.addSpacing(GAP)
        self._build_choices(column)
        self._build_actions(column)
        column.addWidget(self.table, 100)
        column.addStretch(1)
        return self._panel

    def _build_choices(self, column: QVBoxLayout) -> None:
        row = QHBoxLayout()
        row.setSpacing(GRID)
        self.poses: dict[PoseName, QPushButton] = {}
        group = QButtonGroup(self)
        for pose in SEQUENCES:
            button = QPushButton(self._said.pose(pose), self)
            button.setProperty("kind", "segment")
            button.setCheckable(True)
            button.setAccessibleName(self.tr("First pose: {pose}").format(pose=button.text()))
            group.addButton(button)
            row.addWidget(button)
            self.poses[pose] = button
        row.addStretch(1)
        group.buttonClicked.connect(self._choose_pose)
        self.delay = QComboBox(self)
        self.delay.setAccessibleName(self.tr("Countdown"))
        for seconds in DELAYS:
            self.delay.addItem(self.tr("start after {n} s").format(n=seconds), seconds)
        self.delay.currentIndexChanged.connect(self._choose_delay)
        column.addLayout(row)
        column.addWidget(self.delay)

    def _build_actions(self, column: QVBoxLayout) -> None:
        self.start = self._button(self._press_start)
        self.start.setProperty("kind", "primary")
        self.cancel = self._button(self.cancel_requested.emit)
        self.cancel.setText(self.tr("Call off  (Esc)"))
        self.cancel.setAccessibleName(self.tr("Call off"))
        self.sit = self._button(self.rest_requested.emit)
        self.accept = self._button(self.accepted.emit)
        self.accept.setText(self.tr("Accept"))
        self.accept.setAccessibleName(self.tr("Accept the body calibration"))
        self.repeat = self._button(self._repeat_all)
        self.repeat.setText(self.tr("Repeat"))
        self.repeat.setAccessibleName(self.tr("Repeat the pose with the whole body"))
        self.repeat_some = self._button(self._repeat_some)
        column.addWidget(self.start)
        column.addWidget(self.cancel)
        column.addWidget(self.sit)
        column.addSpacing(GRID)
        row = QHBoxLayout()
        row.setSpacing(GAP)
        row.addWidget(self.accept, 1)
        row.addWidget(self.repeat, 1)
        column.addLayout(row)
        column.addWidget(self.repeat_some)
        column.addSpacing(GAP)

    def _button(self, pressed: object) -> QPushButton:
        button = QPushButton(self)
        button.clicked.connect(pressed)
        return button

    def _show_steps(self) -> None:
        steps = self._model.steps()
        for number, (label, (name, state)) in enumerate(zip(self.step_labels, steps, strict=True), 1):
            label.setText(self._said.step(number, name, state))
            label.setAccessibleName(label.text())
            look = {"now": ("section", "accent"), "done": ("", "good"), "todo": ("muted", "")}[state]
            set_look(label, role=look[0], tone=look[1])
        self._shorten_steps()

    def _shorten_steps(self) -> None:
        """Leave the other steps' names out where large text has no room for them."""
        for label in self.step_labels:
            label.setText(label.accessibleName())
        needed = sum(label.sizeHint().width() + GAP_WIDE for label in self.step_labels)
        if needed > self.width() - self._panel.width() - 2 * GAP_PAGE:
            for label in self.step_labels:
                if label.property("tone") != "accent":
                    label.setText(label.text()[:1])

    def _show_now(self) -> None:
        model = self._model
        now = self._said.now(model)
        self.display.show_pose(now.pose)
        self.display.show_words(now.big, now.small, now.tone)
        running = model.rest if model.rest.is_running else model.hold
        share = running.progress(model.now)
        self.display.show_progress(1.0 if model.hold.phase is Phase.JUDGED and not model.rest.is_running else share)
        self.headline.setText(now.headline)

    def _show_buttons(self) -> None:
        focused = next((button for button in self._actions() if button is self.focusWidget()), None)
        self._show_action_buttons()
        # Space and Enter go to what comes next, never to what happens to stand there now.
        if focused is not None and focused.isHidden():
            shown = [button for button in self._actions() if not button.isHidden()]
            first = next((button for button in shown if button.property("kind") == "primary"), None)
            (first or shown[0]).setFocus()

    def _actions(self) -> tuple[QPushButton, ...]:
        return (self.start, self.cancel, self.sit, self.accept, self.repeat, self.repeat_some)

    def _show_action_buttons(self) -> None:
        model = self._model
        hold, running = model.hold, model.is_running
        upcoming = hold.next_pose
        for pose, button in self.poses.items():
            button.setChecked(pose == hold.sequence[0])
            button.setEnabled(not running)
        with QSignalBlocker(self.delay):
            self.delay.setCurrentIndex(DELAYS.index(model.delay))
        self.delay.setEnabled(not running)
        failed = hold.phase is Phase.JUDGED and hold.outcome is not None and hold.outcome.pose not in hold.done
        self.start.setVisible(not running and upcoming is not None and not failed)
        self.start.setEnabled(bool(model.assigned))
        text = self._said.start(upcoming or hold.sequence[0])
        self.start.setText(self.tr("{what}  (Space)").format(what=text))
        self.start.setAccessibleName(text)
        self.cancel.setVisible(running)
        self.sit.setVisible(not running and bool(model.rest_missing) and bool(model.assigned))
        self.sit.setText(self._said.sit(model))
        self.sit.setAccessibleName(self.sit.text())
        self._show_outcome_buttons(failed)

    def _show_outcome_buttons(self, failed: bool) -> None:
        model = self._model
        hold = model.hold
        judged = hold.phase is Phase.JUDGED and not model.is_running
        finished = hold.next_pose is None
        self.accept.setVisible(judged and hold.alignment is not None and not failed)
        self.accept.setText(self.tr("Accept") if finished else self.tr("Accept without the bow"))
        self.accept.setAccessibleName(self.accept.text())
        self.repeat.setVisible(judged)
        moved = hold.outcome.moved if hold.outcome is not None else ()
        some = judged and bool(moved) and hold.alignment is not None
        self.repeat_some.setVisible(some)
        if some:
            words = self.tr("Repeat only {n} limbs").format(n=len(moved))
            self.repeat_some.setText(words if len(moved) > MOST_LIMBS else self._said.repeat_only(moved))
            self.repeat_some.setToolTip(self._said.repeat_only(moved))
            self.repeat_some.setAccessibleName(self.repeat_some.text())
        # One button is the obvious one: repeat what failed, else the next pose, else accept.
        rest_first = not self.sit.isHidden() and hold.outcome is None
        set_look(self.sit, kind="primary" if rest_first else "")
        set_look(self.start, kind="" if rest_first else "primary")
        set_look(self.accept, kind="primary" if finished and not failed else "")
        set_look(self.repeat, kind="primary" if failed and not some else "")
        set_look(self.repeat_some, kind="primary" if some else "")

    def _cue(self, cue: Cue) -> None:
        self.display.cue(cue)

    def _press_start(self) -> None:
        hold = self._model.hold
        if hold.phase is Phase.JUDGED and hold.outcome is not None and hold.outcome.pose not in hold.done:
            self._repeat_all()
        else:
            self.start_requested.emit(hold.next_pose)

    def _repeat_all(self) -> None:
        self.repeat_requested.emit(())

    def _repeat_some(self) -> None:
        outcome = self._model.outcome
        if outcome is not None:
            self.repeat_requested.emit(outcome.moved)

    def _choose_pose(self) -> None:
        chosen = next(pose for pose, button in self.poses.items() if button.isChecked())
        self._model.choose_reference(chosen)

    def _choose_delay(self) -> None:
        self._model.set_delay(int(self.delay.currentData()))
