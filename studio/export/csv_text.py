"""CSV by RFC 4180, written fast and read back slowly."""

import csv
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core.errors import ReadBackDiffers
from studio.export.csv_tables import Preset, Table
from studio.export.number_format import Numbers, Words, as_text

BLOCK = 1024  # rows
FORMULA = ("=", "+", "-", "@", "\t", "\r")  # a spreadsheet computes cells that begin so (ASVS 1.2.10)


def csv_blocks(table: Table, preset: Preset) -> Iterator[bytes]:
    """Yield the header row, then some rows at a time; missing numbers are empty cells."""
    separator = preset.punctuation.separator
    header = separator.join(quoted(name.encode(), separator) for name in table.names)
    yield preset.mark + header + preset.punctuation.line_end
    columns = [_ready(column, separator) for column in table.columns]
    for first in range(0, table.rows, BLOCK):
        rows = slice(first, first + BLOCK)
        yield as_text([_part(column, rows) for column in columns], preset.punctuation)


def harmless(text: bytes) -> bytes:
    """Return a text that no spreadsheet takes for a formula."""
    clean = text.replace(b"\0", b"")
    return b"'" + clean if clean.decode().startswith(FORMULA) else clean


def quoted(text: bytes, separator: bytes) -> bytes:
    """Return a text cell that is no formula, in quotes where RFC 4180 wants them."""
    clean = harmless(text)
    if any(sign in clean for sign in (separator, b'"', b"\r", b"\n")):
        return b'"' + clean.replace(b'"', b'""') + b'"'
    return clean


def compare_with_table(path: Path, table: Table, preset: Preset) -> None:
    """Raise ReadBackDiffers unless the csv module reads the table's own names, words and numbers from ``path``."""
    with path.open(encoding="utf-8-sig" if preset.mark else "utf-8", newline="") as file:
        reader = csv.reader(file, delimiter=preset.punctuation.separator.decode(), strict=True)
        try:
            if tuple(next(reader, [])) != table.names:
                raise ReadBackDiffers(str(path), "the header differs")
            row = 0
            while lines := list(islice(reader, BLOCK)):
                _compare_rows(lines, row, path, table, preset)
                row += len(lines)
        except (csv.Error, UnicodeDecodeError) as failure:
            raise ReadBackDiffers(str(path), f"not CSV: {failure}") from failure
    if row != table.rows:
        raise ReadBackDiffers(str(path), f"{row} rows instead of {table.rows}")


def _compare_rows(lines: list[list[str]], row: int, path: Path, table: Table, preset: Preset) -> None:
    if any(len(line) != len(table.names) for line in lines) or row + len(lines) > table.rows:
        raise ReadBackDiffers(str(path), f"rows after {row} are longer, shorter or more than meant")
    cells = np.array(lines)
    first = 0
    for column in table.columns:
        rows = slice(row, row + len(lines))
        width = 1 if isinstance(column, Words) else column.values.shape[1]
        found = cells[:, first : first + width]
        same = _same_words(found, column, rows) if isinstance(column, Words) else _same(found, column, rows, preset)
        if not same:
            raise ReadBackDiffers(str(path), f"{table.names[first]} differs after row {row}")
        first += width


def _same_words(found: NDArray[np.str_], column: Words, rows: slice) -> bool:
    meant = np.array([harmless(word).decode() for word in column.words])
    return bool((found[:, 0] == meant[column.codes[rows]]).all())


def _same(found: NDArray[np.str_], column: Numbers, rows: slice, preset: Preset) -> bool:
    meant = column.values[rows]
    texts = np.char.replace(found, preset.punctuation.decimal.decode(), ".")
    try:
        numbers = np.where(texts == "", "nan", texts).astype(np.float64)
    except ValueError:
        return False
    half = 0.5 * 10.0**-column.decimals + 1e-15 * np.abs(meant)  # half a last digit and the rounding of a double
    return bool(((np.abs(numbers - meant) <= half * (1 + 1e-6)) | (np.isnan(numbers) & np.isnan(meant))).all())


def _ready(column: Numbers | Words, separator: bytes) -> Numbers | Words:
    if isinstance(column, Numbers):
        return column
    return Words(column.codes, tuple(quoted(word, separator) for word in column.words))


def _part(column: Numbers | Words, rows: slice) -> Numbers | Words:
    if isinstance(column, Words):
        return Words(column.codes[rows], column.words)
    return Numbers(column.values[rows], column.decimals)
