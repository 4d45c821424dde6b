"""Numbers as decimal text, a table at a time: tables of ready-made digits instead of ``%f``.

Each cell is looked up in pieces (sign and up to four digits, then three decimals at a time) and laid
into a byte matrix of fixed width; unused places stay NUL and are deleted at the end. No locale takes
part. Equal to ``"%.6f"`` except that a tie may fall to the other neighbour and that zero has no sign.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]

GROUP = 10_000  # integer digits are looked up four at a time: 20,000 entries of 8 bytes stay in the cache
LARGEST = GROUP * GROUP  # two groups of integer digits; larger numbers go through Python, column by column
WHOLE = 2.0**53  # above it not every integer is a double, so that the scaled number would lose its last digits


@dataclass(frozen=True)
class Numbers:
    """Columns of numbers."""

    values: NDArray[np.float64]
    """(n, columns); NaN becomes an empty cell."""
    decimals: int
    """0, 6 or 9."""


@dataclass(frozen=True)
class Words:
    """One column of words out of a few."""

    codes: NDArray[np.int64]
    """(n,), index into ``words``."""
    words: tuple[bytes, ...]
    """Ready for the file: quoted and free of NUL."""


@dataclass(frozen=True)
class Punctuation:
    """What stands between the digits of a file."""

    decimal: bytes = b"."
    separator: bytes = b","
    line_end: bytes = b"\r\n"


def as_text(columns: Sequence[Numbers | Words], punctuation: Punctuation) -> bytes:
    """Return rows of cells, each ended by the separator and the last by the line end.

    Infinite numbers are our own mistake: ValueError.
    """
    cells = [_cells(column, punctuation) for column in columns]
    ending = np.frombuffer(punctuation.line_end, np.uint8)
    rows = len(cells[0])
    page = np.concatenate([*cells, np.broadcast_to(ending, (rows, len(ending)))], axis=1)
    page[:, -len(ending) - 1] = 0  # the separator after the last cell
    return page.tobytes().translate(None, b"\0")


def _cells(column: Numbers | Words, punctuation: Punctuation) -> Bytes:
    return _words(column, punctuation) if isinstance(column, Words) else _numbers(column, punctuation)


def _words(column: Words, punctuation: Punctuation) -> Bytes:
    width = max(len(word) for word in column.words)
    table = np.zeros((len(column.words), width + 1), np.uint8)
    for row, word in zip(table, column.words, strict=True):
        row[: len(word)] = np.frombuffer(word, np.uint8)
    table[:, -1] = punctuation.separator[0]
    return np.take(table, column.codes, axis=0)


def _numbers(column: Numbers, punctuation: Punctuation) -> Bytes:
    if column.decimals not in (0, 6, 9):  # one group of three has no room for both point and separator
        raise ValueError(f"{column.decimals} decimals are not offered")
    if np.isinf(column.values).any():
        raise ValueError("infinite numbers have no decimal digits")
    rows, width = column.values.shape
    missing = np.isnan(column.values)
    values = np.where(missing, 0.0, column.values) if missing.any() else column.values
    scaled = np.rint(np.abs(values) * 10.0**column.decimals)
    if scaled.size and scaled.max() >= min(LARGEST * 10.0**column.decimals, WHOLE):
        return _by_python(column, punctuation)
    cells = _digits(scaled.astype(np.int64), values < 0, column.decimals, punctuation)
    if missing.any():
        cells[missing, :-1] = 0
    return cells.reshape(rows, width * cells.shape[-1])


def _digits(scaled: NDArray[np.int64], negative: NDArray[np.bool_], decimals: int, punctuation: Punctuation) -> Bytes:
    """Return cells (rows, columns, bytes) of non-negative integers in units of the last decimal."""
    unit = 10**decimals
    whole = scaled // unit
    part = scaled - whole * unit
    negative = negative & (scaled > 0)
    large = bool(whole.size) and int(whole.max()) >= GROUP
    groups = decimals // 3
    width = 8 * (1 + large) + 4 * max(groups, 1)
    cells = np.zeros((*scaled.shape, width), np.uint8)
    eights, fours = cells[..., : 8 * (1 + large)].view(np.uint64), cells[..., 8 * (1 + large) :].view(np.uint32)
    if large:
        high = whole // GROUP
        low = whole - high * GROUP
        eights[..., 0] = np.where(high > 0, _signed()[high + GROUP * (negative & (high > 0))], 0)
        eights[..., 1] = np.where(high > 0, _padded()[low], _signed()[low + GROUP * negative])
    else:
        eights[..., 0] = _signed()[whole + GROUP * negative]
    if not groups:
        cells[..., -1] = punctuation.separator[0]
        return cells
    _fraction(part, fours, punctuation)
    return cells


def _fraction(part: NDArray[np.int64], fours: NDArray[np.uint32], punctuation: Punctuation) -> None:
    """Fill 4 bytes for each three decimals: the point before the first, the separator after the last."""
    groups = fours.shape[-1]
    thousands = part
    for group in range(groups - 1, -1, -1):
        rest = thousands // 1000
        digits = thousands - rest * 1000
        thousands = rest
        before = punctuation.decimal if group == 0 else b""
        after = punctuation.separator if group == groups - 1 else b""
        fours[..., group] = _triples(before, after)[digits]


@lru_cache(maxsize=1)
def _signed() -> NDArray[np.uint64]:
    """Return 0 … 9999 and then -0 … -9999 as up to five characters in eight bytes."""
    texts = [f"{sign}{number}".encode().rjust(8, b"\0") for sign in ("", "-") for number in range(GROUP)]
    return np.frombuffer(b"".join(texts), np.uint64)


@lru_cache(maxsize=1)
def _padded() -> NDArray[np.uint64]:
    """Return 0000 … 9999 in eight bytes."""
    return np.frombuffer(b"".join(f"{number:04d}".encode().rjust(8, b"\0") for number in range(GROUP)), np.uint64)


@lru_cache(maxsize=16)
def _triples(before: bytes, after: bytes) -> NDArray[np.uint32]:
    """Return 000 … 999 between ``before`` and ``after`` in four bytes."""
    texts = [(before + f"{number:03d}".encode() + after).ljust(4, b"\0") for number in range(1000)]
    return np.frombuffer(b"".join(texts), np.uint32)


def _by_python(column: Numbers, punctuation: Punctuation) -> Bytes:
    """Return the same cells for numbers of any size, slowly."""
    flat = column.values.ravel()
    # Adding zero takes the sign off a negative zero.
    rounded = [round(value, column.decimals) + 0.0 for value in flat.tolist()]
    texts = ["" if np.isnan(value) else f"{value:.{column.decimals}f}" for value in rounded]
    written = [text.encode().replace(b".", punctuation.decimal) + punctuation.separator for text in texts]
    width = max(len(text) for text in written)
    cells = np.frombuffer(b"".join(text.rjust(width, b"\0") for text in written), np.uint8)
    return cells.reshape(len(column.values), -1)
