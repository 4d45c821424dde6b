"""What the worker does for somebody who looks at a take: solve it once, and keep the motion for the next time."""

from pathlib import Path
from typing import NamedTuple

from studio.capture.jobs import Progress, SolveRequest, load, motion_of
from studio.core.pose import Motion
from studio.core.take import Mark


class Solved(NamedTuple):
    """A take that can be looked at."""

    folder: Path
    key: str
    """Of the motion in ``derived/``."""
    motion: Motion | None
    """Only when it could not be kept there: a library that cannot be written."""
    marks: tuple[Mark, ...]


def run_review(request: SolveRequest, progress: Progress) -> Solved:
    """Return the motion of a take, computed unless that was done before.

    Raises
    ------
    TakeFileError, CalibrationError, AlignmentError
    """
    loaded = load(request, progress)
    progress("solve", 0.2)
    motion, is_kept = motion_of(request.take, loaded)
    progress("solve", 1.0)
    return Solved(request.take, loaded.key, None if is_kept else motion, loaded.take.marks)
