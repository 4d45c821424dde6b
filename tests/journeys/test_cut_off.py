"""Recording in a process of its own that is killed, or asked to stop.

What the child had taken in when it was killed is known from the suit's pace: it sends in real time, and both
processes have one monotonic clock. A take's time 0 on that clock is in the take.
"""

import os
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from studio.importers.bvh import read_bvh
from studio.storage.session_folder import list_takes
from studio.storage.take_reader import read_take, take_zero
from tests.journeys.command_line import say

ROOT = Path(__file__).resolve().parents[2]

ALLOWED = 0.120  # s lost at most
FRAME = 0.020  # s between two samples of a tag: the newest may be that old
DELIVERY = 0.015  # s from a sample to the studio: 4 ms of radio and cable, then batches of 10 ms
POSED_BY = 7.9  # s since the suit was switched on: the performer has stood and bowed
PATIENCE = 60.0  # s for a start on a busy machine

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="SIGKILL and SIGTERM are of POSIX")


def start_recording(library, seconds=30):
    command = [sys.executable, "-m", "studio", "record", "--source", "synthetic:walk?calibrated=1"]
    return subprocess.Popen(
        [*command, "--seconds", str(seconds), "--library", str(library)],
        cwd=ROOT,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


def wait_for_file(library, child):
    """Return when the take being recorded has its file."""
    pause, until = threading.Event(), time.monotonic() + PATIENCE
    while not list(library.glob("*/*/*/take.part.mcap")):
        assert child.poll() is None, child.stderr.read()
        assert time.monotonic() < until
        pause.wait(0.02)  # another process: there is nothing to be told by


class Killed(NamedTuple):
    library: Path
    at: float
    """s, perf_counter of this computer just before the kill."""


def kill(library, after):
    """Kill a recording ``after`` s after its file was there."""
    with start_recording(library) as child:
        wait_for_file(library, child)
        threading.Event().wait(after)
        at = time.perf_counter()
        child.kill()
    return Killed(library, at)


def assert_kept(killed):
    """Check one take that was cut off; return how much of it is lost, s."""
    (listed,) = list_takes(killed.library)
    take, report = read_take(listed.folder)
    inspected = say("inspect", listed.folder)

    assert listed.recovered
    assert (report.recovered, report.finished, report.damaged) == (True, False, 0)
    assert inspected.code == 0
    assert f"This take was cut off; what was safe by then is here: {report.until_s:.2f} s." in inspected.out
    assert len(take.streams) == 15
    for stream in take.streams:  # nothing is missing before the end
        assert np.array_equal(np.diff(stream.frame), np.ones(len(stream) - 1))
    newest = min(float(stream.time[-1]) for stream in take.streams)
    return killed.at - take_zero(listed.folder) - newest


def kill_some(tmp_path, instants):
    """Kill recordings side by side, check what was kept, and return the folders of the takes."""
    with ThreadPoolExecutor(3) as pool:
        killed = list(pool.map(kill, [tmp_path / f"library {n}" for n in range(len(instants))], instants))
    lost = [assert_kept(one) for one in killed]
    print(f"newest sample kept was measured {[f'{1000 * one:.0f} ms' for one in lost]} before the kill")
    assert max(lost) <= ALLOWED + FRAME + DELIVERY
    assert min(lost) > -FRAME
    return [list_takes(one.library)[0].folder for one in killed]


def test_what_was_recorded_before_a_kill_is_there_and_can_be_exported(tmp_path):
    early = np.random.default_rng(2026).uniform(0.2, POSED_BY, 2).tolist()
    *_, folder = kill_some(tmp_path, [*early, POSED_BY])

    exported = say("export", folder, "--format", "bvh", "-o", tmp_path / "cut.bvh")

    assert exported.code == 0, exported.err
    take, _ = read_take(folder)
    written = read_bvh(tmp_path / "cut.bvh")
    assert len(written.values) * written.frame_time == pytest.approx(take.duration(), abs=0.05)


@pytest.mark.long
@pytest.mark.timeout(600)
def test_twenty_kills(tmp_path):
    folders = kill_some(tmp_path, np.random.default_rng(2027).uniform(0.2, POSED_BY, 20).tolist())
    assert len({*folders}) == 20, "each left a take that is listed"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP], ids=lambda number: number.name)
def test_a_polite_end_finishes_the_take(tmp_path, number):
    """SIGINT is Ctrl+C, SIGHUP a terminal that was closed."""
    with start_recording(tmp_path) as child:
        wait_for_file(tmp_path, child)
        threading.Event().wait(0.5)
        os.kill(child.pid, number)
        out, err = child.communicate(timeout=PATIENCE)

    (listed,) = list_takes(tmp_path)
    assert (child.returncode, out) == (0, f"{listed.folder}\n")
    take, report = read_take(listed.folder)
    assert err.splitlines() == [
        "15 sensors found. Recording…",
        f"Saved: {take.duration():.1f} s, 15 sensors, 0.00% lost.",
    ]
    assert not listed.recovered
    assert (report.finished, report.recovered, report.damaged) == (True, False, 0)
    assert 0.4 < take.duration() < 10
    assert len(take.streams) == 15


def test_ctrl_c_before_any_sensor_ends_at_once_in_one_sentence(tmp_path):
    master, slave = os.openpty()
    command = [sys.executable, "-m", "studio", "record", "--source", f"serial:{os.ttyname(slave)}"]
    with subprocess.Popen(
        [*command, "--library", str(tmp_path)], cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as child:
        os.read(master, 1)  # the receiver is asked who it is: the port is open
        os.kill(child.pid, signal.SIGINT)
        out, err = child.communicate(timeout=PATIENCE)
    os.close(master)
    os.close(slave)

    assert (child.returncode, out) == (1, "")
    assert err.startswith("Nothing was recorded. ")
    assert err.count("\n") == 1
    assert list_takes(tmp_path) == []


def test_a_take_that_was_cut_off_gets_its_end_when_the_next_is_kept(tmp_path):
    killed = kill(tmp_path, 0.5)
    (cut,) = list_takes(killed.library)
    before, _ = read_take(cut.folder)

    told = say("record", "--source", "synthetic:walk?tags=2&speed=max", "--seconds", 1, "--library", tmp_path)
    again = say("record", "--source", "synthetic:walk?tags=2&speed=max", "--seconds", 1, "--library", tmp_path)

    assert (told.code, again.code) == (0, 0)
    assert told.out.count("\n") == 1
    assert f"what was safe by then is in {cut.folder}" in told.err
    assert str(cut.folder) not in again.err
    after, report = read_take(cut.folder)
    assert (report.finished, report.recovered) == (True, True)
    assert [len(stream) for stream in after.streams] == [len(stream) for stream in before.streams]
    assert not list(tmp_path.glob("**/.ballast"))
