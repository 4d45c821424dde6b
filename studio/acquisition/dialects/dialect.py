"""What every wire format offers: bytes in, readings out, and a count of what made no sense."""

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple, Protocol

from studio.core.sample import Quaternion, SensorId, SensorInfo, Vector


class Reading(NamedTuple):
    """One packet of one sensor, decoded but not yet placed in time."""

    sensor: SensorId
    number: int
    """1…15 as the tag says, 0 when it has none."""
    sequence: int
    """The counter as sent; wraps at ``Traits.sequence_modulus``."""
    clock: int
    """The tag's clock as sent, in ticks; wraps at ``Traits.clock_modulus``."""
    orientation: Quaternion
    rate: Vector
    """rad/s; NaN when this packet carries none."""
    acceleration: Vector
    """m/s²; NaN when this packet carries none."""
    flags: int
    battery: float
    temperature: float
    rssi: float
    facts: Mapping[str, str | int | float] | None = None
    """What INFO, DEVICE, COEFFICIENTS and INTEGRAL packets tell besides, by name."""


class Traits(NamedTuple):
    """How a dialect counts."""

    sequence_modulus: int
    clock_modulus: int
    clock_tick: float
    """s."""
    frame_s: float
    """s, nominal."""


class Dialect(Protocol):
    """Pure, incremental codec of one wire format: any split of the bytes gives the same readings."""

    traits: Traits
    malformed: Counter[str]
    """How many pieces were refused, by reason. Refusing is never an exception."""
    refused: Counter[SensorId]
    """Pieces of a known sensor that made no sense, by sensor."""
    foreign_version: int | None
    """The version of our protocol that the other side announced, when it is not the one we speak."""

    def feed(self, data: bytes) -> list[Reading]:
        """Take the next bytes and return the readings they complete."""

    def question(self, info: SensorInfo) -> bytes:
        """Return what asks a sensor for what it has not told yet; empty when there is nothing to ask."""
