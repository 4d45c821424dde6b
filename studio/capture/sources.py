"""Opening what a person names: a port, the synthetic suit, or a take that is played again."""

import heapq
import math
from collections.abc import Iterator
from operator import itemgetter
from pathlib import Path
from typing import NamedTuple, Protocol, runtime_checkable

from studio.acquisition.driver import Arrival, Cue, Found, Known, Link
from studio.acquisition.registry import DRIVERS, driver, kind_of, open_link
from studio.acquisition.replay import ReplayLink
from studio.core.errors import SourceUnreadable
from studio.core.live_solver import samples_of
from studio.core.take import Assignment, Mounting, Setup, Take
from studio.storage.take_reader import read_events, read_raw, read_take

Piece = tuple[float, Arrival | Known | Cue]


@runtime_checkable
class KnowsBody(Protocol):
    """A link that knows who wears its sensors and where: the synthetic suit."""

    mounting: Mounting
    stature: float

    def assignment(self) -> Assignment:
        """Return where each sensor sits."""


class OpenSource(NamedTuple):
    """A link, and the setup that comes with it."""

    link: Link
    setup: Setup | None
    """None: the source knows nothing of a body."""


async def open_source(source: str) -> OpenSource:
    """Open the source named ``kind[:words]``, ``replay:TAKE[?speed=N|max]`` among them.

    Raises
    ------
    LinkError, TakeFileError
    """
    kind, words = kind_of(source)
    if kind == "replay":
        return _open_replay(source, words)
    link = await open_link(source)
    if isinstance(link, KnowsBody):
        setup = Setup(link.assignment(), stature=link.stature, stature_known=True, mounting=link.mounting)
        return OpenSource(link, setup)
    return OpenSource(link, None)


def _open_replay(source: str, words: str) -> OpenSource:
    path, _, options = words.partition("?")
    speed = _speed(source, options)
    folder = Path(path)
    take, _ = read_take(folder)
    dialects = {str(e.facts.get("link")): str(e.facts.get("dialect")) for e in read_events(folder) if e.kind == "link"}
    pieces = _recorded(folder, tuple(dialects)) if dialects else _known(take)
    return OpenSource(ReplayLink(dialects, _with_cues(pieces, take), speed), take.setup)


def _speed(source: str, options: str) -> float:
    name, _, value = options.partition("=")
    if not options:
        return 1.0
    if name != "speed":
        raise SourceUnreadable(source, f"a replay has no option {name}")
    try:
        speed = math.inf if value == "max" else float(value)
    except ValueError:
        speed = math.nan
    if not speed > 0:
        raise SourceUnreadable(source, f"{value} is not a speed")
    return speed


def _recorded(folder: Path, links: tuple[str, ...]) -> Iterator[Piece]:
    """Yield the bytes of all links in the order of arrival; a block of the file has them link by link."""

    def of(link: str) -> Iterator[Piece]:
        return ((time, Arrival(time, data, link)) for name, time, data in read_raw(folder) if name == link)

    return heapq.merge(*map(of, links), key=itemgetter(0))


def _known(take: Take) -> Iterator[Piece]:
    infos = {stream.info.sensor: stream.info for stream in take.streams}
    for sample in samples_of(take):
        yield sample.received, Known(infos[sample.sensor], sample)


def _with_cues(pieces: Iterator[Piece], take: Take) -> Iterator[Piece]:
    """Yield the pieces with the held poses told again where they ended."""
    poses = [(mark.end if math.isfinite(mark.end) else mark.time, mark) for mark in take.poses()]
    for time, piece in pieces:
        while poses and poses[0][0] <= time:
            ended, mark = poses.pop(0)
            yield ended, Cue(mark)
        yield time, piece


def find_sources() -> list[Found]:
    """Return what could be opened now, of every kind."""
    return [found for kind in DRIVERS for found in driver(kind).find()]
