"""The simulated suit as a source like any other: words open it, bytes come out of it."""

import asyncio
import math
import time
from collections.abc import AsyncIterator, Sequence

import numpy as np

from studio.acquisition.dialects.receiver_frames import OrderFrames, TagCommand
from studio.acquisition.driver import Arrival, Cue, Found, Known
from studio.acquisition.synthetic.errors_table import ErrorTable
from studio.acquisition.synthetic.scripts import WORN_SCRIPTS
from studio.acquisition.synthetic.suit import Heard, Suit, worn_places
from studio.acquisition.synthetic.truth import Truth, encode_truth
from studio.acquisition.synthetic.words import SuitOptions, read_words
from studio.core.body import PLACES, SEGMENT_OF
from studio.core.take import Assignment, Mark, Mounting

TRUTH_BLOCK = 4096  # frames computed at once
BATCH_TIME = 0.01  # s of arrivals handed over together in real time


class SyntheticDriver:
    """Opens the simulated suit; it is always there."""

    def find(self) -> list[Found]:
        """Return the walk, as an example of a script."""
        return [Found("synthetic:walk", "Simulated suit, walking")]

    async def open(self, words: str) -> "SyntheticLink":
        """Open ``[script][?name=value&…]``; SourceUnreadable when that makes no sense."""
        return SyntheticLink(read_words(words))


class SyntheticLink:
    """A performer with tags and the receiver's serial port; the clock begins when ``arrivals`` is first asked."""

    name = "synthetic"
    dialect = "receiver_frames"
    mounting: Mounting = "unknown"

    def __init__(self, options: SuitOptions, errors: ErrorTable | None = None) -> None:
        """``errors`` replaces the printed table, for tests."""
        self.options = options
        self.stature = options.stature
        self.paced = math.isfinite(options.speed)
        self.suit = Suit(options, errors)
        self._cues = list(WORN_SCRIPTS[options.script].cues) if options.script in WORN_SCRIPTS else []
        self._orders = OrderFrames()
        self._hellos_owed = 1
        self._base = math.nan
        self._closed = asyncio.Event()

    def assignment(self) -> Assignment:
        """Return where each sensor sits, as the performer believes."""
        return self.suit.assignment()

    async def arrivals(self) -> AsyncIterator[Sequence[Arrival | Known | Cue]]:
        """Yield what the receiver sends, paced by this computer's clock, until the link is closed."""
        if math.isnan(self._base):
            self._base = time.perf_counter() - self.options.ahead
        began, start = time.perf_counter(), self.suit.elapsed
        while not self._closed.is_set():
            heard = self.suit.next_block()
            for batch in self._batches(heard):
                due = began + (batch[-1].at - max(start, self.options.ahead)) / self.options.speed
                await self._wait_until(due)
                if self._closed.is_set():
                    return
                yield self._told(batch)

    async def send(self, data: bytes) -> None:
        """Take what the computer tells the receiver."""
        for order in self._orders.feed(data):
            # The mode and the channel of a simulated receiver are what they are.
            if isinstance(order, TagCommand):
                self.suit.obey(order)
        self._hellos_owed += self._orders.hellos_asked
        self._orders.hellos_asked = 0

    async def close(self) -> None:
        """End ``arrivals``."""
        self._closed.set()

    def truth_attachment(self) -> bytes:
        """Return the true motion up to now as a file for the judge."""
        frames = int(self.suit.elapsed / self.options.frame_s + 0.5)
        times = np.asarray(np.arange(frames) * self.options.frame_s, np.float64)
        measured = [int(SEGMENT_OF[place]) for place in PLACES]
        orientation, hips = np.empty((frames, len(PLACES), 4)), np.empty((frames, 3))
        for start in range(0, frames, TRUTH_BLOCK):
            rows = slice(start, start + TRUTH_BLOCK)
            pose, hips[rows] = self.suit.scene.true_pose(times[rows])
            orientation[rows] = pose[:, measured]
        return encode_truth(Truth(times + self._base, orientation, hips, self._facts()))

    def _batches(self, heard: list[Heard]) -> list[list[Heard]]:
        if not self.paced:
            return [heard]
        batches: list[list[Heard]] = []
        for one in heard:
            if batches and one.at - batches[-1][0].at < BATCH_TIME:
                batches[-1].append(one)
            else:
                batches.append([one])
        return batches

    async def _wait_until(self, due: float) -> None:
        pause = due - time.perf_counter()
        # Give way even when late or unpaced, so that others run and close() is heard.
        await asyncio.sleep(max(pause, 0.0))

    def _told(self, batch: list[Heard]) -> list[Arrival | Known | Cue]:
        told: list[Arrival | Known | Cue] = []
        for heard in batch:
            at = self._base + heard.at
            while self._hellos_owed:
                told.append(Arrival(at, self.suit.hello()))
                self._hellos_owed -= 1
            while self._cues and self._cues[0].end <= heard.at:
                mark = self._cues.pop(0)
                told.append(Cue(Mark(self._base + mark.time, mark.kind, mark.label, self._base + mark.end)))
            told.append(Arrival(at, heard.data))
        return told

    def _facts(self) -> dict[str, object]:
        suit, chips = self.suit, self.suit.chips
        worn = zip(suit.firmware.tags, worn_places(self.options), strict=True)
        tags = {
            f"{tag.serial:08x}": {
                "place": place.value,
                "segment_from_sensor": chips.segment_from_sensor[row].tolist(),
                "position_m": chips.position[row].tolist(),
            }
            for row, (tag, place) in enumerate(worn)
        }
        return {"script": self.options.script, "seed": self.options.seed, "stature_m": self.stature, "tags": tags}
