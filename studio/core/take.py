"""A take and what belongs to it, as values: what the radio said, and the facts in force while it did."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from studio.core.body import DEFAULT_STATURE, PLACES, Place
from studio.core.errors import PlaceTakenTwice
from studio.core.sample import Correction, Quaternion, SensorId, Stream, Vector

NAN = float("nan")

Mounting = Literal["strapped", "unknown"]
"""``strapped``: tags sit as resources/places.json says (arrow and face), within 15 degrees."""

PoseName = Literal["n", "t", "bow", "sit"]


@dataclass(frozen=True, slots=True)
class Mark:
    """Something that happened at a time of the take."""

    time: float
    """s of take time."""
    kind: str
    """``pose``: a pose was held from ``time`` to ``end``, ``label`` is its name. ``record``: R was pressed.
    ``marker``: an operator's marker. Others are shown as they are."""
    label: str = ""
    end: float = NAN
    """s of take time; NaN for an instant."""


@dataclass(frozen=True, slots=True)
class Assignment:
    """Which sensor sits on which place of the body: one to one."""

    sensors: Mapping[Place, SensorId] = field(default_factory=dict)

    def __post_init__(self) -> None:
        seen: dict[SensorId, Place] = {}
        for place, sensor in self.sensors.items():
            if sensor in seen:
                raise PlaceTakenTwice(f"{seen[sensor].value}, {place.value}", (sensor,))
            seen[sensor] = place

    def place_of(self, sensor: SensorId) -> Place | None:
        """Return where ``sensor`` sits, None when it is not worn."""
        return next((place for place, worn in self.sensors.items() if worn == sensor), None)

    def places(self) -> tuple[Place, ...]:
        """Return the assigned places in the order of Table 1."""
        return tuple(place for place in PLACES if place in self.sensors)


@dataclass(frozen=True, slots=True)
class Calibration:
    """A correction of one sensor's gyroscope, with its date and uncertainty."""

    sensor: SensorId
    correction: Correction
    date: str
    """ISO 8601, UTC."""
    method: str
    offset_sigma: Vector = (NAN, NAN, NAN)
    """rad/s, one standard deviation."""
    gain_sigma: float = NAN
    """One standard deviation of the gains, as a fraction."""
    temperature: float = NAN
    """°C while it was measured."""


HeadingSource = Literal["bow", "two poses", "common world", "strap rule", "unknown"]


@dataclass(frozen=True, slots=True)
class LimbAlignment:
    """How one sensor sits on its segment, and where its heading came from (contracts §3)."""

    sensor_from_segment: Quaternion
    heading: float
    """rad, turns the sensor's own filter world into the wearer's world about z; 0 when ``source`` is unknown."""
    source: HeadingSource
    heading_sigma: float
    """rad, one standard deviation; what the source is worth."""
    spread: float
    """rad, root mean square deviation from the mean while the pose was held."""


@dataclass(frozen=True, slots=True)
class Alignment:
    """All limbs out of one held pose; the window calls it body calibration."""

    pose: PoseName
    from_s: float
    to_s: float
    limbs: Mapping[Place, LimbAlignment]


@dataclass(frozen=True, slots=True)
class CarriedAlignment:
    """A body calibration made before the take began, and how it saw each sensor at the take's first sample.

    The samples of its holds are not in the take: this is the fact that stands in for them.
    """

    alignment: Alignment
    """Its times are take times: below 0, because the holds came before."""
    time: float
    """s of the take, where ``wearer_from_sensor`` holds."""
    wearer_from_sensor: Mapping[Place, Quaternion]
    """Attitude of each aligned sensor in the wearer's world (contracts §2); a heading for any filter to start from."""


@dataclass(frozen=True, slots=True)
class Setup:
    """The facts in force: replaced, never changed, and kept in each take."""

    assignment: Assignment = field(default_factory=Assignment)
    calibrations: tuple[Calibration, ...] = ()
    stature: float = DEFAULT_STATURE
    """m."""
    stature_known: bool = False
    """False: nobody entered the stature, the default stands in."""
    mounting: Mounting = "unknown"
    performer: int = 1
    """Counts suits in one take."""
    carried: CarriedAlignment | None = None
    """None: the body is calibrated by poses held in the take, or not at all."""


@dataclass(frozen=True, slots=True)
class Take:
    """Streams, marks and the setup at recording."""

    name: str
    person: str
    """Code, e.g. P014; empty for foreign recordings without one."""
    source: str
    """The words that name the source, e.g. ``synthetic:walk?seed=1`` or ``xio``."""
    started: str
    """ISO 8601 UTC of take time 0; empty when the recording does not tell."""
    streams: tuple[Stream, ...]
    marks: tuple[Mark, ...] = ()
    setup: Setup = field(default_factory=Setup)
    versions: Mapping[str, str] = field(default_factory=dict)
    """Studio, protocol, capture profile."""

    def stream(self, sensor: SensorId) -> Stream:
        """Return the stream of ``sensor``; KeyError when the take has none."""
        for stream in self.streams:
            if stream.info.sensor == sensor:
                return stream
        raise KeyError(sensor)

    def duration(self) -> float:
        """Return the time from the first to the last kept sample, s."""
        # The last to arrive is not always the last that was measured.
        return max([0.0, *(float(stream.time.max()) for stream in self.streams if len(stream))])

    def poses(self) -> tuple[Mark, ...]:
        """Return the marks of held poses in the order of time."""
        return tuple(sorted((m for m in self.marks if m.kind == "pose"), key=lambda m: m.time))
