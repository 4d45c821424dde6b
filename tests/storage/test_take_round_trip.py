"""What was recorded is read back, bit for bit, by us and by the official MCAP library."""

import stat
import struct
import sys
import tracemalloc
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader

from studio.core.errors import NotATake
from studio.core.sample import NO_CORRECTION, Sample, SensorId, SensorInfo, Stream
from studio.core.take import Mark, Take
from studio.storage.encoder import TakeEncoder
from studio.storage.facts import Anchor, identity
from studio.storage.session_folder import list_takes
from studio.storage.take_reader import read_attachment, read_events, read_raw, read_take
from studio.storage.take_store import write_take
from studio.storage.take_writer import CAPACITY
from tests.storage.disks import StallingDisk
from tests.storage.recordings import DAY, RATE, SETUP, START, TAGS, info, sample, samples, start_writing

FIELDS = [name for name in Stream.__dataclass_fields__ if name not in ("info", "arrival")]
SECONDS = 30  # s that any computer needs at most to end a take of this size


def record(library: Path, kept: list[Sample]) -> Path:
    writer = start_writing(library)
    for one in kept:
        writer.sample(one)
    return writer.stop().result(SECONDS).folder


def assert_same_streams(found: Take, expected: Take) -> None:
    assert [stream.info for stream in found.streams] == [stream.info for stream in expected.streams]
    for ours, theirs in zip(found.streams, expected.streams, strict=True):
        for name in (*FIELDS, "arrival"):
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), err_msg=name)


def test_every_number_of_every_sample_comes_back_bit_for_bit(tmp_path: Path) -> None:
    kept = samples(40)

    take, report = read_take(record(tmp_path, kept))

    zero = kept[0].time
    assert report.finished
    assert (report.samples, report.damaged) == (len(kept), 0)
    for stream in take.streams:
        mine = [(arrival, one) for arrival, one in enumerate(kept) if one.sensor == stream.info.sensor]
        assert stream.info == info(stream.info.sensor)
        assert stream.arrival.tolist() == [arrival for arrival, _ in mine]
        for name in FIELDS:
            expected = np.array([getattr(one, name) for _, one in mine], getattr(stream, name).dtype)
            if name in ("time", "received"):
                expected = expected - zero
            assert getattr(stream, name).tobytes() == expected.tobytes(), name


def test_the_facts_in_force_and_the_start_are_kept_with_the_take(tmp_path: Path) -> None:
    take, _ = read_take(record(tmp_path, [s._replace(time=s.time + 2.5) for s in samples(3)]))

    assert repr(take.setup) == repr(SETUP)  # NaN is not equal to itself
    assert (take.name, take.person, take.source) == ("walk", "P014", "synthetic:walk?seed=1")
    assert take.versions == {"studio": "0.1.0", "protocol": "1"}
    assert take.started == "2026-11-24T10:00:02.500000+00:00"


def test_the_official_library_reads_every_message_and_finds_every_checksum_right(tmp_path: Path) -> None:
    kept = samples(20)
    writer = start_writing(tmp_path)
    writer.raw("usb0", START, b"bytes")
    writer.mark(Mark(START, "record"))
    writer.attach("truth", "application/octet-stream", bytes(9 << 20))
    for one in kept:
        writer.sample(one)
    file = writer.stop().result(SECONDS).folder / "take.mcap"

    with file.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        summary = reader.get_summary()
        messages = list(reader.iter_messages(log_time_order=False))
        attachments = list(reader.iter_attachments())
        metadata = list(reader.iter_metadata())
    with file.open("rb") as stream:
        from_the_start = sum(1 for _ in NonSeekingReader(stream, validate_crcs=True).iter_messages())

    assert summary is not None
    assert summary.statistics is not None
    assert summary.statistics.message_count == len(messages) == from_the_start == len(kept) + 2
    assert [a.name for a in attachments] == [f"truth.part-{n}-of-3" for n in (1, 2, 3)]
    assert all(len(a.data) <= 4 << 20 for a in attachments)
    assert metadata[0].name == "kinetag"
    imu = [(channel.topic, message) for _, channel, message in messages if channel.topic.startswith("/imu/")]
    assert [(topic.removeprefix("/imu/"), m.sequence) for topic, m in imu] == [
        (s.sensor, i) for i, s in enumerate(kept)
    ]
    assert [m.log_time for _, m in imu] == [round(s.received * 1e9) for s in kept]
    assert [m.publish_time for _, m in imu] == [round(s.time * 1e9) for s in kept]


def test_a_message_is_what_its_own_schema_says(tmp_path: Path) -> None:
    """Decode by the schema's text and the rules of CDR (little endian, fields aligned to their size)."""
    (one,) = samples(1, tags=1)
    codes = {"float64": "d", "int64": "q", "int32": "i", "uint32": "I"}
    file = record(tmp_path, [one]) / "take.mcap"
    with file.open("rb") as stream:
        ((schema, channel, message),) = make_reader(stream).iter_messages(topics=[f"/imu/{one.sensor}"])
    assert schema is not None

    assert (schema.encoding, channel.message_encoding, message.data[:4]) == ("ros2msg", "cdr", b"\x00\x01\x00\x00")
    found: dict[str, tuple[float, ...]] = {}
    position, body = 0, message.data[4:]
    for line in schema.data.decode().splitlines():
        words = line.partition("#")[0].split()
        if words:
            kind, _, count = words[0].rstrip("]").partition("[")
            layout = struct.Struct("<" + codes[kind] * int(count or 1))
            width = struct.calcsize(codes[kind])
            position = -(-position // width) * width
            found[words[1]] = layout.unpack_from(body, position)
            position += layout.size
    assert position == len(body)
    expected = {
        name: value if isinstance(value, tuple) else (value,)
        for name, value in one._asdict().items()
        if name != "sensor"
    }
    assert {name: str(value) for name, value in found.items()} == {name: str(value) for name, value in expected.items()}


def test_a_sensor_that_appears_later_and_what_becomes_known_of_another(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, tags=1)
    writer.sample(sample(TAGS[0], 0))
    late = replace(info(TAGS[1]), label="late")
    known = replace(info(TAGS[0]), correction=NO_CORRECTION)
    writer.add_sensor(late)
    writer.sample(sample(TAGS[1], 1))
    writer.update_info(known)

    take, _ = read_take(writer.stop().result(SECONDS).folder)

    assert [stream.info for stream in take.streams] == [known, late]


def test_a_sample_of_a_sensor_nobody_announced_is_kept(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, tags=0)
    writer.sample(sample(TAGS[4], 0))

    take, report = read_take(writer.stop().result(SECONDS).folder)

    assert report.samples == 1
    assert take.stream(TAGS[4]).info == SensorInfo(TAGS[4], 0.02)  # the frame of the wire protocol


def test_marks_and_events_come_back_in_take_time(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)
    writer.sample(sample(TAGS[0], 0))
    writer.mark(Mark(START + 1.5, "pose", "n", START + 4.5))
    writer.mark(Mark(START + 2.0, "record"))
    writer.event("loss", {"sensor": TAGS[0], "missing": 3, "share": np.float64(0.5)}, START + 3.0)
    folder = writer.stop().result(SECONDS).folder

    take, _ = read_take(folder)

    assert take.marks[0] == Mark(1.5, "pose", "n", 4.5)
    assert (take.marks[1].time, take.marks[1].kind) == (2.0, "record")
    loss = read_events(folder)[-1]
    assert (loss.kind, loss.received, loss.facts) == ("loss", 3.0, {"sensor": TAGS[0], "missing": 3, "share": 0.5})


def test_an_event_too_long_for_any_reader_is_kept_as_a_word(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)
    writer.event("strange", {"text": "x" * 100_000}, START)

    assert read_events(writer.stop().result(SECONDS).folder)[0].facts.keys() == {"too_long"}


def test_the_bytes_of_each_link_come_back_as_they_were_read(tmp_path: Path) -> None:
    reads = [("usb0", START + 0.1, b"\x00\x01\x02"), ("usb1", START + 0.2, b""), ("usb0", START + 0.3, bytes(3 << 20))]
    writer = start_writing(tmp_path)
    writer.sample(sample(TAGS[0], 0))
    for read in reads:
        writer.raw(*read)

    found = list(read_raw(writer.stop().result(SECONDS).folder))

    assert b"".join(data for link, _, data in found if link == "usb0") == reads[0][2] + reads[2][2]
    assert [(link, data) for link, _, data in found[:2]] == [("usb0", b"\x00\x01\x02"), ("usb1", b"")]
    assert [received for _, received, _ in found[:3]] == pytest.approx([0.1, 0.2, 0.3], abs=1e-9)


def test_attachments_come_back_whole(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)
    large = bytes(range(256)) * (5 << 12)  # 5 MB: two parts
    writer.attach("small", "text/plain", b"x")
    writer.attach("large", "application/octet-stream", large)
    writer.attach("empty", "text/plain", b"")
    folder = writer.stop().result(SECONDS).folder

    assert read_attachment(folder, "small") == b"x"
    assert read_attachment(folder, "large") == large
    assert read_attachment(folder, "empty") == b""
    assert read_attachment(folder, "other") is None


def test_an_empty_recording_is_a_take(tmp_path: Path) -> None:
    take, report = read_take(start_writing(tmp_path).stop().result(SECONDS).folder)

    assert (take.streams, report.samples, report.finished, take.duration()) == ((), 0, True, 0.0)


def test_a_stored_take_is_the_take_that_was_read(tmp_path: Path) -> None:
    first, _ = read_take(record(tmp_path, samples(300)))

    second, report = read_take(write_take(first, tmp_path, DAY))

    assert report.finished
    assert_same_streams(second, first)
    assert repr(replace(second, streams=())) == repr(replace(first, streams=()))


def test_a_take_without_a_person_goes_where_nobody_is_and_stays_without(tmp_path: Path) -> None:
    take, _ = read_take(record(tmp_path, samples(2)))
    folder = write_take(replace(take, person="", started="2025-06-01T12:00:00+00:00"), tmp_path)

    assert folder.relative_to(tmp_path).parts == ("P000", "2025-06-01a", "take-001_walk")
    assert read_take(folder)[0].person == ""


def test_a_frame_nobody_told_is_the_usual_step_of_the_samples(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, tags=0)
    for frame in (0, 1, 2, 7, 8):
        writer.sample(sample(TAGS[4], frame))

    take, _ = read_take(writer.stop().result(SECONDS).folder)

    assert take.stream(TAGS[4]).info.frame_s == pytest.approx(1 / RATE)


def test_a_sample_without_a_time_is_left_out_and_clocks_that_tell_nothing_are_that_of_the_take(tmp_path: Path) -> None:
    inf = float("inf")
    timeless = sample(TAGS[0], 0)._replace(time=float("nan"))
    strange = sample(TAGS[0], 1)._replace(received=inf, device_time=-inf)

    take, report = read_take(record(tmp_path, [timeless, strange, sample(TAGS[0], 2)]))

    stream = take.streams[0]
    assert (report.samples, report.damaged) == (2, 2)
    assert stream.time.tolist() == pytest.approx([0.0, 1 / RATE])  # 0 is the first time there is
    assert stream.received[0] == 0.0
    assert stream.device_time[0] == strange.time


def test_reading_needs_little_more_memory_than_the_take(tmp_path: Path) -> None:
    """A take of half an hour has 205 MB; computers of clinics have 4 GB for everything."""
    n = 20_000
    stream = read_take(record(tmp_path, samples(1, 1)))[0].streams[0]
    repeated: dict[str, Any] = {name: np.repeat(getattr(stream, name), n, axis=0) for name in FIELDS}
    long = replace(stream, **repeated, arrival=np.arange(n))
    streams = tuple(
        replace(long, info=info(tag), arrival=long.arrival * len(TAGS) + number) for number, tag in enumerate(TAGS)
    )
    folder = write_take(Take("long", "", "", "", streams), tmp_path, DAY)

    tracemalloc.start()
    take, report = read_take(folder)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()

    size = sum(getattr(stream, name).nbytes for stream in take.streams for name in (*FIELDS, "arrival"))
    assert (report.samples, report.damaged) == (n * len(TAGS), 0)
    assert peak < 2 * size


def test_the_duration_is_that_of_the_last_sample_measured_not_of_the_last_to_arrive(tmp_path: Path) -> None:
    late = samples(3, 1)
    late[1], late[2] = late[2], late[1]

    take, report = read_take(record(tmp_path, late))

    assert take.duration() == report.until_s == pytest.approx(2 / RATE)


def test_what_a_sensor_calls_itself_is_made_harmless(tmp_path: Path) -> None:
    writer = start_writing(tmp_path, tags=0)
    writer.add_sensor(SensorInfo(TAGS[0], 0.01, label="\u202eevil\x1b[31m" + "x" * 100, facts={"board": "a\x00b"}))
    writer.sample(sample(TAGS[0], 0))

    found = read_take(writer.stop().result(SECONDS).folder)[0].streams[0].info

    assert found.label == ("evil[31m" + "x" * 100)[:64]
    assert found.facts == {"board": "ab"}


def test_channels_stand_again_every_ten_seconds() -> None:
    """So that damage at the start of a take that was cut off costs ten seconds and no more."""
    encoder = TakeEncoder(identity("walk", "P014", "", SETUP, {}, Anchor("", START)))
    encoder.add_sensor(info(TAGS[0]))
    encoder.opening()
    written = [
        (frame / RATE, block.data.count(b"/imu/" + TAGS[0].encode()))
        for frame in range(0, 25 * RATE, 10)
        for block in encoder.blocks([sample(TAGS[0], frame)], [], [])
    ]

    assert [(second, times) for second, times in written if times] == [(0.0, 1), (10.0, 1), (20.0, 1)]


def test_only_the_owner_can_read_a_take(tmp_path: Path) -> None:
    if sys.platform == "win32":
        pytest.skip("Windows keeps rights elsewhere")
    folder = record(tmp_path / "library", samples(1))

    assert {stat.S_IMODE(file.stat().st_mode) for file in folder.iterdir()} == {0o600}
    assert [stat.S_IMODE(path.stat().st_mode) for path in (folder, *folder.parents[:2])] == [0o700] * 3


def test_a_take_being_recorded_is_not_in_the_list(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)

    assert list_takes(tmp_path) == []
    folder = writer.stop().result(SECONDS).folder
    assert [(take.folder, take.recovered) for take in list_takes(tmp_path)] == [(folder, False)]


def test_stopping_twice_gives_the_same_take(tmp_path: Path) -> None:
    writer = start_writing(tmp_path)

    assert writer.stop() is writer.stop()
    assert writer.stop().result(SECONDS).folder == writer.folder


def test_what_finds_the_queue_full_is_counted_in_the_take(tmp_path: Path) -> None:
    disk = StallingDisk()
    writer = start_writing(tmp_path, disk, tags=1)
    beyond = 7
    writer.sample(sample(TAGS[0], 0))
    disk.stalled.wait()
    for frame in range(CAPACITY + beyond):
        writer.sample(sample(TAGS[0], 1 + frame))
    full = writer.fill
    disk.go_on.set()
    folder = writer.stop().result(SECONDS).folder

    assert full == 1.0
    assert read_take(folder)[1].samples == 1 + CAPACITY
    assert [event.facts for event in read_events(folder) if event.kind == "overflow"] == [{"missing": beyond}]


def test_a_disk_that_stalls_for_thirty_seconds_costs_nothing(tmp_path: Path) -> None:
    """F07: everything 15 tags at 100 Hz send meanwhile waits in memory."""
    disk = StallingDisk()
    writer = start_writing(tmp_path, disk)
    kept = samples(30 * RATE)
    writer.sample(kept[0])
    disk.stalled.wait()
    for one in kept[1:]:
        writer.sample(one)
        writer.raw("usb0", one.received, bytes(27))
    full = writer.fill
    disk.go_on.set()

    take, report = read_take(writer.stop().result(SECONDS).folder)

    assert 0.5 < full < 1.0
    assert (report.samples, report.damaged) == (len(kept), 0)
    assert np.array_equal(np.sort(np.concatenate([s.arrival for s in take.streams])), np.arange(len(kept)))


def test_a_folder_without_a_take_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("no take")

    for path in (tmp_path, tmp_path / "notes.txt", tmp_path / "missing"):
        with pytest.raises(NotATake):
            read_take(path)
    with pytest.raises(KeyError):
        Take("", "", "", "", ()).stream(SensorId("tag:1"))
