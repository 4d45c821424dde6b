"""What does not come: a port that was pulled out, a tag that fell silent. Times are passed in."""

from collections.abc import Iterator, Mapping
from typing import Protocol, runtime_checkable

from studio.acquisition.driver import Link
from studio.core.sample import SensorId

SILENCE = 1.0  # s; 50 frames of 20 ms: the longest gap that the solver bridges (contracts §5)

Note = tuple[str, Mapping[str, object]]


@runtime_checkable
class Breakable(Protocol):
    """A link that may be lost and found again: a port."""

    place: str
    """What a person plugs in: the name of the port."""
    is_connected: bool
    interruptions: int
    """How often it was lost."""
    dropped: int
    """Bytes thrown away because nobody took what came before."""


class LinkWatch:
    """Notices silence on one link.

    Notes are pairs of kind and facts (JSON types): ``link lost`` link · ``link back`` link, after (s) ·
    ``dropped`` link, bytes · ``sensor silent`` sensor · ``sensor back`` sensor, after (s).
    """

    def __init__(self, link: Link) -> None:
        self._name = link.name
        self._link = link if isinstance(link, Breakable) else None
        self._interruptions = 0
        self._lost_at: float | None = None
        self._dropped = 0
        self._heard: dict[SensorId, float] = {}
        self._silent: dict[SensorId, float] = {}

    @property
    def lost(self) -> str | None:
        """The port that is gone now, None while all is well."""
        return self._link.place if self._link is not None and not self._link.is_connected else None

    def heard(self, sensor: SensorId, now: float) -> Iterator[Note]:
        """A sensor sent something; yield that it is back."""
        if sensor in self._silent:
            yield "sensor back", {"sensor": sensor, "after": round(now - self._silent.pop(sensor), 3)}
        self._heard[sensor] = now

    def look(self, now: float) -> Iterator[Note]:
        """Yield what became of link and sensors since the last look; ``now`` is on the clock of ``heard``."""
        if self._link is not None:
            yield from self._look_at_link(self._link, now)
        if self._lost_at is not None:
            return  # no tag is to blame
        for sensor, at in self._heard.items():
            if sensor not in self._silent and now - at > SILENCE:
                self._silent[sensor] = at
                yield "sensor silent", {"sensor": sensor}

    def _look_at_link(self, link: Breakable, now: float) -> Iterator[Note]:
        if link.interruptions != self._interruptions:
            self._interruptions = link.interruptions
            if self._lost_at is None:
                self._lost_at = now
                yield "link lost", {"link": self._name}
        if self._lost_at is not None and link.is_connected:
            yield "link back", {"link": self._name, "after": round(now - self._lost_at, 3)}
            self._lost_at = None
            # They had no way to be heard: they get their second from now on.
            self._heard = dict.fromkeys(self._heard, now)
        if link.dropped != self._dropped:
            yield "dropped", {"link": self._name, "bytes": link.dropped - self._dropped}
            self._dropped = link.dropped
