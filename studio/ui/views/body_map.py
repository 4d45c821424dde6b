"""The body with its 15 places, from behind or face to face; each place is a button."""

import math
from collections.abc import Mapping

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen, QResizeEvent
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from studio.core.body import PLACES, Place
from studio.ui.models.assignment_model import PlaceLook
from studio.ui.models.place_words import PlaceWords
from studio.ui.style_sheet import mixed
from studio.ui.theme import GAP, GRID, Theme
from studio.ui.views.body_shapes import HEIGHT, details, fitted, silhouette, spot
from studio.ui.views.place_mark import PlaceMark

MARGIN = 20.0  # px around the figure, for the marks of head and feet
PULSE = 1.2  # s from one ring to the next
LABEL_ROOM = 2.0  # px between a mark and its name
MIDDLE = (Place.HEAD, Place.CHEST, Place.PELVIS)


class BodyMap(QWidget):
    """Figure, places, and which way it is seen."""

    place_chosen = Signal(Place)
    facing_changed = Signal(bool)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.figure = BodyFigure(theme, self)
        self.behind = QPushButton(self.tr("From behind"), self)
        self.face_me = QPushButton(self.tr("Face me"), self)
        self._caption = QLabel(self)
        self._build()
        self.set_facing(facing=False)

    @property
    def marks(self) -> Mapping[Place, PlaceMark]:
        """The button of each place."""
        return self.figure.marks

    def set_words(self, words: Mapping[Place, PlaceWords]) -> None:
        """Name the places."""
        for place, mark in self.marks.items():
            mark.set_words(words[place])
        self.figure.update()

    def show_looks(self, looks: Mapping[Place, PlaceLook]) -> None:
        """Show the state of the places."""
        for place, look in looks.items():
            self.marks[place].show_look(look)
        self.figure.update()

    def set_facing(self, *, facing: bool) -> None:
        """Show the person face to face, or from behind."""
        (self.face_me if facing else self.behind).setChecked(True)
        self._caption.setText(
            self.tr("The performer faces you: their left is on your right")
            if facing
            else self.tr("Seen from behind: the performer's left is on your left")
        )
        self.figure.set_facing(facing=facing)

    def focus_place(self, place: Place) -> None:
        """Give a place the keyboard."""
        self.figure.focus_place(place)

    def tick(self, now: float) -> None:
        """Let the ring of the waiting place grow."""
        self.figure.tick(now)

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.figure.restyle()

    def _build(self) -> None:
        views = QButtonGroup(self)
        row = QHBoxLayout()
        row.setSpacing(GRID)
        row.addStretch(1)
        for button in (self.behind, self.face_me):
            button.setProperty("kind", "segment")
            button.setCheckable(True)
            button.setAccessibleName(self.tr("View: {view}").format(view=button.text()))
            views.addButton(button)
            row.addWidget(button)
        row.addStretch(1)
        views.buttonClicked.connect(self._change_view)
        self._caption.setProperty("role", "caption")
        self._caption.setAlignment(Qt.AlignmentFlag.AlignHCenter)
        self._caption.setWordWrap(True)
        self.figure.place_chosen.connect(self.place_chosen)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GAP)
        column.addLayout(row)
        column.addWidget(self.figure, 1)
        column.addWidget(self._caption)

    def _change_view(self) -> None:
        facing = self.face_me.isChecked()
        self.set_facing(facing=facing)
        self.facing_changed.emit(facing)


class BodyFigure(QWidget):
    """Paints the person and the names, and carries the places as children."""

    place_chosen = Signal(Place)

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme
        self._facing = False
        self._now = 0.0
        self._pulses = False
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setAccessibleName(self.tr("Places of the body"))
        self.marks = {place: PlaceMark(theme, place, self) for place in PLACES}
        for mark in self.marks.values():
            mark.clicked.connect(self._choose)
            mark.left_towards.connect(self._go)
        self._let_tab_reach(Place.HEAD)

    def set_facing(self, *, facing: bool) -> None:
        """Turn the person."""
        self._facing = facing
        self._place_marks()
        self.update()

    def focus_place(self, place: Place) -> None:
        """Give a place the keyboard; Tab comes back to it."""
        self._let_tab_reach(place)
        self.marks[place].setFocus(Qt.FocusReason.OtherFocusReason)

    def tick(self, now: float) -> None:
        """Let the ring of the waiting place grow."""
        waits = any(mark.look.is_pulsing for mark in self.marks.values())
        self._now = now
        if (waits or self._pulses) and not self._theme.reduced_motion:
            self.update()
        self._pulses = waits

    def restyle(self) -> None:
        """Take over colours and text size."""
        for mark in self.marks.values():
            mark.restyle()
        self._place_marks()
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return a comfortable size."""
        return QSize(480, 540)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the size below which the targets of hand and forearm would meet."""
        side = self.marks[Place.HEAD].width()
        return QSize(round(side * 6), round(side * 8.8))

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Put the places where the figure is."""
        self._place_marks()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint the person, the sides, the names, and what surrounds the places."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        scale, origin = self._fit()
        self._paint_person(painter, scale, origin)
        self._paint_sides(painter, scale, origin)
        self._paint_names(painter, scale)
        for mark in self.marks.values():
            self._paint_halo(painter, mark)
        painter.end()

    def _fit(self) -> tuple[float, QPointF]:
        return fitted(QRectF(self.rect()).adjusted(0, MARGIN, 0, -MARGIN))

    def _place_marks(self) -> None:
        scale, origin = self._fit()
        for place, mark in self.marks.items():
            x, y = spot(place, facing=self._facing)
            middle = QPointF(origin.x() + scale * x, origin.y() + scale * y)
            mark.move(round(middle.x() - mark.width() / 2), round(middle.y() - mark.height() / 2))

    def _paint_person(self, painter: QPainter, scale: float, origin: QPointF) -> None:
        tokens = self._theme.tokens
        painter.save()
        painter.translate(origin)
        painter.scale(scale, scale)
        pen = QPen(QColor(mixed(tokens.window, tokens.text, 0.30)), 1.5 / scale)
        painter.setPen(pen)
        painter.setBrush(QColor(mixed(tokens.window, tokens.text, 0.09)))
        painter.drawPath(silhouette())
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.drawPath(details(facing=self._facing))
        painter.restore()

    def _paint_sides(self, painter: QPainter, scale: float, origin: QPointF) -> None:
        tokens = self._theme.tokens
        font = self._theme.font("section", bold=True)
        painter.setFont(font)
        line = painter.fontMetrics().height()
        for text, colour, x in (
            (self.tr("● L"), tokens.left, 40.0 if self._facing else -40.0),
            (self.tr("■ R"), tokens.right, -40.0 if self._facing else 40.0),
        ):
            middle = QPointF(origin.x() + scale * x, origin.y() + scale * 28)
            painter.setPen(QColor(colour))
            room = QRectF(middle.x() - 3 * line, middle.y() - line, 6 * line, 2 * line)
            painter.drawText(room, Qt.AlignmentFlag.AlignCenter, text)

    def _paint_names(self, painter: QPainter, scale: float) -> None:
        """Write the names beside the places, all of them or none."""
        painter.setFont(self._theme.font("caption"))
        painter.setPen(QColor(self._theme.tokens.muted))
        wrap = int(Qt.TextFlag.TextWordWrap)
        rooms = {place: self._name_room(place, scale) for place in PLACES}
        for place, (room, flags) in rooms.items():
            needed = painter.boundingRect(room, flags | wrap, self.marks[place].name)
            if needed.width() > room.width() + 1 or needed.height() > room.height() + 1:
                return
        for place, (room, flags) in rooms.items():
            painter.drawText(room, flags | wrap, self.marks[place].name)

    def _name_room(self, place: Place, scale: float) -> tuple[QRectF, int]:
        box = QRectF(self.marks[place].geometry())
        line = self._theme.pixels("caption") * 1.4
        if place in (Place.CHEST, Place.PELVIS):
            room = QRectF(box.center().x() - 15 * scale, box.bottom() - 2 * GRID, 30 * scale, 2.2 * line)
            return room, int(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
        top = box.center().y() - 1.2 * line
        if place is Place.HEAD:
            room = QRectF(box.center().x() + 12 * scale, top - line, 26 * scale, 2.4 * line)
            return room, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        if box.center().x() < self.width() / 2:
            room = QRectF(0, top, box.left() - LABEL_ROOM, 2.4 * line)
            return room, int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        left = box.right() + LABEL_ROOM
        room = QRectF(left, top, self.width() - left, 2.4 * line)
        return room, int(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)

    def _paint_halo(self, painter: QPainter, mark: PlaceMark) -> None:
        accent = QColor(self._theme.tokens.accent)
        middle, radius = QRectF(mark.geometry()).center(), mark.width() / 2 - 5
        painter.setBrush(Qt.BrushStyle.NoBrush)
        if mark.look.is_selected:
            painter.setPen(QPen(accent, 3))
            painter.drawEllipse(middle, radius + 3, radius + 3)
        if mark.look.is_pulsing:
            still = self._theme.reduced_motion
            phase = 0.5 if still else math.fmod(self._now, PULSE) / PULSE
            painter.setPen(QPen(accent, 2))
            painter.drawEllipse(middle, radius + 2, radius + 2)
            accent.setAlphaF(1.0 if still else 1.0 - phase)
            painter.setPen(QPen(accent, 3))
            painter.drawEllipse(middle, radius + 4 + 14 * phase, radius + 4 + 14 * phase)

    def _choose(self) -> None:
        mark = self.sender()
        if isinstance(mark, PlaceMark):
            self._let_tab_reach(mark.place)
            self.place_chosen.emit(mark.place)

    def _go(self, towards: tuple[int, int]) -> None:
        mark = self.sender()
        if not isinstance(mark, PlaceMark):
            return
        here = spot(mark.place, facing=self._facing)
        best = min(PLACES, key=lambda place: _effort(here, spot(place, facing=self._facing), towards))
        if math.isfinite(_effort(here, spot(best, facing=self._facing), towards)):
            self.focus_place(best)

    def _let_tab_reach(self, place: Place) -> None:
        """Let Tab stop at one place only: arrows do the rest."""
        for other, mark in self.marks.items():
            mark.setFocusPolicy(Qt.FocusPolicy.StrongFocus if other is place else Qt.FocusPolicy.ClickFocus)


def _effort(here: tuple[float, float], there: tuple[float, float], towards: tuple[int, int]) -> float:
    """Return how far a place is in the direction of an arrow key; infinite when it is not there at all."""
    x, y = there[0] - here[0], there[1] - here[1]
    along = x * towards[0] + y * towards[1]
    across = abs(x * towards[1]) + abs(y * towards[0])
    return along + 2 * across if along > HEIGHT / 100 else math.inf
