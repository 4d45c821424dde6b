"""The worker process: offline work away from the window, because the attitude filter holds Python's lock.

Requests and results are frozen values; progress comes over a pipe. One job at a time.
"""

import multiprocessing
import threading
from collections.abc import Callable
from concurrent.futures import Future
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar, cast

from studio.core.errors import StudioError

T = TypeVar("T")
R = TypeVar("R")

Progress = Callable[[str, float], None]
Job = Callable[[R, Progress], T]
"""A function at the top of a module: it is found by name on the other side."""


class WorkerLost(Exception):
    """The worker process ended in the middle of a job: a mistake of ours, or the system ran out of memory."""


class Worker:
    """Starts its process at the first job and keeps it for the next ones."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    def submit(self, job: "Job[R, T]", request: R, progress: Progress) -> "Future[T]":
        """Run ``job(request, progress)`` in the worker process.

        ``progress`` is called on a thread of its own. The future raises what the job raised.
        """
        future: Future[T] = Future()
        waiter = threading.Thread(
            target=self._attend, args=(job, request, progress, future), name="worker", daemon=True
        )
        waiter.start()
        return future

    def close(self) -> None:
        """End the process."""
        with self._lock:
            if self._pipe is not None and self._process is not None:
                self._pipe.close()
                self._process.join(1.0)
                if self._process.is_alive():
                    self._process.terminate()
                    self._process.join()
            self._pipe = self._process = None

    def _attend(self, job: "Job[R, T]", request: R, progress: Progress, future: "Future[T]") -> None:
        with self._lock:
            try:
                future.set_result(cast(T, self._run(job, request, progress)))
            except BaseException as error:  # noqa: BLE001 (outermost place of this thread; the future re-raises it)
                future.set_exception(error)

    def _run(self, job: "Job[R, T]", request: R, progress: Progress) -> Any:
        pipe = self._opened()
        try:
            pipe.send((job, request))
            while True:
                kind, *content = pipe.recv()
                if kind == "progress":
                    progress(*content)
                elif kind == "result":
                    return content[0]
                else:
                    raise content[0]
        except (EOFError, OSError) as lost:
            self._pipe = self._process = None
            raise WorkerLost from lost

    def _opened(self) -> Connection:
        if self._pipe is None or self._process is None or not self._process.is_alive():
            context = multiprocessing.get_context("spawn")
            self._pipe, theirs = context.Pipe()
            self._process = context.Process(target=_serve, args=(theirs,), name="kinetag worker", daemon=True)
            self._process.start()
            theirs.close()
        return self._pipe


def _serve(pipe: Connection) -> None:
    """Run jobs until the other side closes the pipe."""
    while True:
        try:
            job, request = pipe.recv()
        except EOFError:
            return

        def progress(what: str, share: float) -> None:
            pipe.send(("progress", what, share))

        try:
            pipe.send(("result", job(request, progress)))
        except StudioError as refusal:
            pipe.send(("refused", refusal))
