"""A disk that fills up while recording: the take is closed, and the operator is told."""

from pathlib import Path

from studio.cli import main
from studio.storage.filesystem import FileSystem
from studio.storage.take_reader import read_take


def test_the_recording_ends_in_order_and_says_that_the_disk_is_full(tmp_path, capsys, monkeypatch):
    room = [100 << 20]

    def free_space(self: FileSystem, folder: Path) -> int:
        room[0] -= 3 << 20  # another program fills the disk
        return room[0]

    monkeypatch.setattr(FileSystem, "free_space", free_space)

    words = ["--source", "synthetic:walk?speed=40", "--seconds", "900", "--library", str(tmp_path), "--person", "P014"]
    code = main(["record", *words])

    printed = capsys.readouterr()
    assert code == 1
    assert "disk" in printed.err
    assert "disk is full" in printed.err.splitlines()[-1]
    take, report = read_take(Path(printed.out.strip()))
    assert report.finished
    assert 1 < take.duration() < 900


def test_a_folder_that_cannot_be_made_is_named_before_anything_is_recorded(tmp_path, capsys):
    in_the_way = tmp_path / "notes.txt"
    in_the_way.write_text("not a folder")

    assert main(["record", "--source", "synthetic", "--library", str(in_the_way / "library")]) == 1

    assert str(in_the_way) in capsys.readouterr().err
