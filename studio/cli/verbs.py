"""What each verb does: ask, wait, print."""

import json
import sys
from argparse import Namespace
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import TypeVar

from studio.capture import jobs, library
from studio.capture.sources import find_sources
from studio.capture.truth import compare_with_truth
from studio.capture.worker import Job, Worker
from studio.cli import reports
from studio.export.bvh import DEFAULT_RATE
from studio.export.bvh import PRESETS as BVH_PRESETS
from studio.export.csv_tables import PRESETS as CSV_PRESETS
from studio.export.material import Wish
from studio.storage.take_reader import read_take

R = TypeVar("R")
T = TypeVar("T")

WAIT = 0.2  # s; between looks, so that Ctrl+C is heard on every system


def devices(arguments: Namespace) -> None:
    """List the sources."""
    found = find_sources()
    if arguments.json:
        print(json.dumps([source._asdict() for source in found], indent=2, ensure_ascii=False))
        return
    for source in found:
        print(f"{source.source:<32} {source.label}")


def import_recording(arguments: Namespace) -> None:
    """Import a foreign recording."""
    if arguments.map is not None and arguments.format == "xio":
        arguments.usage_error("--map explains tables; x-io recordings explain themselves")
    folder = library.import_into(
        arguments.library, arguments.paths, arguments.format, arguments.map, arguments.person, arguments.stature
    )
    print(folder)


def inspect(arguments: Namespace) -> None:
    """Show the ledger of a take, and how far its motion is from the truth."""
    take, report = read_take(arguments.take)
    truth = compare_with_truth(arguments.take) if arguments.truth else None
    if arguments.json:
        print(json.dumps(reports.inspection(take, report, truth), indent=2, ensure_ascii=False, allow_nan=False))
    else:
        print(reports.inspection_text(take, report, truth))


def solve(arguments: Namespace) -> None:
    """Solve a take in the worker process and show how."""
    report = _in_worker(jobs.run_solve, _solve_request(arguments))
    print(reports.solve_text(report))


def export(arguments: Namespace) -> None:
    """Write one file in the worker process."""
    presets = BVH_PRESETS if arguments.format == "bvh" else CSV_PRESETS
    preset = arguments.preset or next(iter(presets))
    if preset not in presets:
        arguments.usage_error(f"a {arguments.format} file has the presets {', '.join(presets)}")
    if arguments.format == "bvh" and arguments.table:
        arguments.usage_error("--table goes with --format csv")
    if arguments.output.suffix.lower() != f".{arguments.format}":
        arguments.usage_error(f"a {arguments.format} file ends in .{arguments.format}, unlike {arguments.output.name}")
    if arguments.format == "csv" and "fps" in arguments:
        arguments.usage_error("--fps goes with --format bvh; tables keep the times at which the sensors measured")
    exporter = "bvh" if arguments.format == "bvh" else (arguments.table or "joints")
    request = jobs.ExportRequest(
        _solve_request(arguments),
        exporter,
        Wish(preset, getattr(arguments, "fps", DEFAULT_RATE)),
        Path(arguments.output).absolute(),
        arguments.overwrite,
    )
    written, notes = _in_worker(jobs.run_export, request)
    for note in notes:
        print(note, file=sys.stderr)
    print(f"{written} (read back and compared)")


def _solve_request(arguments: Namespace) -> jobs.SolveRequest:
    return jobs.SolveRequest(
        arguments.take,
        arguments.attitude,
        arguments.method,
        arguments.calibration,
        tuple(arguments.poses),
        arguments.stature,
    )


def _in_worker(job: "Job[R, T]", request: R) -> T:
    worker = Worker()
    try:
        return _result(worker.submit(job, request, _progress()))
    finally:
        worker.close()


def _progress() -> Callable[[str, float], None]:
    """Return what shows the progress: nothing, unless somebody watches."""
    watched = sys.stderr.isatty()

    def show(what: str, share: float) -> None:
        if watched:
            end = "\n" if what == "write" and share >= 1 else ""
            print(f"\r{reports.STAGES[what]:<10} {share:4.0%}", end=end, file=sys.stderr, flush=True)

    return show


def _result(future: "Future[T]") -> T:
    """Wait for a future without shutting out signals."""
    while True:
        try:
            return future.result(WAIT)
        except TimeoutError:
            if future.done():
                raise
