"""``studio record``: the folder of the take on stdout, what happens meanwhile on stderr."""

import asyncio
import contextlib
import signal
import sys
from argparse import Namespace
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Empty
from types import FrameType

from studio.capture.headless import Recorded, RecordRequest
from studio.capture.headless import record as record_take
from studio.capture.live_session import LiveSession
from studio.capture.runtime import Runtime
from studio.cli import reports
from studio.cli.help_texts import COMMAND
from studio.cli.record_progress import RecordProgress, summary
from studio.storage.recovery import recover_all
from studio.ui.wording import one_line

WAIT = 0.2  # s; between looks, so that Ctrl+C is heard on every system

POLITE = ("SIGINT", "SIGTERM", "SIGHUP")
"""Signals that end a recording as its time would: Ctrl+C, a polite kill, a terminal that was closed."""


def record(arguments: Namespace) -> None:
    """Record a take."""
    request = RecordRequest(
        arguments.source,
        arguments.seconds,
        arguments.library,
        arguments.person,
        arguments.name,
        arguments.stature,
    )
    recorded = _record(request)
    with contextlib.suppress(OSError):  # the terminal was closed; the take is kept
        print(recorded.saved.folder, flush=True)
    _say(summary(recorded.saved.duration, recorded.sensors, recorded.loss))
    _finish_others(arguments.library)
    if recorded.mistake is not None:
        raise recorded.mistake
    if recorded.stopped_by is not None:
        raise recorded.stopped_by


def _record(request: RecordRequest) -> Recorded:
    runtime = Runtime()
    session = LiveSession(pre_roll=float("inf"))
    stop = asyncio.Event()
    with _ended_by_signals(runtime, stop):
        try:
            future = runtime.call(record_take(request, session, stop))
            progress = RecordProgress()
            while not future.done():
                with contextlib.suppress(TimeoutError):
                    future.exception(WAIT)
                _tell(session, progress)
            _tell(session, progress)
            return future.result()
        finally:
            runtime.stop()


@contextmanager
def _ended_by_signals(runtime: Runtime, stop: asyncio.Event) -> Iterator[None]:
    def interrupt(number: int, frame: FrameType | None) -> None:
        runtime.soon(stop.set)

    numbers = [getattr(signal, name) for name in POLITE if hasattr(signal, name)]
    before = {number: signal.signal(number, interrupt) for number in numbers}
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _tell(session: LiveSession, progress: RecordProgress) -> None:
    """Say what has happened since the last look."""
    with contextlib.suppress(Empty):
        while True:
            for line in progress.lines(session.events.get_nowait(), session.setup.assignment):
                _say(line)


def _say(line: str) -> None:
    with contextlib.suppress(OSError):  # the terminal was closed
        print(line, file=sys.stderr, flush=True)


def _finish_others(library: Path) -> None:
    """Give takes whose recording was cut off their end, now that nothing waits for the disk."""
    for folder, error in recover_all(library):
        _say(reports.RECOVERED.format(folder=folder, command=COMMAND) if error is None else one_line(error))
