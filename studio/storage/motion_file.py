"""A solved motion in ``derived/``: a cache that may be deleted at any time, never the truth.

One line of JSON (what the arrays are), then the arrays as little-endian float64 or bytes, then a CRC-32.
The file's name is the digest of everything the motion depends on, and stands in it; a file that does not hold is
kept aside and the motion computed again.
"""

import hashlib
import json
import struct
import zlib
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

import studio
from studio.core.body import PLACES, Place, Skeleton
from studio.core.pose import Motion
from studio.core.take import Alignment, Take
from studio.storage.documents import set_aside
from studio.storage.facts import NOT_JSON, to_json
from studio.storage.filesystem import write_atomically
from studio.storage.limits import LONGEST_FRAME, LONGEST_TAKE, SHORTEST_FRAME, STATURES
from studio.storage.profile import DERIVED
from studio.storage.take_reader import take_file

_CRC = struct.Struct("<I")
LONGEST_HEAD = 1 << 20  # bytes
NUMBERS_PER_ROW = 1 + 23 * 4 + 3
ROUNDING = 1e-6  # of the length of a unit quaternion; products of some thousand are within 1e-12
FARTHEST = 1e6  # m from the start; a week of walking
READ_AT_ONCE = 1 << 20  # bytes


class _Head(msgspec.Struct, frozen=True):
    key: str
    rows: int
    frame_s: float
    stature: float
    places: list[str]
    alignment: Alignment
    method: str
    attitude: str
    notes: list[str]


def motion_key(folder: Path, take: Take, options: object) -> str:
    """Return the digest of take file, setup, options and version of the studio."""
    digest = hashlib.sha256()
    with take_file(folder).open("rb") as file:
        while block := file.read(READ_AT_ONCE):
            digest.update(block)
    facts = [studio.__version__, json.loads(to_json(take.setup)), json.loads(to_json(list(take.marks)))]
    digest.update(json.dumps([*facts, repr(options)], sort_keys=True).encode())
    return digest.hexdigest()[:32]


def save_motion(folder: Path, key: str, motion: Motion) -> None:
    """Keep a motion beside its take; OSError when that is not possible."""
    places = [place for place in PLACES if place in motion.measured]
    head = _Head(
        key=key,
        rows=len(motion),
        frame_s=motion.frame_s,
        stature=motion.skeleton.stature,
        places=[place.value for place in places],
        alignment=motion.alignment,
        method=motion.method,
        attitude=motion.attitude,
        notes=list(motion.notes),
    )
    masks = np.array([[motion.measured[p], motion.lost[p]] for p in places], np.uint8)
    parts = [msgspec.json.encode(head), b"\n"]
    parts += [a.astype("<f8").tobytes() for a in (motion.time, motion.world_from_segment, motion.hips)]
    body = b"".join([*parts, masks.tobytes()])
    derived = folder / DERIVED
    derived.mkdir(mode=0o700, exist_ok=True)
    write_atomically(derived / f"{key}.motion", body + _CRC.pack(zlib.crc32(body)))


def load_motion(folder: Path, key: str) -> Motion | None:
    """Return the kept motion; None when there is none or it does not hold, which is then kept aside as ``….bad``."""
    file = folder / DERIVED / f"{key}.motion"
    try:
        content = file.read_bytes()
    except OSError:
        return None
    motion = _believed(content, key)
    if motion is None:
        set_aside(file)
    return motion


def _believed(content: bytes, key: str) -> Motion | None:
    """Return the motion in a file; None when it is damaged, another's, or says what no solver says."""
    body = content[: -_CRC.size]
    if len(content) <= _CRC.size or _CRC.unpack(content[-_CRC.size :])[0] != zlib.crc32(body):
        return None
    end = body.find(b"\n", 0, LONGEST_HEAD)
    try:
        head = msgspec.json.decode(body[: max(end, 0)], type=_Head)
        if head.key != key or not _is_plausible(head, len(body) - end - 1):
            return None
        motion = _motion(head, body[end + 1 :])
    except (*NOT_JSON, ValueError):  # written by another version
        return None
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.linalg.norm(motion.world_from_segment, axis=-1)
        holds = (
            (np.abs(lengths - 1.0) < ROUNDING).all()
            and (np.abs(motion.hips) < FARTHEST).all()
            and (np.abs(motion.time) <= LONGEST_TAKE).all()
            and (np.diff(motion.time) >= 0).all()
        )
    return motion if holds else None


def _is_plausible(head: _Head, size: int) -> bool:
    promised = head.rows * (8 * NUMBERS_PER_ROW + 2 * len(head.places))
    return (
        head.rows > 0
        and promised == size
        and head.places == [place.value for place in PLACES if place.value in head.places]
        and SHORTEST_FRAME <= head.frame_s <= LONGEST_FRAME
        and STATURES[0] <= head.stature <= STATURES[1]
    )


def _motion(head: _Head, data: bytes) -> Motion:
    n = head.rows
    sizes = [n, n * 23 * 4, n * 3]
    numbers = np.frombuffer(data, "<f8", sum(sizes)).astype(np.float64)
    time, world, hips = np.split(numbers, np.cumsum(sizes)[:-1])
    masks: NDArray[np.bool_] = np.frombuffer(data, np.uint8, offset=8 * sum(sizes)).astype(bool)
    by_place = masks.reshape(len(head.places), 2, n)
    places = [Place(name) for name in head.places]
    return Motion(
        time=time,
        frame_s=head.frame_s,
        world_from_segment=world.reshape(n, 23, 4),
        hips=hips.reshape(n, 3),
        skeleton=Skeleton.from_stature(head.stature),
        measured={place: by_place[row, 0] for row, place in enumerate(places)},
        lost={place: by_place[row, 1] for row, place in enumerate(places)},
        alignment=head.alignment,
        method="live" if head.method == "live" else "offline",
        attitude=head.attitude,
        notes=tuple(head.notes),
    )
