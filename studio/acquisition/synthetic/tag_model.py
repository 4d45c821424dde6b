"""From the true motion of the carriers to what the chips of the tags read: the analogue half of the suit."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.body_truth import Scene
from studio.acquisition.synthetic.errors_table import (
    ACCEL_RANGE,
    GYRO_RANGE,
    INSTABILITY_TIME,
    RESIDUAL_AXES,
    RESIDUAL_GAIN,
    RESIDUAL_OFFSET,
    ROOM_TEMPERATURE,
    WARM_UP_TIME,
    ErrorTable,
)
from studio.core import rotation
from studio.core.body import PLACES, Place
from studio.core.frames import GRAVITY, UP
from studio.core.sample import Correction, Vector

Array = NDArray[np.float64]

TICK = 0.005  # s; the tag's own step, 200 Hz
BLOCK_TICKS = 100  # ticks generated at once


class Readings(NamedTuple):
    """What t tags read between tick 0 and tick ``BLOCK_TICKS`` of a block."""

    rate: Array
    """(ticks + 1, t, 3), rad/s: mean over the interval that ends at each tick; row 0 belongs to the block before."""
    acceleration: Array
    """(ticks + 1, t, 3), m/s², at each tick."""
    clipped: NDArray[np.bool_]
    """(ticks + 1, t): a chip was at the end of its range, in the interval that ends at each tick."""
    temperature: float
    """°C."""


class Chips:
    """The chips of t tags: how they sit on their carriers, and their errors."""

    def __init__(self, scene: Scene, rows: list[int], table: ErrorTable, generator: np.random.Generator) -> None:
        tags = len(rows)
        self.scene = scene
        self.rows = rows
        """Row of ``PLACES`` where each tag really sits."""
        self.segment_from_sensor = random_rotations(generator, tags)
        self.position = random_positions(generator, rows)
        """(t, 3), m, in segment axes from the segment's origin."""
        self._table = table
        self._noise = generator.spawn(1)[0]
        axes = generator.normal(size=(tags, 3))
        self._tissue = table.soft_tissue * axes / np.linalg.norm(axes, axis=1, keepdims=True)

        def draw(limit: float | tuple[float, float, float], *shape: int) -> Array:
            return np.asarray(generator.uniform(-1.0, 1.0, (tags, *shape)) * limit)

        off_diagonal = 1.0 - np.eye(3)
        self.matrix = np.eye(3) * (1.0 + draw(table.gyro_scale, 3))[:, None, :]
        self.matrix = self.matrix + off_diagonal * draw(table.gyro_cross_axis, 3, 3)
        self.offset = draw(table.gyro_offset, 3)
        self._offset_per_kelvin = draw(table.gyro_offset_per_kelvin, 3)
        self._per_g = draw(table.gyro_per_g, 3, 3)
        self._accel_gain = 1.0 + draw(table.accel_scale, 3)
        self._accel_offset = draw(table.accel_offset, 3)
        self._drift = self._noise.normal(size=(tags, 3)) * table.gyro_instability
        self._last_rate: Array | None = None

    def next_block(self, block: int) -> Readings:
        """Return the readings of block 0, 1, 2, … in this order."""
        start = block * BLOCK_TICKS
        orientation, position = self.sensors(_times(start - 2.0, BLOCK_TICKS + 4))
        turns = rotation.to_rotation_vector(rotation.multiply(rotation.inverse(orientation[:-1]), orientation[1:]))
        second = (position[2:] - 2.0 * position[1:-1] + position[:-2]) / TICK**2
        # Row k is tick k - 1 of the block.
        force = rotation.rotate(rotation.inverse(orientation[1:-1]), second + GRAVITY * UP)
        # The intervals that end at ticks 1 to 100; the first block also needs the one before its first tick.
        first = 0 if self._last_rate is None else 1
        middles = _times(start + first - 0.5, BLOCK_TICKS + 1 - first)
        rate = self._read_rate(turns[1 + first : -1] / TICK, 0.5 * (force[first:-1] + force[first + 1 :]), middles)
        if self._last_rate is not None:
            rate = np.concatenate([self._last_rate, rate])
        self._last_rate = rate[-1:]
        acceleration = self._read_acceleration(force[1:])
        clipped = _at_end(rate, GYRO_RANGE) | _at_end(acceleration, ACCEL_RANGE)
        return Readings(rate, acceleration, clipped, float(self._celsius(middles[-1:])[0]))

    def sensors(self, times: Array) -> tuple[Array, Array]:
        """Return world_from_sensor (n, t, 4) and the tags' positions (n, t, 3), m, at ``times`` (n,), s."""
        carried = self.scene.carried(times)
        segment = carried.orientation[:, self.rows]
        slid = rotation.from_rotation_vector(carried.excursion[:, self.rows, None] * self._tissue)
        skin = rotation.multiply(segment, slid)
        position = carried.position[:, self.rows] + rotation.rotate(skin, self.position)
        return rotation.multiply(skin, self.segment_from_sensor), position

    def calibrate(self, generator: np.random.Generator) -> list[Correction]:
        """Return the offset and gain that a good calibration would have stored in each tag."""
        residual = np.eye(3) + generator.normal(size=self.matrix.shape) * np.where(
            np.eye(3, dtype=bool), RESIDUAL_GAIN, RESIDUAL_AXES
        )
        gains = (residual @ np.linalg.inv(self.matrix)).astype(np.float32).astype(np.float64)
        offsets = self.offset + generator.normal(size=self.offset.shape) * RESIDUAL_OFFSET
        offsets = offsets.astype(np.float32).astype(np.float64)
        return [
            Correction(vector(offset), (vector(gain[0]), vector(gain[1]), vector(gain[2])))
            for offset, gain in zip(offsets, gains, strict=True)
        ]

    def _read_rate(self, true: Array, force: Array, times: Array) -> Array:
        """Return readings (n, t, 3), rad/s, of the true rates, rad/s, under the true specific force, m/s²."""
        table = self._table
        warmer = (self._celsius(times) - ROOM_TEMPERATURE)[:, None, None]
        read = np.einsum("tij,ntj->nti", self.matrix, true) + self.offset + self._offset_per_kelvin * warmer
        read += np.einsum("tij,ntj->nti", self._per_g, force / GRAVITY)
        read += self._wander(len(times)) + self._noise.normal(size=read.shape) * table.gyro_noise * SAMPLE_DEVIATION
        if table.gyro_resolution:
            read = np.round(read / table.gyro_resolution) * table.gyro_resolution
        return np.asarray(np.clip(read, -GYRO_RANGE, GYRO_RANGE))

    def _wander(self, ticks: int) -> Array:
        """Return the bias instability over the next ticks, (ticks, t, 3), rad/s."""
        kept = math.exp(-ticks * TICK / INSTABILITY_TIME)
        fresh = self._noise.normal(size=self._drift.shape) * self._table.gyro_instability * math.sqrt(1.0 - kept**2)
        after = kept * self._drift + fresh
        share = (np.arange(ticks) + 1.0)[:, None, None] / ticks
        path = self._drift + share * (after - self._drift)
        self._drift = after
        return np.asarray(path)

    def _read_acceleration(self, force: Array) -> Array:
        noise = self._noise.normal(size=force.shape) * self._table.accel_noise * SAMPLE_DEVIATION
        return np.clip(self._accel_gain * force + self._accel_offset + noise, -ACCEL_RANGE, ACCEL_RANGE)

    def _celsius(self, times: Array) -> Array:
        return np.asarray(ROOM_TEMPERATURE + self._table.warm_up * np.clip(times / WARM_UP_TIME, 0.0, 1.0))


SAMPLE_DEVIATION = math.sqrt(0.5 / TICK)  # sqrt(Hz): white noise in one tick from its one-sided density


def _times(tick: float, count: int) -> Array:
    return np.asarray((tick + np.arange(count)) * TICK, np.float64)


def _at_end(readings: Array, limit: float) -> NDArray[np.bool_]:
    return np.asarray((np.abs(readings) >= limit).any(axis=-1))


def random_rotations(generator: np.random.Generator, count: int) -> Array:
    """Return rotations uniform over all rotations, (count, 4)."""
    return rotation.normalise(generator.normal(size=(count, 4)))


UPWARDS = (Place.HEAD, Place.CHEST, Place.PELVIS)
"""Segments that reach up from their origin; feet reach forwards, all others down."""
FORWARDS = (Place.LEFT_FOOT, Place.RIGHT_FOOT)


def random_positions(generator: np.random.Generator, rows: list[int]) -> Array:
    """Return where tags sit on the segments of these rows of ``PLACES``, (t, 3), m from the segment's origin."""
    along = generator.uniform(0.05, 0.18, len(rows))  # m; 5 to 18 cm along the bone
    beside = generator.uniform(0.03, 0.08, len(rows))  # m; 3 to 8 cm from its axis: skin, strap and tag
    around = generator.uniform(0.0, 2.0 * math.pi, len(rows))
    forwards, right = beside * np.cos(around), beside * np.sin(around)
    up = np.where([PLACES[row] in UPWARDS for row in rows], along, -along)
    on_foot = np.array([PLACES[row] in FORWARDS for row in rows])
    return np.stack([np.where(on_foot, along, forwards), np.where(on_foot, -0.03, up), right], axis=-1)


def vector(values: Array) -> Vector:
    """Return three numbers as a tuple."""
    x, y, z = values.tolist()
    return x, y, z
