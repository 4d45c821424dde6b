"""A take as a link: what was recorded comes in again, at its own pace or faster."""

import asyncio
import time
from collections.abc import AsyncIterator, Iterable, Mapping, Sequence

from studio.acquisition.driver import Arrival, Cue, Known

BATCH = 0.02  # s of recorded time handed over at once
LARGEST_BATCH = 32  # pieces handed over at once when the pace is free: a third of a second, so that others keep up


class ReplayLink:
    """Recorded pieces in their order, moved to the clock of this computer.

    Parameters
    ----------
    dialects : mapping
        Name of each recorded link to its dialect; empty where the pieces need no decoding.
    pieces : iterable of (s of take time, piece)
        In the order of arrival, each with the link it came by. The link never opens a file: it is given what was read.
    speed : float
        1 is real time; infinity hands everything over as fast as it is read.
    """

    def __init__(
        self,
        dialects: Mapping[str, str],
        pieces: Iterable[tuple[float, Arrival | Known | Cue]],
        speed: float = 1.0,
    ) -> None:
        self.dialects = dialects
        self.name = next(iter(dialects), "replay")
        self.dialect = dialects.get(self.name, "")
        self.paced = speed != float("inf")
        self._pieces = pieces
        self._speed = speed
        self._closed = False

    async def arrivals(self) -> AsyncIterator[Sequence[Arrival | Known | Cue]]:
        """Yield the recorded pieces until the take ends."""
        start = time.perf_counter()
        batch: list[Arrival | Known | Cue] = []
        due = BATCH
        for recorded, piece in self._pieces:
            if batch and (recorded >= due if self.paced else len(batch) >= LARGEST_BATCH):
                yield batch
                batch = []
                await self._wait_until(start, recorded)
                if self._closed:
                    return
                due = recorded + BATCH
            batch.append(_moved(piece, start))
        if batch:
            yield batch

    async def _wait_until(self, start: float, recorded: float) -> None:
        wait = start + recorded / self._speed - time.perf_counter() if self.paced else 0.0
        await asyncio.sleep(max(wait, 0.0))

    async def send(self, data: bytes) -> None:
        """A recording does not listen: nothing is sent."""

    async def close(self) -> None:
        """End the replay."""
        self._closed = True


def _moved(piece: Arrival | Known | Cue, start: float) -> Arrival | Known | Cue:
    """Return a piece with take times moved to this computer's clock."""
    if isinstance(piece, Arrival):
        return piece._replace(received=piece.received + start)
    if isinstance(piece, Known):
        sample = piece.sample
        moved = sample._replace(time=sample.time + start, received=sample.received + start)
        return Known(piece.info, moved)
    mark = piece.mark
    return Cue(type(mark)(mark.time + start, mark.kind, mark.label, mark.end + start))
