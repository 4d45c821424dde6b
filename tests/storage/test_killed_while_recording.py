"""F01: the process is killed while it records. At most 120 ms are lost; everything before is byte-equal."""

import struct
import subprocess
import sys
import threading
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from studio.core.take import Take
from studio.storage.recovery import recover
from studio.storage.session_folder import list_takes
from studio.storage.take_reader import read_take
from tests.storage.recording_child import SIZE
from tests.storage.recordings import SETUP, START, TAGS, sample

ROOT = Path(__file__).parents[2]
ALLOWED = 0.120  # s


class Killed(NamedTuple):
    library: Path
    accepted: int
    handed_over: tuple[float, ...]
    """s, when each sample was handed to the writer"""


def record_and_kill(folder: Path, after: float) -> Killed:
    library, memory = folder / "library", folder / "memory"
    folder.mkdir()
    memory.write_bytes(bytes(SIZE))
    child = subprocess.Popen(
        [sys.executable, "-m", "tests.storage.recording_child", str(library), str(memory)],
        stdout=subprocess.PIPE,
        cwd=ROOT,
    )
    assert child.stdout is not None
    with child.stdout:
        child.stdout.readline()
        threading.Event().wait(after)
        child.kill()
        child.wait()
    content = memory.read_bytes()
    (accepted,) = struct.unpack_from("q", content)
    return Killed(library, accepted, struct.unpack_from(f"{accepted}d", content, 8))


def assert_prefix(take: Take, count: int) -> None:
    """Check that the take is the first ``count`` samples, bit for bit."""
    for stream in take.streams:
        tag = TAGS.index(stream.info.sensor)
        assert stream.arrival.tolist() == list(range(tag, count, len(TAGS)))
        expected = [sample(TAGS[tag], frame) for frame in range(len(stream))]
        for name in ("frame", "device_time", "orientation", "rate", "acceleration", "flags", "battery", "rssi"):
            column = getattr(stream, name)
            assert column.tobytes() == np.array([getattr(one, name) for one in expected], column.dtype).tobytes(), name
        assert stream.time.tobytes() == (np.array([one.time for one in expected]) - START).tobytes()


def assert_kept(killed: Killed) -> float:
    """Check one killed recording and return how much of it is lost, s."""
    (listed,) = list_takes(killed.library)
    take, report = read_take(listed.folder)

    assert listed.recovered
    assert report.recovered
    assert not report.finished
    assert report.damaged == 0
    assert (take.name, take.person, repr(take.setup)) == ("walk", "P014", repr(SETUP))
    assert_prefix(take, report.samples)
    # More than accepted: the writer took a sample that the child had no time to count.
    if report.samples >= killed.accepted:
        return 0.0
    return killed.handed_over[-1] - killed.handed_over[report.samples]


def kill(tmp_path: Path, times: int) -> list[Killed]:
    instants = np.random.default_rng(2026).uniform(0.1, 1.4, times)
    with ThreadPoolExecutor(4) as pool:
        runs = [pool.submit(record_and_kill, tmp_path / f"{n}", after) for n, after in enumerate(instants.tolist())]
        return [run.result() for run in runs]


def assert_all_kept(killed: list[Killed]) -> None:
    lost = [assert_kept(one) for one in killed]
    print(f"lost: median {1000 * float(np.median(lost)):.0f} ms, at most {1000 * max(lost):.0f} ms of {len(lost)} runs")
    assert max(lost) <= ALLOWED
    assert min(one.accepted for one in killed) > 0


def test_a_killed_recording_loses_at_most_120_ms(tmp_path: Path) -> None:
    killed = kill(tmp_path, 20)

    assert_all_kept(killed)
    folder = list_takes(killed[0].library)[0].folder
    before, _ = read_take(folder)
    recover(folder)
    after, report = read_take(folder)
    assert report.finished
    assert report.recovered
    assert_prefix(after, sum(map(len, before.streams)))


@pytest.mark.long
@pytest.mark.timeout(600)
def test_two_hundred_killed_recordings_lose_at_most_120_ms(tmp_path: Path) -> None:
    assert_all_kept(kill(tmp_path, 200))
