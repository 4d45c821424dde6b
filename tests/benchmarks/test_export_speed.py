"""Exports are written at least 3 times as fast as by pybvh and 8 times as fast as by pymotion."""

import json
import subprocess
from pathlib import Path

import pytest

from tests.peers.environments import build

pytestmark = [pytest.mark.benchmark, pytest.mark.timeout(900)]


def test_export_beside_other_writers_in_one_run():
    python = build().readers[0]

    done = subprocess.run(
        [python, str(Path(__file__).parent / "bench_export.py")], capture_output=True, text=True, check=False
    )

    assert done.returncode == 0, done.stderr[-1000:]
    speeds = json.loads(done.stdout.splitlines()[-1])
    for kind, rows in speeds.items():
        for name, speed in rows.items():
            print(f"{kind} {name}: {speed:,.0f} rows/s, studio is {rows['studio'] / speed:.1f} times as fast")
    assert speeds["bvh"]["studio"] > 3 * speeds["bvh"]["pybvh"]
    assert speeds["bvh"]["studio"] > 8 * speeds["bvh"]["pymotion"]
    assert speeds["csv"]["studio"] > 3 * speeds["csv"]["csv.writer"]
