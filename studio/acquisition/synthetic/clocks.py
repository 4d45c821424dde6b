"""When each tag samples, and what its clock and the receiver's show then."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.dialects.tag_advert import TRAITS

Array = NDArray[np.float64]

GRID_SLACK = 1e-6  # of a frame; an instant at the very end of a block belongs to the next
MICROSECONDS_PER_TICK = 64  # of the wire's clock


class Instants(NamedTuple):
    """The samples of all tags in some span of time, one entry each, in the order of time."""

    tag: NDArray[np.int64]
    frame: NDArray[np.int64]
    """Counted from switching on."""
    time: Array
    """s since switching on."""


class Clocks:
    """The clocks of t tags: the receiver's when it is followed, else each its own with its own skew."""

    def __init__(self, tags: int, frame_s: float, skew_ppm: float, generator: np.random.Generator) -> None:
        self.synchronised = skew_ppm == 0.0
        self.skew = generator.uniform(-1.0, 1.0, tags) * skew_ppm * 1e-6
        """(t,), how much faster each clock runs than true time."""
        self._receiver_start = int(generator.integers(0, 1 << 32))
        self._start = np.full(tags, float(self._receiver_start))
        self._period = frame_s / (1.0 + self.skew)
        self._phase = np.zeros(tags)
        if not self.synchronised:
            self._start = generator.uniform(0.0, float(1 << 32), tags)
            self._phase = generator.uniform(0.0, frame_s, tags)

    def instants(self, begin: float, end: float) -> Instants:
        """Return all samples with begin <= time < end, s."""
        tags, frames, times = [], [], []
        for tag, (phase, period) in enumerate(zip(self._phase, self._period, strict=True)):
            first, last = (int(np.ceil((edge - phase) / period - GRID_SLACK)) for edge in (begin, end))
            frame = np.arange(max(first, 0), last)
            tags.append(np.full(len(frame), tag))
            frames.append(frame)
            times.append(phase + frame * period)
        tag_of, frame_of, time_of = np.concatenate(tags), np.concatenate(frames), np.concatenate(times)
        order = np.lexsort((tag_of, time_of))
        return Instants(tag_of[order], frame_of[order], time_of[order])

    def first_frame(self, tag: int, time: float) -> int:
        """Return a tag's first frame at or after ``time``, s."""
        return int(np.ceil((time - self._phase[tag]) / self._period[tag] - GRID_SLACK))

    def shown(self, instants: Instants) -> NDArray[np.int64]:
        """Return what the tags write into their packets: ticks of 64 µs that wrap."""
        tag = instants.tag
        microseconds = self._start[tag] + (1.0 + self.skew[tag]) * instants.time * 1e6
        # Rounded first: a clock that follows the receiver's stands at whole microseconds when it samples.
        whole = np.floor(microseconds + 0.5).astype(np.int64)
        return np.asarray(whole // MICROSECONDS_PER_TICK % TRAITS.clock_modulus)

    def restart(self, tag: int, time: float) -> None:
        """Let a tag that was switched on at ``time`` (s) begin at 0, unless it finds the receiver's clock again."""
        if not self.synchronised:
            self._start[tag] = -(1.0 + self.skew[tag]) * time * 1e6

    def receiver(self, time: float) -> int:
        """Return the receiver's clock at ``time`` (s), µs, not wrapped."""
        return self._receiver_start + round(time * 1e6)
