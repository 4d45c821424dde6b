"""The worker process: results, progress and refusals come back, a lost process is noticed."""

import os

import pytest

from studio.capture.worker import Worker, WorkerLost
from studio.core.errors import NothingToExport
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
