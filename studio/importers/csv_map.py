"""Any CSV recording, explained by a map file.

Several sensors may share a file; a row in which all columns of a sensor are empty is none of its samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path, PurePosixPath
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.errors import MapFileInvalid, RecordingUnreadable
from studio.core.frames import GRAVITY
from studio.core.sample import SensorInfo
from studio.core.take import Assignment, Mark, Setup, Take
from studio.importers.clock import count_frames, median_interval, put_in_order
from studio.importers.map_file import Accelerometer, Column, Gyroscope, Map, Sensor, read_map
from studio.importers.plausible_units import doubt_acceleration, doubt_rate
from studio.importers.streams import Measured, line_up
from studio.importers.table import Rows, Table, open_table

_SECONDS = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_SI = {"rad/s": 1.0, "deg/s": float(np.radians(1.0)), "m/s2": 1.0, "g": GRAVITY}
_NORM_TOLERANCE = 0.1  # of a quaternion's length from 1; two decimals in the file give 0.01, other quantities far more
_WHOLE = 0.01  # of a count from a whole number


class _Source(NamedTuple):
    """One sensor of the map and its rows."""

    where: str
    """JSON path in the map."""
    sensor: Sensor
    file: str
    rows: Rows
    """Columns in the order of ``Sensor.columns``."""


def read_csv(paths: Sequence[Path], map_file: Path) -> Take:
    """Read a recording of CSV files.

    Parameters
    ----------
    paths : files or folders
        Where the files of the map are looked for first; none: beside the map.

    Raises
    ------
    MapFileInvalid
        When the map does not hold together or does not fit the files.
    RecordingUnreadable
        When a file cannot be read or nothing usable is in it.
    """
    described = read_map(map_file)
    sources = _read_sources(described, _find_files(described, paths, map_file), map_file)
    person = described.person
    setup = Setup(
        assignment=Assignment({sensor.place: sensor.identity() for sensor in described.sensors if sensor.place}),
    )
    if person is not None:
        setup = replace(setup, stature=person.stature_m, stature_known=True)
    return Take(
        name=_name(paths, map_file),
        person="",
        source="csv",
        started="",
        streams=line_up([_measure(source, map_file) for source in sources]),
        marks=tuple(Mark(pose.from_s, "pose", pose.name, pose.to_s) for pose in described.poses),
        setup=setup,
    )


def _name(paths: Sequence[Path], map_file: Path) -> str:
    if len(paths) == 1:
        return paths[0].resolve().name if paths[0].is_dir() else paths[0].stem
    return (paths[0] if paths else map_file).resolve().parent.name


def _find_files(described: Map, paths: Sequence[Path], map_file: Path) -> list[Path]:
    """Return each sensor's file; every file given must be one of them."""
    found = []
    for position, sensor in enumerate(described.sensors):
        parts = PurePosixPath(sensor.file.replace("\\", "/")).parts
        given = [path for path in paths if path.parts[-len(parts) :] == parts]
        inside = [path.joinpath(*parts) for path in (*paths, map_file.parent)]
        file = next((path for path in (*given, *inside) if path.is_file()), None)
        if file is None:
            raise MapFileInvalid(str(map_file), f"$.sensors[{position}].file: there is no {sensor.file!r}")
        found.append(file)
    for path in paths:
        if not path.is_dir() and path not in found:
            raise MapFileInvalid(str(map_file), f"$.sensors: none of them is in {path.name!r}")
    return found


def _read_sources(described: Map, files: Sequence[Path], map_file: Path) -> list[_Source]:
    """Read each file once for all its sensors, once more for each when a row is bad."""
    sources: dict[int, _Source] = {}
    for file in dict.fromkeys(files):
        table = open_table(file)
        wanted = {
            position: _positions(table, f"$.sensors[{position}]", described.sensors[position], map_file)
            for position in range(len(files))
            if files[position] == file
        }
        together = sorted({column for columns in wanted.values() for column in columns})
        rows = table.read(together)
        for position, columns in wanted.items():
            if rows.dropped:
                # A cell that is bad for one sensor must not cost the others their row.
                own = table.read(columns)
            else:
                own = Rows(rows.values[:, [together.index(column) for column in columns]], 0, 0)
            sources[position] = _Source(f"$.sensors[{position}]", described.sensors[position], str(file), own)
    return [sources[position] for position in range(len(files))]


def _positions(table: Table, where: str, sensor: Sensor, map_file: Path) -> list[int]:
    """Return the 0-based positions of the sensor's columns; those of the magnetometer only have to exist."""
    ignored = sensor.magnetometer.columns if sensor.magnetometer else ()
    for column in (*sensor.columns(), *ignored):
        if _position(table, column) is None:
            reason = f"{table.file} has no column {column!r}"
            if isinstance(column, str) and any(column in header for header in table.headers):
                reason = f"{table.file} has more than one column {column!r}"
            raise MapFileInvalid(str(map_file), f"{where}: {reason}")
    found = [_position(table, column) for column in sensor.columns()]
    return [position for position in found if position is not None]


def _position(table: Table, column: Column) -> int | None:
    if isinstance(column, str):
        return table.column(column.strip())
    return column if column < table.width else None


def _measure(source: _Source, map_file: Path) -> Measured:
    sensor = source.sensor
    unit = 1.0 / (sensor.time.rate_hz or 1.0) if sensor.time.unit == "sample" else _SECONDS[sensor.time.unit]
    values = source.rows.values
    # Sensors that share a file at different rates leave each other's cells empty.
    values = values[np.isfinite(values[:, 1:]).any(axis=1)]
    order = put_in_order(values[:, 0] * unit)
    values = values[order.keep]
    if len(values) < 2:
        raise RecordingUnreadable(
            source.file, source.rows.first_bad_line, "fewer than two rows have a time and a value"
        )
    frame, frame_s = _count(values[:, 0], unit, source, map_file)
    quantities = _split(sensor, values)
    orientation, refused = _orient(source, quantities.get("orientation"), len(values), map_file)
    rate = _turn(sensor, sensor.gyroscope, quantities.get("gyroscope"), len(values))
    acceleration = _turn(sensor, sensor.accelerometer, quantities.get("accelerometer"), len(values))
    _check_units(source, values[:, 0] * unit, rate, acceleration, frame_s, map_file)
    facts = {
        "rows_dropped": source.rows.dropped + order.dropped,
        "first_bad_line": source.rows.first_bad_line,
        "rows_reordered": order.reordered,
        "orientations_refused": refused,
    }
    told: dict[str, str | int | float] = {"file": Path(source.file).name}
    told |= {name: count for name, count in facts.items() if count or name == "rows_dropped"}
    if sensor.magnetometer:
        told["magnetometer"] = "in the file, not kept"
    info = SensorInfo(
        sensor.identity(),
        frame_s,
        label=sensor.sensor,
        orientation="world" if sensor.orientation else "none",
        common_world=sensor.orientation is not None and sensor.orientation.common_world,
        has_rate=bool(np.isfinite(rate).any()),
        has_acceleration=bool(np.isfinite(acceleration).any()),
        facts=told,
    )
    unknown = np.full(len(values), np.nan)
    return Measured(info, frame, values[:, 0] * unit, orientation, rate, acceleration, unknown, unknown.copy())


def _check_units(
    source: _Source,
    time: NDArray[np.float64],
    rate: NDArray[np.float64],
    acceleration: NDArray[np.float64],
    frame_s: float,
    map_file: Path,
) -> None:
    """Refuse numbers that cannot be what the map says they are."""
    sensor, doubts = source.sensor, {}
    if sensor.accelerometer:
        doubts["accelerometer"] = doubt_acceleration(acceleration, frame_s, sensor.accelerometer.unit)
    if sensor.gyroscope:
        doubts["gyroscope"] = doubt_rate(time, rate, acceleration, frame_s, sensor.gyroscope.unit)
    for quantity, doubt in doubts.items():
        if doubt is not None:
            reason = f"{source.where}.{quantity}.unit of {sensor.sensor!r}: {doubt}"
            raise MapFileInvalid(str(map_file), reason)


def _turn(
    sensor: Sensor, quantity: Gyroscope | Accelerometer | None, read: NDArray[np.float64] | None, rows: int
) -> NDArray[np.float64]:
    """Return vectors in SI units and sensor axes, (n, 3); NaN when the map names none."""
    if quantity is None or read is None:
        return np.full((rows, 3), np.nan)
    # Picked, not multiplied: a missing component must not spread to the others.
    axes = np.abs(sensor.sensor_from_file()).argmax(axis=1)
    signs: NDArray[np.float64] = sensor.sensor_from_file().sum(axis=1)
    return read[:, axes] * (signs * _SI[quantity.unit])


def _count(
    stamps: NDArray[np.float64], unit: float, source: _Source, map_file: Path
) -> tuple[NDArray[np.int64], float]:
    """Return frame numbers and the nominal frame, s; the rows of a sample counter number themselves."""
    told = source.sensor.time
    if told.unit == "sample":
        whole = np.rint(stamps)
        if np.abs(stamps - whole).max() > _WHOLE:
            raise MapFileInvalid(str(map_file), f"{source.where}.time.unit: the column does not count samples")
        return (whole - whole[0]).astype(np.int64), unit
    time = stamps * unit
    median = median_interval(time)
    nominal = 1.0 / told.rate_hz if told.rate_hz else median
    if median < 0.5 * nominal:
        reason = f"its rows are {median:.6g} s apart, not {nominal:.6g}"
        raise MapFileInvalid(str(map_file), f"{source.where}.time.rate_hz: {reason}")
    return count_frames(time, nominal)


def _split(sensor: Sensor, values: NDArray[np.float64]) -> Mapping[str, NDArray[np.float64]]:
    """Return the columns of each mapped quantity, in the order of ``Sensor.columns``."""
    quantities, start = {}, 1
    for name in ("gyroscope", "accelerometer", "orientation"):
        quantity = getattr(sensor, name)
        if quantity is not None:
            quantities[name] = values[:, start : start + len(quantity.columns)]
            start += len(quantity.columns)
    return quantities


def _orient(
    source: _Source, read: NDArray[np.float64] | None, rows: int, map_file: Path
) -> tuple[NDArray[np.float64], int]:
    """Return ``world_from_sensor`` (n, 4), and how many quaternions were refused because of their length."""
    told = source.sensor.orientation
    if told is None or read is None:
        return np.full((rows, 4), np.nan), 0
    file = read[:, [3, 0, 1, 2]] if told.order == "xyzw" else read
    length = np.sqrt((file * file).sum(axis=1))
    present = np.isfinite(length)
    unit = present & (np.abs(length - 1.0) <= _NORM_TOLERANCE)
    if 2 * unit.sum() < present.sum():
        reason = f"their length is {np.median(length[present]):.4g}, a quaternion's is 1"
        raise MapFileInvalid(str(map_file), f"{source.where}.orientation.columns: {reason}")
    world_from_file = rotation.normalise(np.where(unit[:, None], file, np.nan))
    if told.meaning == "sensor_from_world":
        world_from_file = rotation.inverse(world_from_file)
    file_from_sensor = rotation.from_matrix(source.sensor.sensor_from_file().T)
    return rotation.multiply(world_from_file, file_from_sensor), int(present.sum() - unit.sum())
