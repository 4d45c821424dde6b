"""Something that was asked for and is under way elsewhere: looked at on every tick, never waited for."""

from collections.abc import Callable
from concurrent.futures import Future, wait
from queue import Empty, SimpleQueue
from typing import Any

from PySide6.QtCore import QObject, Signal

from studio.core.errors import StudioError


class Operation(QObject):
    """A future with progress, told on the Qt thread."""

    done = Signal(object)
    """The result."""
    refused = Signal(object)
    """A StudioError."""
    failed = Signal()
    """It ended by a mistake of ours, which is raised right after."""
    progressed = Signal(str, float)
    """What is being done, and how far it is, 0…1."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._future: Future[Any] | None = None
        self._progress: SimpleQueue[tuple[str, float]] = SimpleQueue()

    def begin(self, start: Callable[[Callable[[str, float], None]], "Future[Any]"]) -> None:
        """Start it: ``start`` is given the function that tells the progress, from any thread."""
        self._future = start(self._tell)

    @property
    def is_running(self) -> bool:
        """Whether there is still an answer to come."""
        return self._future is not None

    def wait(self, timeout: float) -> None:
        """Wait for the end, at most ``timeout`` s; ``poll`` tells what came of it."""
        if self._future is not None:
            wait((self._future,), timeout)

    def cancel(self) -> None:
        """Call it off: nothing is told of it any more."""
        if self._future is not None:
            self._future.cancel()
            self._future = None

    def poll(self) -> None:
        """Tell what has happened since the last time; our own mistakes are raised here."""
        while True:
            try:
                self.progressed.emit(*self._progress.get_nowait())
            except Empty:
                break
        future = self._future
        if future is None or not future.done():
            return
        self._future = None
        error = future.exception()
        if error is None:
            self.done.emit(future.result())
        elif isinstance(error, StudioError):
            self.refused.emit(error)
        else:
            self.failed.emit()
            raise error

    def _tell(self, what: str, share: float) -> None:
        self._progress.put((what, share))
