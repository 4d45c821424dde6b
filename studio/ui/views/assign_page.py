"""Assign: which tag sits where. The body on the left, tags and tools on the right."""

from collections.abc import Mapping

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import (
    QComboBox,
    QFrame,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QSpinBox,
    QVBoxLayout,
    QWidget,
)

from studio.core.body import PLACES, Place
from studio.core.sample import SensorId
from studio.ui.models.assignment_model import PRESET_NAMES, AssignmentModel, KnownSensor, SensorState
from studio.ui.models.place_words import PlaceWords
from studio.ui.style_sheet import set_look
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.body_map import BodyMap
from studio.ui.views.side_panel import SidePanel

PANEL = 380  # px at 100 % text
SHARE = 0.52  # of the page that the panel may take when text is large
LIST_ROWS = 3  # tags that are seen without scrolling
SENSOR = Qt.ItemDataRole.UserRole
STATURES = (50, 250)  # cm; from a child who can just stand to the tallest person on record (251 cm, living)


class TagList(QListWidget):
    """Content with a few rows; what is left of the page makes it longer."""

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the smallest size."""
        return QSize(super().sizeHint().width(), self.minimumHeight())


class AssignPage(QWidget):
    """Renders the assignment; every press goes to the model."""

    stature_chosen = Signal(float)
    """Height of the person, m."""

    def __init__(
        self,
        theme: Theme,
        model: AssignmentModel,
        words: Mapping[Place, PlaceWords],
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(parent)
        self._theme = theme
        self._model = model
        self._words = words
        self.map = BodyMap(theme, self)
        self._build()
        self.set_words(words)
        self.map.place_chosen.connect(model.choose_place)
        model.changed.connect(self.refresh)
        self.restyle()

    def set_words(self, words: Mapping[Place, PlaceWords]) -> None:
        """Name the places otherwise: for clinic or studio."""
        self._words = words
        self.map.set_words(words)
        self.refresh()

    def moved(self, sensor: SensorId) -> None:
        """A sensor is being moved: it goes to the place that waits."""
        self._model.moved(sensor)

    def show_stature(self, stature: float, *, known: bool) -> None:
        """Show the height of the person, m; one that nobody entered is said to be assumed."""
        with QSignalBlocker(self.stature):
            self.stature.setValue(round(100 * stature))
        self._stature_hint.setText("" if known else self.tr("assumed: enter the real height"))
        self._stature_hint.setVisible(not known)

    def tick(self, now: float) -> None:
        """Let the waiting place pulse."""
        self.map.tick(now)

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.map.restyle()
        self._panel.fit(self.width())
        self._fit_list()

    def refresh(self) -> None:
        """Show what the model says."""
        model = self._model
        self.map.show_looks({place: model.look(place) for place in PLACES})
        self._show_summary()
        self._show_tags()
        self._show_place()
        self.hint.setText(self._hint())
        with QSignalBlocker(self.preset):
            self.preset.setCurrentIndex(PRESET_NAMES.index(model.preset))
        self.undo.setEnabled(model.can_undo)
        self.redo.setEnabled(model.can_redo)
        worn = model.assignment.places()
        self.clear.setEnabled(bool(worn))
        self.by_number.setEnabled(any(known.number for known in model.unassigned) and bool(model.missing))
        self.cross.setEnabled(any(place.value.endswith(("shank", "foot")) for place in worn))
        self.move_one.setChecked(model.waiting is not None)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Share the width anew."""
        self._panel.fit(self.width())

    def _fit_list(self) -> None:
        count = self.tags.count()
        row = max(self.tags.sizeHintForRow(0), self._theme.pixels("body")) if count else 0
        self.tags.setMinimumHeight(min(count, LIST_ROWS) * row + GAP)
        self.tags.setMaximumHeight(count * row + GAP)

    def _build(self) -> None:
        self._panel = SidePanel(self._theme, PANEL, SHARE, GAP_PAGE, self)
        column = self._panel.column
        self._build_tags(column)
        column.addSpacing(GAP)
        column.addWidget(self._build_card())
        column.addSpacing(GAP)
        self._build_tools(column)
        column.addSpacing(GAP)
        self._build_stature(column)
        column.addStretch(1)
        page = QHBoxLayout(self)
        page.setContentsMargins(0, 0, 0, 0)
        page.setSpacing(0)
        left = QVBoxLayout()
        left.setContentsMargins(GAP_PAGE, GAP_WIDE, GAP_PAGE, GAP_WIDE)
        left.addWidget(self.map)
        page.addLayout(left, 1)
        page.addWidget(self._panel)

    def _build_tags(self, column: QVBoxLayout) -> None:
        self.summary = self._label("section")
        self.hint = self._label("muted")
        self.tags = TagList(self)
        self.tags.setAccessibleName(self.tr("Tags without a place"))
        self.tags.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.tags.setTextElideMode(Qt.TextElideMode.ElideMiddle)
        self.tags.itemClicked.connect(self._choose_tag)
        self.tags.itemActivated.connect(self._choose_tag)
        self.no_tags = self._label("muted")
        column.addWidget(self.summary)
        column.addWidget(self.hint)
        column.addWidget(self.tags, 100)
        column.addWidget(self.no_tags)
        self.move_one = self._button(self.tr("Move one sensor"), self._toggle_moving)
        self.move_one.setCheckable(True)
        self.move_one.setAccessibleDescription(self.tr("The tag that is moved goes to the place that pulses"))
        column.addWidget(self.move_one)

    def _build_card(self) -> QFrame:
        card = QFrame(self)
        card.setProperty("ground", "raised")
        self.place_name, self.place_tag = self._label("section"), self._label("")
        self.measurand, self.strap = self._label("muted"), self._label("muted")
        self.take_off = self._button(self.tr("Take off"), self._model.clear_place)
        self.exchange = self._button(self.tr("Exchange with…"), self._model.begin_exchange)
        self.exchange.setCheckable(True)
        rows = QVBoxLayout(card)
        rows.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        rows.setSpacing(GRID)
        for label in (self.place_name, self.place_tag, self.measurand, self.strap):
            rows.addWidget(label)
        buttons = QHBoxLayout()
        buttons.setSpacing(GAP)
        buttons.addWidget(self.take_off)
        buttons.addWidget(self.exchange)
        buttons.addStretch(1)
        rows.addSpacing(GRID)
        rows.addLayout(buttons)
        return card

    def _build_tools(self, column: QVBoxLayout) -> None:
        self.preset = QComboBox(self)
        self.preset.setAccessibleName(self.tr("Places in use"))
        texts = (self.tr("Full body, 15"), self.tr("Upper body, 8"), self.tr("Legs, 7"), self.tr("Own choice"))
        for name, text in zip(PRESET_NAMES, texts, strict=True):
            self.preset.addItem(text, name)
        self.preset.currentIndexChanged.connect(self._choose_preset)
        self.by_number = self._button(self.tr("By number"), self._model.assign_by_number)
        self.by_number.setToolTip(self.tr("Tag 01 to the head, tag 02 to the chest, and so on"))
        self.by_number.setAccessibleDescription(self.by_number.toolTip())
        self.cross = self._button(self.tr("Shanks ⇄ feet"), self._model.exchange_shanks_and_feet)
        self.cross.setToolTip(self.tr("Exchange the tags of shanks and feet (12/13 and 14/15)"))
        self.cross.setAccessibleName(self.cross.toolTip())
        self.undo = self._button(self.tr("Undo"), self._model.undo)
        self.redo = self._button(self.tr("Redo"), self._model.redo)
        self.clear = self._button(self.tr("Take all off"), self._model.clear)
        for button in (self.undo, self.redo, self.clear):
            button.setProperty("kind", "quiet")
        grid = QGridLayout()
        grid.setSpacing(GAP)
        grid.addWidget(self.preset, 0, 0, 1, 2)
        grid.addWidget(self.by_number, 1, 0)
        grid.addWidget(self.cross, 1, 1)
        column.addLayout(grid)
        last = QHBoxLayout()
        last.setSpacing(GRID)
        last.addWidget(self.undo)
        last.addWidget(self.redo)
        last.addStretch(1)
        last.addWidget(self.clear)
        column.addLayout(last)

    def _build_stature(self, column: QVBoxLayout) -> None:
        words = QLabel(self.tr("Height of the person"), self)
        self.stature = QSpinBox(self)
        self.stature.setRange(*STATURES)
        self.stature.setSuffix(self.tr(" cm"))
        self.stature.setAccessibleName(words.text())
        self.stature.setKeyboardTracking(False)
        self.stature.valueChanged.connect(self._choose_stature)
        self._stature_hint = self._label("muted")
        row = QHBoxLayout()
        row.setSpacing(GAP)
        row.addWidget(words, 1)
        row.addWidget(self.stature)
        column.addLayout(row)
        column.addWidget(self._stature_hint)

    def _label(self, role: str) -> QLabel:
        label = QLabel(self)
        label.setWordWrap(True)
        if role:
            label.setProperty("role", role)
        return label

    def _button(self, text: str, pressed: object) -> QPushButton:
        button = QPushButton(text, self)
        button.setAccessibleName(text)
        button.clicked.connect(pressed)
        return button

    def _show_summary(self) -> None:
        worn, wanted = len(self._model.assignment.places()), len(self._model.wanted)
        text = self.tr("{worn} of {wanted} places have a tag").format(worn=worn, wanted=max(wanted, worn))
        self.summary.setText(text)

    def _show_tags(self) -> None:
        free = self._model.unassigned
        shown = [self.tags.item(row).data(SENSOR) for row in range(self.tags.count())]
        if shown != [known.sensor for known in free]:
            self.tags.clear()
            for known in free:
                item = QListWidgetItem(self.tags)
                item.setData(SENSOR, known.sensor)
        with QSignalBlocker(self.tags):
            for row, known in enumerate(free):
                item = self.tags.item(row)
                item.setText(self._tag_words(known))
                item.setToolTip(str(known.sensor))
                item.setSelected(known.sensor == self._model.sensor)
        self._fit_list()
        self.tags.setVisible(bool(free))
        self.no_tags.setVisible(not free)
        nobody = not self._model.assignment.sensors
        self.no_tags.setText(
            self.tr("No tags yet. Connect a source first; its tags then appear here.")
            if nobody
            else self.tr("Every tag has a place.")
        )
        self.move_one.setEnabled(bool(free) or self._model.waiting is not None)

    def _show_place(self) -> None:
        place = self._model.place or self._model.waiting
        worn = self._model.worn_at(place) if place is not None else None
        self.place_tag.setVisible(place is not None)
        self.strap.setVisible(place is not None)
        self.take_off.setVisible(place is not None)
        self.exchange.setVisible(place is not None)
        self.take_off.setEnabled(worn is not None)
        self.exchange.setEnabled(worn is not None)
        self.exchange.setChecked(self._model.is_exchanging)
        if place is None:
            self.place_name.setText(self.tr("No place chosen"))
            self.measurand.setText(self.tr("Choose one to see what it measures and where its strap goes."))
            return
        words = self._words[place]
        self.place_name.setText(self.tr("{number}  {name}").format(number=place.number, name=words.name))
        self.place_tag.setText(self.tr("No tag") if worn is None else self._tag_words(worn))
        weak = worn is not None and worn.state is not SensorState.GOOD
        set_look(self.place_tag, tone="warn" if weak else "")
        self.measurand.setText(self.tr("Measures: {what}").format(what=words.measurand))
        self.strap.setText(self.tr("Strap: {where}").format(where=words.strap))

    def _hint(self) -> str:
        model = self._model
        if model.waiting is not None:
            name = self._words[model.waiting].name
            return self.tr("Move the tag for: {place}. It goes to the place that pulses.").format(place=name)
        if model.place is not None:
            name = self._words[model.place].name
            text = self.tr("{place}: now choose a tag.")
            if model.is_exchanging:
                text = self.tr("{place}: now choose the place to exchange with.")
            elif not model.unassigned:
                text = self.tr("{place}: no tag is free.")
            return text.format(place=name)
        if model.sensor is not None:
            chosen = next((known for known in model.unassigned if known.sensor == model.sensor), None)
            return self.tr("{tag}: now choose its place.").format(tag=chosen.name if chosen else model.sensor)
        return self.tr("Choose a place and a tag, in either order.")

    def _tag_words(self, known: KnownSensor) -> str:
        states = {
            SensorState.GOOD: self.tr("good"),
            SensorState.WEAK: self.tr("▲ weak"),
            SensorState.SILENT: self.tr("▲ silent"),
        }
        number = f"{known.number:02d}" if known.number else "–"
        return self.tr("{number}   {name}   {state}").format(number=number, name=known.name, state=states[known.state])

    def _choose_tag(self, item: QListWidgetItem) -> None:
        self._model.choose_sensor(SensorId(str(item.data(SENSOR))))

    def _choose_preset(self, row: int) -> None:
        self._model.choose_preset(PRESET_NAMES[row])

    def _choose_stature(self, centimetres: int) -> None:
        self._stature_hint.hide()
        self.stature_chosen.emit(centimetres / 100)

    def _toggle_moving(self) -> None:
        if self._model.waiting is None:
            self._model.begin_moving()
        else:
            self._model.end_moving()
