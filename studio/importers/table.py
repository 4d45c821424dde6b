"""Tables of numbers in text files, whoever wrote them.

Read are comma, semicolon, tab or blanks between cells, a decimal comma where the comma does not separate
cells, UTF-8 with or without BOM, UTF-16 with BOM, any line end, quoted cells, notes above the header and a
row of units under it. An empty cell is a missing value (NaN). A row with too few or too many cells, with
text where a number is asked for, or with an infinite number is bad: it is left out and counted.
"""

import csv
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import RecordingUnreadable

BLANKS = ""
"""Stands for "any run of blanks" where a delimiter is named."""

_DELIMITERS = (";", "\t", ",", BLANKS)  # in the order of trust: when two explain a file equally well, the first holds
_LOOKED_AT = 200  # lines from which the layout is recognised
_BLOCK = 8192  # rows parsed at once; a block with a bad row is halved
_ROW_BY_ROW = 64  # rows; halving goes no further, since calling the fast parser costs as much
_MISSING = frozenset({"", "na", "n/a", "null", "none", "nan"})


@dataclass(frozen=True)
class Rows:
    """The good rows of some columns of a table."""

    values: NDArray[np.float64]
    """(n, columns); NaN where a cell is empty."""
    dropped: int
    """Bad rows."""
    first_bad_line: int
    """1-based line of the first bad row, 0 when all are good."""


@dataclass(frozen=True)
class Table:
    """A text file whose layout is known and whose numbers are not parsed yet."""

    file: str
    delimiter: str
    width: int
    """Cells in each row."""
    headers: tuple[tuple[str, ...], ...]
    """Rows of words directly above the numbers, the nearest last; empty when there are none."""
    lines: Sequence[str]
    """The rows, blank lines among them."""
    first_line: int
    """1-based line of ``lines[0]``."""

    def column(self, name: str) -> int | None:
        """Return the 0-based column called ``name``; None when none or more than one is."""
        for header in self.headers:
            if header.count(name) == 1:
                return header.index(name)
        return None

    def read(self, columns: Sequence[int]) -> Rows:
        """Parse the columns, which must be below ``width``.

        Raises
        ------
        RecordingUnreadable
            When not one row is good.
        """
        blocks: list[NDArray[np.float64]] = []
        bad: list[int] = []
        for start in range(0, len(self.lines), _BLOCK):
            self._parse(start, min(start + _BLOCK, len(self.lines)), columns, blocks, bad)
        values = np.concatenate(blocks)
        if not len(values):
            raise RecordingUnreadable(self.file, bad[0] if bad else 0, "no row holds numbers in the columns asked for")
        return Rows(values, len(bad), bad[0] if bad else 0)

    def _parse(
        self, start: int, end: int, columns: Sequence[int], blocks: list[NDArray[np.float64]], bad: list[int]
    ) -> None:
        """Append the good rows of ``lines[start:end]`` to ``blocks`` and the line numbers of the others to ``bad``."""
        block = self.lines[start:end]
        values = self._parse_quickly(block, columns)
        if values is None and end - start > _ROW_BY_ROW:
            middle = (start + end) // 2
            self._parse(start, middle, columns, blocks, bad)
            self._parse(middle, end, columns, blocks, bad)
            return
        if values is None:
            values, wrong = self._parse_row_by_row(block, columns)
            bad += [self.first_line + start + row for row in wrong]
        blocks.append(values)

    def _parse_quickly(self, block: Sequence[str], columns: Sequence[int]) -> NDArray[np.float64] | None:
        """Return the block's numbers, None when one of its rows needs a closer look."""
        if self.delimiter == BLANKS:
            regular = all(len(line.split()) == self.width for line in block)
        else:
            regular = all(line.count(self.delimiter) == self.width - 1 for line in block)
            pair = 2 * self.delimiter
            if regular and any(pair in line or line.endswith(self.delimiter) for line in block):
                block = [_fill(line, self.delimiter) for line in block]
        if not regular:
            return None
        try:
            values = np.loadtxt(block, delimiter=self.delimiter or None, usecols=columns, comments=None, ndmin=2)
        except ValueError:
            return None
        return None if len(values) != len(block) or np.isinf(values).any() else values

    def _parse_row_by_row(self, block: Sequence[str], columns: Sequence[int]) -> tuple[NDArray[np.float64], list[int]]:
        rows, wrong = [], []
        for position, line in enumerate(block):
            if not line.strip():
                continue
            try:
                cells = _split(line, self.delimiter)
                if len(cells) != self.width:
                    raise ValueError(len(cells))
                rows.append([_number(cells[column]) for column in columns])
            except (ValueError, csv.Error):
                wrong.append(position)
        return np.array(rows, np.float64).reshape(-1, len(columns)), wrong


def open_table(path: Path) -> Table:
    """Recognise the layout of a text file.

    Raises
    ------
    RecordingUnreadable
        When the file cannot be opened or holds no table of at least two columns of numbers.
    """
    lines = _read_lines(path)
    sample = [line for line in lines if line.strip()][:_LOOKED_AT]
    score, delimiter, width = 0, BLANKS, 0
    for candidate in _DELIMITERS:
        numbers, cells = _explain(sample, candidate)
        if numbers > score:
            score, delimiter, width = numbers, candidate, cells
    start = next((i for i, line in enumerate(lines) if width and _is_row(line, delimiter, width)), None)
    if start is None:
        raise RecordingUnreadable(str(path), 0, "it holds no table of numbers")
    rows = lines[start:]
    if delimiter != "," and any("," in line for line in rows):
        rows = [line.replace(",", ".") for line in rows]
    return Table(str(path), delimiter, width, _headers(lines[:start], delimiter, width), rows, start + 1)


def _read_lines(path: Path) -> list[str]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RecordingUnreadable(str(path), 0, (error.strerror or "it cannot be opened").lower()) from error
    return decode_text(data).replace("\r\n", "\n").replace("\r", "\n").split("\n")


def decode_text(data: bytes) -> str:
    """Return the text of a file in UTF-8, UTF-16 with BOM, or else one byte a letter."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return data.decode("utf-16", errors="replace")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Windows programs write "°/s" as one byte; only header words can contain it.
        return data.decode("latin-1")


def _split(line: str, delimiter: str) -> list[str]:
    if delimiter == BLANKS:
        return line.split()
    if '"' in line:
        return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))
    return line.split(delimiter)


def _fill(line: str, delimiter: str) -> str:
    """Return the line with ``nan`` in its empty cells, which the fast parser does not know."""
    pair, filled = 2 * delimiter, f"{delimiter}nan{delimiter}"
    # Twice: neighbouring empty cells share a delimiter.
    line = f"{delimiter}{line}{delimiter}".replace(pair, filled).replace(pair, filled)
    return line[1:-1]


def _number(cell: str) -> float:
    """Return the number in a cell, NaN for a missing one; ValueError for anything else."""
    cell = cell.strip()
    if cell.lower() in _MISSING:
        return float("nan")
    value = float(cell)
    if "_" in cell or value in (float("inf"), float("-inf")):
        raise ValueError(cell)
    return value


def _count_numbers(cells: Sequence[str], delimiter: str) -> int:
    """Return how many cells hold a number; a missing one is none."""
    numbers = 0
    for cell in cells:
        try:
            value = _number(cell if delimiter == "," else cell.replace(",", "."))
        except ValueError:
            continue
        numbers += value == value
    return numbers


def _cells(line: str, delimiter: str) -> list[str]:
    try:
        return _split(line, delimiter)
    except csv.Error:
        return []


def _explain(sample: Sequence[str], delimiter: str) -> tuple[int, int]:
    """Return how many numbers the delimiter uncovers in rows of one width, and that width."""
    numbers: Counter[int] = Counter()
    for line in sample:
        cells = _cells(line, delimiter)
        if len(cells) > 1:
            numbers[len(cells)] += _count_numbers(cells, delimiter)
    width, count = max(numbers.items(), key=lambda item: item[1], default=(0, 0))
    return count, width


def _is_row(line: str, delimiter: str, width: int) -> bool:
    """Return whether the line holds numbers rather than names or notes."""
    cells = _cells(line, delimiter)
    missing = sum(cell.strip().lower() in _MISSING for cell in cells)
    numbers = _count_numbers(cells, delimiter)
    return len(cells) == width and numbers > 0 and 2 * (numbers + missing) > width


def _headers(above: Sequence[str], delimiter: str, width: int) -> tuple[tuple[str, ...], ...]:
    """Return the rows of words above the numbers; a trailing delimiter may make one differ by a cell."""
    headers: list[tuple[str, ...]] = []
    for line in reversed(above):
        if not line.strip():
            if headers:
                break
            continue
        cells = _cells(line.lstrip("#% "), delimiter)
        if abs(len(cells) - width) > 1 or len(cells) < 2:
            break
        headers.insert(0, tuple(cell.strip() for cell in cells))
    return tuple(headers)
