"""How fast exports are written, beside other writers in one run: ratios of processor time, median of five.

Run by the Python of the peers (``tests/peers/environments.py``), which has pybvh and pymotion; prints JSON.
All hold the same motion in memory; "from the motion" also turns poses into Euler angles.
"""

import contextlib
import csv
import io
import json
import statistics
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pybvh  # type: ignore[import-not-found]
from pymotion.io.bvh import BVH  # type: ignore[import-not-found]

sys.path.insert(0, str(Path(__file__).parents[2]))

from studio.export.bvh import PRESETS, bvh_blocks
from studio.export.csv_tables import PRESETS as CSV_PRESETS
from studio.export.csv_tables import joints_table
from studio.export.csv_text import csv_blocks
from studio.export.number_format import Numbers, Punctuation, as_text
from studio.export.resampling import BLOCK
from tests.export.moving_body import moving_body

FRAMES = 6000  # 2 min at 50 Hz; long enough that starting does not count


def seconds(work):
    spent = []
    for _ in range(5):
        before = time.process_time()
        work()
        spent.append(time.process_time() - before)
    return statistics.median(spent)


def bvh_speeds(folder):
    motion = moving_body(FRAMES)
    source, target = folder / "source.bvh", folder / "target.bvh"
    source.write_bytes(b"".join(bvh_blocks(motion, PRESETS["motionbuilder"], None)))
    values = np.loadtxt(source.read_text().split("Frame Time:")[1].splitlines()[1:])
    theirs, other = pybvh.read_bvh_file(source), BVH()
    other.load(str(source))

    def ours_from_the_motion():
        with target.open("wb") as file:
            file.writelines(bvh_blocks(motion, PRESETS["motionbuilder"], None))

    def ours():
        with target.open("wb") as file:
            for first in range(0, FRAMES, BLOCK):
                file.write(as_text([Numbers(values[first : first + BLOCK], 6)], Punctuation(b".", b" ", b"\n")))

    def savetxt():
        np.savetxt(target, values, fmt="%.6f")

    def by_pybvh():
        with contextlib.redirect_stdout(io.StringIO()):
            pybvh.write_bvh_file(theirs, target)

    def by_pymotion():
        other.save(str(target))

    works = {
        "studio": ours,
        "studio, from the motion": ours_from_the_motion,
        "numpy savetxt": savetxt,
        "pybvh": by_pybvh,
        "pymotion": by_pymotion,
    }
    return {name: FRAMES / seconds(work) for name, work in works.items()}


def csv_speeds(folder):
    table, target = joints_table(moving_body(FRAMES)), folder / "joints.csv"
    values = np.concatenate([column.values for column in table.columns if isinstance(column, Numbers)], axis=1)

    def ours():
        with target.open("wb") as file:
            file.writelines(csv_blocks(table, CSV_PRESETS["plain"]))

    def savetxt():
        np.savetxt(target, values, fmt="%.6f", delimiter=",")

    def by_csv():
        with target.open("w", newline="") as file:
            csv.writer(file).writerows(values.tolist())

    works = {"studio": ours, "numpy savetxt": savetxt, "csv.writer": by_csv}
    return {name: FRAMES / seconds(work) for name, work in works.items()}


if __name__ == "__main__":
    with TemporaryDirectory() as folder:
        print(json.dumps({"bvh": bvh_speeds(Path(folder)), "csv": csv_speeds(Path(folder))}))
