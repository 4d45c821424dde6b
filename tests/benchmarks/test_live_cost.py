"""What 15 tags cost while they are received, solved and kept: share of one core, through a pseudo-terminal."""

import asyncio
import sys
import time

import pytest

from studio.analysis.ledger import ledger
from studio.capture.headless import RecordRequest, record
from studio.capture.live_session import LiveSession
from studio.core.take import Mark
from studio.storage.take_reader import read_take
from tests.journeys.test_receiver_on_a_cable import suit

pytestmark = [
    pytest.mark.benchmark,
    pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals"),
]

PRELUDE = 10  # s in which the suit stands, bows and is aligned
SECONDS = 30  # s measured after that
HOLDS = (("n", 1.2, 4.0), ("bow", 5.7, 7.7))  # s since switching on (resources/manual/synthetic-suit.md)


async def measured(session, request):
    """Return the take's folder and the share of a core while everything runs."""
    stop = asyncio.Event()
    recording = asyncio.create_task(record(request, session, stop))
    await asyncio.sleep(PRELUDE)
    first = session.recording.first
    for name, since, until in HOLDS:
        session.held(Mark(first + since, "pose", name, first + until))
    await asyncio.sleep(1)
    wall, used = time.perf_counter(), time.process_time()
    await asyncio.sleep(SECONDS)
    share = (time.process_time() - used) / (time.perf_counter() - wall)
    assert session.buffer.newest()[1] is not None, "no pose was computed"
    stop.set()
    return (await recording).saved.folder, share


@pytest.mark.parametrize("rate", [50, 100])
def test_live_cost_of_fifteen_tags(tmp_path, rate):
    session = LiveSession(pre_roll=float("inf"))
    with suit(f"walk?seed=1&calibrated=1&rate={rate}&speed=1", PRELUDE + SECONDS + 5) as port:
        request = RecordRequest(f"serial:{port}", float("inf"), tmp_path, "P014", "cost")
        folder, share = asyncio.run(measured(session, request))
    take, _ = read_take(folder)
    accounts = ledger(take)

    lost = sum(account.lost for account in accounts)
    print(f"\n15 tags x {rate} Hz: {share:.1%} of a core for decoding, solving, posing and writing; {lost} lost")
    assert lost == 0
    assert len(accounts) == 15
