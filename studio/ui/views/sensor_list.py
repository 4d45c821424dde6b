"""The table of sensors: states in colour beside their words, a bar while a rest is measured."""

from PySide6.QtCore import QItemSelectionModel, QModelIndex, QPersistentModelIndex, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QResizeEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableView,
    QWidget,
)

from studio.core.sample import SensorId
from studio.ui.models.sensor_table import (
    MOVED_ROLE,
    SENSOR_ROLE,
    SHARE_ROLE,
    SIDE_ROLE,
    STATE_ROLE,
    Column,
    SensorTableModel,
    State,
)
from studio.ui.style_sheet import mixed
from studio.ui.theme import CONTROL, GAP, GAP_WIDE, GRID, Theme

WIDEST = {
    Column.NUMBER: "00",
    Column.NAME: "Kinetag 00",
    Column.PLACE: "■ right upper arm",
    Column.RATE: "▲ 100.0",
    Column.LOSS: "▲ 75.0",
    Column.BATTERY: "▲ 100",
    Column.TEMPERATURE: "-00",
    Column.STILL: "this one",
    Column.HEARD: "✖ 00 s ago",
    Column.LINK: "▂▄▆█",
    Column.OFFSET: "waits for rest",
}
"""What each column has room for; longer names and places are shortened."""
BAR = 4  # px
LEAST_ROWS = 4  # seen at any text size
MOVED = 0.45  # of the accent in the ground of the line that lights up

Index = QModelIndex | QPersistentModelIndex


class SensorList(QTableView):
    """One line for each sensor; the selection stays while numbers change."""

    picked = Signal(str)
    """The sensor that is selected now; empty for none."""

    def __init__(self, theme: Theme, model: SensorTableModel, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._model = model
        self._rooms: dict[Column, int] = {}
        self.setModel(model)
        self.setItemDelegate(_Cell(theme, self))
        self.setAccessibleName(self.tr("Sensors"))
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setEditTriggers(QAbstractItemView.EditTrigger.DoubleClicked | QAbstractItemView.EditTrigger.EditKeyPressed)
        self.setShowGrid(False)
        self.setTabKeyNavigation(False)
        self.setWordWrap(False)
        self.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.verticalHeader().hide()
        header = self.horizontalHeader()
        header.setAccessibleName(self.tr("Columns of the table of sensors"))
        header.setHighlightSections(False)
        header.setSectionsClickable(False)
        header.setMinimumSectionSize(CONTROL)
        header.setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
        self.selectionModel().currentRowChanged.connect(self._tell)
        model.rowsInserted.connect(self._select_first)
        model.rowsRemoved.connect(self._select_first)
        self.restyle()

    def sensor(self) -> SensorId | None:
        """Return the sensor that is selected."""
        index = self.currentIndex()
        return SensorId(index.data(SENSOR_ROLE)) if index.isValid() else None

    def select(self, sensor: SensorId) -> None:
        """Select a sensor."""
        row = self._model.row_of(sensor)
        if row >= 0:
            flags = QItemSelectionModel.SelectionFlag.ClearAndSelect | QItemSelectionModel.SelectionFlag.Rows
            self.selectionModel().setCurrentIndex(self._model.index(row, Column.NAME), flags)

    def rename(self) -> None:
        """Begin to edit the name of the sensor that is selected."""
        index = self.currentIndex()
        if index.isValid():
            self.edit(self._model.index(index.row(), Column.NAME))

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.setFont(self._theme.font("body"))
        cells = QFontMetrics(self._theme.font("body"))
        heads = QFontMetrics(self._theme.font("caption"))
        self.verticalHeader().setDefaultSectionSize(max(cells.height() + 2 * GRID, CONTROL - GRID))
        for column, widest in WIDEST.items():
            head = str(self._model.headerData(column, Qt.Orientation.Horizontal))
            room = max(cells.horizontalAdvance(widest), heads.horizontalAdvance(head)) + 2 * GAP + GRID
            self._rooms[column] = room
        self._share_width()
        header = self.horizontalHeader()
        header.setFixedHeight(heads.height() + 3 * GRID)
        self.setMinimumHeight(header.height() + LEAST_ROWS * self.verticalHeader().defaultSectionSize() + GAP_WIDE)
        self.viewport().update()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Give names the room that is left; below their least the table scrolls."""
        super().resizeEvent(event)
        self._share_width()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 (Qt's name)
        """Show the first lines, or the selected one when it is further down."""
        super().showEvent(event)
        self.scrollToTop()
        self.scrollTo(self.currentIndex())

    def _share_width(self) -> None:
        others = sum(self._rooms.values()) - self._rooms[Column.NAME]
        for column, room in self._rooms.items():
            left = self.viewport().width() - others
            self.horizontalHeader().resizeSection(column, max(room, left) if column is Column.NAME else room)

    def _select_first(self) -> None:
        if not self.currentIndex().isValid() and self._model.rowCount():
            self.select(self._model.sensor_at(0))

    def _tell(self, current: QModelIndex) -> None:
        self.picked.emit(str(current.data(SENSOR_ROLE)) if current.isValid() else "")


class _Cell(QStyledItemDelegate):
    """Paints states, sides and the bar; the rest is the style's."""

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme

    def initStyleOption(self, option: QStyleOptionViewItem, index: Index) -> None:  # noqa: N802 (Qt's name)
        """Shorten names in the middle; lines are focused, not cells."""
        super().initStyleOption(option, index)
        option.textElideMode = Qt.TextElideMode.ElideMiddle

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint ground, words and marks."""
        tokens = self._theme.tokens
        rect, state = option.rect, option.state
        selected = bool(state & QStyle.StateFlag.State_Selected)
        ground = mixed(tokens.panel, tokens.accent, 0.18) if selected else tokens.panel
        if index.data(MOVED_ROLE):
            ground = mixed(ground, tokens.accent, MOVED)
        elif state & QStyle.StateFlag.State_MouseOver and not selected:
            ground = mixed(tokens.panel, tokens.text, 0.07)
        painter.save()
        painter.fillRect(rect, QColor(ground))
        if selected and index.column() == 0:
            painter.fillRect(rect.x(), rect.y(), 3, rect.height(), QColor(tokens.accent))
        self._paint_words(painter, QRectF(rect).adjusted(GAP, 0, -GAP, 0), index)
        painter.restore()

    def _paint_words(self, painter: QPainter, room: QRectF, index: Index) -> None:
        tokens = self._theme.tokens
        colours = {
            State.PLAIN: tokens.text,
            State.MUTED: tokens.muted,
            State.GOOD: tokens.good,
            State.WARN: tokens.warn,
            State.BAD: tokens.bad,
        }
        painter.setFont(self._theme.font("body"))
        side = index.data(SIDE_ROLE)
        if side:
            painter.setPen(QColor(tokens.left if side == "left" else tokens.right))
            mark = "●" if side == "left" else "■"
            painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, mark)
            room = room.adjusted(painter.fontMetrics().horizontalAdvance("■ "), 0, 0, 0)
        share = index.data(SHARE_ROLE)
        if share:
            self._paint_bar(painter, room, float(share))
            room = room.adjusted(0, 0, 0, -BAR)
        painter.setPen(QColor(colours[State(index.data(STATE_ROLE))]))
        words = painter.fontMetrics().elidedText(str(index.data()), Qt.TextElideMode.ElideMiddle, int(room.width()))
        painter.drawText(room, index.data(Qt.ItemDataRole.TextAlignmentRole), words)

    def _paint_bar(self, painter: QPainter, room: QRectF, share: float) -> None:
        tokens = self._theme.tokens
        whole = QRectF(room.left(), room.bottom() - BAR - 2, room.width(), BAR)
        painter.fillRect(whole, QColor(tokens.line))
        painter.fillRect(QRectF(whole.left(), whole.top(), whole.width() * share, BAR), QColor(tokens.accent))
