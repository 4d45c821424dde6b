"""F34, F35: whatever was done to a take file, what is undamaged is read, nothing wrong is, and nothing hangs."""

import struct
import sys
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.records import Channel, Header, Metadata
from mcap.writer import Writer

from studio.core.errors import Damaged, NotATake, StudioError, TakeUnsafe, WrittenByNewerStudio
from studio.core.sample import Stream
from studio.core.take import Take
from studio.storage.block_reader import MAX_RECORDS
from studio.storage.blocks import BlockBuilder, encode
from studio.storage.encoder import TakeEncoder
from studio.storage.facts import Anchor, identity
from studio.storage.filesystem import FILES
from studio.storage.profile import BLOCK_HEAD_SIZE, MAGIC, MAX_BLOCK, MAX_CHANNELS, PROFILE, SYNC
from studio.storage.recovery import recover
from studio.storage.take_file import TakeFile
from studio.storage.take_reader import read_attachment, read_events, read_raw, read_take
from tests.storage.recordings import SETUP, START, TAGS, info, samples

MUTANTS = 1000
FRAMES, BLOCKS, SENSORS = 12, 6, 3


def small_take(folder: Path) -> Path:
    """Write a take of several blocks with all kinds of content; the blocks are the same on every computer."""
    encoder = TakeEncoder(identity("walk", "P014", "synthetic", SETUP, {"studio": "0"}, Anchor("", START)))
    file = TakeFile(folder, "walk", encoder, FILES)
    for sensor in TAGS[:SENSORS]:
        encoder.add_sensor(info(sensor))
    kept = samples(FRAMES, SENSORS)
    size = len(kept) // BLOCKS
    for block in range(BLOCKS):
        part = kept[block * size : (block + 1) * size]
        for encoded in encoder.blocks(part, [], []):
            file.append(encoded)
    for encoded in encoder.attachment("note", "text/plain", b"x" * 300):
        file.append(encoded)
    return file.finish().folder / "take.mcap"


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_take(tmp_path_factory.mktemp("original"))


def assert_nothing_wrong(found: Take, truth: Take) -> int:
    """Check that every sample found is one that was recorded, and return how many there are."""
    for stream in found.streams:
        true = truth.stream(stream.info.sensor)
        assert stream.info == true.info
        rows = np.searchsorted(true.arrival, stream.arrival)
        assert len(np.unique(rows)) == len(rows)
        for name in Stream.__dataclass_fields__:
            if name != "info":
                assert getattr(stream, name).tobytes() == getattr(true, name)[rows].tobytes(), name
    return sum(map(len, found.streams))


def flip(data: bytearray, random: np.random.Generator) -> None:
    data[random.integers(len(data))] ^= 1 << random.integers(8)


def zero(data: bytearray, random: np.random.Generator) -> None:
    start, size = random.integers(len(data)), int(random.integers(1, 600))
    data[start : start + size] = bytes(len(data[start : start + size]))


def noise(data: bytearray, random: np.random.Generator) -> None:
    start, size = random.integers(len(data)), int(random.integers(1, 600))
    data[start : start + size] = random.bytes(len(data[start : start + size]))


def cut_off(data: bytearray, random: np.random.Generator) -> None:
    del data[random.integers(len(data)) :]


def lose(data: bytearray, random: np.random.Generator) -> None:
    start = random.integers(len(data))
    del data[start : start + random.integers(1, 600)]


def repeat(data: bytearray, random: np.random.Generator) -> None:
    start, target = random.integers(len(data), size=2)
    data[target:target] = data[start : start + 3000]


Mutation = Callable[[bytearray, np.random.Generator], None]
MUTATIONS: tuple[Mutation, ...] = (flip, zero, noise, cut_off, lose, repeat)


@pytest.mark.parametrize("mutation", MUTATIONS)
def test_a_mutated_take_is_read_as_far_as_it_is_good(original: Path, tmp_path: Path, mutation: Mutation) -> None:
    truth, _ = read_take(original)
    random = np.random.default_rng(MUTATIONS.index(mutation))
    whole = original.read_bytes()
    recorded = FRAMES * SENSORS
    file = tmp_path / "take.mcap"
    kept = []
    for _ in range(MUTANTS // len(MUTATIONS) + 1):
        data = bytearray(whole)
        mutation(data, random)
        file.write_bytes(data)
        try:
            found, report = read_take(file)
        except (NotATake, Damaged):
            kept.append(0)
            continue
        kept.append(assert_nothing_wrong(found, truth))
        assert report.samples == kept[-1]
        if kept[-1] < recorded:
            assert report.damaged or not report.finished

    # One block of six, and the channels of the first block stand again at the end.
    floor = {"cut_off": 0.3, "zero": 0.7, "noise": 0.7, "lose": 0.7}.get(mutation.__name__, 0.8)
    assert np.mean(kept) >= floor * recorded


def test_a_take_cut_off_at_any_byte_is_read_up_to_there(original: Path, tmp_path: Path) -> None:
    truth, _ = read_take(original)
    whole = original.read_bytes()
    file = tmp_path / "take.part.mcap"
    before = 0
    for length in range(0, len(whole), 7):
        file.write_bytes(whole[:length])
        try:
            found, report = read_take(file)
        except NotATake:
            assert length < whole.index(SYNC) + BLOCK_HEAD_SIZE
            continue
        except Damaged:
            assert before == 0
            continue
        kept = assert_nothing_wrong(found, truth)
        assert kept >= before
        assert report.recovered
        # What was still being written is not damage; the first samples need their channels, from the same block.
        assert report.damaged == 0 or kept == 0
        before = kept
    assert before == FRAMES * SENSORS


def test_the_other_readers_survive_the_same_damage(original: Path, tmp_path: Path) -> None:
    random = np.random.default_rng(9)
    whole = original.read_bytes()
    note = read_attachment(original, "note")
    for number in range(200):
        data = bytearray(whole)
        MUTATIONS[number % len(MUTATIONS)](data, random)
        folder = tmp_path / str(number)
        folder.mkdir()
        (folder / "take.part.mcap").write_bytes(data)
        try:
            list(read_raw(folder))
            read_events(folder)
            assert read_attachment(folder, "note") in (note, None)
            recover(folder)
        except StudioError:
            continue
        assert read_take(folder)[1].finished


def test_bytes_of_another_take_are_not_taken_for_this_one(original: Path, tmp_path: Path) -> None:
    """What a power cut leaves in pages that were not written yet."""
    truth, _ = read_take(original)
    other = small_take(tmp_path).read_bytes()
    mine = original.read_bytes()
    middle = len(mine) // 2
    file = tmp_path / "take.mcap"
    file.write_bytes(mine[:middle] + other[middle:])

    found, report = read_take(file)

    assert 0 < assert_nothing_wrong(found, truth) < FRAMES * SENSORS
    assert not report.finished or report.damaged


def block(*parts: bytes, number: int = 1) -> bytes:
    builder = BlockBuilder(b"hostile!", number)
    for part in parts:
        builder.add(part)
    return builder.finish().data


LEAD = MAGIC + encode(Header(PROFILE, ""))


def imu_channel(number: int, topic: str = "/imu/tag:1") -> bytes:
    return encode(Channel(id=number, topic=topic, message_encoding="cdr", metadata={"sensor": "{}"}, schema_id=1))


def compressed_chunk() -> bytes:
    bomb = zlib.compress(bytes(10_000_000))
    content = struct.pack("<QQQII4sQ", 0, 0, 10_000_000, 0, 4, b"zstd", len(bomb)) + bomb
    return struct.pack("<BQ", 6, len(content)) + content


def long_head() -> bytes:
    head = bytearray(block())
    struct.pack_into("<I", head, BLOCK_HEAD_SIZE - 12, MAX_BLOCK + 1)
    struct.pack_into("<I", head, BLOCK_HEAD_SIZE - 4, zlib.crc32(head[: BLOCK_HEAD_SIZE - 4]))
    return bytes(head)


HOSTILE = {
    "a compressed chunk": block(compressed_chunk()),
    "a block of more bytes than any block has": long_head(),
    "more channels than any take": b"".join(
        block(*(imu_channel(1 + n + 500 * part, f"/raw/{n}") for n in range(500)), number=part + 1)
        for part in range(MAX_CHANNELS // 500 + 1)
    ),
    "a block of empty records": block(struct.pack("<BQ", 0x90, 0) * (MAX_RECORDS + 1)),
    "a sensor under another name": block(
        encode(
            Channel(
                id=1,
                topic="/imu/tag:1",
                message_encoding="cdr",
                metadata={"sensor": '{"zero_s":0,"info":{"sensor":"tag:2","frame_s":0.01}}'},
                schema_id=1,
            )
        )
    ),
}


@pytest.mark.parametrize("what", HOSTILE)
def test_a_hostile_file_is_refused(tmp_path: Path, what: str) -> None:
    (tmp_path / "take.mcap").write_bytes(LEAD + HOSTILE[what])

    with pytest.raises(TakeUnsafe):
        read_take(tmp_path)


HARMLESS = {
    "a length of 2**63": block(struct.pack("<BQ", 6, 1 << 63)),
    "an attachment of 2**63": block(struct.pack("<BQQQIIQ", 9, 32, 0, 0, 0, 0, 1 << 63)),
    "deep JSON": block(encode(Metadata("kinetag", {"profile": PROFILE, "take": "[" * 100_000}))),
    "a channel that says nothing": block(imu_channel(1)),
    "lengths that contradict each other": block(struct.pack("<BQHHI", 4, 8, 1, 1, 0xFFFFFFFF)),
}


@pytest.mark.parametrize("what", HARMLESS)
def test_nonsense_in_a_whole_block_is_no_take(tmp_path: Path, what: str) -> None:
    (tmp_path / "take.mcap").write_bytes(LEAD + HARMLESS[what])

    with pytest.raises(Damaged):
        read_take(tmp_path)
    assert read_attachment(tmp_path, "x") is None


def test_heads_that_promise_more_than_there_is_cost_no_time(tmp_path: Path) -> None:
    """Each of 20,000 heads claims the rest of the file: reading it for each would be 20 GB."""
    heads = bytearray()
    for number in range(1, 20_000):
        head = bytearray(block(number=number))
        struct.pack_into("<I", head, BLOCK_HEAD_SIZE - 12, MAX_BLOCK)
        struct.pack_into("<I", head, BLOCK_HEAD_SIZE - 4, zlib.crc32(head[: BLOCK_HEAD_SIZE - 4]))
        heads += head
    (tmp_path / "take.mcap").write_bytes(LEAD + heads)

    with pytest.raises(TakeUnsafe, match="no take"):
        read_take(tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="sparse files are made differently there")
def test_a_huge_empty_file_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "take.mcap"
    with file.open("wb") as stream:
        stream.write(MAGIC)
        stream.truncate(1 << 40)

    with pytest.raises(TakeUnsafe):
        read_take(file)


def test_a_take_of_a_later_profile_is_said_to_be_one(tmp_path: Path) -> None:
    file = tmp_path / "take.mcap"
    later = Metadata("kinetag", {"profile": "kinetag.take/2", "take": "{}"})

    for content in (LEAD + block(encode(later)), MAGIC + encode(Header("kinetag.take/2", ""))):
        file.write_bytes(content)
        with pytest.raises(WrittenByNewerStudio) as refusal:
            read_take(file)
        assert (refusal.value.found, refusal.value.supported) == ("kinetag.take/2", PROFILE)


def test_a_recording_of_another_program_is_not_a_take(tmp_path: Path) -> None:
    file = tmp_path / "other.mcap"
    with file.open("wb") as stream:
        writer = Writer(stream)
        writer.start("ros2", "another")
        writer.finish()

    with pytest.raises(NotATake):
        read_take(file)
