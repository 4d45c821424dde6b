"""The map file: which columns of foreign CSV files are what (contracts §7; schema in resources/map.schema.json)."""

import inspect
import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path, PurePosixPath
from typing import Annotated, Any, Literal

import msgspec
import numpy as np
from msgspec import Meta

from studio.core.body import Place
from studio.core.errors import MapFileInvalid
from studio.core.sample import SensorId
from studio.importers.map_words import in_words
from studio.importers.table import decode_text

Column = Annotated[str, Meta(min_length=1)] | Annotated[int, Meta(ge=0)]
"""The name in the header, or the position counted from 0."""

Axis = Literal["+x", "-x", "+y", "-y", "+z", "-z"]
Positive = Annotated[float, Meta(gt=0)]
Name = Annotated[str, Meta(min_length=1)]


class Strict(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A part of the map; a word it does not know is a mistake, not a wish."""


class Time(Strict, frozen=True):
    """When a row was measured. All files of a map share one clock."""

    column: Column
    unit: Literal["s", "ms", "us", "sample"]
    """``sample``: the column counts samples; ``rate_hz`` says how many a second."""
    rate_hz: Positive | None = None
    """Nominal samples a second; without it the median interval counts the lost ones."""


class Gyroscope(Strict, frozen=True):
    """Angular rate about the file's axes x, y, z."""

    columns: tuple[Column, Column, Column]
    unit: Literal["rad/s", "deg/s"]


class Accelerometer(Strict, frozen=True):
    """Specific force along the file's axes x, y, z: +1 g upwards at rest."""

    columns: tuple[Column, Column, Column]
    unit: Literal["m/s2", "g"]


class Magnetometer(Strict, frozen=True):
    """Magnetic field. The columns must exist, and nothing is kept of them: no estimator uses them."""

    columns: tuple[Column, Column, Column]
    unit: str = ""


class Orientation(Strict, frozen=True):
    """The sensor's own estimate as a quaternion; the z axis of its world points up."""

    columns: tuple[Column, Column, Column, Column]
    order: Literal["wxyz", "xyzw"]
    meaning: Literal["world_from_sensor", "sensor_from_world"]
    common_world: bool = False
    """All sensors of the recording share one heading."""


class Sensor(Strict, frozen=True):
    """One sensor: its file, name, place and columns."""

    file: Name
    """Relative to the paths given, else to the map; ``/`` between folders."""
    sensor: Name
    time: Time
    place: Place | None = None
    """None: the sensor was not worn."""
    gyroscope: Gyroscope | None = None
    accelerometer: Accelerometer | None = None
    magnetometer: Magnetometer | None = None
    orientation: Orientation | None = None
    axes: tuple[Axis, Axis, Axis] = ("+x", "+y", "+z")
    """For each sensor axis the file's axis that gives it; together right-handed."""

    def identity(self) -> SensorId:
        """Return the name as a sensor's identity."""
        return SensorId(f"file:{re.sub(r'[^a-z0-9]+', '-', self.sensor.lower()).strip('-') or 'sensor'}")

    def sensor_from_file(self) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        """Return the matrix (3, 3) that turns the file's axes into the sensor's."""
        rows = np.zeros((3, 3))
        for row, axis in enumerate(self.axes):
            rows[row, "xyz".index(axis[1])] = 1.0 if axis[0] == "+" else -1.0
        return rows

    def columns(self) -> tuple[Column, ...]:
        """Return all columns: time, gyroscope, accelerometer, orientation as far as mapped."""
        quantities = (self.gyroscope, self.accelerometer, self.orientation)
        return (self.time.column, *(column for quantity in quantities if quantity for column in quantity.columns))


class Person(Strict, frozen=True):
    """Who wore the sensors."""

    stature_m: Annotated[float, Meta(ge=0.3, le=2.8)]


class Pose(Strict, frozen=True):
    """A pose held from one take time to another; take time 0 is the first sample kept."""

    name: Literal["n", "t", "bow", "sit"]
    from_s: Annotated[float, Meta(ge=0)]
    to_s: Annotated[float, Meta(gt=0)]


class Map(Strict, frozen=True):
    """What the columns of one recording's files mean."""

    sensors: Annotated[tuple[Sensor, ...], Meta(min_length=1)]
    person: Person | None = None
    poses: tuple[Pose, ...] = ()


def read_map(path: Path) -> Map:
    """Read a map and check that it holds together.

    Raises
    ------
    MapFileInvalid
        With the JSON path of what is wrong in its reason.
    """
    try:
        text = decode_text(path.read_bytes()).encode("utf-8", "replace")
    except OSError as error:
        raise MapFileInvalid(str(path), (error.strerror or "it cannot be opened").lower()) from error
    try:
        read = msgspec.json.decode(text, type=Map)
    except RecursionError as error:
        raise MapFileInvalid(str(path), "$: nested too deeply") from error
    except msgspec.DecodeError as error:
        message, _, place = str(error).partition(" - at `")
        where = place.rstrip("`") or "$"
        raise MapFileInvalid(str(path), f"{where}: {in_words(message, where, text, schema())}") from error
    for where, reason in _contradictions(read):
        raise MapFileInvalid(str(path), f"{where}: {reason}")
    return read


def schema() -> dict[str, Any]:
    """Return the JSON Schema of the map, as kept in resources/map.schema.json."""
    return json.loads(json.dumps(msgspec.json.schema(Map)), object_hook=_described)  # type: ignore[no-any-return]


def _described(node: dict[str, Any]) -> dict[str, Any]:
    """Return a schema's node whose description reads alike on every Python: before 3.13 docstrings stay indented."""
    described = node.get("description")
    return {**node, "description": inspect.cleandoc(described)} if isinstance(described, str) else node


def _contradictions(read: Map) -> Iterator[tuple[str, str]]:
    for position, sensor in enumerate(read.sensors):
        yield from _contradictions_of(f"$.sensors[{position}]", sensor, read.sensors[:position])
    for position, pose in enumerate(read.poses):
        if pose.to_s <= pose.from_s:
            yield f"$.poses[{position}].to_s", f"{pose.to_s:g} is not after from_s"


def _contradictions_of(where: str, sensor: Sensor, earlier: Sequence[Sensor]) -> Iterator[tuple[str, str]]:
    path = PurePosixPath(sensor.file.replace("\\", "/"))
    if path.is_absolute() or ".." in path.parts or ":" in path.parts[0]:
        yield f"{where}.file", "it must lie in the folder of the recording"
    if sensor.time.unit == "sample" and sensor.time.rate_hz is None:
        yield f"{where}.time.rate_hz", "samples are counted, so it must say how many a second"
    if not (sensor.gyroscope or sensor.accelerometer or sensor.orientation):
        yield where, "neither gyroscope nor accelerometer nor orientation is named"
    if round(float(np.linalg.det(sensor.sensor_from_file()))) != 1:
        yield f"{where}.axes", "they are no right-handed set of three axes"
    for other in earlier:
        if other.identity() == sensor.identity():
            yield f"{where}.sensor", f"{sensor.sensor!r} names two sensors"
        if sensor.place and other.place == sensor.place:
            yield f"{where}.place", f"two sensors sit on {sensor.place.value}"
