"""A receiver on a cable, from its first byte to a kept take: 15 tags through a pseudo-terminal in real time."""

import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest

from studio.analysis.ledger import ledger
from studio.cli import main
from studio.core.body import PLACES
from studio.storage.take_reader import read_raw, read_take

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")


@contextmanager
def suit(words, seconds):
    """Yield the port of a suit that runs in a process of its own."""
    command = [sys.executable, "-m", "tests.journeys.pty_suit", words, str(seconds)]
    with subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().strip()
        finally:
            process.kill()  # it may be writing into a port that nobody reads any more


@pytest.mark.parametrize(("rate", "frames"), [(50, 0.02), (100, 0.01)])
def test_fifteen_tags_are_kept_without_a_single_loss(tmp_path, capsys, rate, frames):
    with suit(f"walk?seed=3&rate={rate}&speed=1", 8) as port:
        words = ["--source", f"serial:{port}", "--seconds", "4", "--library", str(tmp_path), "--person", "P014"]
        code = main(["record", *words])
    printed = capsys.readouterr()
    assert code == 0, printed.err

    take, report = read_take(Path(printed.out.strip()))

    accounts = ledger(take)
    assert len(accounts) == 15
    assert report.finished
    assert [account.lost for account in accounts] == [0] * 15
    assert {account.place for account in accounts} == {place.value for place in PLACES}  # by the tags' numbers
    assert all(stream.info.frame_s == pytest.approx(frames) for stream in take.streams)
    assert all(len(stream) == pytest.approx(4 * rate, abs=8) for stream in take.streams)  # the first come in a heap
    assert all(stream.info.correction is not None for stream in take.streams)  # the tags were asked
    assert sum(len(data) for _, _, data in read_raw(Path(printed.out.strip()))) > 30 * 4 * rate * 15
