"""Our own icons: line drawings of 20 px, tinted by a colour of the theme."""

from functools import cache
from pathlib import Path

from PySide6.QtCore import QByteArray, QRectF, QSize, Qt
from PySide6.QtGui import QGuiApplication, QIcon, QPainter, QPixmap
from PySide6.QtSvg import QSvgRenderer

ICONS = Path(__file__).resolve().parents[2] / "resources" / "icons"
SIZE = 20  # px

_INK = "currentColor"  # what the files are drawn with


def icon_file(name: str) -> Path:
    """Return the file of an icon."""
    return ICONS / f"{name}.svg"


def pixmap(name: str, colour: str, size: int = SIZE) -> QPixmap:
    """Return an icon in ``colour`` (``#RRGGBB``), ``size`` px high, sharp on this screen."""
    drawing = _drawing(name).replace(_INK, colour)
    ratio = QGuiApplication.primaryScreen().devicePixelRatio()
    canvas = QPixmap(QSize(round(size * ratio), round(size * ratio)))
    canvas.fill(Qt.GlobalColor.transparent)
    painter = QPainter(canvas)
    QSvgRenderer(QByteArray(drawing.encode())).render(painter, QRectF(canvas.rect()))
    painter.end()
    canvas.setDevicePixelRatio(ratio)
    return canvas


def icon(name: str, colour: str, size: int = SIZE) -> QIcon:
    """Return an icon for a button."""
    return QIcon(pixmap(name, colour, size))


@cache
def _drawing(name: str) -> str:
    return icon_file(name).read_text(encoding="utf-8")
