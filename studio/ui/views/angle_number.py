"""One joint angle, large enough to be read from three metres, with its range and a target band."""

import math

from PySide6.QtCore import QPointF, QRectF, QSize, Qt
from PySide6.QtGui import QColor, QFontMetrics, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from studio.ui.models.live_angles import Shown
from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme

NUMBER = 2.0  # of the figure size: 68 px at 100 %, which three metres away is like 9 px at arm's length
BAND_HEIGHT = 12  # px
SPAN = 30.0  # degrees; the least that the bar covers


class AngleNumber(QWidget):
    """Painted: side mark and name, the number, least to most with the target band."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._words = ""
        self._shown: Shown | None = None
        self._target: tuple[float, float] | None = None
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_angle(self, words: str, shown: Shown) -> None:
        """Show an angle; ``words`` is its name for people."""
        self._words, self._shown = words, shown
        self.setAccessibleName(words)
        self.setAccessibleDescription(self.text())
        self.update()

    def set_target(self, band: tuple[float, float] | None) -> None:
        """Show a band to reach, degrees; None for none."""
        self._target = band
        self.update()

    def text(self) -> str:
        """Return what is shown as words."""
        shown = self._shown
        if shown is None or not math.isfinite(shown.now):
            return self.tr("not measured")
        said = self.tr("{now:.0f} degrees, from {least:.0f} to {most:.0f}")
        said = said.format(now=shown.now, least=shown.least, most=shown.most)
        if self._target is not None and self._target[0] <= shown.now <= self._target[1]:
            said += self.tr(", in the target band")
        return said

    def restyle(self) -> None:
        """Take over colours and text size."""
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return room for three digits and a degree sign."""
        theme = self._theme
        number = round(theme.pixels("figure") * NUMBER)
        font = theme.font("figure")
        font.setPixelSize(number)
        lines = 1.4 * theme.pixels("body") + QFontMetrics(font).height() + 1.5 * theme.pixels("caption")
        return QSize(round(number * 2.6), math.ceil(lines + BAND_HEIGHT + 2 * GRID))

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the same: the number is never cut."""
        return self.sizeHint()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        top = self._paint_name(painter)
        top = self._paint_number(painter, top)
        self._paint_range(painter, top)
        painter.end()

    def _paint_name(self, painter: QPainter) -> float:
        theme, tokens = self._theme, self._theme.tokens
        side = self._shown.name.partition("_")[0] if self._shown else ""
        height = float(theme.pixels("body"))
        left = 0.0
        mark = QRectF(0, height * 0.3, height * 0.6, height * 0.6)
        painter.setPen(Qt.PenStyle.NoPen)
        if side == "left":
            painter.setBrush(QColor(tokens.left))
            painter.drawEllipse(mark)
        elif side == "right":
            painter.setBrush(QColor(tokens.right))
            painter.drawRect(mark)
        if side in ("left", "right"):
            left = mark.right() + GAP
        painter.setFont(theme.font("body"))
        painter.setPen(QColor(tokens.muted))
        room = QRectF(left, 0, self.width() - left, height * 1.4)
        words = painter.fontMetrics().elidedText(self._words, Qt.TextElideMode.ElideMiddle, int(room.width()))
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, words)
        return height * 1.4

    def _paint_number(self, painter: QPainter, top: float) -> float:
        theme = self._theme
        font = theme.font("figure")
        font.setPixelSize(round(theme.pixels("figure") * NUMBER))
        painter.setFont(font)
        painter.setPen(QColor(theme.tokens.text))
        shown = self._shown
        text = "–" if shown is None or not math.isfinite(shown.now) else f"{whole(shown.now)}°"
        height = float(painter.fontMetrics().height())
        painter.drawText(QRectF(0, top, self.width(), height), Qt.AlignmentFlag.AlignVCenter, text)
        return top + height

    def _paint_range(self, painter: QPainter, top: float) -> None:
        shown, tokens = self._shown, self._theme.tokens
        if shown is None or not math.isfinite(shown.least):
            return
        low, high = self._span(shown)
        bar = QRectF(0, top + GRID, self.width() - GAP_WIDE, BAND_HEIGHT)

        def x(degrees: float) -> float:
            return bar.left() + bar.width() * (degrees - low) / (high - low)

        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.line))
        painter.drawRoundedRect(bar, BAND_HEIGHT / 2, BAND_HEIGHT / 2)
        if self._target is not None:
            painter.setBrush(QColor(tokens.good))
            painter.drawRect(
                QRectF(x(self._target[0]), bar.top(), x(self._target[1]) - x(self._target[0]), BAND_HEIGHT)
            )
        painter.setBrush(QColor(tokens.accent))
        reached = QRectF(x(shown.least), bar.center().y() - 2, x(shown.most) - x(shown.least), 4)
        painter.drawRoundedRect(reached, 2, 2)
        if math.isfinite(shown.now):
            painter.setPen(QPen(QColor(tokens.text), 3))
            painter.drawLine(QPointF(x(shown.now), bar.top() - 2), QPointF(x(shown.now), bar.bottom() + 2))
        painter.setFont(self._theme.font("caption"))
        painter.setPen(QColor(tokens.muted))
        said = self.tr("{least}° to {most}°, range {range}°")
        said = said.format(least=whole(shown.least), most=whole(shown.most), range=whole(shown.range))
        room = QRectF(0, bar.bottom() + GRID, self.width(), self._theme.pixels("caption") * 1.5)
        painter.drawText(room, Qt.AlignmentFlag.AlignVCenter, said)

    def _span(self, shown: Shown) -> tuple[float, float]:
        """Return the ends of the bar, degrees: all that was reached and is to be reached, with some air."""
        ends = [shown.least, shown.most, *(self._target or ())]
        low, high = min(ends), max(ends)
        air = max(0.05 * (high - low), 0.5 * (SPAN - (high - low)), 0.0)
        return low - air, high + air


def whole(degrees: float) -> str:
    """Return whole degrees with a true minus, and never minus nothing."""
    return (
        f"{degrees + 0.0:.0f}".replace("-0", "0", 1).replace("-", "−")
        if abs(degrees) < 0.5
        else (f"{degrees:.0f}".replace("-", "−"))
    )
