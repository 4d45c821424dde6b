"""Whether the last starts ended as they should: a file that stands as long as the studio runs.

A studio that crashes each time it opens the last source or take could never be started again; after the second such
start it offers to leave them closed.
"""

import contextlib
import os
from pathlib import Path

from studio.storage.filesystem import FILES, FOLDER_MODE, is_held

OFFERED_AFTER = 2  # starts that did not end well, one after the other

_PREFIX = "run_"


class StartGuard:
    """The sentinel of this process, and those that others left behind."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._own: tuple[int, Path] | None = None
        self.crashes = 0
        """Earlier starts, one after the other, that never ended."""

    @property
    def offers_safe_start(self) -> bool:
        """Whether to start without the last source and the last take."""
        return self.crashes >= OFFERED_AFTER

    def begin(self) -> None:
        """Count what was left behind and stand up for this process. A folder without rights counts as no crash."""
        with contextlib.suppress(OSError):
            self._folder.mkdir(mode=FOLDER_MODE, parents=True, exist_ok=True)
            self.crashes = len(self._left_behind())
            file = self._free_name()
            # The lock ends with the process, however it ends; its number may soon be another program's.
            self._own = FILES.create(file), file

    def end(self) -> None:
        """This run ended well: nothing is held against it or the starts before it."""
        if self._own is None:
            return
        descriptor, file = self._own
        self._own = None
        with contextlib.suppress(OSError):
            FILES.close(descriptor)
            FILES.remove(file)
            for stale in self._left_behind():
                FILES.remove(stale)

    def _left_behind(self) -> list[Path]:
        return [file for file in self._folder.glob(f"{_PREFIX}*") if not is_held(file)]

    def _free_name(self) -> Path:
        name = f"{_PREFIX}{os.getpid()}"
        taken = len(list(self._folder.glob(f"{name}*")))  # the number of a process that crashed came round again
        return self._folder / (f"{name}_{taken}" if taken else name)
