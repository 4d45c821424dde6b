"""A disk that fills up, fails or was never writable: what was recorded is safe, and it is said (F05, F06, F08)."""

import errno
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from studio.core.errors import DiskFull, FileAtLimit, FolderNotWritable, RecordingError, TakeAtLimit
from studio.storage.encoder import TakeEncoder
from studio.storage.facts import Anchor, identity
from studio.storage.longest_file import NO_LIMIT, kind_of_mount, longest_file
from studio.storage.profile import MAX_EVENTS, MAX_SAMPLES
from studio.storage.take_file import BALLAST, END_RESERVE, RESERVE, TakeFile
from studio.storage.take_reader import read_events, read_take
from studio.storage.take_store import write_take
from studio.storage.take_writer import CAPACITY, EVENT_CAPACITY, MOST_EVENTS, MOST_SAMPLES, WARN_S
from tests.storage.disks import FullDisk, ShortFiles, SmallDisk
from tests.storage.recordings import DAY, SETUP, START, TAGS, sample, samples, start_writing

SECONDS = 30
GIB = 1 << 30


def wait_until(happened: Callable[[], bool]) -> None:
    pause = threading.Event()
    while not happened():
        pause.wait(0.002)


@pytest.mark.parametrize("torn", [0, 60])
@pytest.mark.parametrize("refused", range(9))
def test_a_disk_full_at_any_write_keeps_everything_that_was_accepted(tmp_path: Path, refused: int, torn: int) -> None:
    """Writes: 0 opening, 1 to 4 blocks, 5 last words, 6 end, 7 take.json; 8 never happens."""
    kept, blocks = samples(8), 4
    size = len(kept) // blocks
    disk = FullDisk(refused, torn=torn)
    encoder = TakeEncoder(identity("walk", "P014", "", SETUP, {}, Anchor("", START)))
    if refused == 0:
        with pytest.raises(DiskFull):
            TakeFile(tmp_path, "walk", encoder, disk)
        assert list(tmp_path.iterdir()) == []
        return

    file = TakeFile(tmp_path, "walk", encoder, disk)
    for block in range(blocks):
        if file.failure is None:
            for encoded in encoder.blocks(kept[block * size : (block + 1) * size], [], []):
                file.append(encoded)
    if refused in (5, 6):  # the ballast had gone by then: another program took its room
        with pytest.raises(DiskFull) as refusal:
            file.finish()
        assert refusal.value.kept_s == pytest.approx(kept[-1].time - START)
    else:
        file.finish()
    take, report = read_take(file.folder)

    accepted = min(refused, blocks) * size
    assert (report.samples, report.damaged) == (accepted, 0)
    assert report.finished == (refused not in (5, 6))
    assert isinstance(file.failure, DiskFull) == (refused <= blocks)
    assert np.sort(np.concatenate([s.arrival for s in take.streams])).tolist() == list(range(accepted))
    assert not (file.folder / ".ballast").exists()


def test_a_failed_recording_refuses_further_samples_in_silence(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, FullDisk(1))
    for one in samples(1):
        writer.sample(one)
    wait_until(lambda: writer.failure is not None)
    for one in samples(100):
        writer.sample(one)
        writer.raw("usb0", one.received, b"bytes")

    assert 1 <= writer.stop().result(SECONDS).samples <= 15
    assert isinstance(writer.failure, DiskFull)


def test_a_disk_that_breaks_is_not_called_full(tmp_path: Path) -> None:
    disk = FullDisk(2, errno.EIO, for_good=True)
    writer = start_writing(tmp_path, disk)
    for one in samples(1):
        writer.sample(one)
    wait_until(lambda: disk.writes >= 2)
    writer.event("gap", {}, START)
    wait_until(lambda: writer.failure is not None)

    with pytest.raises(FolderNotWritable):
        writer.stop().result(SECONDS)
    take, report = read_take(writer.folder)
    assert 1 <= report.samples <= 15
    assert report.recovered
    assert take.setup.stature == 1.81


def test_a_take_that_cannot_be_stored_whole_is_not_stored_in_silence(tmp_path: Path) -> None:
    take, _ = read_take(start_and_stop(tmp_path))

    with pytest.raises(RecordingError):
        write_take(take, tmp_path, DAY, filesystem=FullDisk(1))


def start_and_stop(library: Path) -> Path:
    writer = start_writing(library)
    for one in samples(3):
        writer.sample(one)
    return writer.stop().result(SECONDS).folder


@pytest.mark.skipif(sys.platform == "win32", reason="no such limit on Windows")
def test_a_real_limit_on_the_length_of_files(tmp_path: Path) -> None:
    """What a FAT32 stick does at 4 GiB (EFBIG): what does not fit is lost, everything before it stays."""
    program = f"""
import resource, signal, threading
from pathlib import Path
from tests.storage.recordings import samples, start_writing
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
writer = start_writing(Path({str(tmp_path)!r}))
resource.setrlimit(resource.RLIMIT_FSIZE, (400_000, 400_000))
pause = threading.Event()
for one in samples(400):
    writer.sample(one)
    if writer.failure is None and one.sensor == "tag:00000000":
        pause.wait(0.01)
try:
    saved = writer.stop().result({SECONDS})
    print("saved", writer.failure.kept_s, writer.folder)
except Exception as error:
    print(type(error).__name__, error.kept_s, writer.folder)
"""
    done = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True, timeout=60)

    _, kept_s, folder = done.stdout.split()
    take, report = read_take(Path(folder))
    assert 100_000 < report.samples * 179 < 400_000
    assert report.damaged == 0
    assert take.duration() == pytest.approx(float(kept_s), abs=0.01)


def test_recording_does_not_start_without_room(tmp_path: Path) -> None:
    with pytest.raises(DiskFull) as refusal:
        start_writing(tmp_path, SmallDisk(RESERVE + BALLAST - 1))

    assert refusal.value.kept_s == 0.0
    assert list(tmp_path.glob("*/*/*")) == []


def test_recording_does_not_start_where_nothing_can_be_written(tmp_path: Path) -> None:
    (tmp_path / "P014").write_text("a file where a folder should be")

    with pytest.raises(FolderNotWritable):
        start_writing(tmp_path)


def test_the_operator_is_warned_ten_minutes_before_the_disk_is_full(tmp_path: Path) -> None:
    # A take of one tag at 100 Hz grows by some 20 kB/s: 10 MB above the reserve last about 500 s.
    writer = start_writing(tmp_path, SmallDisk(GIB, RESERVE + (10 << 20)), tags=1)
    for frame in range(200):
        writer.sample(sample(TAGS[0], frame))
    wait_until(lambda: writer.seconds_left is not None)
    left = writer.seconds_left
    folder = writer.stop().result(SECONDS).folder

    assert left is not None
    assert 60 < left < WARN_S
    assert [event.kind for event in read_events(folder)].count("disk") == 1
    assert writer.failure is None


def test_recording_stops_in_order_before_its_file_is_as_long_as_the_disk_allows(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, ShortFiles(END_RESERVE + 100_000))
    for one in samples(100):  # 270 kB
        writer.sample(one)
    wait_until(lambda: writer.failure is not None)

    saved = writer.stop().result(SECONDS)

    assert isinstance(writer.failure, FileAtLimit)
    assert writer.failure.kept_s == pytest.approx(0.99, abs=0.01)
    assert read_take(saved.folder)[1].finished
    with (saved.folder / "take.mcap").open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.chunk_indexes


def test_the_operator_is_warned_ten_minutes_before_the_file_is_as_long_as_the_disk_allows(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, ShortFiles(END_RESERVE + (10 << 20)), tags=1)
    for frame in range(200):
        writer.sample(sample(TAGS[0], frame))
    wait_until(lambda: writer.seconds_left is not None)
    left = writer.seconds_left
    folder = writer.stop().result(SECONDS).folder

    assert left is not None
    assert 60 < left < WARN_S
    assert [event.kind for event in read_events(folder)].count("disk") == 1


def test_a_file_gets_its_end_where_its_index_is_too_long_for_the_disk(tmp_path: Path) -> None:
    def written(longest: int) -> TakeFile:
        encoder = TakeEncoder(identity("walk", "P014", "", SETUP, {}, Anchor("", START)))
        file = TakeFile(tmp_path, "walk", encoder, ShortFiles(longest))
        for block in encoder.blocks(samples(8), [], []):
            file.append(block)
        return file

    size = written(1 << 30).ledger.size

    folder = written(size + 20_000).finish().folder  # last words and an end fit in, 64 kB kept for an index do not

    assert read_take(folder)[1].finished
    with (folder / "take.mcap").open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    assert summary.chunk_indexes == []


def test_an_imported_take_too_long_for_the_disk_is_said_to_be_that(tmp_path: Path) -> None:
    take, _ = read_take(start_and_stop(tmp_path))

    with pytest.raises(FileAtLimit):
        write_take(take, tmp_path, DAY, filesystem=ShortFiles(8000))


def test_a_day_of_two_suits_fits_into_a_take_and_what_recording_keeps_can_be_read() -> None:
    assert MOST_SAMPLES >= 24 * 3600 * 30 * 100
    assert MOST_SAMPLES + CAPACITY <= MAX_SAMPLES
    assert MOST_EVENTS + EVENT_CAPACITY < MAX_EVENTS


@pytest.mark.parametrize(("limit", "fed"), [("MOST_SAMPLES", "samples"), ("MOST_EVENTS", "events")])
def test_recording_stops_in_order_before_a_take_has_more_than_readers_accept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, limit: str, fed: str
) -> None:
    monkeypatch.setattr(f"studio.storage.take_writer.{limit}", 30)
    writer = start_writing(tmp_path, tags=1)
    writer.sample(sample(TAGS[0], 0))
    for number in range(1, 30):
        if fed == "samples":
            writer.sample(sample(TAGS[0], number))
        else:
            writer.event("gap", {}, START)
    if fed == "events":
        writer.event("gap", {}, START)
    wait_until(lambda: writer.failure is not None)

    saved = writer.stop().result(SECONDS)

    assert isinstance(writer.failure, TakeAtLimit)
    assert writer.failure.kept_s == pytest.approx(saved.duration)
    assert read_take(saved.folder)[1].finished


MOUNTS = """\
24 1 8:2 / / rw,relatime shared:1 - ext4 /dev/sda2 rw
31 24 8:17 / /media/a\\040stick rw,nosuid shared:9 - vfat /dev/sdb1 rw,fmask=0022
32 24 0:30 / /proc rw
"""


@pytest.mark.parametrize(("major", "minor", "kind"), [(8, 2, "ext4"), (8, 17, "vfat"), (0, 30, ""), (8, 1, "")])
def test_a_stick_with_fat32_is_known_by_its_mount(major: int, minor: int, kind: str) -> None:
    assert kind_of_mount(MOUNTS, major, minor) == kind


def test_most_disks_allow_files_of_any_length(tmp_path: Path) -> None:
    assert longest_file(tmp_path) == NO_LIMIT
    assert longest_file(tmp_path / "missing") == NO_LIMIT


def test_recording_stops_in_order_before_the_system_runs_out_of_room(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, SmallDisk(GIB, RESERVE - 1), tags=1)
    writer.sample(sample(TAGS[0], 0))
    wait_until(lambda: writer.failure is not None)

    assert isinstance(writer.failure, DiskFull)
    assert writer.stop().result(SECONDS).samples == 1
