"""Connect: choose a source, see each sensor's health, look at one from near, measure the offsets at rest."""

import math
from collections.abc import Mapping, Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from studio.acquisition.driver import Found
from studio.acquisition.health import HealthSnapshot
from studio.capture.live_buffer import Window
from studio.core.body import Place
from studio.core.sample import SensorId, SensorInfo
from studio.ui.icons import pixmap
from studio.ui.models.rest_watch import RestWatch
from studio.ui.models.sensor_motion import shaken, speed_of
from studio.ui.models.sensor_table import SensorTableModel
from studio.ui.style_sheet import set_look
from studio.ui.theme import CONTROL, FORM_WIDTH, GAP, GAP_PAGE, GAP_WIDE, Theme
from studio.ui.views.announcement import announce
from studio.ui.views.sensor_list import SensorList
from studio.ui.views.sensor_panel import SensorPanel
from studio.ui.views.source_choice import SourceChoice
from studio.ui.wording import Message

MOVED_FOR = 1.0  # s a line stays lit after its tag was moved


class ConnectPage(QWidget):
    """Renders health, rest and signals; says what the operator wants."""

    source_chosen = Signal(str)
    """The words that open a source."""
    disconnect_requested = Signal()
    refresh_requested = Signal()
    """Look for receivers again, then ``offer_ports``."""
    folder_requested = Signal()
    """Let a take be chosen in another folder, then ``choose_source``."""
    rename_requested = Signal(str, str)
    """A sensor and its new name."""
    blink_requested = Signal(str)
    select_changed = Signal(str)
    """The sensor looked at; empty for none."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._since: float | None = None
        self._is_connected = False
        self._now = 0.0
        self._moved_at = -math.inf
        self._had_sensors = False
        self.sensors = SensorTableModel(self)
        self.choice = SourceChoice(theme, self)
        self.list = SensorList(theme, self.sensors, self)
        self.panel = SensorPanel(theme, self)
        self.retry = QPushButton(self.tr("Try again"), self)
        self.simulator = QPushButton(self.tr("Use the simulator"), self)
        self.instead = QPushButton(self.tr("Use the simulator"), self)
        self._status, self._rest_words, self._rest_count = QLabel(self), QLabel(self), QLabel(self)
        self._refusal, self._empty = QFrame(self), QFrame(self)
        self._said = [QLabel(self._refusal) for _ in range(3)]
        self._empty_icon, self._empty_title, self._empty_text = (QLabel(self._empty) for _ in range(3))
        self._build()
        self._connect()
        self.show_idle()
        self.restyle()

    def offer_ports(self, ports: Sequence[Found]) -> None:
        """Offer these receivers."""
        self.choice.offer_ports(ports)

    def offer_takes(self, takes: Sequence[tuple[str, str]]) -> None:
        """Offer these takes for replay: words and folder, newest first."""
        self.choice.offer_takes(takes)

    def choose_source(self, source: str) -> None:
        """Show a source as chosen, without opening it."""
        self.choice.set_source(source)

    def offer(self, *, rename: bool, blink: bool) -> None:
        """Say what the source lets be done to a sensor; nothing at first."""
        self.sensors.can_rename = rename
        self.panel.offer(rename=rename, blink=blink)

    def set_place_words(self, words: Mapping[Place, str]) -> None:
        """Use these names of places."""
        self.sensors.set_place_words(words)

    def show_idle(self) -> None:
        """No source is open."""
        self._show(is_open=False, status="")
        self._empty_title.setText(self.tr("No sensors yet"))
        self._empty_text.setText(
            self.tr(
                "Plug the receiver in, switch the tags on, and press Connect. "
                "Without tags, the simulator shows everything the studio does."
            )
        )

    def show_connecting(self, source: str, now: float) -> None:
        """A source is being opened since ``now``."""
        self.choice.set_source(source)
        self._show(is_open=True, status="")
        self._since, self._now = now, now
        self._empty_title.setText(self.tr("Listening for sensors…"))
        self._empty_text.setText(self.tr("A receiver needs some seconds after it was plugged in."))
        self._say_seconds()

    def show_connected(self, source: str) -> None:
        """A source is open."""
        self.choice.set_source(source)
        self._show(is_open=True, status="")
        self._is_connected = True
        self._say_count()
        self._empty_title.setText(self.tr("Connected, and no sensor is heard"))
        self._empty_text.setText(
            self.tr("Switch a tag on and keep it within 3 m of the receiver. Charge it when its light stays dark.")
        )

    def show_refusal(self, message: Message) -> None:
        """The source cannot be opened, or was lost."""
        self._show(is_open=False, status="")
        for label, words in zip(self._said, message[1:], strict=True):
            label.setText(words)
            label.setVisible(bool(words))
        self._refusal.show()
        self._show_body()
        announce(self, " ".join(message[1:]))

    def show_sensors(
        self,
        health: Mapping[SensorId, HealthSnapshot],
        infos: Mapping[SensorId, SensorInfo],
        places: Mapping[SensorId, Place],
        now: float,
    ) -> None:
        """Show the newest counts, four times a second."""
        self.sensors.show_sensors(health, infos, places, now)
        sensor = self.selected()
        if sensor is not None:
            self.panel.set_title(self.sensors.title_of(sensor))
        self._say_count()
        self._show_body()

    def show_rest(self, watch: RestWatch) -> None:
        """Show how far the rest of each sensor is, four times a second."""
        self.sensors.show_rest(watch.progress, watch.is_still)
        done, count = watch.done(), self.sensors.rowCount()
        all_done = 0 < count <= done
        words = self.tr("Lay the tags down and don't touch them: the offset is measured by itself.")
        self._rest_words.setText(self.tr("✔ Offsets measured. The tags can be put on.") if all_done else words)
        self._rest_count.setText(self.tr("{n} of {all} measured").format(n=done, all=count))
        self._rest_count.setVisible(not all_done)
        set_look(self._rest_words, tone="good" if all_done else "")

    def show_worn(self) -> None:
        """The body is calibrated: the tags are worn, and nobody is to lay them down."""
        self._rest_words.setText(self.tr("✔ The tags are worn and the body is calibrated."))
        self._rest_count.hide()
        set_look(self._rest_words, tone="good")

    def show_motion(self, windows: Mapping[SensorId, Window], now: float) -> None:
        """Light up the tag that somebody shakes, four times a second; the last half second is enough."""
        moved = shaken({sensor: speed_of(window) for sensor, window in windows.items()})
        if moved is not None:
            self._moved_at = now
            self.sensors.show_moved(moved)
        elif now - self._moved_at > MOVED_FOR:
            self.sensors.show_moved(None)

    def show_signal(self, window: Window, now: float) -> None:
        """Show the newest ten seconds of the selected sensor, 25 times a second."""
        self.panel.show_window(window, now)

    def selected(self) -> SensorId | None:
        """Return the sensor that is looked at."""
        return self.list.sensor()

    def tick(self, now: float) -> None:
        """Count the seconds of connecting."""
        self._now = now
        if self._since is not None:
            self._say_seconds()

    def restyle(self) -> None:
        """Take over colours and text size."""
        width = round(FORM_WIDTH * max(self._theme.text_scale, 1.0))
        for label in self._said:
            label.setMaximumWidth(width)
        self._empty_icon.setPixmap(pixmap("connect", self._theme.tokens.muted, 2 * CONTROL))
        self.choice.restyle()
        self.list.restyle()
        self.panel.restyle()
        self._need_room()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 (Qt's name)
        """Take the room the fonts need, which are known now."""
        super().showEvent(event)
        self._need_room()

    def _need_room(self) -> None:
        # Without it the splitter is as high as its parts wish, and the page scrolls where it need not.
        self._body.setMinimumHeight(self._body.minimumSizeHint().height())

    def _build(self) -> None:
        title = QLabel(self.tr("Connect"), self)
        title.setProperty("role", "page")
        head = QHBoxLayout()
        head.setSpacing(GAP_WIDE)
        head.addWidget(title)
        head.addWidget(self._status, 1)
        content = QWidget(self)
        column = QVBoxLayout(content)
        column.setContentsMargins(GAP_PAGE, GAP_WIDE, GAP_PAGE, GAP_WIDE)
        column.setSpacing(GAP_WIDE)
        column.addLayout(head)
        column.addWidget(self.choice)
        self._build_refusal()
        column.addWidget(self._refusal)
        self._build_empty()
        column.addWidget(self._empty, 1)
        self._rest = self._build_rest()
        column.addWidget(self._rest)
        self._body = self._build_body()
        column.addWidget(self._body, 1)
        # Large text needs more height than a small window has.
        scroll = QScrollArea(self)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        scroll.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        scroll.setWidget(content)
        page = QVBoxLayout(self)
        page.setContentsMargins(0, 0, 0, 0)
        page.addWidget(scroll)

    def _build_refusal(self) -> None:
        self._refusal.setProperty("ground", "raised")
        self._refusal.setAccessibleName(self.tr("What went wrong"))
        self._said[0].setProperty("role", "section")
        self._said[0].setProperty("tone", "bad")
        self._said[1].setProperty("role", "muted")
        column = QVBoxLayout(self._refusal)
        column.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.setSpacing(GAP)
        for label in self._said:
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
            column.addWidget(label)
        self.retry.setAccessibleName(self.tr("Try to connect again"))
        self.simulator.setAccessibleName(self.tr("Use the simulator instead"))
        self.simulator.setProperty("kind", "quiet")
        buttons = QHBoxLayout()
        buttons.setSpacing(GAP)
        buttons.addWidget(self.retry)
        buttons.addWidget(self.simulator)
        buttons.addStretch(1)
        column.addLayout(buttons)

    def _build_empty(self) -> None:
        self._empty_title.setProperty("role", "section")
        self._empty_text.setProperty("role", "muted")
        self.instead.setAccessibleName(self.tr("Use the simulator"))
        inside = QVBoxLayout()
        inside.setSpacing(GAP)
        for label in (self._empty_icon, self._empty_title, self._empty_text):
            label.setAlignment(Qt.AlignmentFlag.AlignHCenter)
            inside.addWidget(label)
        self._empty_text.setWordWrap(True)
        self._empty_title.setWordWrap(True)
        inside.addSpacing(GAP)
        inside.addWidget(self.instead, 0, Qt.AlignmentFlag.AlignHCenter)
        column = QVBoxLayout(self._empty)
        column.addStretch(1)
        column.addLayout(inside)
        column.addStretch(2)

    def _build_rest(self) -> QWidget:
        row = QWidget(self)
        rest = QHBoxLayout(row)
        rest.setContentsMargins(0, 0, 0, 0)
        rest.setSpacing(GAP_WIDE)
        self._rest_words.setWordWrap(True)
        self._rest_count.setProperty("role", "muted")
        rest.addWidget(self._rest_words, 1)
        rest.addWidget(self._rest_count)
        return row

    def _build_body(self) -> QSplitter:
        body = QSplitter(Qt.Orientation.Vertical, self)
        body.setChildrenCollapsible(False)
        body.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Ignored)
        body.addWidget(self.list)
        body.addWidget(self.panel)
        body.setStretchFactor(0, 3)
        body.setStretchFactor(1, 2)
        return body

    def _connect(self) -> None:
        self.choice.chosen.connect(self.source_chosen)
        self.choice.left.connect(self.disconnect_requested)
        self.choice.refresh_requested.connect(self.refresh_requested)
        self.choice.folder_requested.connect(self.folder_requested)
        self.list.picked.connect(self._pick)
        self.sensors.renamed.connect(self.rename_requested)
        self.panel.rename_asked.connect(self.list.rename)
        self.panel.blink_asked.connect(self._blink)
        self.retry.clicked.connect(self._try_again)
        self.simulator.clicked.connect(self._use_simulator)
        self.instead.clicked.connect(self._use_simulator)

    def _show(self, *, is_open: bool, status: str) -> None:
        self._since, self._is_connected = None, False
        self.choice.show_open(is_open=is_open)
        self._status.setText(status)
        set_look(self._status, tone="", role="muted")
        self._refusal.hide()
        self._show_body()

    def _show_body(self) -> None:
        has_sensors = self.sensors.rowCount() > 0
        self._rest.setVisible(has_sensors)
        self._body.setVisible(has_sensors)
        self._empty.setVisible(not has_sensors)
        refused = not self._refusal.isHidden()
        for part in (self._empty_icon, self._empty_title, self._empty_text, self.instead):
            part.setVisible(not refused)
        self.instead.setVisible(not refused and not self.choice.is_open)
        if has_sensors and not self._had_sensors:
            self._need_room()
        self._had_sensors = has_sensors

    def _say_count(self) -> None:
        if not self._is_connected:
            return
        count = self.sensors.rowCount()
        words = self.tr("✔ Connected, {n} sensors") if count > 1 else self.tr("✔ Connected, one sensor")
        self._status.setText(words.format(n=count) if count else self.tr("✔ Connected"))
        set_look(self._status, tone="good")

    def _say_seconds(self) -> None:
        seconds = 0 if self._since is None else int(self._now - self._since)
        words = self.tr("Connecting… {n} s").format(n=seconds)
        if words != self._status.text():
            self._status.setText(words)

    def _pick(self, sensor: str) -> None:
        if sensor:
            self.panel.set_sensor(self.sensors.title_of(SensorId(sensor)))
        self.select_changed.emit(sensor)

    def _blink(self) -> None:
        sensor = self.selected()
        if sensor is not None:
            self.blink_requested.emit(sensor)

    def _try_again(self) -> None:
        self.source_chosen.emit(self.choice.source())

    def _use_simulator(self) -> None:
        self.choice.set_kind("synthetic")
        self.source_chosen.emit(self.choice.source())
