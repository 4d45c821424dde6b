"""One place of the body on the map: a real button, so that keyboard and screen readers find it."""

from PySide6.QtCore import QEvent, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPainterPath, QPaintEvent, QPen
from PySide6.QtWidgets import QAbstractButton, QWidget

from studio.core.body import Place
from studio.ui.models.assignment_model import PlaceLook, PlaceState, SensorState
from studio.ui.models.place_words import PlaceWords
from studio.ui.style_sheet import mixed
from studio.ui.theme import FOCUS, GRID, Theme

SMALLEST = 28  # px, of the badge; with its margin a target of 44
MARGIN = 8  # px around the badge, for focus ring and warning
ARROWS = {
    Qt.Key.Key_Left: (-1, 0),
    Qt.Key.Key_Right: (1, 0),
    Qt.Key.Key_Up: (0, -1),
    Qt.Key.Key_Down: (0, 1),
}


class PlaceMark(QAbstractButton):
    """Left: a disc. Right: a square. Middle: between both."""

    left_towards = Signal(object)
    """(x, y) of an arrow key: the neighbour there is to be focused."""

    def __init__(self, theme: Theme, place: Place, parent: QWidget) -> None:
        super().__init__(parent)
        self.place = place
        self.look = PlaceLook(PlaceState.EMPTY)
        self._theme = theme
        self._name = place.value.replace("_", " ").capitalize()
        self.setCheckable(True)
        self.setCursor(Qt.CursorShape.PointingHandCursor)
        self.restyle()

    @property
    def name(self) -> str:
        """The place's name for people."""
        return self._name

    def set_words(self, words: PlaceWords) -> None:
        """Take over what the place is called and what it measures."""
        self._name = words.name
        self.setToolTip(f"{words.name}\n{words.measurand}")
        self.setAccessibleDescription(words.measurand)
        self._tell()

    def show_look(self, look: PlaceLook) -> None:
        """Show another state."""
        if look != self.look:
            self.look = look
            self._tell()
            self.update()

    def restyle(self) -> None:
        """Take over colours and text size."""
        side = max(SMALLEST, round(1.6 * self._theme.pixels("body")) + GRID) + 2 * MARGIN
        self.resize(side, side)
        self._tell()
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the size of the target."""
        return self.size()

    def nextCheckState(self) -> None:  # noqa: N802 (Qt's name)
        """Do nothing: the model says what is selected."""

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Arrows go to the neighbour, Enter chooses as Space does."""
        key = Qt.Key(event.key())
        if key in ARROWS:
            self.left_towards.emit(ARROWS[key])
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.click()
        else:
            super().keyPressEvent(event)

    def enterEvent(self, event: QEvent) -> None:  # noqa: N802 (Qt's name)
        """Show that it can be clicked."""
        self.update()

    def leaveEvent(self, event: QEvent) -> None:  # noqa: N802 (Qt's name)
        """Show it no more."""
        self.update()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint the badge with the tag's number."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        badge = QRectF(self.rect()).adjusted(MARGIN, MARGIN, -MARGIN, -MARGIN)
        self._paint_badge(painter, self._shape(badge))
        self._paint_number(painter, badge)
        if self.look.state is PlaceState.WARNING:
            self._paint_warning(painter)
        if self.hasFocus():
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.setPen(QPen(QColor(self._theme.tokens.accent), FOCUS))
            painter.drawPath(self._shape(QRectF(self.rect()).adjusted(5, 5, -5, -5)))
        painter.end()

    def _shape(self, room: QRectF) -> QPainterPath:
        shape = QPainterPath()
        if self.place.value.startswith("left"):
            shape.addEllipse(room)
        elif self.place.value.startswith("right"):
            shape.addRoundedRect(room.adjusted(1, 1, -1, -1), 3, 3)
        else:
            shape.addRoundedRect(room, room.height() * 0.3, room.height() * 0.3)
        return shape

    def _colour(self) -> QColor:
        tokens = self._theme.tokens
        side = self.place.value.partition("_")[0]
        return QColor({"left": tokens.left, "right": tokens.right}.get(side, mixed(tokens.text, tokens.panel, 0.15)))

    def _paint_badge(self, painter: QPainter, shape: QPainterPath) -> None:
        tokens = self._theme.tokens
        colour = self._colour()
        if self.look.sensor is not None:
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(colour.lighter(112) if self.underMouse() else colour)
        else:
            wanted = self.look.state is PlaceState.MISSING
            pen = QPen(colour if wanted else QColor(tokens.muted), 2 if wanted else 1.2)
            if wanted:
                pen.setDashPattern([2.5, 2.0])
            painter.setPen(pen)
            painter.setBrush(QColor(tokens.raised if self.underMouse() else tokens.window))
        painter.drawPath(shape)

    def _paint_number(self, painter: QPainter, badge: QRectF) -> None:
        tokens, sensor = self._theme.tokens, self.look.sensor
        font = self._theme.font("body", bold=True)
        if sensor is not None:
            painter.setPen(QColor(tokens.on_accent if self._theme.is_dark else tokens.panel))
            text = f"{sensor.number:02d}" if sensor.number else "✓"
        else:
            painter.setPen(QColor(tokens.text if self.look.state is PlaceState.MISSING else tokens.muted))
            text = "+"
        painter.setFont(font)
        painter.drawText(badge, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_warning(self, painter: QPainter) -> None:
        tokens = self._theme.tokens
        side = self.width() * 0.36
        right, top = float(self.width()), 0.0
        triangle = QPainterPath(QPointF(right - side / 2, top + 1))
        triangle.lineTo(right - 1, top + side - 1)
        triangle.lineTo(right - side + 1, top + side - 1)
        triangle.closeSubpath()
        painter.setPen(QPen(QColor(tokens.window), 2))
        painter.setBrush(QColor(tokens.warn))
        painter.drawPath(triangle)
        painter.setPen(QPen(QColor(tokens.window), 1.6))
        middle = right - side / 2
        painter.drawLine(QPointF(middle, top + side * 0.38), QPointF(middle, top + side * 0.62))
        painter.drawPoint(QPointF(middle, top + side * 0.8))

    def _tell(self) -> None:
        self.setChecked(self.look.is_selected)
        self.setAccessibleName(self._spoken())

    def _spoken(self) -> str:
        sensor = self.look.sensor
        if sensor is None:
            text = self.tr("{place}, no tag") if self.look.state is PlaceState.MISSING else self.tr("{place}, not used")
            text = text.format(place=self._name)
        else:
            states = {
                SensorState.GOOD: self.tr("good"),
                SensorState.WEAK: self.tr("weak"),
                SensorState.SILENT: self.tr("silent"),
            }
            tag = f"{sensor.number:02d}" if sensor.number else sensor.name
            text = self.tr("{place}, tag {tag}, {state}")
            text = text.format(place=self._name, tag=tag, state=states[sensor.state])
        return text + self.tr(", waits for a tag") if self.look.is_pulsing else text
