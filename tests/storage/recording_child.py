"""A process that records in real time until it is killed; says in shared memory what it has handed over.

Arguments: library, file of shared memory. The memory: one count, then the time of each sample handed over.
"""

import mmap
import struct
import sys
import threading
import time
from pathlib import Path

from tests.storage.recordings import RATE, TAGS, sample, start_writing

CAPACITY = 60_000  # samples, 40 s
SIZE = 8 * (1 + CAPACITY)


def main(library: Path, memory: Path) -> None:
    writer = start_writing(library)
    pause = threading.Event()
    with memory.open("r+b") as file, mmap.mmap(file.fileno(), SIZE) as shared:
        print("recording", flush=True)
        begin = time.perf_counter()
        accepted = frame = 0
        while accepted + len(TAGS) <= CAPACITY:
            pause.wait(max(begin + frame / RATE - time.perf_counter(), 0.0))
            for sensor in TAGS:
                one = sample(sensor, frame)
                struct.pack_into("d", shared, 8 * (1 + accepted), time.perf_counter())
                writer.sample(one)
                accepted += 1
                struct.pack_into("q", shared, 0, accepted)
            writer.raw("usb0", sample(TAGS[0], frame).received, bytes(27))
            frame += 1


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
