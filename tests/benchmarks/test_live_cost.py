"""What 15 tags cost while they are received, solved and kept: share of one core, through a pseudo-terminal."""

import asyncio
import sys
import time

import pytest

from studio.analysis.ledger import ledger
from studio.capture.headless import RecordRequest, record
from studio.capture.live_session import LiveSession
from studio.storage.take_reader import read_take
from tests.journeys.test_receiver_on_a_cable import suit

pytestmark = [
    pytest.mark.benchmark,
    pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals"),
]

SECONDS = 30


@pytest.mark.parametrize("rate", [50, 100])
def test_live_cost_of_fifteen_tags(tmp_path, rate):
    session = LiveSession(pre_roll=float("inf"))
    with suit(f"walk?seed=1&rate={rate}&speed=1", SECONDS + 5) as port:
        request = RecordRequest(f"serial:{port}", SECONDS, tmp_path, "P014", "cost")

        async def measured():
            return await record(request, session, asyncio.Event())

        wall, used = time.perf_counter(), time.process_time()
        saved = asyncio.run(measured())
        wall, used = time.perf_counter() - wall, time.process_time() - used
    take, _ = read_take(saved.folder)
    accounts = ledger(take)

    print(
        f"\n15 tags x {rate} Hz for {SECONDS} s: {used / wall:.1%} of a core for decoding, solving and writing "
        f"(start, stop and reading back included); {saved.samples} samples, {sum(a.lost for a in accounts)} lost"
    )
    assert sum(account.lost for account in accounts) == 0
    assert len(accounts) == 15
