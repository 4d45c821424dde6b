"""The takes of the library as rows: newest first, filtered by words and by star."""

import math
from collections.abc import Iterable
from datetime import datetime
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

from PySide6.QtCore import (
    QAbstractListModel,
    QDate,
    QDateTime,
    QLocale,
    QModelIndex,
    QObject,
    QPersistentModelIndex,
    Qt,
    QTime,
    Signal,
)

from studio.storage.take_summary import TakeSummary, age_order

SUMMARY = Qt.ItemDataRole.UserRole
"""Role of the ``TakeSummary`` itself."""
THIS_YEAR, ANY_YEAR = "d MMM HH:mm", "d MMM yyyy HH:mm"
LONGEST_NAME = 64  # characters, as where takes are named

Index = QModelIndex | QPersistentModelIndex


class _Entry(NamedTuple):
    """A take with what it is sorted and found by: both cost more than a row that is painted."""

    summary: TakeSummary
    age: tuple[float, str]
    text: str


class TakeListModel(QAbstractListModel):
    """What is shown of the library."""

    rename_asked = Signal(object, str)
    """A ``TakeSummary`` and its new name; the row changes when ``put`` brings the take as it is kept."""
    filter_changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._all: dict[Path, _Entry] = {}
        self._shown: list[TakeSummary] = []
        self._words = ""
        self._starred = False

    @property
    def total(self) -> int:
        """How many takes there are, shown or not."""
        return len(self._all)

    @property
    def is_filtered(self) -> bool:
        """Whether some takes are not shown on purpose."""
        return bool(self._words) or self._starred

    def set_takes(self, summaries: Iterable[TakeSummary]) -> None:
        """Show these takes instead."""
        self._sort([_entry(summary) for summary in summaries])

    def put(self, summary: TakeSummary) -> None:
        """Show a new take, or one as it is now."""
        entry = _entry(summary)
        if summary.folder not in self._all:
            self._sort([*self._all.values(), entry])
            return
        self._all[summary.folder] = entry
        row = self.row_of(summary.folder)
        if row is not None and self._matches(entry):
            self._shown[row] = summary
            self.dataChanged.emit(self.index(row), self.index(row))
        elif row is not None:
            self.beginRemoveRows(QModelIndex(), row, row)
            del self._shown[row]
            self.endRemoveRows()
        elif self._matches(entry):
            self._sort(list(self._all.values()))

    def set_filter(self, words: str) -> None:
        """Show takes that have all of these words in name, person, session or notes."""
        self._refilter(words.strip().casefold(), self._starred)

    def set_starred_only(self, on: bool) -> None:
        """Show only takes with a star, or all."""
        self._refilter(self._words, on)

    def newest(self) -> list[TakeSummary]:
        """Return all takes, shown or not, newest first."""
        return sorted((entry.summary for entry in self._all.values()), key=age_order, reverse=True)

    def row_of(self, folder: Path) -> int | None:
        """Return the row of a take, None when it is not shown."""
        return next((row for row, summary in enumerate(self._shown) if summary.folder == folder), None)

    def summary(self, folder: Path) -> TakeSummary | None:
        """Return a take, shown or not."""
        entry = self._all.get(folder)
        return None if entry is None else entry.summary

    def rowCount(self, parent: Index = QModelIndex()) -> int:  # noqa: N802, B008 (Qt's name and default)
        """Return how many takes are shown."""
        return 0 if parent.isValid() else len(self._shown)

    def data(self, index: Index, role: int = Qt.ItemDataRole.DisplayRole) -> Any:
        """Return one aspect of a row."""
        if not index.isValid() or index.row() >= len(self._shown):
            return None
        summary = self._shown[index.row()]
        if role == SUMMARY:
            return summary
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.EditRole):
            return summary.name
        if role == Qt.ItemDataRole.ToolTipRole:
            return summary.name
        if role == Qt.ItemDataRole.AccessibleTextRole:
            return self.sentence(summary)
        return None

    def setData(self, index: Index, value: Any, role: int = Qt.ItemDataRole.EditRole) -> bool:  # noqa: N802
        """Ask for another name."""
        name = " ".join(str(value).split())[:LONGEST_NAME]
        summary = self.data(index, SUMMARY)
        if role != Qt.ItemDataRole.EditRole or summary is None or not name or name == summary.name:
            return False
        self.rename_asked.emit(summary, name)
        return True

    def flags(self, index: Index) -> Qt.ItemFlag:
        """Tell that takes that can be read can be renamed."""
        flags = super().flags(index)
        summary = self.data(index, SUMMARY)
        return flags | Qt.ItemFlag.ItemIsEditable if summary is not None and summary.refusal is None else flags

    def sentence(self, summary: TakeSummary) -> str:
        """Return a row as it is read to those who cannot see it."""
        if summary.refusal is not None:
            return self.tr("{name}, cannot be read").format(name=summary.name)
        said = [summary.name, length(summary.duration_s), self.loss(summary), self.when(summary), summary.person]
        if summary.verdict == "star":
            said.append(self.tr("starred"))
        if summary.verdict == "bad":
            said.append(self.tr("bad take"))
        if summary.recovered:
            said.append(self.tr("recovered"))
        return ", ".join(part for part in said if part)

    def loss(self, summary: TakeSummary) -> str:
        """Return how much is missing, in words; empty when it cannot be told."""
        if math.isnan(summary.lost):
            return ""
        percent = 100.0 * summary.lost
        if 0.0 < percent < 0.1:
            return self.tr("under 0.1 % lost")
        return self.tr("{n} % lost").format(n=f"{percent:.1f}" if percent else "0")

    def when(self, summary: TakeSummary) -> str:
        """Return day and time on this computer's clock; the session when the recording does not tell."""
        try:
            moment = datetime.fromisoformat(summary.started)
            local = moment.astimezone()
        except (ValueError, OverflowError):
            return summary.session
        known = QDateTime(QDate(*local.timetuple()[:3]), QTime(local.hour, local.minute))
        year = QDate.currentDate().year()
        return QLocale().toString(known, THIS_YEAR if known.date().year() == year else ANY_YEAR)

    def _refilter(self, words: str, starred: bool) -> None:
        if (words, starred) == (self._words, self._starred):
            return
        self._words, self._starred = words, starred
        self.beginResetModel()
        self._shown = self._filtered()
        self.endResetModel()
        self.filter_changed.emit()

    def _sort(self, entries: list[_Entry]) -> None:
        self.beginResetModel()
        self._all = {entry.summary.folder: entry for entry in sorted(entries, key=attrgetter("age"), reverse=True)}
        self._shown = self._filtered()
        self.endResetModel()

    def _filtered(self) -> list[TakeSummary]:
        return [entry.summary for entry in self._all.values() if self._matches(entry)]

    def _matches(self, entry: _Entry) -> bool:
        if self._starred and entry.summary.verdict != "star":
            return False
        return all(word in entry.text for word in self._words.split())


def _entry(summary: TakeSummary) -> _Entry:
    text = f"{summary.name} {summary.person} {summary.session} {summary.notes}".casefold()
    return _Entry(summary, age_order(summary), text)


def length(seconds: float) -> str:
    """Return how long a take is: ``0:42``, ``12:04``, ``1:02:07``."""
    whole = round(seconds)
    minutes, rest = divmod(whole, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
