"""A solved motion beside its take: a cache, never the truth."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body import PRESETS
from studio.core.solver import SolveOptions, solve
from studio.storage.motion_file import load_motion, motion_key, save_motion
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


def test_there_is_none_before_one_was_kept(stored):
    folder, _ = stored

    assert load_motion(folder, "nothing") is None
