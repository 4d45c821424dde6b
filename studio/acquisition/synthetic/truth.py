"""The true motion as a file beside a take; only the judge (``studio.capture.truth``) may read it."""

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Truth:
    """The true motion of the 15 measured segments."""

    time: NDArray[np.float64]
    """(n,), s, on the clock of ``Arrival.received``: this computer's monotonic clock at recording."""
    world_from_segment: NDArray[np.float64]
    """(n, 15, 4), in the order of ``core.body.PLACES``."""
    hips: NDArray[np.float64]
    """(n, 3), m, world."""
    facts: Mapping[str, object]
    """Script, seed, how each tag was mounted."""


def encode_truth(truth: Truth) -> bytes:
    """Return the file: a NumPy archive without pickled objects."""
    file = io.BytesIO()
    np.savez_compressed(
        file,
        time_s=truth.time,
        world_from_segment=truth.world_from_segment.astype(np.float32),
        hips=truth.hips.astype(np.float32),
        facts=np.frombuffer(json.dumps(truth.facts).encode(), np.uint8),
    )
    return file.getvalue()


def decode_truth(data: bytes) -> Truth:
    """Return what ``encode_truth`` was given, in double precision; ValueError when it is something else."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
            time, world_from_segment, hips, facts = (
                _array(archive, name) for name in ("time_s", "world_from_segment", "hips", "facts")
            )
    except (zipfile.BadZipFile, KeyError) as damaged:
        raise ValueError("no true motion in this attachment") from damaged
    told = json.loads(facts.astype(np.uint8).tobytes())
    return Truth(time.astype(np.float64), world_from_segment.astype(np.float64), hips.astype(np.float64), told)


def _array(archive: zipfile.ZipFile, name: str) -> NDArray[np.generic]:
    with archive.open(f"{name}.npy") as file:
        # The archive's own reader would unpickle what a stranger put into it.
        array: NDArray[np.generic] = np.lib.format.read_array(file, allow_pickle=False)
    return array
