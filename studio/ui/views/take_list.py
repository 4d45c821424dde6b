"""The library as a list: search on top, one row of two lines for each take, what can be done with it below."""

from pathlib import Path

from PySide6.QtCore import QItemSelectionModel, QModelIndex, QSize, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListView,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from studio.storage.take_summary import TakeSummary
from studio.ui.icons import icon
from studio.ui.models.take_list_model import SUMMARY, TakeListModel
from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme
from studio.ui.views.flow import FlowLayout
from studio.ui.views.take_row import TakeRow

STAR = 16  # px at 100 % text


class TakeList(QFrame):
    """Shows takes; choosing, renaming and judging are wishes, and rows change when the model says so."""

    take_chosen = Signal(object)
    """Folder of the take to be looked at."""
    selection_changed = Signal(object)
    """Folders of all selected takes, a tuple, as they stand in the list."""
    rename_requested = Signal(object, str)
    """Folder and new name."""
    verdict_requested = Signal(object, str)
    """Folder, and ``star``, ``bad`` or ``none``."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.model = TakeListModel(self)
        self._row = TakeRow(theme, self)
        self.search = QLineEdit(self)
        self.starred = QPushButton(self.tr("Starred"), self)
        self.view = QListView(self)
        self.count = QLabel(self)
        self.rename = QPushButton(self.tr("Rename"), self)
        self.star = QPushButton(self.tr("Star"), self)
        self.bad = QPushButton(self.tr("Bad take"), self)
        self._pages = QStackedWidget(self)
        self._nothing = QLabel(self)
        self.show_all = QPushButton(self.tr("Show all takes"), self)
        self._chosen: Path | None = None
        self._wanted: dict[Path, str] = {}
        """Verdicts that were asked for and not answered yet."""
        self._loading = False
        self._build()
        self._wire()
        self.restyle()
        self._refresh()

    def set_loading(self, on: bool) -> None:
        """Say that the library is being read."""
        self._loading = on
        self._refresh()

    def choose(self, folder: Path | None) -> None:
        """Mark the take that is looked at, without asking for it."""
        self._chosen = folder
        row = None if folder is None else self.model.row_of(folder)
        if row is None:
            self.view.selectionModel().clear()
        elif folder not in self.selected():
            flags = QItemSelectionModel.SelectionFlag.ClearAndSelect
            self.view.selectionModel().setCurrentIndex(self.model.index(row), flags)
        self._refresh()

    def selected(self) -> tuple[Path, ...]:
        """Return the folders of the selected takes, from top to bottom."""
        rows = sorted(self.view.selectionModel().selectedRows(), key=QModelIndex.row)
        return tuple(row.data(SUMMARY).folder for row in rows)

    def current(self) -> TakeSummary | None:
        """Return the take the buttons are about: the only selected one, else the one that is looked at."""
        selected = self.selected()
        folder = selected[0] if len(selected) == 1 else self._chosen
        return None if folder is None else self.model.summary(folder)

    def begin_rename(self) -> None:
        """Let the name be typed."""
        summary = self.current()
        row = None if summary is None else self.model.row_of(summary.folder)
        if row is not None and summary is not None and summary.refusal is None:
            self.view.setCurrentIndex(self.model.index(row))
            self.view.edit(self.model.index(row))

    def toggle_star(self) -> None:
        """Ask for a star, or for none."""
        self._toggle("star")

    def toggle_bad(self) -> None:
        """Ask to mark a bad take, or no longer."""
        self._toggle("bad")

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        self._row.restyle()
        tint = self._theme.tokens.muted
        size = round(STAR * self._theme.text_scale)
        self.starred.setIcon(icon("star", tint, size))
        self.starred.setIconSize(QSize(size, size))
        self.view.doItemsLayout()

    def _build(self) -> None:
        self.setProperty("ground", "panel")
        title = QLabel(self.tr("Takes"), self)
        title.setProperty("role", "section")
        self.count.setProperty("role", "caption")
        self.search.setPlaceholderText(self.tr("Name, person or date"))
        self.search.setAccessibleName(self.tr("Search takes by name, person or date"))
        self.search.setClearButtonEnabled(True)
        self.starred.setCheckable(True)
        self.starred.setProperty("kind", "quiet")
        self.starred.setAccessibleName(self.tr("Show only takes with a star"))
        self._build_view()
        head = QHBoxLayout()
        head.addWidget(title)
        head.addStretch(1)
        head.addWidget(self.starred)
        column = QVBoxLayout(self)
        column.setContentsMargins(GAP, GAP_WIDE, GAP, GAP)
        column.setSpacing(GAP)
        column.addLayout(head)
        column.addWidget(self.search)
        column.addWidget(self._pages, 1)
        column.addWidget(self.count)
        column.addWidget(self._actions())

    def _build_view(self) -> None:
        self.view.setModel(self.model)
        self.view.setItemDelegate(self._row)
        self.view.setUniformItemSizes(True)
        self.view.setAccessibleName(self.tr("Takes, newest first"))
        self.view.setMouseTracking(True)
        self.view.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.view.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.view.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.view.setEditTriggers(QAbstractItemView.EditTrigger.EditKeyPressed)
        self._nothing.setWordWrap(True)
        self._nothing.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._nothing.setProperty("role", "muted")
        nothing = QWidget(self)
        column = QVBoxLayout(nothing)
        column.setContentsMargins(GAP, 0, GAP, 0)
        column.setSpacing(GAP_WIDE)
        column.addStretch(1)
        column.addWidget(self._nothing)
        column.addWidget(self.show_all, 0, Qt.AlignmentFlag.AlignHCenter)
        column.addStretch(2)
        self._pages.addWidget(self.view)
        self._pages.addWidget(nothing)

    def _actions(self) -> QWidget:
        bar = QWidget(self)
        flow = FlowLayout(bar, gap=GRID, line_gap=GRID)
        said = {
            self.rename: self.tr("Rename the selected take (F2)"),
            self.star: self.tr("Star the selected take (S)"),
            self.bad: self.tr("Mark the selected take as bad (X)"),
        }
        for button, words in said.items():
            button.setProperty("kind", "quiet")
            button.setAccessibleName(words)
            button.setToolTip(words)
            flow.addWidget(button)
        self.star.setCheckable(True)
        self.bad.setCheckable(True)
        return bar

    def _wire(self) -> None:
        self.search.textChanged.connect(self.model.set_filter)
        self.starred.toggled.connect(self.model.set_starred_only)
        self.model.modelReset.connect(self._on_reset)
        self.model.dataChanged.connect(self._wanted.clear)
        self.view.setProperty("gives_way", True)  # Space and the sideways arrows play the take that was chosen here
        self.model.rowsRemoved.connect(self._refresh)
        self.model.dataChanged.connect(self._refresh)
        self.model.rename_asked.connect(self._on_rename)
        self.view.selectionModel().selectionChanged.connect(self._on_selected)
        self.view.activated.connect(self._on_activated)
        self.rename.clicked.connect(self.begin_rename)
        self.star.clicked.connect(self.toggle_star)
        self.bad.clicked.connect(self.toggle_bad)
        self.show_all.clicked.connect(self._on_show_all)

    def _refresh(self) -> None:
        shown, total = self.model.rowCount(), self.model.total
        self._pages.setCurrentIndex(0 if shown else 1)
        self.show_all.setVisible(total > 0)
        self._nothing.setText(self._why_nothing())
        some = self.tr("{n} of {total} takes").format(n=f"{shown:,}", total=f"{total:,}")
        every = self.tr("one take") if total == 1 else self.tr("{n} takes").format(n=f"{total:,}")
        self.count.setText(some if self.model.is_filtered else every)
        self.count.setVisible(total > 0)
        self.search.setEnabled(total > 0)
        self.starred.setEnabled(total > 0)
        summary = self.current()
        verdict = "none" if summary is None else summary.verdict
        for button, own in ((self.rename, ""), (self.star, "star"), (self.bad, "bad")):
            button.setEnabled(summary is not None and summary.refusal is None)
            button.setChecked(bool(own) and verdict == own)

    def _why_nothing(self) -> str:
        if self._loading:
            return self.tr("Reading the library…")
        if not self.model.total:
            return self.tr("No takes yet. Record one with R; it appears here as soon as it is saved.")
        if self.search.text().strip():
            return self.tr("No take matches “{words}”.").format(words=self.search.text().strip())
        return self.tr("No take has a star yet. Select a take and press S.")

    def _toggle(self, verdict: str) -> None:
        summary = self.current()
        if summary is not None and summary.refusal is None:
            shown = self._wanted.get(summary.folder, summary.verdict)
            wanted = "none" if shown == verdict else verdict
            self._wanted[summary.folder] = wanted  # until the answer comes: a second press means the other way
            self.verdict_requested.emit(summary.folder, wanted)
        self._refresh()

    def _on_reset(self) -> None:
        self.choose(self._chosen)

    def _on_rename(self, summary: TakeSummary, name: str) -> None:
        self.rename_requested.emit(summary.folder, name)

    def _on_selected(self) -> None:
        selected = self.selected()
        self.selection_changed.emit(selected)
        if len(selected) == 1 and selected[0] != self._chosen:
            self._chosen = selected[0]
            self.take_chosen.emit(selected[0])
        self._refresh()

    def _on_activated(self, index: QModelIndex) -> None:
        self.take_chosen.emit(index.data(SUMMARY).folder)

    def _on_show_all(self) -> None:
        self.search.clear()
        self.starred.setChecked(False)
