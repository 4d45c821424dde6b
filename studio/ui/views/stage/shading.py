"""The figure's colours: a soft shade of two tones for each way the light can fall, made once and kept."""

import math
from collections.abc import Iterable

from PySide6.QtCore import Qt
from PySide6.QtGui import (
    QBrush,
    QColor,
    QGradient,
    QLinearGradient,
    QPainter,
    QPen,
    QPixmap,
    QRadialGradient,
    QTransform,
)

from studio.ui.theme import Theme
from studio.ui.views.stage.body_parts import Tone

LEVELS = 12  # steps of each of the light's two parts; neighbouring shades differ by less than the eye sees
STOPS = 9
WRAP = 0.30  # the light reaches a little around the edge, as in a room

# Share of the text colour in (lit, middle, shaded) tones and in the rim; the rest is the ground's.
_DARK_LIMB, _DARK_RIM = (0.98, 0.74, 0.36), 0.10
_LIGHT_LIMB, _LIGHT_RIM = (0.07, 0.25, 0.55), 0.74
_DARK_FACE, _LIGHT_FACE = (0.42, 0.28, 0.16), (0.56, 0.68, 0.82)
_SIDE = 0.62  # of the side's colour in hands and feet
_JOINT = 0.35  # of the lit tone in the tones of joints
SHADOW = ((0.0, 150), (0.35, 110), (0.7, 34), (1.0, 0))  # from the middle to the edge, of 255
BLOT = 256  # px
HATCH = 7.0  # px, from one line to the next

Tones = tuple[QColor, QColor, QColor]


class Shading:
    """Brushes and pens of one palette."""

    def __init__(self, theme: Theme) -> None:
        tokens = theme.tokens
        text, ground = QColor(tokens.text), QColor(tokens.window)
        shares = _DARK_LIMB if theme.is_dark else _LIGHT_LIMB
        limb = _three(mixed(ground, text, share) for share in shares)
        self._tones: dict[Tone, Tones] = {
            "limb": limb,
            "joint": _three(mixed(tone, limb[0], _JOINT) for tone in limb),
            "left": _three(mixed(tone, QColor(tokens.left), _SIDE) for tone in limb),
            "right": _three(mixed(tone, QColor(tokens.right), _SIDE) for tone in limb),
            "face": _three(mixed(ground, text, share) for share in (_DARK_FACE if theme.is_dark else _LIGHT_FACE)),
        }
        self.rim = QBrush(mixed(ground, text, _DARK_RIM if theme.is_dark else _LIGHT_RIM))
        self.hollow_fill = QBrush(with_alpha(ground, 190))
        self.hollow_pen = QPen(QColor(tokens.warn), 2.0)
        self.hatch = _hatch(mixed(ground, text, 0.20), mixed(ground, text, 0.52))
        self.hatch_pen = QPen(mixed(ground, text, 0.62), 1.25, Qt.PenStyle.DashLine)
        self.ghost_fill = QBrush(with_alpha(QColor(tokens.muted), 40))
        self.ghost_edge = QBrush(with_alpha(QColor(tokens.muted), 190))
        self.shadow = _shadow(QColor("#000000") if theme.is_dark else mixed(ground, text, 0.75))
        self._brushes: dict[tuple[Tone, int, int], QBrush] = {}

    def brush(self, tone: Tone, across: float, towards: float) -> QBrush:
        """Return a brush that runs from the dark edge at x = -1 to the lit edge at x = 1.

        ``across`` and ``towards``, 0…1, are the light's parts in the directions of the lit edge and of the eye.
        """
        key = (tone, round(across * LEVELS), round(towards * LEVELS))
        found = self._brushes.get(key)
        if found is None:
            found = self._brushes[key] = self._made(*key)
        return found

    def _made(self, tone: Tone, across: int, towards: int) -> QBrush:
        gradient = QLinearGradient(-1.0, 0.0, 1.0, 0.0)
        lit, middle, shaded = self._tones[tone]
        for stop in range(STOPS):
            x = 2.0 * stop / (STOPS - 1) - 1.0
            light = (math.sqrt(1.0 - x * x) * towards + x * across) / LEVELS
            amount = min(max((light + WRAP) / (1.0 + WRAP), 0.0), 1.0)
            if amount < 0.5:
                colour = mixed(shaded, middle, _eased(2.0 * amount))
            else:
                colour = mixed(middle, lit, _eased(2.0 * amount - 1.0))
            gradient.setColorAt(stop / (STOPS - 1), colour)
        return QBrush(gradient)


def mixed(one: QColor, other: QColor, share: float) -> QColor:
    """Return a colour between ``one`` (0) and ``other`` (1)."""
    rest = 1.0 - share
    return QColor.fromRgbF(
        one.redF() * rest + other.redF() * share,
        one.greenF() * rest + other.greenF() * share,
        one.blueF() * rest + other.blueF() * share,
    )


def with_alpha(colour: QColor, alpha: int) -> QColor:
    """Return a colour of which ``alpha`` of 255 parts cover."""
    seen = QColor(colour)
    seen.setAlpha(alpha)
    return seen


def placed(brush: QBrush, transform: QTransform) -> QBrush:
    """Return the brush laid somewhere else; the gradient itself is shared."""
    moved = QBrush(brush)
    moved.setTransform(transform)
    return moved


def _eased(share: float) -> float:
    return share * share * (3.0 - 2.0 * share)


def _three(colours: Iterable[QColor]) -> Tones:
    lit, middle, shaded = colours
    return lit, middle, shaded


def _hatch(ground: QColor, line: QColor) -> QBrush:
    gradient = QLinearGradient(0.0, 0.0, HATCH, 0.0)
    gradient.setSpread(QGradient.Spread.RepeatSpread)
    for position, colour in ((0.0, line), (0.16, line), (0.30, ground), (0.86, ground), (1.0, line)):
        gradient.setColorAt(position, colour)
    return QBrush(gradient)


def _shadow(colour: QColor) -> QPixmap:
    """Return a round soft blot. A picture that is only stretched costs a tenth of a gradient that is turned."""
    gradient = QRadialGradient(0.5, 0.5, 0.5)
    gradient.setCoordinateMode(QGradient.CoordinateMode.ObjectMode)
    for position, alpha in SHADOW:
        gradient.setColorAt(position, with_alpha(colour, alpha))
    blot = QPixmap(BLOT, BLOT)
    blot.fill(Qt.GlobalColor.transparent)
    painter = QPainter(blot)
    painter.fillRect(blot.rect(), gradient)
    painter.end()
    return blot
