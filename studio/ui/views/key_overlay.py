"""All keys on one sheet, made from the table they are bound by."""

from collections.abc import Iterable, Mapping

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QFontMetrics, QKeyEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.keys import Key, in_words
from studio.ui.theme import GAP, GAP_PAGE, GAP_WIDE, GRID, Theme
from studio.ui.views.focus import give_back

WIDTH = 760  # px at 100 %


class KeyOverlay(QFrame):
    """Opens over the window; Esc, ? or its button closes it."""

    settings_requested = Signal()

    def __init__(self, theme: Theme, parent: QWidget) -> None:
        super().__init__(parent)
        self._theme = theme
        self._host = parent
        self._rows: tuple[tuple[str, str, str], ...] = ()
        self._before: QWidget | None = None
        self.setProperty("ground", "floating")
        self.setAccessibleName(self.tr("Keys"))
        self._area = QScrollArea(self)
        self.close_button = QPushButton(self)
        self.change_button = QPushButton(self.tr("Change keys…"), self)
        self._build()
        self.hide()

    @property
    def rows(self) -> tuple[tuple[str, str, str], ...]:
        """Group, keys and words of each line."""
        return self._rows

    def open_with(self, keys: Iterable[Key], in_force: Mapping[str, tuple[str, ...]]) -> None:
        """Show these keys."""
        self._rows = tuple((key.group, in_words(in_force[key.action]), key.words) for key in keys)
        self._before = self.window().focusWidget()
        self._fill()
        self.restyle()
        self.show()
        self.raise_()
        self._area.setFocus(Qt.FocusReason.PopupFocusReason)

    def close_overlay(self) -> None:
        """Close, and give the focus back."""
        give_back(self._before, self.window())
        self.hide()

    def place(self) -> None:
        """Take the middle of the parent."""
        room = self._host.rect().adjusted(GAP_PAGE, GAP_PAGE, -GAP_PAGE, -GAP_PAGE)
        width = min(round(WIDTH * max(self._theme.text_scale, 1.0)), room.width())
        sheet = self._area.widget()
        inner = sheet.sizeHint().height() if sheet is not None else 0
        height = min(inner + self.close_button.sizeHint().height() + 3 * GAP_WIDE + 2 * GAP, room.height())
        self.setGeometry(
            room.left() + (room.width() - width) // 2, room.top() + (room.height() - height) // 2, width, height
        )

    def restyle(self) -> None:
        """Take over colours and text size."""
        size = round(SIZE * max(self._theme.text_scale, 1.0))
        self.close_button.setIconSize(QSize(size, size))
        self.close_button.setIcon(icon("close", self._theme.tokens.muted, size))
        if self._rows:
            self._fill()
        self.place()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Esc closes."""
        if event.key() == Qt.Key.Key_Escape:
            self.close_overlay()
        else:
            super().keyPressEvent(event)

    def _build(self) -> None:
        title = QLabel(self.tr("Keys"), self)
        title.setProperty("role", "section")
        self.change_button.setProperty("kind", "quiet")
        self.change_button.setAccessibleName(self.tr("Change keys"))
        self.close_button.setProperty("kind", "quiet")
        self.close_button.setAccessibleName(self.tr("Close"))
        self.close_button.setToolTip(self.tr("Close (Esc)"))
        self._area.setWidgetResizable(True)
        self._area.setAccessibleName(self.tr("List of keys"))
        head = QHBoxLayout()
        head.addWidget(title, 1)
        head.addWidget(self.change_button)
        head.addWidget(self.close_button)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP_PAGE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        column.setSpacing(GAP)
        column.addLayout(head)
        column.addWidget(self._area, 1)
        self.close_button.clicked.connect(self.close_overlay)
        self.change_button.clicked.connect(self._on_change)

    def _fill(self) -> None:
        sheet = QWidget(self._area)
        columns = QHBoxLayout(sheet)
        columns.setContentsMargins(0, 0, 0, GAP)
        columns.setSpacing(GAP_PAGE)
        groups: dict[str, list[tuple[str, str]]] = {}
        for group, keys, words in self._rows:
            groups.setdefault(group, []).append((keys, words))
        # Two columns of about the same height; one where large text leaves no room for two.
        two = self._theme.text_scale <= 1.5
        sides = [QVBoxLayout() for _ in range(2 if two else 1)]
        heights = [0] * len(sides)
        for group, lines in groups.items():
            shortest = heights.index(min(heights))
            sides[shortest].addWidget(self._group(group, lines, sheet))
            heights[shortest] += len(lines) + 2
        for side in sides:
            side.setSpacing(GAP_WIDE)
            side.addStretch(1)
            columns.addLayout(side, 1)
        self._area.setWidget(sheet)

    def _group(self, name: str, lines: list[tuple[str, str]], parent: QWidget) -> QWidget:
        group = QWidget(parent)
        grid = QGridLayout(group)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(GAP_WIDE)
        grid.setVerticalSpacing(GRID)
        grid.setColumnStretch(1, 1)
        metrics = QFontMetrics(self._theme.font("body", bold=True))
        grid.setColumnMinimumWidth(0, max(metrics.horizontalAdvance(keys) for _, keys, _ in self._rows))
        title = QLabel(name, group)
        title.setProperty("role", "caption")
        grid.addWidget(title, 0, 0, 1, 2)
        for row, (keys, words) in enumerate(lines, 1):
            key = QLabel(keys, group)
            key.setProperty("role", "strong")
            text = QLabel(words, group)
            text.setWordWrap(True)
            grid.addWidget(key, row, 0, Qt.AlignmentFlag.AlignTop)
            grid.addWidget(text, row, 1)
        return group

    def _on_change(self) -> None:
        self.close_overlay()
        self.settings_requested.emit()
