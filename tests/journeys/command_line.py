"""The studio as a person at a terminal has it: words in, an exit code and two streams of text out."""

import contextlib
import csv
import io
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

from studio.cli import main


class Answer(NamedTuple):
    """What the studio said."""

    code: int
    out: str
    err: str


def say(*words: object) -> Answer:
    """Run one verb in this process."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(word) for word in words])
    return Answer(code, out.getvalue(), err.getvalue())


def recorded(source: str, seconds: float, library: Path) -> Path:
    """Record from a source that is as fast as it can be, and return the folder of the take."""
    answer = say("record", "--source", source, "--seconds", seconds, "--library", library)
    assert answer.code == 0, answer.err
    return Path(answer.out.removesuffix("\n"))


_RECORDED: dict[str, Path] = {}


def minute_of_walking(seed: int, loss: float, folders: pytest.TempPathFactory) -> Path:
    """Return the take of a calibrated suit's walk, recorded once for all tests that look at it."""
    source = f"synthetic:walk?speed=max&seed={seed}&calibrated=1" + (f"&loss={loss}" if loss else "")
    if source not in _RECORDED:
        _RECORDED[source] = recorded(source, 60, folders.mktemp("walk"))
    return _RECORDED[source]


def columns_of(path: Path) -> dict[str, NDArray[np.float64]]:
    """Return the columns of a table of numbers by name; empty cells are NaN."""
    with path.open(newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    cells = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    return dict(zip(names, cells.T, strict=True))
