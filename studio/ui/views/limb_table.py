"""What a hold gave, limb by limb: movement in degrees, in a word, and where the heading came from."""

import math
from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFontMetrics, QResizeEvent
from PySide6.QtWidgets import QAbstractItemView, QHeaderView, QTableWidget, QTableWidgetItem, QWidget

from studio.capture.procedures.judged_hold import LimbResult
from studio.ui.theme import GRID, Theme
from studio.ui.views.hold_words import HoldWords

LIMB, DEGREES, GRADE, HEADING = range(4)
ROWS_SEEN = 4  # at least
PADDING = 10  # px on each side of a cell
MARKS = {"left": "●", "right": "■"}


class LimbTable(QTableWidget):
    """Read only; the worst limbs first."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(0, 4, parent)
        self._theme = theme
        self.setAccessibleName(self.tr("Result of the hold, limb by limb"))
        titles = (self.tr("Limb"), self.tr("Moved, °"), self.tr("Result"), self.tr("Heading"))
        for column, title in enumerate(titles):
            item = QTableWidgetItem(title)
            side = Qt.AlignmentFlag.AlignRight if column == DEGREES else Qt.AlignmentFlag.AlignLeft
            item.setTextAlignment(side | Qt.AlignmentFlag.AlignVCenter)
            self.setHorizontalHeaderItem(column, item)
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.setTabKeyNavigation(False)
        self.verticalHeader().hide()
        header = self.horizontalHeader()
        header.setAccessibleName(self.tr("Columns of the table of limbs"))
        header.setHighlightSections(False)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(LIMB, QHeaderView.ResizeMode.Stretch)

    def show_limbs(self, limbs: Sequence[LimbResult], said: HoldWords) -> None:
        """Show the result of each limb."""
        order = {"moved": 0, "silent": 1, "fair": 2, "good": 3}
        shown = sorted(limbs, key=lambda limb: order[limb.grade])
        self.setRowCount(len(shown))
        for row, limb in enumerate(shown):
            self._show_row(row, limb, said)
        self._fit()

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Share the width anew."""
        super().resizeEvent(event)
        self._spare_heading()

    def restyle(self) -> None:
        """Take over colours and text size."""
        line = QFontMetrics(self._theme.font("body")).height()
        self.verticalHeader().setDefaultSectionSize(line + 2 * GRID)
        self._fit()

    def _show_row(self, row: int, limb: LimbResult, said: HoldWords) -> None:
        tokens = self._theme.tokens
        side = limb.place.value.partition("_")[0]
        name = said.place(limb.place)
        degrees = f"{limb.degrees:.1f}" if math.isfinite(limb.degrees) else "–"
        heading = said.heading(limb)
        texts = (f"{MARKS.get(side, ' ')}  {name}", degrees, said.grade(limb.grade), heading)
        spoken = {"limb": name, "grade": texts[GRADE], "degrees": degrees, "heading": heading}
        tones = {"good": tokens.good, "fair": tokens.text, "moved": tokens.bad, "silent": tokens.warn}
        for column, text in enumerate(texts):
            item = QTableWidgetItem(text)
            item.setToolTip(self.tr("{limb}: {grade}, {degrees}°, heading {heading}").format(**spoken))
            if column == DEGREES:
                item.setTextAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
            elif column == GRADE:
                item.setForeground(QColor(tones[limb.grade]))
            elif column == HEADING:
                item.setForeground(QColor(tokens.warn if limb.source == "unknown" else tokens.muted))
            self.setItem(row, column, item)

    def _fit(self) -> None:
        height = self.verticalHeader().defaultSectionSize()
        self._spare_heading()
        top = self.horizontalHeader().sizeHint().height() + 2 * GRID
        self.setMinimumHeight(min(self.rowCount(), ROWS_SEEN) * height + top)
        self.setMaximumHeight(self.rowCount() * height + top)

    def _spare_heading(self) -> None:
        """Leave the headings to the tooltips where large text would cut the limbs' names."""
        metrics = QFontMetrics(self._theme.font("body"))
        needed = 0
        for column in range(self.columnCount()):
            cells = [self.item(row, column) for row in range(self.rowCount())]
            texts = [cell.text() for cell in (*cells, self.horizontalHeaderItem(column)) if cell is not None]
            needed += max(metrics.horizontalAdvance(text) for text in texts) + 2 * PADDING
        self.setColumnHidden(HEADING, needed > self.viewport().width())
