"""A link is an open source of bytes; a driver finds and opens links of one kind."""

from collections.abc import AsyncIterator, Mapping, Sequence
from typing import NamedTuple, Protocol, runtime_checkable

from studio.core.sample import Sample, SensorInfo
from studio.core.take import Mark


class Arrival(NamedTuple):
    """Bytes as one read gave them."""

    received: float
    """s, monotonic clock of this computer (a simulated one where the source runs faster than time)."""
    data: bytes
    link: str = ""
    """Which link of a ``Bundle`` it came by; empty for any other."""


class Known(NamedTuple):
    """A sample from a source that needs no decoding: a replayed take of a foreign recording."""

    info: SensorInfo
    sample: Sample


class Cue(NamedTuple):
    """What the performer was asked to do: a replayed take and the simulated performer tell it themselves."""

    mark: Mark
    """``time`` and ``end`` on the clock of ``Arrival.received``."""


class Link(Protocol):
    """An open source. One consumer; closing ends ``arrivals``."""

    name: str
    """Kept in the take as ``/raw/<name>``: letters, digits, ``-`` and ``_``."""
    dialect: str
    """Key in ``acquisition.dialects.registry.DIALECTS``."""
    paced: bool
    """False: the source runs as fast as it is read, so the reader may slow it down."""

    def arrivals(self) -> AsyncIterator[Sequence[Arrival | Known | Cue]]:
        """Yield what came in since the last time, in order, until the source ends."""

    async def send(self, data: bytes) -> None:
        """Send bytes to the other side."""

    async def close(self) -> None:
        """Close the source; waits until its threads have ended."""


@runtime_checkable
class Bundle(Protocol):
    """A link through which several come: a replayed take that was recorded from two receivers."""

    dialects: Mapping[str, str]
    """Name of each link to its dialect."""


class Found(NamedTuple):
    """A source that could be opened now."""

    source: str
    """The words that open it, e.g. ``serial:/dev/ttyACM0``."""
    label: str
    """What a person calls it."""


class Driver(Protocol):
    """Finds and opens links of one kind."""

    def find(self) -> list[Found]:
        """Return what could be opened now."""

    async def open(self, words: str) -> Link:
        """Open the source named by what follows the colon; LinkError when it cannot be."""
