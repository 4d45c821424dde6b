"""Letters that tell left from right: a round L and a square R at hands and feet."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPixmap

from studio.ui.theme import Theme
from studio.ui.views.stage.body_parts import Body
from studio.ui.views.stage.outlines import EDGE, Outlines, distances

Array = NDArray[np.float64]

LETTERED = ("hand", "toes")
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

    def paint(self, painter: QPainter, body: Body, seen: Outlines, letters: Letters) -> None:
        """Paint the letters of the hands and feet that are not behind the body or the other side's limbs."""
        rows = list(seen.order)
        height = float(np.ptp(seen.edges[rows, :, 1])) if rows else 0.0
        usual = min(max(height * OF_SMALL, LEAST), self._theme.pixels("caption") * 1.5)
        size = round(max(usual, height * OF_LARGE))
        ratio = painter.device().devicePixelRatio()
        shown = LETTERED if height >= SMALL_FIGURE else LETTERED[1:]
        lettered = [row for row in rows if body.parts[row].name in shown]
        if not lettered:
            return
        places = _beyond(seen, lettered, 0.75 * size)
        hidden = hidden_letters(body, seen, lettered, places, size / 4).tolist()
        for row, is_hidden, (x, y) in zip(lettered, hidden, (places - size / 2).tolist(), strict=True):
            if not is_hidden:
                badge = self._badge(body.parts[row].tone == "left", size, letters, ratio)
                painter.drawPixmap(QPointF(x, y), badge)

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


def _beyond(seen: Outlines, rows: Sequence[int], distance: float) -> Array:
    """Return the points ``distance`` px beyond the lower ends of parts, (rows, 2)."""
    along, middle = seen.along[rows], seen.middles[rows]
    reach = ((seen.edges[rows] - middle[:, None]) * along[:, None]).sum(axis=-1).max(axis=1)
    return np.asarray(middle + along * (reach + distance)[:, None])


def hidden_letters(body: Body, seen: Outlines, rows: Sequence[int], places: Array, reach: float) -> NDArray[np.bool_]:
    """Return for parts whether all four ends of each are behind nearer parts of other limbs, (rows,).

    A letter whose place, (rows, 2), is on the other side's glove or shoe, or less than ``reach`` px beside it, would
    name that one: it is hidden as well.
    """
    order = np.array(seen.order)
    turn = np.empty(len(body.parts), np.intp)
    turn[order] = np.arange(len(order))
    nearer = turn[rows][:, None] < np.arange(len(order))
    others = nearer & (body.limbs[rows][:, None] != body.limbs[order])
    opposite = nearer & (body.sides[rows][:, None] * body.sides[order] < 0)
    points = seen.edges[rows, :: EDGE // 4][:, :, None]
    upper, along = seen.axis[order, 0], seen.axis[order, 1] - seen.axis[order, 0]
    from_upper = points - upper
    share = (from_upper * along).sum(axis=-1) / np.maximum((along * along).sum(axis=-1), 1e-9)
    share = np.minimum(np.maximum(share, 0.0), 1.0)
    apart = from_upper - share[..., None] * along
    width = seen.widths[order, 0] * (1.0 - share) + seen.widths[order, 1] * share
    inside = (apart * apart).sum(axis=-1) < width * width
    behind = (inside & others[:, None]).any(axis=2).all(axis=1)
    gloves = opposite.any(axis=0)
    lying = distances(seen.edges[order[gloves]], places) < reach
    return np.asarray(behind | (lying & opposite[:, gloves]).any(axis=1))
