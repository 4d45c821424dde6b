"""What a person three metres away is told: the count, HOLD, done. The visual twin of the tones."""

import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetricsF, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.capture.procedures.held_pose import Cue, Kind
from studio.core.take import PoseName
from studio.ui.style_sheet import mixed
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, Theme
from studio.ui.views.body_shapes import HEIGHT, fitted, pose_arm, pose_lines, pose_outline

FLASH = 0.15  # s
FLASH_GAP = 0.34  # s from one flash to the next: under 3 a second
RING = 14.0  # px
SENTENCE = 22  # px; large text gives way to the ring down to this
NUMBER = 0.46  # of the ring's diameter


class HoldDisplay(QWidget):
    """Painted: the pose to hold on the left, ring with number or word on the right, a sentence below."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._pose: PoseName = "n"
        self._big, self._small, self._tone = "", "", "text"
        self._progress = 0.0
        self._now = 0.0
        self._flash_at = -math.inf
        self._flash = False
        self._flash_tone = "accent"
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    @property
    def is_lit(self) -> bool:
        """Whether the ground flashes now."""
        return self._flash

    def show_pose(self, pose: PoseName) -> None:
        """Draw the pose to hold."""
        if pose != self._pose:
            self._pose = pose
            self.update()

    def show_words(self, big: str, small: str, tone: str = "text") -> None:
        """Show a number or a word, and a sentence below; ``tone`` is the name of a colour."""
        if (big, small, tone) != (self._big, self._small, self._tone):
            self._big, self._small, self._tone = big, small, tone
            self.setAccessibleName(f"{big}. {small}" if big else small)
            self.update()

    def show_progress(self, share: float) -> None:
        """Fill the ring, 0…1."""
        if share != self._progress:
            self._progress = share
            self.update()

    def cue(self, cue: Cue) -> None:
        """Flash, unless the last flash was less than a third of a second ago."""
        if self._now - self._flash_at >= FLASH_GAP:
            self._flash_at, self._flash = self._now, True
            self._flash_tone = {Kind.DONE: "good", Kind.FAILED: "bad"}.get(cue.kind, "accent")
            self.update()

    def tick(self, now: float) -> None:
        """End the flash."""
        self._now = now
        if self._flash and now - self._flash_at >= FLASH:
            self._flash = False
            self.update()

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return a comfortable size."""
        return QSize(560, 420)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the size below which nothing can be read from afar."""
        return QSize(360, 260)

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint."""
        tokens = self._theme.tokens
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        ground = mixed(tokens.window, getattr(tokens, self._flash_tone), 0.35) if self._flash else tokens.window
        painter.fillRect(self.rect(), QColor(ground))
        sentence = self._paint_sentence(painter)
        stage = QRectF(self.rect()).adjusted(GAP_PAGE, GAP_PAGE, -GAP_PAGE, -GAP_WIDE)
        stage.setBottom(sentence.top() - GAP_WIDE)
        half = stage.width() / 2 - GAP
        self._paint_pose(painter, QRectF(stage.left(), stage.top(), half, stage.height()))
        self._paint_ring(painter, QRectF(stage.right() - half, stage.top(), half, stage.height()))
        painter.end()

    def _paint_sentence(self, painter: QPainter) -> QRectF:
        font = self._theme.font("page")
        font.setPixelSize(min(font.pixelSize(), max(SENTENCE, self.width() // 13)))
        painter.setFont(font)
        painter.setPen(QColor(self._theme.tokens.text))
        flags = int(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop | Qt.TextFlag.TextWordWrap)
        room = QRectF(self.rect()).adjusted(GAP_PAGE, 0, -GAP_PAGE, 0)
        line = painter.fontMetrics().lineSpacing()
        # Always room for two lines, so that the ring does not move when the words change.
        height = max(2.0 * line, painter.boundingRect(room, flags, self._small).height())
        room = QRectF(room.left(), self.height() - height - GAP, room.width(), height)
        painter.drawText(room, flags, self._small)
        return room

    def _paint_pose(self, painter: QPainter, room: QRectF) -> None:
        tokens = self._theme.tokens
        outline = pose_outline(self._pose)
        scale, origin = fitted(room, max(outline.boundingRect().width() + 12, 120.0))
        middle = outline.boundingRect().center().x()
        painter.save()
        painter.translate(origin)
        painter.scale(scale, scale)
        painter.translate(-middle, 0)
        painter.setPen(QPen(QColor(mixed(tokens.window, tokens.text, 0.25)), 2 / scale))
        painter.drawLine(QPointF(middle - 58, HEIGHT), QPointF(middle + 58, HEIGHT))
        painter.drawPath(pose_lines(self._pose))
        painter.setPen(QPen(QColor(mixed(tokens.window, tokens.text, 0.40)), 1.5 / scale))
        painter.setBrush(QColor(mixed(tokens.window, tokens.text, 0.16)))
        painter.drawPath(outline)
        painter.drawPath(pose_arm(self._pose))
        painter.restore()

    def _paint_ring(self, painter: QPainter, room: QRectF) -> None:
        tokens = self._theme.tokens
        side = min(room.width(), room.height())
        ring = QRectF(0, 0, side - RING, side - RING)
        ring.moveCenter(room.center())
        pen = QPen(QColor(tokens.line), RING)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(pen)
        painter.drawEllipse(ring)
        colour = QColor(getattr(tokens, self._tone))
        if self._progress > 0:
            pen.setColor(QColor(tokens.accent) if self._tone == "text" else colour)
            pen.setCapStyle(Qt.PenCapStyle.RoundCap)
            painter.setPen(pen)
            painter.drawArc(ring, 90 * 16, -round(360 * 16 * self._progress))
        painter.setPen(colour)
        painter.setFont(self._fitting(self._big, ring.width() * 0.78, ring.height() * NUMBER))
        painter.drawText(ring, Qt.AlignmentFlag.AlignCenter, self._big)

    def _fitting(self, text: str, width: float, height: float) -> QFont:
        """Return the largest bold font in which the text fits."""
        font = self._theme.font("figure", bold=True)
        font.setPixelSize(max(round(height), 12))
        needed = QFontMetricsF(font).horizontalAdvance(text)
        if needed > width:
            font.setPixelSize(max(round(height * width / needed), 12))
        return font
