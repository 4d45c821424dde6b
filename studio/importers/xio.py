"""Recordings of x-IMU3 sensors (x-io Technologies): a folder per sensor, a CSV file per message type.

Gyroscope in deg/s, accelerometer in g, stamps in whole microseconds on a clock the sensors keep together.
``Quaternion.csv`` is ``world_from_sensor`` (w x y z), z up, with one heading for all sensors: at rest it
turns the accelerometer's reading into (0, 0, +1) g on all seven sensors of the sample take.
"""

import json
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.errors import FormatUnknown, RecordingUnreadable
from studio.core.frames import GRAVITY
from studio.core.sample import SensorId, SensorInfo
from studio.core.take import Assignment, Setup, Take
from studio.importers.clock import count_frames, median_interval, put_in_order
from studio.importers.place_words import guess_assignment
from studio.importers.streams import Measured, line_up
from studio.importers.table import open_table

_INERTIAL, _QUATERNION = "Inertial.csv", "Quaternion.csv"
_STAMP = "Timestamp (us)"
_TICK = 1e-6  # s; unit of the stamps
_GYROSCOPE = ("Gyroscope X (deg/s)", "Gyroscope Y (deg/s)", "Gyroscope Z (deg/s)")
_ACCELEROMETER = ("Accelerometer X (g)", "Accelerometer Y (g)", "Accelerometer Z (g)")
_ORIENTATION = ("W", "X", "Y", "Z")
_CLOCK = re.compile(r"(\d{4}-\d\d-\d\d)[ T](\d\d:\d\d:\d\d)")


class _Series(NamedTuple):
    """One file of one sensor."""

    stamps: NDArray[np.float64]
    """(n,), s, strictly increasing."""
    values: NDArray[np.float64]
    dropped: int
    reordered: int


def looks_like_xio(paths: Sequence[Path]) -> bool:
    """Return whether the paths are one folder of sensor folders, or sensor folders themselves."""
    return bool(_sensor_folders(paths))


def read_xio(*paths: Path) -> Take:
    """Read one folder of sensor folders, or several sensor folders; places are guessed from their names.

    No pose is assumed: the take has no marks.

    Raises
    ------
    FormatUnknown
        When no path holds sensor folders.
    RecordingUnreadable
        When a file of a sensor does not hold what its name promises.
    """
    folders = _sensor_folders(paths)
    if not folders:
        raise FormatUnknown(tuple(str(path) for path in paths))
    notes = [_read_commands(folder) for folder in folders]
    sensors = _name_sensors(folders)
    measured = [_read_sensor(*named) for named in zip(folders, sensors, notes, strict=True)]
    assignment = guess_assignment(list(zip(sensors, [_plain_name(folder) for folder in folders], strict=True)))
    clocks = sorted(note["clock"] for note in notes if "clock" in note)
    return Take(
        name=(folders[0] if folders[0] in paths else folders[0].parent).resolve().name,
        person="",
        source="xio",
        # The device's calendar clock tells no time zone; it is read as UTC and said so.
        started=f"{clocks[0].replace(' ', 'T')}Z" if clocks else "",
        streams=line_up(measured),
        setup=Setup(assignment=Assignment(assignment)),
        versions={"started": "calendar clock of the sensors, read as UTC"} if clocks else {},
    )


def _sensor_folders(paths: Sequence[Path]) -> list[Path]:
    """Return the folders that hold one sensor's files, in the order of their names."""
    found: list[Path] = []
    for path in paths:
        if not path.is_dir():
            continue
        try:
            inside = [path] if _is_sensor(path) else [child for child in path.iterdir() if _is_sensor(child)]
        except OSError:
            # A folder that may not be listed is no recording.
            continue
        found += [folder for folder in inside if folder not in found]
    return sorted(found, key=lambda folder: (folder.name.lower(), str(folder)))


def _is_sensor(folder: Path) -> bool:
    return (folder / _INERTIAL).is_file() or (folder / _QUATERNION).is_file()


def _plain_name(folder: Path) -> str:
    """Return the folder's name without the interface, which is no property of the sensor."""
    return re.sub(r"\s*\([^)]*\)\s*$", "", folder.name)


def _name_sensors(folders: Sequence[Path]) -> list[SensorId]:
    sensors: list[SensorId] = []
    for folder in folders:
        slug = re.sub(r"[^a-z0-9]+", "-", _plain_name(folder).lower()).strip("-") or "sensor"
        same, count = SensorId(f"file:{slug}"), 1
        while same in sensors:
            count += 1
            same = SensorId(f"file:{slug}-{count}")
        sensors.append(same)
    return sensors


def _read_commands(folder: Path) -> Mapping[str, str]:
    """Return ``name``, ``serial``, ``interface`` and ``clock`` as far as the sensor's answers tell them."""
    try:
        answers = json.loads((folder / "Command.json").read_text(encoding="utf-8-sig"))
    except (OSError, ValueError, RecursionError):
        return {}
    told: dict[str, str] = {}
    for answer in answers if isinstance(answers, list) else []:
        if not isinstance(answer, dict):
            continue
        ping, clock = answer.get("ping"), _CLOCK.match(str(answer.get("time")))
        if isinstance(ping, dict):
            pairs = (("name", "name"), ("serial", "sn"), ("interface", "interface"))
            told |= {ours: str(ping[theirs]) for ours, theirs in pairs if theirs in ping}
        if clock:
            told["clock"] = f"{clock[1]} {clock[2]}"
    return told


def _read_sensor(folder: Path, sensor: SensorId, told: Mapping[str, str]) -> Measured:
    inertial = _read_series(folder / _INERTIAL, _GYROSCOPE + _ACCELEROMETER)
    oriented = _read_series(folder / _QUATERNION, _ORIENTATION)
    leading = inertial or oriented
    if leading is None or len(leading.stamps) < 2:
        raise RecordingUnreadable(str(folder), 0, "fewer than two samples have a time")
    frame, frame_s = count_frames(leading.stamps, median_interval(leading.stamps))
    readings = inertial.values if inertial else np.full((len(frame), 6), np.nan)
    facts: dict[str, str | int | float] = {**told, "folder": folder.name}
    facts["rows_dropped"] = sum(series.dropped for series in (inertial, oriented) if series)
    facts["rows_reordered"] = sum(series.reordered for series in (inertial, oriented) if series)
    info = SensorInfo(
        sensor,
        frame_s,
        label=told.get("name", _plain_name(folder)),
        orientation="world" if oriented else "none",
        common_world=oriented is not None,
        has_rate=inertial is not None,
        has_acceleration=inertial is not None,
        facts=facts,
    )
    return Measured(
        info,
        frame,
        leading.stamps,
        _orientation_at(leading.stamps, oriented, frame_s),
        np.radians(readings[:, :3]),
        readings[:, 3:] * GRAVITY,
        _last_told(leading.stamps, _read_series(folder / "Battery.csv", ("Percentage (%)",))) / 100,
        _last_told(leading.stamps, _read_series(folder / "Temperature.csv", ("Temperature (degC)",))),
    )


def _read_series(path: Path, names: Sequence[str]) -> _Series | None:
    """Return the named columns of a file, None when the recording has no such file."""
    if not path.is_file():
        return None
    table = open_table(path)
    columns = [table.column(name) for name in (_STAMP, *names)]
    found = [column for column in columns if column is not None]
    if len(found) < len(columns):
        missing = (_STAMP, *names)[columns.index(None)]
        raise RecordingUnreadable(str(path), max(table.first_line - 1, 1), f"there is no column {missing!r}")
    rows = table.read(found)
    stamps = rows.values[:, 0] * _TICK
    order = put_in_order(stamps)
    return _Series(stamps[order.keep], rows.values[order.keep, 1:], rows.dropped + order.dropped, order.reordered)


def _orientation_at(stamps: NDArray[np.float64], oriented: _Series | None, frame_s: float) -> NDArray[np.float64]:
    """Return the quaternion nearest to each stamp, NaN where none lies within half a frame."""
    found = np.full((len(stamps), 4), np.nan)
    if oriented is None:
        return found
    after = np.clip(np.searchsorted(oriented.stamps, stamps), 1, max(len(oriented.stamps) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(oriented.stamps) - 1)
    nearer = np.abs(oriented.stamps[after] - stamps) < np.abs(oriented.stamps[before] - stamps)
    nearest = np.where(nearer, after, before)
    close = np.abs(oriented.stamps[nearest] - stamps) <= 0.5 * frame_s
    found[close] = rotation.normalise(oriented.values[nearest[close]])
    return found


def _last_told(stamps: NDArray[np.float64], told: _Series | None) -> NDArray[np.float64]:
    """Return for each stamp the last value sent until then, NaN before the first."""
    if told is None:
        return np.full(len(stamps), math.nan)
    values = np.concatenate([[math.nan], told.values[:, 0]])
    return values[np.searchsorted(told.stamps, stamps, side="right")]
