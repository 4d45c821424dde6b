"""From what one link delivers to samples: dialect and tracker, and the commands that tags need."""

from collections.abc import Iterator, Mapping
from typing import Protocol, runtime_checkable

from studio.acquisition.dialects.registry import open_dialect
from studio.acquisition.driver import Arrival, Bundle, Known, Link
from studio.acquisition.health import SensorHealth
from studio.acquisition.tracker import LinkTracker
from studio.capture.link_watch import LinkWatch, Note
from studio.core.errors import PortGone
from studio.core.sample import Sample, SensorId, SensorInfo

QUESTIONS = 10  # times a sensor is asked; a radio loses questions and answers
QUESTION_EVERY = 1.0  # s; a receiver repeats a command in ten beacons


@runtime_checkable
class KnowsTruth(Protocol):
    """A link that can hand over a file to be put into the take: the synthetic suit's true motion."""

    def truth_attachment(self) -> bytes:
        """Return the file."""


class _Branch:
    """One stream of bytes: a link, or one of those that come through it."""

    def __init__(self, name: str, dialect: str) -> None:
        self.dialect = open_dialect(dialect)
        self.tracker = LinkTracker(name, self.dialect.traits)


class LinkIntake:
    """One link being read."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.watch = LinkWatch(link)
        self.dialects = link.dialects if isinstance(link, Bundle) else {link.name: link.dialect}
        self.infos: dict[SensorId, SensorInfo] = {}
        self._asked: dict[SensorId, tuple[int, float]] = {}
        self._arrivals = 0
        self._branches = {name: _Branch(name, dialect) for name, dialect in self.dialects.items() if dialect}

    def samples(self, piece: Arrival | Known) -> Iterator[Sample]:
        """Yield the samples that a piece completes; ``infos`` is up to date for each."""
        if isinstance(piece, Known):
            self.infos[piece.info.sensor] = piece.info
            yield piece.sample
            return
        self._arrivals += 1
        branch = self._branches.get(self.name_of(piece))
        if branch is None:
            raise ValueError(f"link {self.name_of(piece)} sends bytes but names no dialect")
        for reading in branch.dialect.feed(piece.data):
            sample = branch.tracker.accept(reading, piece.received)
            if sample is not None:
                self.infos[sample.sensor] = branch.tracker.infos[sample.sensor]
                yield sample

    def name_of(self, piece: Arrival) -> str:
        """Return the link that a piece is kept under."""
        return piece.link or self.link.name

    async def ask(self, now: float) -> None:
        """Ask the sensors for what they have not told yet, a few times; ``now`` is the clock of ``Sample.time``."""
        for branch in self._branches.values():
            for sensor, info in branch.tracker.infos.items():
                asked, last = self._asked.get(sensor, (0, float("-inf")))
                if asked >= QUESTIONS or now - last < QUESTION_EVERY:
                    continue
                question = branch.dialect.question(info)
                self._asked[sensor] = (asked + 1, now)
                if not question:
                    continue
                try:
                    await self.link.send(question)
                except PortGone:
                    return  # the question is lost as one by radio would be; the watch tells of the port

    def notes(self) -> list[Note]:
        """Return what happened since the last call: reboots, gaps, two tags with one number…"""
        told: list[Note] = []
        for branch in self._branches.values():
            branch.tracker.note_refused(branch.dialect.refused)
            told += branch.tracker.take_events()
        return told

    def health(self) -> Mapping[SensorId, SensorHealth]:
        """Return the counts of each sensor."""
        counts = (branch.tracker.health for branch in self._branches.values())
        return {sensor: health for branch in counts for sensor, health in branch.items()}

    def truth(self) -> bytes | None:
        """Return the true motion as a file, None where nobody knows it."""
        return self.link.truth_attachment() if isinstance(self.link, KnowsTruth) else None

    def foreign_version(self) -> int | None:
        """Return the version of the wire protocol the other side announced, None when it is ours or was not told."""
        versions = (branch.dialect.foreign_version for branch in self._branches.values())
        return next((version for version in versions if version is not None), None)

    def malformed(self) -> int:
        """Return how many pieces made no sense: all of them as long as no sensor was heard."""
        # What has not even the look of a message, such as the words of some other device, no dialect counts.
        counted = sum(sum(branch.dialect.malformed.values()) for branch in self._branches.values())
        return counted if self.infos else max(counted, self._arrivals)
