"""What the firmware of the tags does with the readings: integrate, count, obey; the digital half of the suit."""

import struct
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.dialects.receiver_frames import TagCommand
from studio.acquisition.dialects.tag_advert import ALL_TAGS, GAIN_LIMIT, OFFSET_LIMIT, Command, calibration_crc
from studio.acquisition.synthetic.tag_model import TICK, Readings, vector
from studio.core import rotation
from studio.core.sample import NO_CORRECTION, Correction

Array = NDArray[np.float64]

STILL_RATE = np.deg2rad(0.15)  # rad/s, SD over a block: three times the noise, less than a standing body sways
STILL_FORCE = 0.12  # m/s², SD over one block: three times the chip's noise


@dataclass(slots=True)
class TagState:
    """What one tag keeps."""

    number: int
    serial: int
    correction: Correction
    """In force; lost with the power unless saved."""
    saved: Correction
    offset_known: bool
    battery: float
    """0…1."""
    power_on_frame: int
    """Frame in which its counter was 0."""
    integrating: bool = False
    """Sends type 3."""
    awaits_rest: bool = False
    """To measure its offset."""
    rows_to_tell: list[int] = field(default_factory=list)
    """Rows of the correction still to be sent as type 6."""

    @property
    def is_calibrated(self) -> bool:
        """Tell whether it has a gain of its own."""
        return self.correction.gain != NO_CORRECTION.gain

    @property
    def crc(self) -> int:
        """Name of the coefficients in force."""
        return calibration_crc(self.correction)


@dataclass(frozen=True, slots=True)
class Integrated:
    """One block as the firmware saw it."""

    orientation: Array
    """(ticks + 1, t, 4), start_from_sensor at each tick."""
    step: Array
    """(ticks, t, 3), rad: the turn from each tick to the next."""
    angle: Array
    """(ticks + 1, t, 3), rad: running integrals of the readings since command 3."""
    at_rest: NDArray[np.bool_]
    """(t,)."""
    summed: NDArray[np.int64]
    """(t,), ticks summed since command 3 at the first tick."""


class Firmware:
    """The firmware of all tags, integrated together."""

    def __init__(self, tags: list[TagState]) -> None:
        self.tags = tags
        self._orientation = np.tile(rotation.IDENTITY, (len(tags), 1))
        self._angle = np.zeros((len(tags), 3))
        self._summed = np.zeros(len(tags), np.int64)

    def integrate(self, readings: Readings, restarted: dict[int, int]) -> Integrated:
        """Return the tags' own orientations over a block.

        Parameters
        ----------
        restarted : tag to tick of this block
            Tags that are switched on in this block begin there with the identity.
        """
        offset = np.array([tag.correction.offset for tag in self.tags])
        gain = np.array([tag.correction.gain for tag in self.tags])
        rate = readings.rate[1:]
        step = np.einsum("tij,ntj->nti", gain, rate - offset) * TICK
        turns = np.concatenate([self._orientation[None], rotation.from_rotation_vector(step)])
        orientation = rotation.normalise(running_product(turns))
        for tag, tick in restarted.items():
            start = rotation.inverse(orientation[tick, tag])
            orientation[tick:, tag] = rotation.multiply(start, orientation[tick:, tag])
        angle = np.concatenate([self._angle[None], self._angle + np.cumsum(rate, axis=0) * TICK])
        still = (rate.std(axis=0) < STILL_RATE).all(axis=-1)
        still &= (readings.acceleration.std(axis=0) < STILL_FORCE).all(axis=-1)
        before = self._summed.copy()
        self._orientation, self._angle = orientation[-1], angle[-1]
        self._summed += len(rate)
        self._measure_offsets(rate, still)
        return Integrated(orientation, step, angle, still, before)

    def obey(self, command: TagCommand) -> None:
        """Do what the receiver passes on, before the next block."""
        for row, tag in enumerate(self.tags):
            if command.serial in (ALL_TAGS, tag.serial):
                self._obey(row, tag, command)

    def restart(self, row: int, frame: int) -> None:
        """Switch a tag off and on: its counter is 0 in ``frame``, and what was not saved is gone."""
        tag = self.tags[row]
        tag.correction = tag.saved
        tag.power_on_frame = frame
        tag.integrating = tag.awaits_rest = False
        tag.rows_to_tell.clear()

    def _obey(self, row: int, tag: TagState, command: TagCommand) -> None:
        match command.command:
            case Command.ASSIGN_NUMBER if command.argument[0] <= 15:
                tag.number = command.argument[0]
            case Command.MEASURE_OFFSET:
                tag.awaits_rest = True
            case Command.START_INTEGRALS:
                tag.integrating = True
                self._angle[row] = 0.0
                self._summed[row] = 0
            case Command.STREAM:
                tag.integrating = False
            case Command.COEFFICIENT:
                _set_coefficient(tag, command.argument)
            case Command.SAVE:
                tag.saved = tag.correction
            case Command.REPORT_COEFFICIENTS:
                tag.rows_to_tell = [0, 1, 2, 3]
            case _:
                pass  # nobody sees a light blink; no two of these tags share a number, so none leaves its slot

    def _measure_offsets(self, rate: Array, still: NDArray[np.bool_]) -> None:
        for row, tag in enumerate(self.tags):
            if tag.awaits_rest and still[row]:
                offset = rate[:, row].mean(axis=0).astype(np.float32).astype(np.float64)
                tag.correction = Correction(vector(offset), tag.correction.gain)
                tag.awaits_rest, tag.offset_known = False, True
                self._orientation[row] = rotation.IDENTITY


def _set_coefficient(tag: TagState, argument: bytes) -> None:
    index, value = struct.unpack_from("<Bf", argument)
    rows = [list(tag.correction.offset), *(list(row) for row in tag.correction.gain)]
    limit = OFFSET_LIMIT if index < 3 else GAIN_LIMIT
    if index < 12 and abs(value) <= limit:  # NaN fails too
        rows[index // 3][index % 3] = value
        offset, *gain = (vector(np.array(row)) for row in rows)
        tag.correction = Correction(offset, (gain[0], gain[1], gain[2]))


def running_product(turns: Array) -> Array:
    """Return turns[0] * … * turns[k] for each k, (n, …, 4): a prefix scan by doubling."""
    product = turns.copy()
    reach = 1
    while reach < len(product):
        product[reach:] = rotation.multiply(product[:-reach], product[reach:])
        reach *= 2
    return product
