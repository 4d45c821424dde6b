"""The byte stream between receiver and computer (firmware/protocol/PROTOCOL.md 4), held against vectors.json."""

import itertools
from typing import Any

import numpy as np
import pytest
from cobs import cobs as independent  # type: ignore[import-untyped]
from hypothesis import given
from hypothesis import strategies as st

from studio.acquisition.dialects import cobs, receiver_frames, tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.dialects.receiver_frames import (
    Hello,
    Kind,
    Mode,
    OrderFrames,
    ReceiverFrames,
    SetChannel,
    SetMode,
    Status,
    TagCommand,
)
from studio.acquisition.dialects.registry import DIALECTS, open_dialect
from tests.acquisition.wire_vectors import VECTORS, neighbourhood

FRAMES = VECTORS["frames"]
ADDRESS = bytes.fromhex("78563412aac0")


def framed(*names: str) -> bytes:
    return b"".join(bytes.fromhex(v["framed"]) for v in FRAMES if v["name"] in names)


def of_kind(kind: Kind) -> Any:
    return pytest.mark.parametrize("vector", [v for v in FRAMES if v["kind"] == kind], ids=lambda v: v["name"])


ALL = b"".join(bytes.fromhex(v["framed"]) for v in FRAMES if v["kind"] >= Kind.HELLO)


def same(a: list[Reading], b: list[Reading]) -> bool:
    # repr, because NaN is not itself.
    return repr(a) == repr(b)


@pytest.mark.parametrize("name", DIALECTS)
def test_every_dialect_opens_and_refuses_noise_without_raising(name):
    dialect = open_dialect(name)

    assert dialect.feed(np.random.default_rng(1).bytes(4096)) == []
    assert sum(dialect.malformed.values()) > 0
    assert dialect.traits.sequence_modulus > 1


@pytest.mark.parametrize("vector", FRAMES, ids=lambda v: v["name"])
def test_frames_are_cobs_with_a_crc(vector):
    assert cobs.frame(bytes.fromhex(vector["body"])).hex() == vector["framed"]


@of_kind(Kind.PACKET)
def test_a_packet_is_encoded_to_the_same_bytes_and_read_as_its_payload_says(vector):
    raw, dialect = vector["raw"], ReceiverFrames()
    payload, address = bytes.fromhex(raw["payload"]), bytes.fromhex(raw["address"])

    made = receiver_frames.encode_packet(raw["clock_us"], address, -raw["loss"], raw["channel"], payload)
    readings = dialect.feed(made)

    assert made.hex() == vector["framed"]
    said = tag_advert.decode(payload, tag_advert.sensor_of(0x12345678), -float(raw["loss"]))
    if isinstance(said, tag_advert.Sync):
        assert (readings, dialect.beacon) == ([], said)
        return
    assert isinstance(said, Reading)
    if said.facts is not None:
        said = said._replace(facts={**said.facts, "address": "c0:aa:12:34:56:78"})
    assert same(readings, [said])


def test_hello_and_status_are_kept_and_are_no_readings():
    dialect = ReceiverFrames()

    assert dialect.feed(framed("hello", "status")) == []
    assert dialect.hello == Hello(version=1, hardware=1, firmware=0x0102, serial=0xCAFE0001)
    assert dialect.status == Status(5_000_000, 3750, 12, 0, (1, 1, 0, 2, *[0] * 11))
    assert not dialect.malformed
    assert receiver_frames.encode_hello(dialect.hello) + receiver_frames.encode_status(dialect.status) == framed(
        "hello", "status"
    )


def test_the_computer_speaks_and_a_receiver_understands():
    receiver = OrderFrames()
    said = (
        receiver_frames.encode_mode(Mode.FRAMES)
        + receiver_frames.encode_mode(Mode.DATA_MATRIX)
        + receiver_frames.encode_channel(39)
        + receiver_frames.encode_command(0x12345678, tag_advert.Command.REPORT_COEFFICIENTS)
        + receiver_frames.encode_command(
            tag_advert.ALL_TAGS, tag_advert.Command.LEAVE_SLOTS, bytes.fromhex("04000000005aa5")
        )
    )

    heard = [order for byte in said for order in receiver.feed(bytes([byte]))]

    assert said == framed("mode: frames", "mode: data matrix", "channel", "command to one tag", "command to all")
    assert heard == [
        SetMode(0),
        SetMode(1),
        SetChannel(39),
        TagCommand(0x12345678, 9, bytes(7)),
        TagCommand(0xFFFFFFFF, 8, bytes.fromhex("04000000005aa5")),
    ]
    assert not receiver.malformed


def test_a_lone_zero_asks_for_hello():
    receiver = OrderFrames()

    assert receiver.feed(receiver_frames.HELLO_REQUEST) == []
    assert receiver.hellos_asked == 1


def test_a_receiver_counts_what_it_does_not_understand():
    receiver = OrderFrames()

    assert receiver.feed(b"\x03\x01\x02\0" + framed("hello") + b"\x55" * 300 + b"\0") == []
    assert receiver.malformed == {"crc": 2, "kind": 1}


@pytest.mark.parametrize("vector", VECTORS["refused_frames"], ids=lambda v: v["name"])
def test_a_frame_that_makes_no_sense_is_counted_with_its_reason_and_the_next_is_read(vector):
    dialect = ReceiverFrames()

    readings = dialect.feed(bytes.fromhex(vector["framed"]) + framed("packet: sample"))

    assert len(readings) == 1
    assert dialect.malformed == {vector["reason"]: 1}


@pytest.mark.parametrize("vector", VECTORS["refused"], ids=lambda v: v["name"])
def test_an_intact_frame_with_a_senseless_payload_is_counted_for_its_tag(vector):
    dialect = ReceiverFrames()
    payload = bytes.fromhex(vector["advert"])[4:].ljust(27, b"\0")[:27]
    dialect.feed(framed("packet: sample"))
    said = tag_advert.decode(payload, tag_advert.sensor_of(0x12345678))

    readings = dialect.feed(receiver_frames.encode_packet(0, ADDRESS, -60, 37, payload))

    if isinstance(said, str):
        assert readings == []
        assert dialect.malformed == {said: 1}
        assert dialect.refused == {"tag:12345678": 1}
    else:
        assert len(readings) == 1  # cut to 27 bytes it is whole again


def test_other_version_in_the_stream_is_a_count_and_not_an_exception():
    dialect = ReceiverFrames()
    payload = bytearray(bytes.fromhex(FRAMES[1]["raw"]["payload"]))
    payload[1] = 0x21

    assert dialect.feed(receiver_frames.encode_packet(0, ADDRESS, -60, 37, bytes(payload))) == []
    assert dialect.malformed == {"version": 1}


def test_every_split_of_a_stream_gives_the_same_readings():
    noisy = b"boot: nRF52840\r\n\0" + ALL + b"\x07" * 200 + ALL
    whole = ReceiverFrames()
    expected = whole.feed(noisy)

    for at in range(len(noisy) + 1):
        parts = ReceiverFrames()
        readings = parts.feed(noisy[:at]) + parts.feed(noisy[at:])
        assert same(readings, expected)
        assert (parts.malformed, parts.hello, parts.status) == (whole.malformed, whole.hello, whole.status)


@given(st.lists(st.integers(0, len(ALL)), max_size=40))
def test_any_number_of_splits_gives_the_same_readings(cuts):
    expected = ReceiverFrames().feed(ALL)
    parts = ReceiverFrames()
    ends = [0, *sorted(cuts), len(ALL)]

    readings = [reading for a, b in itertools.pairwise(ends) for reading in parts.feed(ALL[a:b])]

    assert same(readings, expected)
    assert not parts.malformed


def test_a_stream_without_zeros_is_forgotten_and_not_collected():
    dialect = ReceiverFrames()

    for _ in range(200):
        dialect.feed(b"\x55" * 10_000)

    assert _held(dialect) <= receiver_frames.LONGEST_FRAME + 1
    assert len(dialect.feed(b"\0" + framed("packet: sample"))) == 1
    assert dialect.malformed == {"long": 1}


def test_the_tags_of_a_hostile_stream_are_forgotten():
    dialect = ReceiverFrames()
    payload = bytes.fromhex(FRAMES[1]["raw"]["payload"])

    for serial in range(3 * receiver_frames.KNOWN_TAGS):
        address = serial.to_bytes(4, "little") + b"\xaa\xc0"
        dialect.feed(receiver_frames.encode_packet(0, address, -60, 37, payload))

    assert len(dialect._tags) <= receiver_frames.KNOWN_TAGS  # noqa: SLF001


def test_no_neighbour_forwarded_by_a_receiver_is_taken_for_a_tag():
    dialect = ReceiverFrames()

    for report in neighbourhood():
        for start in range(max(len(report) - 26, 1)):
            payload = report[start : start + 27].ljust(27, b"\0")
            assert dialect.feed(receiver_frames.encode_packet(0, ADDRESS, -60, 37, payload)) == []

    assert set(dialect.malformed) == {"foreign"}


def test_single_bit_errors_are_never_read_as_something_else():
    frame = framed("packet: sample")
    truth = ReceiverFrames().feed(frame)

    for bit in range(8 * len(frame)):
        damaged = bytearray(frame)
        damaged[bit // 8] ^= 1 << bit % 8
        readings = ReceiverFrames().feed(bytes(damaged) + b"\0")
        assert readings == [] or same(readings, truth)


def test_a_hundred_thousand_damaged_frames_give_no_wrong_sample():
    """Bursts of up to 16 bits, bytes replaced, lost, doubled or swapped, and pure noise between good frames."""
    rng = np.random.default_rng(20)
    frames = [bytes.fromhex(v["framed"]) for v in FRAMES if v["kind"] >= Kind.HELLO]
    true = {repr(reading) for frame in frames for reading in ReceiverFrames().feed(frame)}
    dialect = ReceiverFrames()
    wrong, right = [], 0

    for turn in range(100_000):
        damaged = DAMAGES[turn % len(DAMAGES)](rng, frames[rng.integers(len(frames))])
        for reading in dialect.feed(damaged + b"\0"):
            right += repr(reading) in true
            wrong += [reading] if repr(reading) not in true else []

    assert wrong == []
    assert sum(dialect.malformed.values()) > 90_000
    assert right < 10_000  # swaps of equal bytes, and errors beside the frame


def test_good_frames_among_garbage_are_recovered():
    rng = np.random.default_rng(21)
    sample = framed("packet: sample")
    dialect = ReceiverFrames()
    read = 0

    for _ in range(5_000):
        read += len(dialect.feed(rng.bytes(int(rng.integers(80))) + b"\0" + sample))

    assert read == 5_000


@given(st.binary(max_size=600))
def test_stuffing_agrees_with_an_independent_implementation(data):
    assert cobs.stuff(data) == independent.encode(data)
    assert cobs.unstuff(cobs.stuff(data)) == data


@given(st.binary(max_size=80).map(lambda data: data.replace(b"\0", b"\1")))
def test_unstuffing_agrees_on_any_bytes(stuffed):
    try:
        expected = independent.decode(stuffed)
    except independent.DecodeError:
        expected = None

    assert cobs.unstuff(stuffed) == expected


def test_the_check_is_crc_16_ccitt_false():
    # The catalogue's check value of "123456789" (Greg Cook, CRC RevEng catalogue).
    assert cobs.is_intact(b"123456789\xb1\x29")
    assert not cobs.is_intact(b"123456789\x29\xb1")


def _whole(rng: np.random.Generator, first: int, end: int = 0) -> int:
    return int(rng.integers(first, end or None))


def _burst(rng: np.random.Generator, frame: bytes) -> bytes:
    size = _whole(rng, 1, 17)
    at = _whole(rng, 8 * (len(frame) - 1) - size + 1)
    error = (_whole(rng, 1 << size) | 1 | 1 << size - 1) << at
    return (int.from_bytes(frame, "little") ^ error).to_bytes(len(frame), "little")


def _replaced(rng: np.random.Generator, frame: bytes) -> bytes:
    at = _whole(rng, len(frame) - 1)
    return frame[:at] + bytes([frame[at] ^ _whole(rng, 1, 256)]) + frame[at + 1 :]


def _lost(rng: np.random.Generator, frame: bytes) -> bytes:
    at = _whole(rng, len(frame) - 1)
    return frame[:at] + frame[at + 1 :]


def _doubled(rng: np.random.Generator, frame: bytes) -> bytes:
    at = _whole(rng, len(frame) - 1)
    return frame[: at + 1] + frame[at:]


def _swapped(rng: np.random.Generator, frame: bytes) -> bytes:
    at = _whole(rng, len(frame) - 2)
    return frame[:at] + frame[at : at + 2][::-1] + frame[at + 2 :]


def _merged(rng: np.random.Generator, frame: bytes) -> bytes:
    return frame[: _whole(rng, 1, len(frame) - 1)] + frame[_whole(rng, 1, len(frame) - 1) :]


def _noise(rng: np.random.Generator, frame: bytes) -> bytes:
    return rng.bytes(len(frame))


DAMAGES = (_burst, _replaced, _lost, _doubled, _swapped, _merged, _noise, _burst)


def _held(dialect: ReceiverFrames) -> int:
    return len(dialect._splitter._rest)  # noqa: SLF001
