"""Letters that tell left from right: a round L and a square R at hands and feet."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPixmap

from studio.core.body import Place
from studio.ui.theme import Theme
from studio.ui.views.stage.body_parts import Part
from studio.ui.views.stage.outlines import EDGE, Outlines

LETTERED = ("hand", "toes")
ARM = ("upper_arm", "forearm", "hand")
SMALL_FIGURE = 160.0  # px; of a figure that is less high only the feet get letters
OF_SMALL, OF_LARGE = 0.06, 0.028  # of the figure's height; a letter is between these, if it can one and a half captions
LEAST = 16.0  # px


class Letters(NamedTuple):
    """The letters of both sides in the language of the window."""

    left: str
    right: str


class SideLetters:
    """Draws each letter once."""

    def __init__(self, theme: Theme) -> None:
        self._theme = theme
        self._badges: dict[tuple[bool, int, Letters, float], QPixmap] = {}

    def paint(self, painter: QPainter, parts: Sequence[Part], seen: Outlines, letters: Letters) -> None:
        """Paint the letters of the hands and feet that are not behind the body or the other side's limbs."""
        rows = list(seen.order)
        height = float(np.ptp(seen.edges[rows][..., 1])) if rows else 0.0
        usual = min(max(height * OF_SMALL, LEAST), self._theme.pixels("caption") * 1.5)
        size = round(max(usual, height * OF_LARGE))
        ratio = painter.device().devicePixelRatio()
        shown = LETTERED if height >= SMALL_FIGURE else LETTERED[1:]
        lettered = [row for row in rows if parts[row].name in shown]
        for row, is_hidden in zip(lettered, _hidden(parts, seen, lettered), strict=True):
            if is_hidden:
                continue
            corner = _beyond(seen, row, 0.75 * size) - QPointF(size / 2, size / 2)
            painter.drawPixmap(corner, self._badge(parts[row].tone == "left", size, letters, ratio))

    def _badge(self, is_left: bool, size: int, letters: Letters, ratio: float) -> QPixmap:
        """Return a letter on its ground; drawn once for each size."""
        key = (is_left, size, letters, ratio)
        if key not in self._badges:
            self._badges[key] = self._drawn(*key)
        return self._badges[key]

    def _drawn(self, is_left: bool, size: int, letters: Letters, ratio: float) -> QPixmap:
        tokens = self._theme.tokens
        badge = QPixmap(round(size * ratio), round(size * ratio))
        badge.setDevicePixelRatio(ratio)
        badge.fill(Qt.GlobalColor.transparent)
        box = QRectF(0.0, 0.0, size, size)
        painter = QPainter(badge)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(QColor(tokens.left if is_left else tokens.right))
        if is_left:
            painter.drawEllipse(box)
        else:
            painter.drawRoundedRect(box, 2.0, 2.0)
        font = self._theme.font("caption", bold=True)
        font.setPixelSize(round(size / 1.5))
        painter.setFont(font)
        painter.setPen(QColor(tokens.on_accent))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, letters.left if is_left else letters.right)
        painter.end()
        return badge


def _beyond(seen: Outlines, row: int, distance: float) -> QPointF:
    """Return the point ``distance`` px beyond the lower end of a part."""
    along, middle = seen.along[row], seen.middles[row]
    reach = float(((seen.edges[row] - middle) @ along).max())
    x, y = (middle + along * (reach + distance)).tolist()
    return QPointF(x, y)


def _hidden(parts: Sequence[Part], seen: Outlines, rows: Sequence[int]) -> list[bool]:
    """Return for parts whether all four ends of each are behind nearer parts of other limbs."""
    if not rows:
        return []
    others = list(seen.order)
    turn = {row: place for place, row in enumerate(others)}
    limbs = [_LIMBS[parts[other].place] for other in others]
    may_hide = [[turn[row] < k and _LIMBS[parts[row].place] != limb for k, limb in enumerate(limbs)] for row in rows]
    ends = seen.edges[list(rows), :: EDGE // 4][:, :, None]
    upper, along = seen.axis[others, 0], seen.axis[others, 1] - seen.axis[others, 0]
    from_upper = ends - upper
    share = (from_upper * along).sum(axis=-1) / np.maximum((along * along).sum(axis=-1), 1e-9)
    share = np.minimum(np.maximum(share, 0.0), 1.0)
    apart = from_upper - share[..., None] * along
    width = seen.widths[others, 0] * (1.0 - share) + seen.widths[others, 1] * share
    inside = ((apart * apart).sum(axis=-1) < width * width) & np.array(may_hide)[:, None]
    hidden: list[bool] = inside.any(axis=2).all(axis=1).tolist()
    return hidden


def _limb(place: Place) -> str:
    """Return one name for all places of an arm, of a leg, and of the trunk."""
    side, _, name = place.value.partition("_")
    if not name:
        return "trunk"
    return f"{side} {'arm' if name in ARM else 'leg'}"


_LIMBS = {place: _limb(place) for place in Place}
