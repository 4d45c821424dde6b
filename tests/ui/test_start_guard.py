"""Start guard: two starts that never ended, and the third offers to leave the last source and take closed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from studio.ui.start_guard import StartGuard

ROOT = Path(__file__).resolve().parents[2]
CRASH = """
import os, sys
from pathlib import Path
from studio.ui.start_guard import StartGuard
guard = StartGuard(Path(sys.argv[1]))
guard.begin()
os._exit(3)
"""
RUN = """
import sys
from pathlib import Path
from studio.ui.start_guard import StartGuard
guard = StartGuard(Path(sys.argv[1]))
guard.begin()
print("runs", flush=True)
sys.stdin.read()
"""


def crash(folder: Path) -> None:
    run = subprocess.run([sys.executable, "-c", CRASH, str(folder)], cwd=ROOT, check=False)
    assert run.returncode == 3


@pytest.fixture
def guard(tmp_path):
    made = StartGuard(tmp_path / "state")
    yield made
    made.end()


def test_a_first_start_offers_nothing(guard, tmp_path):
    guard.begin()

    assert guard.crashes == 0
    assert not guard.offers_safe_start
    assert (tmp_path / "state" / f"run_{os.getpid()}").exists()


def test_one_crash_is_not_yet_a_reason(guard, tmp_path):
    crash(tmp_path / "state")

    guard.begin()

    assert guard.crashes == 1
    assert not guard.offers_safe_start


def test_the_second_failed_start_offers_a_safe_one(guard, tmp_path):
    crash(tmp_path / "state")
    crash(tmp_path / "state")

    guard.begin()

    assert guard.crashes == 2
    assert guard.offers_safe_start


def test_an_end_that_is_well_forgives_everything(guard, tmp_path):
    crash(tmp_path / "state")
    crash(tmp_path / "state")
    guard.begin()
    guard.end()

    later = StartGuard(tmp_path / "state")
    later.begin()
    later.end()

    assert later.crashes == 0
    assert list((tmp_path / "state").iterdir()) == []


def test_a_studio_that_still_runs_is_no_crash(guard, tmp_path):
    arguments = [sys.executable, "-c", RUN, str(tmp_path / "state")]
    with subprocess.Popen(arguments, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == "runs\n"

        guard.begin()
        assert guard.crashes == 0
        guard.end()
        assert len(list((tmp_path / "state").iterdir())) == 1  # the other's is left alone

        other.kill()


def test_a_number_that_comes_round_again_is_counted_and_does_not_collide(guard, tmp_path):
    stale = tmp_path / "state" / f"run_{os.getpid()}"
    stale.parent.mkdir()
    stale.touch()

    guard.begin()

    assert guard.crashes == 1


def test_a_folder_that_cannot_be_made_does_not_stop_the_start(tmp_path):
    (tmp_path / "state").write_text("a file")
    guard = StartGuard(tmp_path / "state")

    guard.begin()
    guard.end()

    assert guard.crashes == 0
