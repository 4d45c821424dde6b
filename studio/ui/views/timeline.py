"""A take from left to right: an angle's envelope, what is lost, what was marked, and the line that plays."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QBrush,
    QColor,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
    QPolygonF,
    QResizeEvent,
)
from PySide6.QtWidgets import QAbstractSlider, QSizePolicy, QWidget

from studio.core.take import Mark
from studio.ui.fact_words import POSES
from studio.ui.models.playhead import LONG_STEP, Playhead, clock
from studio.ui.models.take_review import Stretch, TakeReview, envelope, gaps, in_words, lost_share, side_of
from studio.ui.style_sheet import mixed
from studio.ui.theme import FOCUS, GAP, GRID, RADIUS, Theme

BAND = 48  # px, height of the envelope
COLUMN = 2  # px, width of one column of the envelope
NEAR = 6  # px; a click so near to a mark means the mark
LEAST_STRETCH = 2.0  # px; a shorter gap is drawn this wide, so that it is seen
GAP_S = 0.1  # s; a longer gap is hatched, what is shorter stands below as a bar
LOSS_HEIGHT = 10.0  # px of the bar where everything is missing
STEPS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600)  # s between times
LINE, BELOW = 0.7, 0.2  # of the side's colour in the envelope and below it: the line in front must stand out


class Flag(NamedTuple):
    """A mark as it is drawn."""

    x: float
    to_x: float
    words: str
    colour: str
    time: float


class Timeline(QAbstractSlider):
    """A slider over the frames of a take: keys, wheel and screen readers work it like one."""

    scrubbed = Signal(float)
    """s; somebody asked for this time."""

    def __init__(self, theme: Theme, playhead: Playhead, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._playhead = playhead
        self._review: TakeReview | None = None
        self._angle = ""
        self._ground: QPixmap | None = None
        self._flags: Sequence[Flag] = ()
        self.setOrientation(Qt.Orientation.Horizontal)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setMouseTracking(True)
        self.setSingleStep(1)
        self.setPageStep(LONG_STEP)
        self.setAccessibleName(self.tr("Time in the take"))
        self.setEnabled(False)
        playhead.moved.connect(self._on_moved)
        playhead.changed.connect(self._on_changed)
        self._on_changed()

    def show_take(self, review: TakeReview | None, angle: str) -> None:
        """Show a take with the envelope of one angle; nothing for None."""
        self._review, self._angle = review, angle
        self.setEnabled(review is not None)
        self._draw_anew()

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        self.updateGeometry()
        self._draw_anew()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return room for flags, envelope and times."""
        return QSize(640, round(self._flag_height() + BAND + self._time_height() + 2 * FOCUS))

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the same height."""
        return QSize(160, self.sizeHint().height())

    def area(self) -> QRectF:
        """Return where the envelope is drawn, px."""
        return QRectF(GAP, FOCUS + self._flag_height(), max(self.width() - 2.0 * GAP, 1.0), BAND)

    def x_of(self, time: float) -> float:
        """Return where a time stands, px."""
        area, duration = self.area(), self._playhead.duration
        return area.left() + area.width() * (time / duration if duration > 0.0 else 0.0)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint what stays, and the line that plays."""
        ratio = self.devicePixelRatioF()
        if self._ground is None or self._ground.devicePixelRatio() != ratio:
            self._ground = self._drawn(ratio)
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.drawPixmap(0, 0, self._ground)
        if self._review is not None:
            self._paint_range(painter)
            self._paint_playhead(painter)
        if self.hasFocus():
            painter.setPen(QColor(self._theme.tokens.accent))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), RADIUS, RADIUS)
        painter.end()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Draw what stays anew."""
        self._draw_anew()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Go to where it was pressed, or to a mark nearby."""
        if event.button() == Qt.MouseButton.LeftButton and self._review is not None:
            flag = self._flag_at(event.position())
            self.scrubbed.emit(self._time_at(event.position().x()) if flag is None else flag.time)
            self.setSliderDown(True)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Go along while dragging; name a mark that is pointed at."""
        if self.isSliderDown():
            self.scrubbed.emit(self._time_at(event.position().x()))
            return
        flag = self._flag_at(event.position())
        self.setToolTip(
            "" if flag is None else self.tr("{mark} at {time}").format(mark=flag.words, time=clock(flag.time))
        )

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Let go."""
        self.setSliderDown(False)

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Step by frames; ten with Shift."""
        long = LONG_STEP if event.modifiers() & Qt.KeyboardModifier.ShiftModifier else 1
        frames = {Qt.Key.Key_Left: -long, Qt.Key.Key_Right: long, Qt.Key.Key_PageUp: -LONG_STEP,
                  Qt.Key.Key_PageDown: LONG_STEP}.get(Qt.Key(event.key()))  # fmt: skip
        if frames is not None:
            self._playhead.step(frames)
        elif event.key() == Qt.Key.Key_Home:
            self._playhead.home()
        elif event.key() == Qt.Key.Key_End:
            self._playhead.to_end()
        else:
            event.ignore()

    def sliderChange(self, change: QAbstractSlider.SliderChange) -> None:  # noqa: N802 (Qt's name)
        """Follow what a wheel or a screen reader asks for."""
        super().sliderChange(change)
        if change is QAbstractSlider.SliderChange.SliderValueChange and self.value() != self._playhead.frame:
            self.scrubbed.emit(self.value() * self._playhead.frame_s)

    def _on_moved(self) -> None:
        head = self._playhead
        if not self.isSliderDown() or self.value() != head.frame:
            self.setValue(head.frame)
        said = self.tr("{now} of {end}").format(now=clock(head.time), end=clock(head.duration))
        self.setAccessibleDescription(said)
        self.update()

    def _on_changed(self) -> None:
        self.setRange(0, max(self._playhead.frames - 1, 0))
        self._on_moved()

    def _draw_anew(self) -> None:
        self._ground = None
        self.update()

    def _time_at(self, x: float) -> float:
        area = self.area()
        return min(max((x - area.left()) / area.width(), 0.0), 1.0) * self._playhead.duration

    def _flag_at(self, place: QPointF) -> Flag | None:
        if place.y() > self.area().top():
            return None
        near = [flag for flag in self._flags if flag.x - NEAR <= place.x() <= flag.to_x + NEAR]
        return min(near, key=lambda flag: abs(flag.x - place.x()), default=None)

    def _flag_height(self) -> float:
        return self._theme.pixels("caption") * 1.5 + GRID

    def _time_height(self) -> float:
        return self._theme.pixels("caption") * 1.5 + GRID

    def _drawn(self, ratio: float) -> QPixmap:
        """Return everything that stays while it plays."""
        ground = QPixmap(round(self.width() * ratio), round(self.height() * ratio))
        ground.setDevicePixelRatio(ratio)
        ground.fill(Qt.GlobalColor.transparent)
        painter = QPainter(ground)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._theme.tokens.panel))
        painter.drawRoundedRect(self.area(), GRID, GRID)
        review = self._review
        if review is not None:
            if self._angle:
                self._paint_envelope(painter, review)
                self._paint_lost(painter, review)
            self._paint_times(painter)
            self._flags = self._flags_of(review.marks)
            self._paint_flags(painter)
        painter.end()
        return ground

    def _edges(self) -> NDArray[np.float64]:
        columns = max(int(self.area().width()) // COLUMN, 1)
        return np.linspace(0.0, self._playhead.duration, columns + 1)

    def _paint_envelope(self, painter: QPainter, review: TakeReview) -> None:
        area, edges, tokens = self.area(), self._edges(), self._theme.tokens
        least, most = envelope(review.motion.time, review.degrees[self._angle], edges)
        if np.isnan(least).all():
            return
        low, high = float(np.nanmin(least)), float(np.nanmax(most))
        bottom = area.bottom() - GRID
        scale = (area.height() - 2 * GRID) / max(high - low, 1.0)
        width = area.width() / len(least)
        side = {"left": tokens.left, "right": tokens.right}.get(side_of(self._angle), tokens.text)
        line, below = QColor(mixed(tokens.panel, side, LINE)), QColor(mixed(tokens.panel, side, BELOW))
        x0, foot = area.left(), area.bottom()
        lines, grounds = [], []
        for column in np.flatnonzero(~np.isnan(least)).tolist():
            top = bottom - (float(most[column]) - low) * scale
            height = max((float(most[column]) - float(least[column])) * scale, COLUMN)
            left = x0 + column * width
            grounds.append(QRectF(left, top, width, foot - top))
            lines.append(QRectF(left, top, width, height))
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing, on=False)
        for rectangles, colour in ((grounds, below), (lines, line)):
            painter.setBrush(colour)
            painter.drawRects(rectangles)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_caption(painter, low, high)

    def _paint_caption(self, painter: QPainter, low: float, high: float) -> None:
        area = self.area()
        painter.setFont(self._theme.font("caption"))
        low, high = round(low), round(high)  # whole numbers have no negative zero
        words = self.tr("{angle}, {low}° to {high}°").format(angle=in_words(self._angle), low=low, high=high)
        metrics = QFontMetricsF(painter.font())
        room = QRectF(area.left() + GRID, area.top() + 2, metrics.horizontalAdvance(words) + GAP, metrics.height())
        ground = QColor(self._theme.tokens.panel)
        ground.setAlphaF(0.8)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(ground)
        painter.drawRoundedRect(room, GRID, GRID)
        painter.setPen(QColor(self._theme.tokens.muted))
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter, words)
        painter.setPen(Qt.PenStyle.NoPen)

    def _paint_lost(self, painter: QPainter, review: TakeReview) -> None:
        """Paint gaps hatched over the whole height, and below how much is missing in each column."""
        area, edges = self.area(), self._edges()
        colour = QColor(self._theme.tokens.bad)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QBrush(colour, Qt.BrushStyle.BDiagPattern))
        for gap in gaps(review, self._angle, GAP_S):
            painter.drawRect(self._between(gap))
        share = lost_share(review, self._angle, edges)
        width, x0, foot = area.width() / len(share), area.left(), area.bottom()
        columns = np.flatnonzero(share).tolist()
        heights = np.maximum(LOSS_HEIGHT * share, 2.0).tolist()
        painter.setBrush(colour)
        painter.drawRects([QRectF(x0 + k * width, foot - heights[k], width, heights[k]) for k in columns])

    def _between(self, stretch: Stretch) -> QRectF:
        area = self.area()
        left, right = self.x_of(max(stretch.from_s, 0.0)), self.x_of(min(stretch.to_s, self._playhead.duration))
        return QRectF(left, area.top(), max(right - left, LEAST_STRETCH), area.height())

    def _paint_times(self, painter: QPainter) -> None:
        area, duration = self.area(), self._playhead.duration
        painter.setFont(self._theme.font("caption"))
        metrics = QFontMetricsF(painter.font())
        room = metrics.horizontalAdvance("00:00.0") + 3 * GAP
        least = duration * room / area.width()
        step = next((step for step in STEPS if step >= least), STEPS[-1])
        top = area.bottom() + GRID
        for time in np.arange(0.0, duration + 1e-9, step).tolist():
            x = self.x_of(time)
            painter.setPen(QColor(self._theme.tokens.line))
            painter.drawLine(QPointF(x, area.bottom()), QPointF(x, top))
            words = clock(time)[:-3] if step >= 1 else clock(time)[:-1]
            width = metrics.horizontalAdvance(words)
            left = min(max(x - width / 2, 0.0), self.width() - width)
            painter.setPen(QColor(self._theme.tokens.muted))
            painter.drawText(QPointF(left, top + metrics.ascent()), words)

    def _flags_of(self, marks: Sequence[Mark]) -> list[Flag]:
        tokens, flags, number = self._theme.tokens, [], 0
        for mark in marks:
            number += mark.kind == "marker"
            if not 0.0 <= mark.time <= self._playhead.duration:
                continue
            x = self.x_of(mark.time)
            to_x = self.x_of(min(mark.end, self._playhead.duration)) if mark.end > mark.time else x
            if mark.kind == "pose":
                flags.append(Flag(x, to_x, POSES.get(mark.label, mark.label), tokens.good, mark.time))
            elif mark.kind == "marker":
                words = mark.label or self.tr("Marker {n}").format(n=number)
                flags.append(Flag(x, to_x, words, tokens.accent, mark.time))
            elif mark.kind == "record":
                flags.append(Flag(x, to_x, self.tr("Record"), tokens.rec, mark.time))
            else:
                flags.append(Flag(x, to_x, mark.label or mark.kind, tokens.muted, mark.time))
        return flags

    def _paint_flags(self, painter: QPainter) -> None:
        """Paint marks above the envelope; words only where there is room before the next."""
        area, caption = self.area(), self._theme.font("caption")
        painter.setFont(caption)
        metrics = QFontMetricsF(caption)
        bottom = area.top() - 1
        nexts = [*(flag.x for flag in self._flags), area.right() + GAP][1:]
        for flag, following in zip(self._flags, nexts, strict=True):
            colour = QColor(flag.colour)
            painter.setPen(Qt.PenStyle.NoPen)
            painter.setBrush(colour)
            if flag.to_x > flag.x:
                painter.drawRect(QRectF(flag.x, bottom - 3, flag.to_x - flag.x, 3))
            tip = QPolygonF([QPointF(flag.x, bottom), QPointF(flag.x, bottom - 10), QPointF(flag.x + 7, bottom - 7)])
            painter.drawPolygon(tip)
            painter.setPen(colour)
            painter.drawLine(QPointF(flag.x, bottom - 10), QPointF(flag.x, area.bottom()))
            painter.setPen(QColor(self._theme.tokens.muted))
            room = following - flag.x - 10 - GAP
            words = metrics.elidedText(flag.words, Qt.TextElideMode.ElideRight, room)
            if len(words) > 2:
                painter.drawText(QPointF(flag.x + 10, bottom - 4), words)

    def _paint_range(self, painter: QPainter) -> None:
        head, area = self._playhead, self.area()
        if head.range_from is None and head.range_to is None:
            return
        left, right = self.x_of(head.begin), self.x_of(head.end)
        outside = QColor(self._theme.tokens.window)
        outside.setAlphaF(0.65)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(outside)
        painter.drawRect(QRectF(area.left(), area.top(), left - area.left(), area.height()))
        painter.drawRect(QRectF(right, area.top(), area.right() - right, area.height()))
        painter.setBrush(QColor(self._theme.tokens.accent))
        for x, inwards in ((left, 1.0), (right, -1.0)):
            painter.drawRect(QRectF(x - 1, area.top(), 2, area.height()))
            painter.drawRect(QRectF(min(x, x + 6 * inwards), area.top(), 6, 2))
            painter.drawRect(QRectF(min(x, x + 6 * inwards), area.bottom() - 2, 6, 2))

    def _paint_playhead(self, painter: QPainter) -> None:
        x, area = self.x_of(self._playhead.time), self.area()
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(self._theme.tokens.text))
        painter.drawRect(QRectF(x - 1, area.top() - 2, 2, area.height() + 4))
        head = [QPointF(x - 5, area.top() - 6), QPointF(x + 5, area.top() - 6), QPointF(x, area.top() + 2)]
        painter.drawPolygon(QPolygonF(head))
