"""The worker process: results, progress and refusals come back, a lost process is noticed."""

import os
import threading
import traceback

import pytest

from studio.capture.worker import JobFailed, Worker
from studio.core.errors import NothingToExport, WorkerLost
from tests.capture import worker_jobs

PATIENCE = 30  # s; starting Python takes a second on a busy machine


@pytest.fixture
def worker():
    worker = Worker()
    yield worker
    worker.close()


def nothing(what, share):
    """Watch nothing."""


def test_a_job_runs_in_another_process_and_tells_how_far_it_is(worker):
    told = []

    process = worker.submit(worker_jobs.count, 4, lambda what, share: told.append((what, share))).result(PATIENCE)

    assert process != os.getpid()
    assert told == [("solve", 0.25), ("solve", 0.5), ("solve", 0.75), ("solve", 1.0)]


def test_the_process_is_kept_for_the_next_job(worker):
    first = worker.submit(worker_jobs.count, 1, nothing).result(PATIENCE)

    assert worker.submit(worker_jobs.count, 1, nothing).result(PATIENCE) == first


def test_a_refusal_arrives_with_its_facts(worker):
    with pytest.raises(NothingToExport) as refusal:
        worker.submit(worker_jobs.refuse, "joint angles", nothing).result(PATIENCE)

    assert refusal.value.what == "joint angles"


def test_a_process_that_dies_is_noticed_and_the_next_job_gets_a_new_one(worker):
    with pytest.raises(WorkerLost):
        worker.submit(worker_jobs.die, None, nothing).result(PATIENCE)

    assert worker.submit(worker_jobs.count, 1, nothing).result(PATIENCE) != os.getpid()


def test_a_mistake_of_ours_arrives_with_where_it_happened_and_the_process_lives_on(worker):
    process = worker.submit(worker_jobs.count, 1, nothing).result(PATIENCE)

    with pytest.raises(JobFailed, match=r"(?s)worker_jobs.py.*in stumble\n.*IndexError") as failure:
        worker.submit(worker_jobs.stumble, 3, nothing).result(PATIENCE)
    with pytest.raises(JobFailed, match="pickle"):
        worker.submit(worker_jobs.answer_with_what_cannot_be_sent, 3, nothing).result(PATIENCE)

    assert "IndexError: list index out of range" in write_crash_text(failure.value)
    assert worker.submit(worker_jobs.count, 1, nothing).result(PATIENCE) == process


def write_crash_text(error):
    return "".join(traceback.format_exception(error))


def test_progress_that_fails_costs_its_own_job_only(worker):
    def fail(what, share):
        raise BrokenPipeError("nobody watches")

    with pytest.raises(BrokenPipeError, match="nobody watches"):
        worker.submit(worker_jobs.answer_with, "first", fail).result(PATIENCE)

    assert worker.submit(worker_jobs.answer_with, "second", nothing).result(PATIENCE) == "second"


def test_closing_ends_what_runs_and_what_waits(worker):
    begun = threading.Event()
    running = worker.submit(worker_jobs.run_for_ever, None, lambda what, share: begun.set())
    assert begun.wait(PATIENCE)
    waiting = worker.submit(worker_jobs.count, 1, nothing)

    worker.close()

    for future in (running, waiting, worker.submit(worker_jobs.count, 1, nothing)):
        with pytest.raises(WorkerLost):
            future.result(PATIENCE)


def test_a_job_called_off_before_its_turn_does_not_run(worker):
    begun, go_on, told = threading.Event(), threading.Event(), []

    def hold(what, share):
        begun.set()
        go_on.wait(PATIENCE)

    first = worker.submit(worker_jobs.answer_with, 1, hold)
    assert begun.wait(PATIENCE)
    second = worker.submit(worker_jobs.answer_with, 2, lambda what, share: told.append(what))

    assert second.cancel()
    go_on.set()

    assert first.result(PATIENCE) == 1
    assert worker.submit(worker_jobs.answer_with, 3, nothing).result(PATIENCE) == 3
    assert told == []
