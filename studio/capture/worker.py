"""The worker process: offline work away from the window, because the attitude filter holds Python's lock.

Requests and results are frozen values; progress comes over a pipe. One job at a time.
"""

import multiprocessing
import threading
import traceback
from collections.abc import Callable
from concurrent.futures import Future
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from typing import Any, TypeVar, cast

from studio.core.errors import StudioError, WorkerLost

PATIENCE = 0.5  # s; a process that does not end by then is not asked again

T = TypeVar("T")
R = TypeVar("R")

Progress = Callable[[str, float], None]
Job = Callable[[R, Progress], T]
"""A function at the top of a module: it is found by name on the other side."""


class JobFailed(Exception):
    """A job made a mistake of ours; the text is the traceback from the worker process."""


class Worker:
    """Starts its process at the first job and keeps it for the next ones."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        """Held while a job runs."""
        self._gate = threading.Lock()
        """Held while the process starts or ends."""
        self._closed = False
        self._process: BaseProcess | None = None
        self._pipe: Connection | None = None

    def submit(self, job: "Job[R, T]", request: R, progress: Progress) -> "Future[T]":
        """Run ``job(request, progress)`` in the worker process.

        ``progress`` is called on a thread of its own. The future raises the StudioError that the job raised,
        JobFailed for any other error, WorkerLost when the process ended, and what ``progress`` raised. Cancelled
        before its turn, the job does not run.
        """
        future: Future[T] = Future()
        waiter = threading.Thread(
            target=self._attend, args=(job, request, progress, future), name="worker", daemon=True
        )
        waiter.start()
        return future

    def close(self) -> None:
        """End the process, whatever it does: the job that runs and those that wait end with WorkerLost."""
        with self._gate:
            self._closed = True
            self._end()

    def _attend(self, job: "Job[R, T]", request: R, progress: Progress, future: "Future[T]") -> None:
        with self._turn:
            if not future.set_running_or_notify_cancel():
                return
            try:
                future.set_result(cast(T, self._run(job, request, progress)))
            except BaseException as error:  # noqa: BLE001 (outermost place of this thread; the future re-raises it)
                future.set_exception(error)

    def _run(self, job: "Job[R, T]", request: R, progress: Progress) -> Any:
        pipe = self._opened()
        answered = False
        try:
            _send(pipe, (job, request))
            kind, *content = _received(pipe)
            while kind == "progress":
                progress(*content)
                kind, *content = _received(pipe)
            answered = True
        finally:
            if not answered:  # what comes out of this pipe next would be taken for the answer to the next job
                pipe.close()
                with self._gate:
                    self._end()
        if kind == "result":
            return content[0]
        if kind == "refused":
            raise content[0]
        raise JobFailed(content[0])

    def _opened(self) -> Connection:
        with self._gate:
            if self._closed:
                raise WorkerLost
            if self._pipe is None or self._process is None or not self._process.is_alive():
                context = multiprocessing.get_context("spawn")
                self._pipe, theirs = context.Pipe()
                self._process = context.Process(target=_serve, args=(theirs,), name="kinetag worker", daemon=True)
                self._process.start()
                theirs.close()
            return self._pipe

    def _end(self) -> None:
        if self._process is not None:
            self._process.terminate()
            self._process.join(PATIENCE)
            if self._process.is_alive():
                self._process.kill()
        self._pipe = self._process = None


def _send(pipe: Connection, what: object) -> None:
    try:
        pipe.send(what)
    except OSError as lost:
        raise WorkerLost from lost


def _received(pipe: Connection) -> Any:
    try:
        return pipe.recv()
    except (EOFError, OSError) as lost:
        raise WorkerLost from lost


def _serve(pipe: Connection) -> None:
    """Run jobs until the other side closes the pipe."""

    def progress(what: str, share: float) -> None:
        pipe.send(("progress", what, share))

    while True:
        try:
            job, request = pipe.recv()
        except EOFError:
            return
        try:
            pipe.send(("result", job(request, progress)))
        except StudioError as refusal:
            pipe.send(("refused", refusal))
        except Exception:  # noqa: BLE001 (outermost place of this process; the future re-raises it)
            pipe.send(("failed", traceback.format_exc()))
