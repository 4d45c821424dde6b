"""A take that was cut off gets its end; the original goes only when nothing of it is lost."""

import os
import time
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from studio.core.errors import Damaged, DiskFull, FolderNotWritable, NotATake
from studio.core.take import Mark
from studio.storage.recovery import BEGINNING, recover, recover_all
from studio.storage.session_folder import list_takes
from studio.storage.take_reader import read_attachment, read_events, read_take
from tests.storage.disks import FullDisk
from tests.storage.recordings import START, samples, start_writing


def cut_off(library: Path, keep: float) -> tuple[Path, bytes]:
    """Return a take as a power cut leaves it: the first part of the file under its working name."""
    writer = start_writing(library)
    for one in samples(50):
        writer.sample(one)
    writer.mark(Mark(START + 0.1, "record"))
    writer.attach("note", "text/plain", b"kept")
    folder = writer.stop().result(30).folder
    whole = (folder / "take.mcap").read_bytes()
    (folder / "take.mcap").unlink()
    part = whole[: int(len(whole) * keep)]
    (folder / "take.part.mcap").write_bytes(part)
    (folder / ".ballast").write_bytes(b"room")
    return folder, part


def end_of_data(whole: bytes) -> float:
    """Return the share of a file that stands before its summary."""
    return whole.rindex(b"\x0f\x04\x00\x00\x00\x00\x00\x00\x00") / len(whole)


def test_a_take_without_its_end_gets_one(tmp_path: Path) -> None:
    folder, whole = cut_off(tmp_path, 1.0)
    (folder / "take.part.mcap").write_bytes(whole[: int(end_of_data(whole) * len(whole))])
    before, _ = read_take(folder)

    recover(folder)
    after, report = read_take(folder)

    assert (report.finished, report.recovered, report.damaged) == (True, True, 0)
    for ours, theirs in zip(after.streams, before.streams, strict=True):
        assert ours.info == theirs.info
        assert ours.orientation.tobytes() == theirs.orientation.tobytes()
        assert np.array_equal(ours.arrival, theirs.arrival)
    assert repr(after.marks) == repr(before.marks)
    assert read_attachment(folder, "note") == b"kept"
    assert sorted(file.name for file in folder.iterdir()) == ["take.json", "take.mcap"]
    assert [take.recovered for take in list_takes(tmp_path)] == [False]
    with (folder / "take.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert sum(1 for _ in reader.iter_messages()) == 50 * 15 + 1 + 1  # the mark, and the note of the recovery
        assert [attachment.data for attachment in reader.iter_attachments()] == [b"kept"]
        assert [metadata.name for metadata in reader.iter_metadata()] == ["kinetag"]


def test_a_take_with_damage_inside_keeps_its_original(tmp_path: Path) -> None:
    folder, whole = cut_off(tmp_path, 1.0)
    hurt = bytearray(whole)
    hurt[len(hurt) // 3] ^= 1
    (folder / "take.part.mcap").write_bytes(hurt)
    _, before = read_take(folder)

    recover(folder)

    assert (folder / "take.damaged.mcap").read_bytes() == hurt
    _, report = read_take(folder)
    assert (report.samples, report.damaged) == (before.samples, 0)
    assert read_events(folder)[-1].facts["damaged"] == before.damaged > 0


def test_a_take_being_recorded_is_not_recovered(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)

    with pytest.raises(FolderNotWritable):
        recover(writer.folder)
    assert (writer.stop().result(30).folder / "take.mcap").is_file()


@pytest.mark.parametrize("refused", range(3))
def test_a_full_disk_leaves_the_original_as_it_was(tmp_path: Path, refused: int) -> None:
    folder, part = cut_off(tmp_path, 0.9)

    with pytest.raises(DiskFull):
        recover(folder, FullDisk(refused, for_good=True))

    assert (folder / "take.part.mcap").read_bytes() == part
    assert not list(folder.glob("take.recovering*"))
    assert recover(folder) == folder


def test_what_is_no_take_is_not_recovered(tmp_path: Path) -> None:
    with pytest.raises(NotATake):
        recover(tmp_path)
    folder, part = cut_off(tmp_path, 1.0)
    (folder / "take.part.mcap").write_bytes(b"nothing")
    with pytest.raises(NotATake):
        recover(folder)
    first = part.index(b"kinetag.take/1", 100)
    (folder / "take.part.mcap").write_bytes(part[:first])
    with pytest.raises(Damaged):
        recover(folder)


def test_a_finished_take_is_left_as_it_is(tmp_path: Path) -> None:
    folder = start_writing(tmp_path).stop().result(30).folder
    content = (folder / "take.mcap").read_bytes()

    assert recover(folder) == folder
    assert (folder / "take.mcap").read_bytes() == content


def test_all_takes_whose_writer_is_gone_are_finished_and_told_once(tmp_path: Path) -> None:
    first, whole = cut_off(tmp_path, 1.0)
    (first / "take.part.mcap").write_bytes(whole[: int(end_of_data(whole) * len(whole))])
    second, part = cut_off(tmp_path, 0.9)
    (second / "take.part.mcap").write_bytes(part[: part.index(b"kinetag.take/1", 100)])
    running = start_writing(tmp_path)

    told = recover_all(tmp_path)

    assert [(folder, type(error)) for folder, error in told] == [(first, type(None)), (second, Damaged)]
    assert [folder for folder, _ in recover_all(tmp_path)] == [second]
    assert (running.stop().result(30).folder / "take.mcap").is_file()


def aged(ballast: Path, seconds: float) -> Path:
    ballast.parent.mkdir(parents=True, exist_ok=True)
    ballast.write_bytes(b"room")
    then = time.time() - seconds
    os.utime(ballast, (then, then))
    return ballast


def test_room_that_nobody_holds_back_any_more_is_freed(tmp_path: Path) -> None:
    session = tmp_path / "P014" / "2026-11-24a"
    finished = start_writing(tmp_path).stop().result(30).folder
    never_begun = aged(session / "take-007" / ".ballast", BEGINNING + 1)
    beginning = aged(session / "take-008" / ".ballast", BEGINNING - 10)
    left_over = aged(finished / ".ballast", BEGINNING + 1)
    running = start_writing(tmp_path)
    held = aged(running.folder / ".ballast", BEGINNING + 1)

    assert recover_all(tmp_path) == []

    assert not never_begun.parent.exists()
    assert beginning.exists()
    assert not left_over.exists()
    assert (finished / "take.mcap").exists()
    assert held.exists()
    assert (running.stop().result(30).folder / "take.mcap").is_file()
