"""The three tables: joint angles, sensor orientations, and the samples as they were kept."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.analysis.joint_angles import joint_angles
from studio.analysis.ledger import missing_before
from studio.core import euler, rotation
from studio.core.errors import NothingToExport
from studio.core.pose import Motion
from studio.core.sample import SensorId, Stream
from studio.core.take import Assignment, Take
from studio.export.material import Orientations
from studio.export.number_format import Numbers, Punctuation, Words

Array = NDArray[np.float64]

BRIDGE = 0.1  # s; F25: between samples further apart nothing is interpolated


@dataclass(frozen=True)
class Table:
    """Named columns of one length."""

    names: tuple[str, ...]
    columns: tuple[Numbers | Words, ...]
    """Words as they are, in UTF-8: quoting is the writer's business."""
    rows: int


@dataclass(frozen=True)
class Preset:
    """What a spreadsheet or a statistics program expects between the cells."""

    label: str
    punctuation: Punctuation
    mark: bytes
    """Byte order mark."""


PRESETS = {
    "plain": Preset("RFC 4180", Punctuation(), b""),
    "excel": Preset("Excel (semicolon, decimal comma)", Punctuation(b",", b";"), b"\xef\xbb\xbf"),
}


def joints_table(motion: Motion) -> Table:
    """Return ``time_s`` and one column in degrees for each angle of ``analysis.joint_angles``."""
    angles = joint_angles(motion)
    if not any(np.isfinite(angle.values).any() for angle in angles):
        raise NothingToExport("joint angles", _why_no_angles(motion))
    names = ("time_s", *(f"{angle.name}_deg" for angle in angles))
    degrees = np.degrees(np.stack([angle.values for angle in angles], axis=1))
    return Table(names, (Numbers(motion.time[:, None], 6), Numbers(degrees, 6)), len(motion))


def orientations_table(orientations: Orientations, assignment: Assignment) -> Table:
    """Return ``world_from_sensor`` of all sensors at the sample times of the fastest.

    Sensors that sampled at other times stand interpolated along the shortest way, where their own
    samples are at most 0.1 s apart, and empty elsewhere.
    """
    sampled = {sensor: (time, turned) for sensor, (time, turned) in orientations.items() if len(time) > 1}
    if not sampled:
        raise NothingToExport("orientations", "no sensor has an orientation at two times or more")
    # The shortest step between samples, not their number: a sensor that was lost half the time is still the fastest.
    fastest = min(sampled, key=lambda sensor: float(np.median(np.diff(sampled[sensor][0]))))
    grid = sampled[fastest][0]
    names, columns = ["time_s"], [Numbers(grid[:, None], 6)]
    words = column_words(orientations, assignment)
    for sensor, samples in sampled.items():
        word, turned = words[sensor], _at(grid, *samples)
        names += [f"{word}_{part}" for part in ("w", "x", "y", "z", "roll_deg", "pitch_deg", "yaw_deg")]
        columns += [Numbers(turned, 9), Numbers(np.degrees(euler.roll_pitch_yaw(turned)), 6)]
    return Table(tuple(names), tuple(columns), len(grid))


def raw_table(take: Take) -> Table:
    """Return every kept sample as it was decoded, a row each, in the order of arrival; nothing is interpolated."""
    streams = [stream for stream in take.streams if len(stream)]
    if not streams:
        raise NothingToExport("samples", "no sensor sent any")
    order = np.argsort(np.concatenate([stream.arrival for stream in streams]), kind="stable")

    def numbers(parts: Sequence[NDArray[np.generic]], decimals: int) -> Numbers:
        return Numbers(np.concatenate(parts).astype(np.float64).reshape(len(order), -1)[order], decimals)

    worn = [take.setup.assignment.place_of(stream.info.sensor) for stream in streams]
    codes = np.repeat(np.arange(len(streams)), [len(stream) for stream in streams])[order]
    described: list[tuple[tuple[str, ...], Numbers | Words]] = [
        (("time_s",), numbers([s.time for s in streams], 6)),
        (("sensor",), Words(codes, tuple(s.info.sensor.encode() for s in streams))),
        (("place",), Words(codes, tuple(place.value.encode() if place else b"" for place in worn))),
        (("sample",), numbers([np.arange(len(s)) for s in streams], 0)),
        (("epoch", "frame", "lost_before"), numbers([_counts(s) for s in streams], 0)),
        (("device_time_s", "received_s"), numbers([_clocks(s) for s in streams], 6)),
        (_named("orientation", "wxyz", ""), numbers([s.orientation for s in streams], 9)),
        (_named("rate", "xyz", "_rad_s"), numbers([s.rate for s in streams], 9)),
        (_named("acceleration", "xyz", "_m_s2"), numbers([s.acceleration for s in streams], 6)),
        (("flags",), numbers([s.flags for s in streams], 0)),
        (("battery", "temperature_c", "rssi_dbm"), numbers([_health(s) for s in streams], 6)),
    ]
    names = tuple(name for group, _ in described for name in group)
    return Table(names, tuple(column for _, column in described), len(order))


def column_words(sensors: Iterable[SensorId], assignment: Assignment) -> dict[SensorId, str]:
    """Return a snake_case ASCII word for each sensor: its place, or its name with unsafe characters replaced."""
    words: dict[SensorId, str] = {}
    for sensor in sensors:
        place = assignment.place_of(sensor)
        word = place.value if place else re.sub(r"[^a-z0-9]+", "_", sensor.lower()).strip("_") or "sensor"
        candidate, number = word, 2
        while candidate in words.values():
            candidate, number = f"{word}_{number}", number + 1
        words[sensor] = candidate
    return words


def _why_no_angles(motion: Motion) -> str:
    known = [place.value.replace("_", " ") for place, measured in motion.measured.items() if measured.any()]
    here = ", ".join(known) if known else "none"
    return f"an angle needs the sensors on both sides of a joint with known headings, and known here: {here}"


def _at(grid: Array, time: Array, turned: Array) -> Array:
    """Return rotations (n, 4) at the times of ``grid``; NaN outside and across gaps."""
    after = np.clip(np.searchsorted(time, grid, side="left"), 1, len(time) - 1)
    before = after - 1
    step = time[after] - time[before]
    fraction = np.divide(grid - time[before], step, out=np.zeros(len(grid)), where=step > 0)
    between = rotation.slerp(turned[before], turned[after], np.clip(fraction, 0, 1))
    sampled = (grid == time[before]) | (grid == time[after])
    inside = (grid >= time[before]) & (grid <= time[after]) & ((step <= BRIDGE) | sampled)
    exact = np.where((grid == time[after])[:, None], turned[after], between)
    return np.where(inside[:, None], exact, np.nan)


def _counts(stream: Stream) -> NDArray[np.int64]:
    return np.stack([stream.epoch.astype(np.int64), stream.frame, missing_before(stream)], axis=1)


def _clocks(stream: Stream) -> Array:
    return np.stack([stream.device_time, stream.received], axis=1)


def _health(stream: Stream) -> Array:
    return np.stack([stream.battery, stream.temperature, stream.rssi], axis=1)


def _named(quantity: str, parts: str, unit: str) -> tuple[str, ...]:
    return tuple(f"{quantity}_{part}{unit}" for part in parts)
