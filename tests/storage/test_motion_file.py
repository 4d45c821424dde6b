"""A solved motion beside its take: a cache, never the truth."""

import json
import struct
import zlib
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body import PRESETS
from studio.core.solver import SolveOptions, solve
from studio.storage.motion_file import NUMBERS_PER_ROW, load_motion, motion_key, save_motion
from studio.storage.take_store import write_take
from tests.core.worn_sensors import worn_take


@pytest.fixture
def stored(tmp_path):
    take, _ = worn_take(PRESETS["lower"], 12.0)
    return write_take(take, tmp_path), take


def test_a_motion_comes_back_as_it_was(stored):
    folder, take = stored
    motion = solve(take).motion
    key = motion_key(folder, take, SolveOptions())

    save_motion(folder, key, motion)
    again = load_motion(folder, key)

    assert again is not None
    for name in ("time", "world_from_segment", "hips"):
        np.testing.assert_array_equal(getattr(again, name), getattr(motion, name))
    assert again.alignment == motion.alignment
    assert (again.method, again.attitude, again.notes) == (motion.method, motion.attitude, motion.notes)
    for place, known in motion.measured.items():
        np.testing.assert_array_equal(again.measured[place], known)
        np.testing.assert_array_equal(again.lost[place], motion.lost[place])


def test_another_choice_another_setup_and_other_bytes_have_other_keys(stored):
    folder, take = stored
    key = motion_key(folder, take, SolveOptions())

    assert motion_key(folder, take, SolveOptions(attitude="gyro")) != key
    assert motion_key(folder, replace(take, setup=replace(take.setup, stature=1.8)), SolveOptions()) != key
    with (folder / "take.mcap").open("ab") as file:
        file.write(b"\0")
    assert motion_key(folder, take, SolveOptions()) != key


def test_a_damaged_file_is_no_motion(stored):
    folder, take = stored
    key = motion_key(folder, take, SolveOptions())
    save_motion(folder, key, solve(take).motion)
    file = next((folder / "derived").iterdir())
    whole = file.read_bytes()

    for at in (0, 40, len(whole) // 2, len(whole) - 1):
        damaged = bytearray(whole)
        damaged[at] ^= 0x10
        file.write_bytes(damaged)
        assert load_motion(folder, key) is None
    for length in (0, 3, 100, len(whole) - 5):
        file.write_bytes(whole[:length])
        assert load_motion(folder, key) is None


def forge(folder, key, change):
    """Rewrite a kept motion with a right checksum after ``change(head, numbers)``."""
    file = folder / "derived" / f"{key}.motion"
    body = file.read_bytes()[:-4]
    end = body.index(b"\n")
    head = json.loads(body[:end])
    numbers = np.frombuffer(body[end + 1 :], "<f8", head["rows"] * NUMBERS_PER_ROW).copy()
    rest = body[end + 1 + numbers.nbytes :]
    change(head, numbers)
    forged = json.dumps(head).encode() + b"\n" + numbers.tobytes() + rest
    file.write_bytes(forged + struct.pack("<I", zlib.crc32(forged)))
    return file


def put(at, value):
    return lambda head, numbers: numbers.__setitem__(at, value)


def say(**claims):
    return lambda head, numbers: head.update(claims)


@pytest.mark.parametrize(
    "change",
    [
        say(key="0" * 32),  # of another take, under this one's name
        say(frame_s=0.0),
        say(frame_s=1e9),
        say(stature=-1.0),
        say(rows=0),
        say(rows=-5),
        say(rows=10**9),
        say(places=[]),
        say(places=["tail"] * 7),
        lambda head, numbers: head["places"].reverse(),
        put(3, np.nan),  # time
        put(3, -1e12),
        put(5, 0.0),  # time goes backwards
        put(-1, np.inf),  # hips
        put(-1, 1e300),
        put(2000, np.nan),  # a segment
        put(2000, 3.0),
    ],
)
def test_a_forged_motion_is_no_motion_and_is_kept_aside(stored, change):
    """A take of a stranger may come with results that nobody solved: right in its checksum, and not believed."""
    folder, take = stored
    key = motion_key(folder, take, SolveOptions())
    save_motion(folder, key, solve(take).motion)
    assert load_motion(folder, key) is not None
    file = forge(folder, key, change)

    assert load_motion(folder, key) is None
    assert not file.exists()
    assert file.with_name(file.name + ".bad").exists()


@pytest.mark.parametrize("method", ["live", "offline"])
def test_a_motion_of_either_method_is_believed(stored, method):
    folder, take = stored
    options = SolveOptions(method=method)
    key = motion_key(folder, take, options)

    save_motion(folder, key, solve(take, options).motion)

    assert load_motion(folder, key) is not None


def test_there_is_none_before_one_was_kept(stored):
    folder, _ = stored

    assert load_motion(folder, "nothing") is None
