"""The byte stream between a receiver and the computer (firmware/protocol/PROTOCOL.md, "Receiver and computer")."""

import struct
from collections import Counter
from enum import IntEnum
from typing import NamedTuple

from studio.acquisition.dialects import cobs, tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.core.sample import SensorId, SensorInfo

BAUD = 1_000_000  # 8N1; 15 tags at 50 Hz fill 30 % of it
SERIAL_SIZE = 4  # bytes of a device address that are the tag's serial, as on air: least significant first
SLOTS = 15  # tags one receiver gives time slots to

LONGEST_FRAME = 64  # bytes before the closing zero; the longest we know, a packet, has 43
KNOWN_TAGS = 1024  # addresses remembered; a room has some, a hostile stream could have 2^48


class Kind(IntEnum):
    """First byte of a frame."""

    MODE = 0x01
    CHANNEL = 0x02
    COMMAND = 0x03
    HELLO = 0x20
    PACKET = 0x21
    STATUS = 0x22


class Mode(IntEnum):
    """What the receiver sends."""

    FRAMES = 0
    DATA_MATRIX = 1


class Hello(NamedTuple):
    """What a receiver says of itself on opening and when it reads a lone zero."""

    version: int
    """Of the wire protocol; ours is ``tag_advert.VERSION``."""
    hardware: int
    firmware: int
    """major << 8 | minor."""
    serial: int


class SlotState(IntEnum):
    """What a receiver hears in a time slot."""

    SILENT = 0
    HEARD = 1
    COLLIDING = 2
    """Only damaged packets for a second: two tags have this number."""


class Status(NamedTuple):
    """What a receiver counts, told once a second."""

    clock_us: int
    """µs, wraps at 2^32."""
    received: int
    crc_errors: int
    dropped: int
    """Packets the receiver heard and could not hand on."""
    slots: tuple[int, ...]
    """``SlotState`` of tag 1…15."""


class SetMode(NamedTuple):
    """The computer chooses what the receiver sends."""

    mode: int


class SetChannel(NamedTuple):
    """The computer chooses the advertising channel, 37…39."""

    channel: int


class TagCommand(NamedTuple):
    """The computer has the receiver tell a tag something in its beacons."""

    serial: int
    """``tag_advert.ALL_TAGS`` for every tag."""
    command: int
    argument: bytes
    """7 bytes: value (5) and pairing nonce (2)."""


Order = SetMode | SetChannel | TagCommand

_HELLO = struct.Struct("<BBBHI")
_PACKET = struct.Struct("<BI6sBB27s")
_STATUS = struct.Struct("<BIIII15s")
_MODE = struct.Struct("<BB")
_CHANNEL = struct.Struct("<BB")
_COMMAND = struct.Struct("<BI2sB7s")

_SIZES = {
    Kind.HELLO.value: _HELLO.size + cobs.CHECK_SIZE,
    Kind.PACKET.value: _PACKET.size + cobs.CHECK_SIZE,
    Kind.STATUS.value: _STATUS.size + cobs.CHECK_SIZE,
}

HELLO_REQUEST = b"\0"
"""What makes a receiver say hello."""


def encode_packet(clock_us: int, address: bytes, rssi: float, channel: int, payload: bytes) -> bytes:
    """Return the frame of one packet heard: ``address`` 6 bytes as on air, ``rssi`` in dBm, 27 bytes of payload."""
    loss = min(max(round(-rssi), 0), 255)
    return cobs.frame(_PACKET.pack(Kind.PACKET, clock_us & 0xFFFFFFFF, address, loss, channel, payload))


def encode_hello(hello: Hello) -> bytes:
    """Return the frame by which a receiver introduces itself."""
    return cobs.frame(_HELLO.pack(Kind.HELLO, *hello))


def encode_status(status: Status) -> bytes:
    """Return the frame of a receiver's counts."""
    counts = (status.clock_us & 0xFFFFFFFF, status.received, status.crc_errors, status.dropped)
    return cobs.frame(_STATUS.pack(Kind.STATUS, *counts, bytes(status.slots)))


def encode_mode(mode: Mode) -> bytes:
    """Return the order that chooses what the receiver sends."""
    return cobs.frame(_MODE.pack(Kind.MODE, mode))


def encode_channel(channel: int) -> bytes:
    """Return the order to listen on an advertising channel, 37…39."""
    return cobs.frame(_CHANNEL.pack(Kind.CHANNEL, channel))


def encode_command(serial: int, command: int, argument: bytes = b"") -> bytes:
    """Return the order to tell a tag something; the argument is filled with zeros to 7 bytes."""
    return cobs.frame(_COMMAND.pack(Kind.COMMAND, serial, b"\xff\xff", command, argument.ljust(7, b"\0")))


class _Splitter:
    """Cuts a byte stream at its zeros; what it holds back stays small however long no zero comes."""

    def __init__(self) -> None:
        self._rest = b""

    def feed(self, data: bytes) -> list[bytes]:
        """Return the stuffed frames these bytes complete; one that is too long is cut, not kept whole."""
        pieces = (self._rest + data).split(b"\0")
        self._rest = pieces.pop()[: LONGEST_FRAME + 1]
        return pieces


class ReceiverFrames:
    """What a receiver sends, as readings; its hello, status and beacons heard beside them."""

    def __init__(self) -> None:
        self.traits = tag_advert.TRAITS
        self.malformed: Counter[str] = Counter()
        """Pieces refused, by reason."""
        self.refused: Counter[SensorId] = Counter()
        """Intact frames of a known tag whose payload made no sense, by tag."""
        self.foreign_version: int | None = None
        """Of the receiver, when it is not ours."""
        self.hello: Hello | None = None
        """The last one."""
        self.status: Status | None = None
        """The last one."""
        self.beacon: tag_advert.Sync | None = None
        """The last beacon of another receiver that was heard."""
        self._splitter = _Splitter()
        self._tags: dict[bytes, SensorId] = {}

    def feed(self, data: bytes) -> list[Reading]:
        """Take the next bytes and return the readings they complete."""
        readings: list[Reading] = []
        for piece in self._splitter.feed(data):
            if not piece:
                continue
            if len(piece) > LONGEST_FRAME:
                self.malformed["long"] += 1
                continue
            checked = cobs.unstuff(piece)
            if checked is None or len(checked) <= cobs.CHECK_SIZE:
                self.malformed["cobs"] += 1
            elif not cobs.is_intact(checked):
                self.malformed["crc"] += 1
            elif checked[0] == Kind.PACKET.value and len(checked) == _SIZES[Kind.PACKET.value]:
                self._take_packet(checked, readings)
            else:
                self._take_word(checked)
        return readings

    def question(self, info: SensorInfo) -> bytes:
        """Return the order that asks a tag for its offset and gain, empty when it has told."""
        if info.correction is not None:
            return b""
        serial = int(info.sensor.removeprefix("tag:"), 16)
        return encode_command(serial, tag_advert.Command.REPORT_COEFFICIENTS)

    def _take_packet(self, checked: bytes, readings: list[Reading]) -> None:
        _, _, address, loss, _, payload = _PACKET.unpack_from(checked)
        sensor = self._tags.get(address)
        known = sensor is not None
        if sensor is None:
            sensor = tag_advert.sensor_of(int.from_bytes(address[:SERIAL_SIZE], "little"))
        told = tag_advert.decode(payload, sensor, -float(loss))
        if isinstance(told, Reading):
            if told.facts is not None:
                told = told._replace(facts={**told.facts, "address": address[::-1].hex(":")})
            if not known:
                self._remember(address, sensor)
            readings.append(told)
        elif isinstance(told, tag_advert.Sync):
            self.beacon = told
        else:
            self.malformed[told] += 1
            if known:
                self.refused[sensor] += 1

    def _remember(self, address: bytes, sensor: SensorId) -> None:
        if len(self._tags) >= KNOWN_TAGS:
            self._tags.clear()
            self.refused.clear()
        self._tags[address] = sensor

    def _take_word(self, checked: bytes) -> None:
        size = _SIZES.get(checked[0])
        if size is None:
            self.malformed["kind"] += 1
        elif len(checked) != size:
            self.malformed["short" if len(checked) < size else "long"] += 1
        elif checked[0] == Kind.HELLO:
            self.hello = Hello(*_HELLO.unpack_from(checked)[1:])
            if self.hello.version != tag_advert.VERSION:
                self.malformed["version"] += 1
                self.foreign_version = self.hello.version
        else:
            _, clock_us, received, crc_errors, dropped, slots = _STATUS.unpack_from(checked)
            self.status = Status(clock_us, received, crc_errors, dropped, tuple(slots))


class OrderFrames:
    """What the computer sends, as a receiver reads it."""

    def __init__(self) -> None:
        self.malformed: Counter[str] = Counter()
        self.hellos_asked = 0
        """Lone zeros: the computer wants to know who is there."""
        self._splitter = _Splitter()

    def feed(self, data: bytes) -> list[Order]:
        """Take the next bytes and return the orders they complete."""
        orders: list[Order] = []
        for piece in self._splitter.feed(data):
            if not piece:
                self.hellos_asked += 1
                continue
            checked = cobs.unstuff(piece) if len(piece) <= LONGEST_FRAME else None
            if checked is None or not cobs.is_intact(checked):
                self.malformed["crc"] += 1
                continue
            order = _order_of(checked[: -cobs.CHECK_SIZE])
            if order is None:
                self.malformed["kind"] += 1
            else:
                orders.append(order)
        return orders


def _order_of(body: bytes) -> Order | None:
    kind = body[:1]
    if kind == bytes([Kind.MODE]) and len(body) == _MODE.size:
        return SetMode(body[1])
    if kind == bytes([Kind.CHANNEL]) and len(body) == _CHANNEL.size:
        return SetChannel(body[1])
    if kind == bytes([Kind.COMMAND]) and len(body) == _COMMAND.size:
        _, serial, _, command, argument = _COMMAND.unpack(body)
        return TagCommand(serial, command, argument)
    return None
