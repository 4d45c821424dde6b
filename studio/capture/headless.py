"""Recording without a window: connect, wait for the sensors, keep a while, close."""

import asyncio
from collections.abc import Coroutine
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

from studio.capture.live_session import LiveSession
from studio.capture.setups import remember, setup_for, with_stature
from studio.capture.sources import open_source
from studio.core.errors import FellSilent, NoData, StoppedEarly, StudioError
from studio.core.take import Setup
from studio.storage.person_file import Person, load_person
from studio.storage.take_file import Saved


@dataclass(frozen=True)
class RecordRequest:
    """What a person asked to be recorded."""

    source: str
    seconds: float
    """s after the first kept sample; infinity records until it is stopped."""
    library: Path
    person: str
    name: str
    stature: float | None = None
    """m; kept for the person. None: as known."""


class Recorded(NamedTuple):
    """A take that is on disk, and why it is shorter than it was to be."""

    saved: Saved
    stopped_by: StudioError | None
    """DiskFull, a lost source or one that fell silent; None when it has its length or was stopped by hand."""
    mistake: BaseException | None
    """Ours, that ended it: for the crash report."""
    sensors: int
    loss: float | None
    """Lost frames as a share of all, 0…1; None when not all sensors were counted, or nobody heard how it went on."""


async def record(request: RecordRequest, session: LiveSession, stop: asyncio.Event) -> Recorded:
    """Record one take and return when it has been read back. ``stop`` ends it early; what was kept is kept.

    Raises
    ------
    LinkError, RecordingError, SetupError, TakeFileError
        StoppedEarly when ``stop`` came before anything was kept.
    """
    with_stature(request.library, request.person, request.stature)
    person = load_person(request.library, request.person)
    opened = await open_source(request.source)
    await session.connect(request.source, opened.link)
    stopper = asyncio.create_task(stop.wait())
    try:
        if not await _comes_first(session.sensors_known(), stopper):
            raise StoppedEarly(request.source)
        session.adopt(_setup(request, session, opened.setup, person))
        recording = await session.start_recording(
            request.library, request.person, request.name, request.source, request.seconds
        )
        await _comes_first(session.finished(recording), stopper)
        silence = FellSilent(request.source, recording.silent_for, request.seconds) if recording.silent_for else None
        stopped_by = recording.writer.failure or session.lost() or silence
        saved = await session.stop_recording()
        sensors, loss = len(session.infos), None if silence else _loss(session)
    finally:
        stopper.cancel()
        await session.disconnect()
    mistake = session.take_mistake()
    if saved.samples == 0 and mistake is None:
        raise stopped_by or NoData(request.source, 0)
    if opened.setup is None:
        remember(request.library, request.person, session.setup)
    return Recorded(saved, stopped_by, mistake, sensors, loss)


async def _comes_first(work: Coroutine[Any, Any, None], stopper: asyncio.Task[bool]) -> bool:
    """Wait for something or for the stop; False when it was the stop."""
    task = asyncio.create_task(work)
    await asyncio.wait({task, stopper}, return_when=asyncio.FIRST_COMPLETED)
    if not task.done():
        task.cancel()
        await asyncio.wait({task})
        return False
    task.result()
    return True


def _loss(session: LiveSession) -> float | None:
    counts = session.health()
    if counts.keys() < session.infos.keys():  # played again from samples: what is missing there was lost before
        return None
    lost = sum(health.lost for health in counts.values())
    return lost / max(lost + sum(health.received for health in counts.values()), 1)


def _setup(request: RecordRequest, session: LiveSession, offered: Setup | None, person: Person) -> Setup:
    """Return the setup of the recording; a stature that was asked for is stronger than what the source says."""
    setup = setup_for(session.infos, offered, person)
    return setup if request.stature is None else replace(setup, stature=request.stature, stature_known=True)
