"""Exact sensors on a body as a source of a live session, and a session that is asked step by step."""

import asyncio
import math
from collections.abc import Callable, Coroutine, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from studio.acquisition.driver import Known
from studio.acquisition.replay import ReplayLink
from studio.capture.live_session import LiveSession
from studio.core import rotation
from studio.core.body import PRESETS, Place
from studio.core.live_solver import samples_of
from studio.core.take import Take
from tests.core.worn_sensors import RATE, procedure, worn_take

PATIENCE = 20.0  # s after which a test gives up; each takes a fraction on an idle machine
UPPER = PRESETS["upper"]
LOWER = PRESETS["lower"]
RESTLESS = Place.LEFT_FOREARM

Told = list[tuple[float, Known]]


def told(take: Take) -> Told:
    """Return the samples of a take with their times of arrival, as a link hands them over."""
    infos = {stream.info.sensor: stream.info for stream in take.streams}
    return [(sample.received, Known(infos[sample.sensor], sample)) for sample in samples_of(take)]


def restless_take(seconds: float = 24.0) -> tuple[Take, dict[Place, Any]]:
    """Return N-pose in which the left forearm waves, a bow, then standing; no pose is marked."""
    time = np.arange(round(seconds * RATE) + 1) / RATE
    motion = {place: procedure(place, time, walking=0.0) for place in UPPER}
    waving = np.radians(12.0) * np.sin(2 * np.pi * 0.8 * time) * (time < 4.4)
    motion[RESTLESS] = rotation.multiply(motion[RESTLESS], rotation.about(2, waving))
    take, truth = worn_take(UPPER, seconds, motion=motion)
    return replace(take, marks=()), truth


def run(story: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(story, PATIENCE))


async def until(is_so: Callable[[], bool]) -> None:
    while not is_so():  # noqa: ASYNC110  # files are made in another thread, which tells nobody
        await asyncio.sleep(0)


class HandFed:
    """A link that gives what it is fed, when it is fed; its clock is that of the samples."""

    name = "hand"
    dialect = ""

    def __init__(self, *, paced: bool = True) -> None:
        self.paced = paced
        self._waiting: asyncio.Queue[list[Known] | BaseException | None] = asyncio.Queue()

    async def arrivals(self):
        while (batch := await self._waiting.get()) is not None:
            if isinstance(batch, BaseException):
                raise batch
            yield batch

    async def send(self, data: bytes) -> None:
        """Nobody listens."""

    async def close(self) -> None:
        self._waiting.put_nowait(None)

    async def give(self, pieces: Told) -> None:
        """Hand pieces over and let the session take them in."""
        for start in range(0, len(pieces), 64):
            self._waiting.put_nowait([piece for _, piece in pieces[start : start + 64]])
        await self._taken()

    async def break_off(self, problem: BaseException | None) -> None:
        """End, by a problem or without one."""
        self._waiting.put_nowait(problem)
        await self._taken()

    async def _taken(self) -> None:
        await until(self._waiting.empty)
        for _ in range(8):  # the task that reads has its turns, and whoever waits for it
            await asyncio.sleep(0)


def between(pieces: Told, start: float, end: float) -> Told:
    return [one for one in pieces if start <= one[0] < end]


def replayed(pieces: Iterator[tuple[float, Known]] | Told) -> ReplayLink:
    return ReplayLink({}, iter(pieces), float("inf"))


def events_of(session: LiveSession, kind: type) -> list[Any]:
    """Take what the session has told and return the events of one kind."""
    return [event for event in iter_events(session) if isinstance(event, kind)]


def iter_events(session):
    for _ in range(session.events.qsize()):
        yield session.events.get()


async def connected(link, take, pieces, *, source="hand", pre_roll=2.0):
    """Return a session that has heard all sensors and has the setup of the take."""
    session = LiveSession(pre_roll=pre_roll)
    await session.connect(source, link)
    await link.give(pieces)
    await session.sensors_known()
    session.adopt(take.setup)
    return session


def start(session, library, seconds=math.inf):
    return session.start_recording(library, "P014", "walk", "hand", seconds)
