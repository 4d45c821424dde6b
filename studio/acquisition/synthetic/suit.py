"""The whole simulated suit and its receiver: block by block, the bytes that would come out of the serial port."""

import math
from itertools import groupby
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.dialects import receiver_frames, tag_advert
from studio.acquisition.dialects.receiver_frames import Hello, SlotState, Status, TagCommand
from studio.acquisition.synthetic.body_truth import Performer, Scene
from studio.acquisition.synthetic.clocks import Clocks, Instants
from studio.acquisition.synthetic.errors_table import CALIBRATED, DATA_SHEET, ErrorTable
from studio.acquisition.synthetic.firmware import Firmware, Integrated, TagState
from studio.acquisition.synthetic.packets import FIRMWARE_VERSION, HARDWARE, Moment, payload
from studio.acquisition.synthetic.radio import Air
from studio.acquisition.synthetic.scripts import WORN_SCRIPTS
from studio.acquisition.synthetic.tag_model import BLOCK_TICKS, TICK, Chips, Readings
from studio.acquisition.synthetic.unworn import Table, TurnedBox
from studio.acquisition.synthetic.words import SuitOptions
from studio.core import rotation
from studio.core.body import PLACES, Place
from studio.core.sample import NO_CORRECTION, Flag
from studio.core.take import Assignment

Array = NDArray[np.float64]

BLOCK_TIME = BLOCK_TICKS * TICK  # s
LATENCY = (1e-3, 4e-3)  # s, from sampling to this computer; the time slots on the air are not simulated
AIR_TIME = 376e-6  # s of one packet on the air (firmware.md, section 3)
CHANNEL = 37
ADDRESS_KIND = 0xC0  # the two top bits of a random static address
SWITCHED_OFF = BLOCK_TIME  # s between power-off and power-on of a tag that reboots
FINDING = 0.3  # s from power-on to the first packet: start-up and the next beacons
FULL_ENOUGH, LOW_BATTERY = (0.5, 0.95), 0.08
STATUS_PERIOD = 1.0  # s
OLDEST_POWER_ON = 100_000  # frames; tags were switched on at different times before the receiver


class Heard(NamedTuple):
    """Bytes that leave the receiver at one moment."""

    at: float
    """s since the suit was switched on; when this computer has read them."""
    data: bytes


class Suit:
    """A performer with tags, and the receiver that hears them."""

    def __init__(self, options: SuitOptions, errors: ErrorTable | None = None) -> None:
        """Draw everything from the seed; ``errors`` replaces the table that the options select, for tests."""
        self.options = options
        body, chips, tags, clocks, air, receiver = np.random.default_rng(options.seed).spawn(6)
        self.scene = make_scene(options, body)
        table = errors or (CALIBRATED if options.calibrated else DATA_SHEET)
        count = len(options.places)
        self.chips = Chips(self.scene, [PLACES.index(place) for place in worn_places(options)], table, chips)
        self.addresses = [_address(tags) for _ in range(count)]
        self.firmware = Firmware(self._states(tags, stores=options.calibrated and errors is None))
        self.clocks = Clocks(count, options.frame_s, options.skew, clocks)
        self._air = Air(count, options.loss, options.burst, air)
        self._receiver = receiver
        self._counter_start = int(receiver.integers(0, 1 << 31))
        self._serial = int(receiver.integers(0, 1 << 32))
        self._received = 0
        self._heard_at = np.full(count, -math.inf)
        self._clipped_before = np.zeros(count, np.bool_)
        self._block = 0
        usual = Place.PELVIS if Place.PELVIS in options.places else options.places[0]
        self._reboots = options.places.index(options.reboot_place or usual)

    @property
    def elapsed(self) -> float:
        """Time up to which packets were made, s since the suit was switched on."""
        return self._block * BLOCK_TIME

    def assignment(self) -> Assignment:
        """Return where the sensors are said to sit: a swap is not told."""
        sensors = [tag_advert.sensor_of(tag.serial) for tag in self.firmware.tags]
        return Assignment(dict(zip(self.options.places, sensors, strict=True)))

    def obey(self, command: TagCommand) -> None:
        """Pass a command on to the tags; it takes effect with the next block."""
        self.firmware.obey(command)

    def hello(self) -> bytes:
        """Return how the receiver introduces itself."""
        return receiver_frames.encode_hello(Hello(tag_advert.VERSION, HARDWARE, FIRMWARE_VERSION, self._serial))

    def next_block(self) -> list[Heard]:
        """Return what arrives in the next half second, in order."""
        begin = self.elapsed
        restarted = self._restart(begin)
        readings = self.chips.next_block(self._block)
        integrated = self.firmware.integrate(readings, restarted)
        self._block += 1
        instants = self._on_air(self.clocks.instants(begin, begin + BLOCK_TIME))
        packets = self._packets(instants, begin, readings, integrated)
        heard = []
        for time, together in groupby(zip(instants.time.tolist(), packets, strict=True), key=lambda pair: pair[0]):
            late = float(self._receiver.uniform(*LATENCY))
            heard.append(Heard(time + late, b"".join(packet for _, packet in together)))
        self._received += len(packets)
        self._heard_at[instants.tag] = begin
        if begin % STATUS_PERIOD == 0.0:
            heard.append(Heard(begin + BLOCK_TIME, self._status(begin + BLOCK_TIME)))
        return sorted(heard, key=lambda one: one.at)

    def _states(self, generator: np.random.Generator, *, stores: bool) -> list[TagState]:
        options = self.options
        count = len(options.places)
        corrections = self.chips.calibrate(generator) if stores else [NO_CORRECTION] * count
        batteries = np.full(count, LOW_BATTERY) if options.low_battery else generator.uniform(*FULL_ENOUGH, count)
        power_on = -generator.integers(0, OLDEST_POWER_ON, count)
        return [
            TagState(place.number, int.from_bytes(address[:4], "little"), stored, stored, stores, battery, start)
            for place, address, stored, battery, start in zip(
                options.places, self.addresses, corrections, batteries.tolist(), power_on.tolist(), strict=True
            )
        ]

    def _restart(self, begin: float) -> dict[int, int]:
        """Switch the tag on that reboots when its time has come; return its tick in this block."""
        powered = self.options.reboot + SWITCHED_OFF
        if not begin <= powered < begin + BLOCK_TIME:
            return {}
        tag = self._reboots
        self.firmware.restart(tag, self.clocks.first_frame(tag, powered))
        self.clocks.restart(tag, powered)
        return {tag: math.ceil((powered - begin) / TICK)}

    def _on_air(self, instants: Instants) -> Instants:
        """Return the samples whose packets the receiver hears."""
        base = int(instants.frame.min())
        passes = self._air.passes(int(instants.frame.max()) - base + 1)
        heard = passes[instants.frame - base, instants.tag]
        off = self.options.reboot
        if math.isfinite(off):
            silent = (instants.time >= off) & (instants.time < off + SWITCHED_OFF + FINDING)
            heard &= ~(silent & (instants.tag == self._reboots))
        return Instants(instants.tag[heard], instants.frame[heard], instants.time[heard])

    def _packets(self, instants: Instants, begin: float, readings: Readings, block: Integrated) -> list[bytes]:
        """Return the receiver's frames of these samples."""
        place = (instants.time - begin) / TICK
        orientation, rate, acceleration, summed = _between_ticks(place, instants.tag, readings, block)
        flags = self._flags(instants, place, readings, block)
        strengths = self._air.strengths(instants.tag)
        sent = zip(instants.tag.tolist(), instants.frame.tolist(), instants.time.tolist(), strengths, strict=True)
        measured = zip(
            self.clocks.shown(instants).tolist(),
            flags.tolist(),
            orientation.tolist(),
            rate.tolist(),
            acceleration.tolist(),
            summed.tolist(),
            (block.summed[instants.tag] + np.floor(place).astype(np.int64)).tolist(),
            strict=True,
        )
        packets = []
        for (tag, frame, time, strength), values in zip(sent, measured, strict=True):
            state = self.firmware.tags[tag]
            sequence = frame - state.power_on_frame
            counter = self._counter_start + frame if self.clocks.synchronised else sequence
            told = payload(state, Moment(sequence, counter, readings.temperature, *values))
            heard_at = self.clocks.receiver(time + AIR_TIME)
            packets.append(receiver_frames.encode_packet(heard_at, self.addresses[tag], strength, CHANNEL, told))
        return packets

    def _flags(self, instants: Instants, place: Array, readings: Readings, block: Integrated) -> NDArray[np.int64]:
        states = self.firmware.tags
        own = np.array(
            [
                Flag.CALIBRATED * tag.is_calibrated
                | Flag.OFFSET_OK * tag.offset_known
                | Flag.LOW_BATTERY * self.options.low_battery
                | Flag.TIME_SYNCED * self.clocks.synchronised
                for tag in states
            ]
        )
        own |= np.where(block.at_rest, int(Flag.AT_REST), 0)
        frame_ticks = round(self.options.frame_s / TICK)
        counted = np.concatenate([np.zeros((1, len(states)), np.int64), np.cumsum(readings.clipped[1:], axis=0)])
        here = np.floor(place).astype(np.int64)
        back = here - frame_ticks
        clipped = counted[here, instants.tag] > counted[np.maximum(back, 0), instants.tag]
        clipped |= (back < 0) & self._clipped_before[instants.tag]
        self._clipped_before = counted[-1] > counted[-1 - frame_ticks]
        return np.asarray(own[instants.tag] | np.where(clipped, int(Flag.CLIPPED), 0))

    def _status(self, time: float) -> bytes:
        slots = [SlotState.SILENT] * receiver_frames.SLOTS
        for tag, heard_at in zip(self.firmware.tags, self._heard_at, strict=True):
            if tag.number and time - heard_at <= STATUS_PERIOD:
                slots[tag.number - 1] = SlotState.HEARD
        return receiver_frames.encode_status(Status(self.clocks.receiver(time), self._received, 0, 0, tuple(slots)))


def make_scene(options: SuitOptions, generator: np.random.Generator) -> Scene:
    """Return what moves the tags."""
    if options.script == "rest":
        return Table()
    if options.script == "turns":
        return TurnedBox(generator)
    return Performer(WORN_SCRIPTS[options.script], options.stature, generator)


def worn_places(options: SuitOptions) -> list[Place]:
    """Return where each tag really sits, in the order of ``options.places``."""
    places = list(options.places)
    if options.swap is not None:
        first, second = (places.index(place) for place in options.swap)
        places[first], places[second] = places[second], places[first]
    return places


def _address(generator: np.random.Generator) -> bytes:
    address = generator.integers(0, 256, 6, np.uint8)
    address[-1] |= ADDRESS_KIND
    return address.tobytes()


def _between_ticks(
    place: Array, tag: NDArray[np.int64], readings: Readings, block: Integrated
) -> tuple[Array, Array, Array, Array]:
    """Return orientation, rate, acceleration and running integral of samples at ``place`` (m,), in ticks.

    Tags with clocks of their own sample between the ticks; those that follow the receiver on them.
    """
    here = np.minimum(np.floor(place).astype(np.int64), BLOCK_TICKS - 1)
    share = (place - here)[:, None]
    orientation = rotation.multiply(
        block.orientation[here, tag], rotation.from_rotation_vector(share * block.step[here, tag])
    )
    acceleration = _mix(readings.acceleration, here, tag, share)
    angle = _mix(block.angle, here, tag, share)
    # A rate is the mean over the interval that ends at its tick: it belongs to half a tick before.
    middle = np.floor(place + 0.5).astype(np.int64)
    rate = _mix(readings.rate, np.minimum(middle, BLOCK_TICKS - 1), tag, (place + 0.5 - middle)[:, None])
    return orientation, rate, acceleration, angle


def _mix(values: Array, row: NDArray[np.int64], tag: NDArray[np.int64], share: Array) -> Array:
    return np.asarray((1.0 - share) * values[row, tag] + share * values[row + 1, tag])
