"""`packets.h` as gcc compiles it and the studio's codec mean the same bytes (firmware/protocol/PROTOCOL.md 5)."""

import os
import shutil
import struct
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from cobs import cobs  # type: ignore[import-untyped]

from studio.acquisition.dialects import receiver_frames, tag_advert
from studio.core.sample import Flag
from tests.acquisition.wire_vectors import ROOT, VECTORS

pytestmark = pytest.mark.firmware

PROBE = Path(__file__).with_name("packets_probe.c")
STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
FRAMES = {
    receiver_frames.Kind.HELLO: "frame_hello",
    receiver_frames.Kind.PACKET: "frame_packet",
    receiver_frames.Kind.STATUS: "frame_status",
    receiver_frames.Kind.MODE: "frame_mode",
    receiver_frames.Kind.CHANNEL: "frame_channel",
    receiver_frames.Kind.COMMAND: "frame_command",
}
RESERVED: dict[str, dict[str, Any]] = {"integral": {"zero": 0}, "coefficients": {"zero": "000000"}}
FLOATS = {("coefficients", "value")}

Ask = Callable[[str], str]


@pytest.fixture(scope="module")
def ask(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Ask]:
    """Compile the probe and return a function that gives it a line and returns its answer."""
    if shutil.which("gcc") is None:
        assert not os.environ.get("KINETAG_REQUIRE_GCC"), "KINETAG_REQUIRE_GCC is set and there is no gcc"
        pytest.skip("gcc is not installed: packets.h is not compared")
    program = tmp_path_factory.mktemp("conformance") / "packets_probe"
    include = ROOT / "firmware" / "protocol"
    subprocess.run(["gcc", *STRICT, f"-I{include}", "-o", program, PROBE], check=True)
    with subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as probe:
        pipe_in, pipe_out = probe.stdin, probe.stdout
        assert pipe_in is not None
        assert pipe_out is not None

        def answer(line: str) -> str:
            pipe_in.write(line + "\n")
            pipe_in.flush()
            return pipe_out.readline().strip()

        yield answer
        pipe_in.close()


@pytest.fixture(scope="module")
def layout(ask: Ask) -> dict[str, dict[str, tuple[int, int]]]:
    """Return offset and size of each field, by struct; the whole size as the field ``""``."""
    words = ask("layout").split()
    structs: dict[str, dict[str, tuple[int, int]]] = {}
    for at in range(0, len(words), 5):
        structure, name, offset, size, whole = words[at : at + 5]
        structs.setdefault(structure, {"": (0, int(whole))})[name] = (int(offset), int(size))
    return structs


def field_bytes(structure: str, name: str, value: Any, size: int) -> bytes:
    """Return the bytes of one field of the vectors: hex, one integer, or several of equal size."""
    if isinstance(value, str):
        return bytes.fromhex(value)
    if (structure, name) in FLOATS:
        return struct.pack(f"<{len(value)}f", *value)
    numbers = value if isinstance(value, list) else [value]
    each = size // len(numbers)
    return b"".join((n % (1 << 8 * each)).to_bytes(each, "little") for n in numbers)


def of_payload(vector: dict[str, Any]) -> tuple[str, dict[str, Any], bytes]:
    """Return struct, fields and bytes of a payload in the vectors."""
    kind, raw, body = vector["type"], dict(vector["raw"]), bytes.fromhex(vector["advert"])[4:]
    head: dict[str, Any] = {"magic": 0x6D, "version_type": 0x10 | tag_advert.Packet[kind.upper()]}
    if kind == "sync":
        return kind, head | raw, body
    head |= {name: raw.pop(name) for name in ("number", "sequence", "clock", "flags")}
    reserved = RESERVED.get(kind, {})
    return kind, {f"head.{name}": value for name, value in head.items()} | raw | reserved, body


def of_frame(vector: dict[str, Any]) -> tuple[str, dict[str, Any], bytes]:
    """Return struct, fields and bytes of a serial frame in the vectors."""
    return FRAMES[vector["kind"]], {"kind": vector["kind"]} | vector["raw"], bytes.fromhex(vector["body"])


ALL = [of_payload(v) for v in VECTORS["payloads"]] + [of_frame(v) for v in VECTORS["frames"]]
NAMES = [v["name"] for v in VECTORS["payloads"]] + [f"frame {v['name']}" for v in VECTORS["frames"]]


@pytest.mark.parametrize(("structure", "fields", "expected"), ALL, ids=NAMES)
def test_fields_assigned_in_c_are_the_bytes_of_the_vector(ask, layout, structure, fields, expected):
    sizes = layout[structure]
    assigned = " ".join(
        f"{name}={field_bytes(structure, name, value, sizes[name][1]).hex()}" for name, value in fields.items()
    )

    assert set(fields) == set(sizes) - {""}  # every field of the struct is in the vector, and the reverse
    assert ask(f"write {structure} {assigned}") == expected.hex()


@pytest.mark.parametrize(("structure", "fields", "expected"), ALL, ids=NAMES)
def test_bytes_of_the_vector_are_the_fields_in_c(ask, layout, structure, fields, expected):
    words = ask(f"read {structure} {expected.hex()}").split()
    sizes = layout[structure]

    assert dict(zip(words[::2], words[1::2], strict=True)) == {
        name: field_bytes(structure, name, value, sizes[name][1]).hex() for name, value in fields.items()
    }


def test_the_structs_have_no_padding_and_cover_every_byte(layout):
    for fields in layout.values():
        whole = fields[""][1]
        covered = sorted(at for name, (start, size) in fields.items() if name for at in range(start, start + size))
        assert covered == list(range(whole))


def test_sizes_are_those_of_the_codec(layout):
    for kind in tag_advert.Packet:
        assert layout[kind.name.lower()][""] == (0, tag_advert.PAYLOAD_SIZE)
    framed = {
        "frame_hello": receiver_frames.encode_hello(receiver_frames.Hello(1, 1, 1, 1)),
        "frame_packet": receiver_frames.encode_packet(0, bytes(6), -60, 37, bytes(27)),
        "frame_status": receiver_frames.encode_status(receiver_frames.Status(0, 0, 0, 0, (0,) * receiver_frames.SLOTS)),
        "frame_mode": receiver_frames.encode_mode(receiver_frames.Mode.FRAMES),
        "frame_channel": receiver_frames.encode_channel(37),
        "frame_command": receiver_frames.encode_command(1, tag_advert.Command.BLINK),
    }
    overhead = 1 + 2 + 1  # distance byte of COBS, CRC, closing zero
    for structure, frame in framed.items():
        assert len(frame) == layout[structure][""][1] + overhead


def test_constants_are_those_of_the_codec(ask):
    version, magic, payload, advert, tick_us, bits, frame_us, tags, everyone = map(int, ask("constants").split())
    traits = tag_advert.TRAITS

    assert (version, magic, payload, advert) == (
        tag_advert.VERSION,
        tag_advert.MAGIC,
        tag_advert.PAYLOAD_SIZE,
        tag_advert.ADVERT_SIZE,
    )
    assert (tick_us * 1e-6, 1 << bits, frame_us * 1e-6) == pytest.approx(
        (traits.clock_tick, traits.clock_modulus, traits.frame_s)
    )
    assert (tags, everyone) == (receiver_frames.SLOTS, tag_advert.ALL_TAGS)


@pytest.mark.parametrize("vector", VECTORS["frames"], ids=lambda v: v["name"])
def test_the_check_in_c_is_the_check_of_the_frames(ask, vector):
    body = bytes.fromhex(vector["body"])
    crc = int(ask(f"crc {body.hex()}"))

    checked = cobs.decode(bytes.fromhex(vector["framed"])[:-1])

    assert checked == body + crc.to_bytes(2, "little")
    assert int(ask("crc " + b"123456789".hex())) == 0x29B1  # the catalogue's check value


def test_the_names_of_flags_and_commands_are_the_same_on_both_sides():
    header = (ROOT / "firmware" / "protocol" / "packets.h").read_text("utf-8")

    for flag in Flag:
        if flag is not Flag.FILLED:
            assert f"KT_{flag.name} = {flag.value}" in header
    for command in tag_advert.Command:
        name = {"NONE": "NO_COMMAND", "COEFFICIENT": "SET_COEFFICIENT"}.get(command.name, command.name)
        assert f"KT_{name} = {command.value}" in header
