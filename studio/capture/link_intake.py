"""From what one link delivers to samples: dialect and tracker, and the commands that tags need."""

from collections.abc import Iterator, Mapping

from studio.acquisition.dialects.registry import open_dialect
from studio.acquisition.driver import Arrival, Known, Link
from studio.acquisition.health import SensorHealth
from studio.acquisition.tracker import LinkTracker
from studio.core.sample import Sample, SensorId, SensorInfo

Note = tuple[str, Mapping[str, object]]

QUESTIONS = 10  # times a sensor is asked; a radio loses questions and answers
QUESTION_EVERY = 1.0  # s; a receiver repeats a command in ten beacons


class LinkIntake:
    """One link being read."""

    def __init__(self, link: Link) -> None:
        self.link = link
        self.infos: dict[SensorId, SensorInfo] = {}
        self._asked: dict[SensorId, tuple[int, float]] = {}
        self._dialect = open_dialect(link.dialect) if link.dialect else None
        self._tracker = LinkTracker(link.name, self._dialect.traits) if self._dialect else None

    def samples(self, piece: Arrival | Known) -> Iterator[Sample]:
        """Yield the samples that a piece completes; ``infos`` is up to date for each."""
        if isinstance(piece, Known):
            self.infos[piece.info.sensor] = piece.info
            yield piece.sample
            return
        if self._dialect is None or self._tracker is None:
            raise ValueError(f"link {self.link.name} sends bytes but names no dialect")
        for reading in self._dialect.feed(piece.data):
            sample = self._tracker.accept(reading, piece.received)
            if sample is not None:
                self.infos[sample.sensor] = self._tracker.infos[sample.sensor]
                yield sample

    async def ask(self, now: float) -> None:
        """Ask the sensors for what they have not told yet, a few times; ``now`` is the clock of ``Sample.time``."""
        if self._dialect is None:
            return
        for sensor, info in self.infos.items():
            asked, last = self._asked.get(sensor, (0, float("-inf")))
            if asked >= QUESTIONS or now - last < QUESTION_EVERY:
                continue
            question = self._dialect.question(info)
            self._asked[sensor] = (asked + 1, now)
            if question:
                await self.link.send(question)

    def notes(self) -> list[Note]:
        """Return what happened since the last call: reboots, gaps, two tags with one number…"""
        if self._tracker is None or self._dialect is None:
            return []
        self._tracker.note_refused(self._dialect.refused)
        return list(self._tracker.take_events())

    def health(self) -> Mapping[SensorId, SensorHealth]:
        """Return the counts of each sensor."""
        return {} if self._tracker is None else self._tracker.health

    def foreign_version(self) -> int | None:
        """Return the version of the wire protocol the other side announced, None when it is ours or was not told."""
        return None if self._dialect is None else self._dialect.foreign_version

    def malformed(self) -> int:
        """Return how many pieces made no sense."""
        return 0 if self._dialect is None else sum(self._dialect.malformed.values())
