"""At every instant the target is the whole old file or the whole new one."""

import os
import signal
import subprocess
import sys

import pytest

from studio.core.errors import CannotWrite, ReadBackDiffers
from studio.export.file_target import write_file


def accept(_path):
    """A read-back that finds nothing wrong."""


def test_a_new_file_is_whole_and_nothing_lies_beside_it(tmp_path):
    path = tmp_path / "walk.bvh"

    write_file(path, [b"one ", b"two"], accept)

    assert path.read_bytes() == b"one two"
    assert list(tmp_path.iterdir()) == [path]


def test_the_written_file_is_read_back_before_the_old_one_goes(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")
    seen = []

    def look(part):
        seen.append((part.read_bytes(), path.read_bytes()))

    write_file(path, [b"new"], look)

    assert seen == [(b"new", b"old")]
    assert path.read_bytes() == b"new"


def test_a_difference_keeps_the_old_file_and_names_the_target(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")

    def refuse(part):
        raise ReadBackDiffers(str(part), "frame 3")

    with pytest.raises(ReadBackDiffers) as refusal:
        write_file(path, [b"new"], refuse)

    assert refusal.value.path == str(path)
    assert refusal.value.difference == "frame 3"
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_an_exporter_that_fails_half_way_keeps_the_old_file(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")

    def blocks():
        yield b"half"
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        write_file(path, blocks(), accept)

    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_named(tmp_path):
    with pytest.raises(CannotWrite) as refusal:
        write_file(tmp_path / "nowhere" / "walk.bvh", [b"new"], accept)

    assert refusal.value.path == str(tmp_path / "nowhere" / "walk.bvh")


def test_a_target_that_is_a_folder_is_named_and_left(tmp_path):
    target = tmp_path / "walk.bvh"
    (target / "kept").mkdir(parents=True)

    with pytest.raises(CannotWrite):
        write_file(target, [b"new"], accept)

    assert list(tmp_path.iterdir()) == [target]
    assert (target / "kept").is_dir()


@pytest.mark.skipif(os.name != "posix", reason="Windows has no permission bits")
def test_only_its_owner_can_read_an_export(tmp_path):
    path = tmp_path / "walk.bvh"
    before = os.umask(0)
    try:
        write_file(path, [b"new"], accept)
    finally:
        os.umask(before)

    assert path.stat().st_mode & 0o777 == 0o600


KILLED = """
import os, signal, sys
from pathlib import Path
from studio.export.file_target import write_file
path, moment = Path(sys.argv[1]), sys.argv[2]
def die(here):
    if here == moment:
        os.kill(os.getpid(), signal.SIGKILL)
def blocks():
    for number in range(50):
        die(f"block {number}")
        yield b"new" * 1000
def read_back(part):
    die("read back")
write_file(path, blocks(), read_back)
die("done")
"""


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
@pytest.mark.parametrize("moment", ["block 0", "block 1", "block 25", "block 49", "read back", "done"])
def test_killed_at_any_moment_the_target_is_old_or_new(tmp_path, moment):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")

    ended = subprocess.run([sys.executable, "-c", KILLED, str(path), moment], check=False)

    assert ended.returncode == -signal.SIGKILL
    assert path.read_bytes() == (b"new" * 50_000 if moment == "done" else b"old")


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL")
def test_what_a_killed_export_left_goes_with_the_next(tmp_path):
    path = tmp_path / "walk.bvh"
    subprocess.run([sys.executable, "-c", KILLED, str(path), "block 25"], check=False)
    assert len(list(tmp_path.iterdir())) == 1

    write_file(path, [b"new"], accept)

    assert list(tmp_path.iterdir()) == [path]


def test_an_export_never_lands_in_a_take(tmp_path):
    take = tmp_path / "take-001"
    (take / "derived").mkdir(parents=True)
    (take / "take.mcap").write_bytes(b"what the radio said")

    for target in (take / "take.mcap", take / "walk.csv", take / "derived" / "walk.csv"):
        with pytest.raises(CannotWrite):
            write_file(target, [b"x"], lambda path: None)

    assert (take / "take.mcap").read_bytes() == b"what the radio said"
