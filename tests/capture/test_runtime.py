"""The acquisition thread."""

import asyncio
import threading

import pytest

from studio.capture.runtime import Runtime


async def thread_name():
    return threading.current_thread().name


async def fail():
    raise ValueError("on purpose")


def test_coroutines_run_on_one_other_thread_and_their_results_come_back():
    runtime = Runtime()

    names = {runtime.call(thread_name()).result(5) for _ in range(3)}

    runtime.stop()
    assert names == {"acquisition"}


def test_what_a_coroutine_raises_arrives_at_the_caller():
    runtime = Runtime()
    try:
        with pytest.raises(ValueError, match="on purpose"):
            runtime.call(fail()).result(5)
    finally:
        runtime.stop()


def test_stopping_cancels_what_still_runs_and_leaves_no_thread():
    runtime = Runtime()
    cancelled = threading.Event()

    async def forever():
        try:
            await asyncio.Event().wait()
        finally:
            cancelled.set()

    runtime.call(forever())
    runtime.call(thread_name()).result(5)

    runtime.stop()

    assert cancelled.is_set()
    assert "acquisition" not in {thread.name for thread in threading.enumerate()}
