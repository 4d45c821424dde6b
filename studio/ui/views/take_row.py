"""One take of the list, painted: name and length above, when and how good below."""

from PySide6.QtCore import QModelIndex, QObject, QPersistentModelIndex, QRect, QSize, Qt
from PySide6.QtGui import QColor, QFont, QFontMetrics, QPainter, QPen
from PySide6.QtWidgets import QLineEdit, QStyle, QStyledItemDelegate, QStyleOptionViewItem, QWidget

from studio.storage.take_summary import TakeSummary
from studio.ui.icons import pixmap
from studio.ui.models.take_list_model import LONGEST_NAME, SUMMARY, TakeListModel, length
from studio.ui.style_sheet import mixed
from studio.ui.theme import FOCUS, GAP, GRID, RADIUS, Theme

Index = QModelIndex | QPersistentModelIndex


class TakeRow(QStyledItemDelegate):
    """Paints a row and edits its name in place."""

    def __init__(self, theme: Theme, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.restyle()

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        theme = self._theme
        self._name_font, self._small_font = theme.font("body", bold=True), theme.font("caption")
        self._name, self._small = QFontMetrics(self._name_font), QFontMetrics(self._small_font)
        size = theme.pixels("body")
        self._star = pixmap("star", theme.tokens.warn, size)
        self._problem = pixmap("problem", theme.tokens.bad, size)

    def sizeHint(self, option: QStyleOptionViewItem, index: Index) -> QSize:  # noqa: N802 (Qt's name)
        """Return the same height for every row."""
        return QSize(160, self._name.height() + self._small.height() + 2 * GAP + GRID)

    def paint(self, painter: QPainter, option: QStyleOptionViewItem, index: Index) -> None:
        """Paint a row."""
        summary: TakeSummary | None = index.data(SUMMARY)
        if summary is None:
            return
        painter.save()
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._paint_ground(painter, option)
        area: QRect = option.rect.adjusted(GAP + GRID, GAP, -GAP - GRID, -GAP)
        above = QRect(area.left(), area.top(), area.width(), self._name.height())
        below = QRect(area.left(), above.bottom() + 1 + GRID, area.width(), self._small.height())
        self._paint_name(painter, above, summary)
        model = index.model()
        assert isinstance(model, TakeListModel)
        self._paint_facts(painter, below, summary, model)
        painter.restore()

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: Index) -> QWidget:  # noqa: N802
        """Return a field for the name."""
        editor = QLineEdit(parent)
        editor.setMaxLength(LONGEST_NAME)
        editor.setAccessibleName(self.tr("New name of the take"))
        return editor

    def updateEditorGeometry(self, editor: QWidget, option: QStyleOptionViewItem, index: Index) -> None:  # noqa: N802
        """Fill the row with the field."""
        editor.setGeometry(option.rect.adjusted(GRID, GRID, -GRID, -GRID))

    def _paint_ground(self, painter: QPainter, option: QStyleOptionViewItem) -> None:
        tokens = self._theme.tokens
        ground = QRect(option.rect).adjusted(1, 1, -1, -1)
        painter.setPen(Qt.PenStyle.NoPen)
        if option.state & QStyle.StateFlag.State_Selected:
            painter.setBrush(QColor(mixed(tokens.panel, tokens.accent, 0.18)))
            painter.drawRoundedRect(ground, RADIUS, RADIUS)
        elif option.state & QStyle.StateFlag.State_MouseOver:
            painter.setBrush(QColor(mixed(tokens.raised, tokens.text, 0.07)))
            painter.drawRoundedRect(ground, RADIUS, RADIUS)
        if option.state & QStyle.StateFlag.State_HasFocus:
            painter.setPen(QPen(QColor(tokens.accent), FOCUS))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(ground, RADIUS, RADIUS)

    def _paint_name(self, painter: QPainter, area: QRect, summary: TakeSummary) -> None:
        tokens = self._theme.tokens
        right = area.right() + 1
        painter.setFont(self._small_font)
        painter.setPen(QColor(tokens.muted))
        if summary.refusal is None:
            words = length(summary.duration_s)
            right -= self._small.horizontalAdvance(words)
            painter.drawText(QRect(right, area.top(), area.right() + 1 - right, area.height()), _MIDDLE, words)
            right -= GAP
        left = area.left()
        mark = self._problem if summary.refusal is not None else self._star if summary.verdict == "star" else None
        if mark is not None:
            height = round(mark.deviceIndependentSize().height())
            painter.drawPixmap(left, area.center().y() - height // 2 + 1, mark)
            left += height + GRID
        font = QFont(self._name_font)
        font.setStrikeOut(summary.verdict == "bad")
        painter.setFont(font)
        faded = summary.verdict == "bad" or summary.refusal is not None
        painter.setPen(QColor(tokens.muted if faded else tokens.text))
        words = self._name.elidedText(numbered(summary), Qt.TextElideMode.ElideMiddle, right - left)
        painter.drawText(QRect(left, area.top(), right - left, area.height()), _MIDDLE, words)

    def _paint_facts(self, painter: QPainter, area: QRect, summary: TakeSummary, model: TakeListModel) -> None:
        tokens = self._theme.tokens
        painter.setFont(self._small_font)
        right = area.right() + 1
        words, colour = self._badge(summary)
        if words:
            room = min(self._small.horizontalAdvance(words), area.width())
            painter.setPen(QColor(colour))
            painter.drawText(QRect(right - room, area.top(), room, area.height()), _MIDDLE, words)
            right -= room + GAP
        if summary.refusal is not None:
            return
        facts = " · ".join(part for part in (summary.person, model.when(summary), model.loss(summary)) if part)
        painter.setPen(QColor(tokens.muted))
        cut = self._small.elidedText(facts, Qt.TextElideMode.ElideRight, max(right - area.left(), 0))
        painter.drawText(QRect(area.left(), area.top(), right - area.left(), area.height()), _MIDDLE, cut)

    def _badge(self, summary: TakeSummary) -> tuple[str, str]:
        tokens = self._theme.tokens
        if summary.refusal is not None:
            return self.tr("cannot be read"), tokens.bad
        if summary.verdict == "bad":
            return self.tr("✖ bad take"), tokens.muted
        if summary.recovered:
            return self.tr("▲ recovered"), tokens.warn
        return "", ""


def numbered(summary: TakeSummary) -> str:
    """Return the take's number within its session, and its name."""
    number = summary.folder.name.partition("_")[0].removeprefix("take-")
    return f"{number}  {summary.name}" if number.isdecimal() else summary.name


_MIDDLE = int(Qt.AlignmentFlag.AlignVCenter | Qt.AlignmentFlag.AlignLeft | Qt.TextFlag.TextSingleLine)
