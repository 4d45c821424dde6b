"""What a simulated suit says, read through the real dialect and tracker."""

from collections import Counter, defaultdict
from dataclasses import dataclass

import numpy as np

from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.dialects.receiver_frames import OrderFrames, ReceiverFrames, Status, TagCommand, encode_command
from studio.acquisition.synthetic.errors_table import ErrorTable
from studio.acquisition.synthetic.suit import Suit
from studio.acquisition.synthetic.words import read_words
from studio.acquisition.tracker import Event, LinkTracker
from studio.core.body import Place
from studio.core.sample import Flag, Sample, SensorId

WIRE_RESOLUTION = np.radians(0.0086)  # of smallest three (PROTOCOL.md, section 2.2)


@dataclass
class Listened:
    """What came of a suit."""

    suit: Suit
    tracker: LinkTracker
    readings: dict[SensorId, list[Reading]]
    samples: dict[SensorId, list[Sample]]
    malformed: Counter[str]
    status: Status | None

    def sensor(self, place: Place) -> SensorId:
        return self.suit.assignment().sensors[place]

    def events(self, kind: str) -> list[Event]:
        return [event for event in self.tracker.take_events() if event[0] == kind]


class Listener:
    """A computer at the receiver's serial port whose clock is 0 when the suit is switched on."""

    def __init__(self, words: str, errors: ErrorTable | None = None) -> None:
        self.suit = Suit(read_words(words), errors)
        self._dialect = ReceiverFrames()
        self._tracker = LinkTracker("synthetic", self._dialect.traits)
        self._readings: dict[SensorId, list[Reading]] = defaultdict(list)
        self._samples: dict[SensorId, list[Sample]] = defaultdict(list)

    def hear(self, seconds: float) -> Listened:
        """Listen for so long and return all that was heard since the beginning."""
        end = self.suit.elapsed + seconds
        while self.suit.elapsed < end:
            for heard in self.suit.next_block():
                for reading in self._dialect.feed(heard.data):
                    self._readings[reading.sensor].append(reading)
                    sample = self._tracker.accept(reading, heard.at)
                    if sample is not None:
                        self._samples[reading.sensor].append(sample)
        parts = (self._readings, self._samples, self._dialect.malformed, self._dialect.status)
        return Listened(self.suit, self._tracker, *parts)

    def tell(self, serial: int, command: int, argument: bytes = b"") -> None:
        """Send a command as the studio would."""
        (order,) = OrderFrames().feed(encode_command(serial, command, argument))
        assert isinstance(order, TagCommand)
        self.suit.obey(order)


def listen(words: str, seconds: float, errors: ErrorTable | None = None) -> Listened:
    """Return what a suit said in so many seconds."""
    return Listener(words, errors).hear(seconds)


def measured(samples: list[Sample]) -> list[Sample]:
    """Return those that carry gyroscope and accelerometer."""
    return [sample for sample in samples if not sample.flags & Flag.FILLED]


def frames_of(heard: Listened, place: Place) -> tuple[list[Sample], np.ndarray]:
    """Return the samples of a tag and when they were taken, s since switching on: frame after frame from 0 on."""
    samples = heard.samples[heard.sensor(place)]
    count = np.array([sample.frame for sample in samples])
    return samples, (count - count[0]) * heard.suit.options.frame_s
