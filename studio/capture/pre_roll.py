"""What arrived in the last seconds before anybody pressed R: it belongs to the take that begins then."""

from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from studio.acquisition.driver import Arrival
from studio.core.sample import Sample, SensorId


class Kept(NamedTuple):
    """One thing that arrived, in the order of arrival."""

    link: str
    piece: Arrival | Sample


class PreRoll:
    """Bytes and samples of the last ``seconds``."""

    def __init__(self, seconds: float) -> None:
        self.is_frozen = False
        """True while a take is being opened: what it begins with must not change meanwhile."""
        self._seconds = seconds
        self._kept: deque[Kept] = deque()

    def __iter__(self) -> Iterator[Kept]:
        return iter(self._kept)

    def keep(self, link: str, piece: Arrival | Sample) -> None:
        """Keep something that arrived."""
        self._kept.append(Kept(link, piece))

    def forget(self, now: float) -> None:
        """Drop what arrived more than ``seconds`` before ``now`` (s, clock of ``Sample.received``)."""
        if self.is_frozen:
            return
        while self._kept and self._kept[0].piece.received < now - self._seconds:
            self._kept.popleft()

    def clear(self) -> None:
        """Drop everything."""
        self._kept.clear()

    def samples(self, sensor: SensorId | None = None) -> list[Sample]:
        """Return the samples, of all sensors or of one."""
        pieces = [kept.piece for kept in self._kept if isinstance(kept.piece, Sample)]
        return pieces if sensor is None else [sample for sample in pieces if sample.sensor == sensor]

    def first(self) -> float | None:
        """Return the time of the first sample, s on the clock of ``Sample.time``; None without any."""
        return next((kept.piece.time for kept in self._kept if isinstance(kept.piece, Sample)), None)
