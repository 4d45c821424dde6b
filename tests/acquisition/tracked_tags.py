"""Tags as the radio hears them, and what a tracker makes of it: for the tests of the tracker."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from studio.acquisition.dialects import tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.tracker import LinkTracker
from studio.core.sample import Sample, SensorId

SENSOR = tag_advert.sensor_of(0x12345678)
TICK, CLOCKS = tag_advert.TRAITS.clock_tick, tag_advert.TRAITS.clock_modulus
ROWS = ((0.01, 0.02, -0.03), (1.02, 0.0, 0.0), (0.01, 0.98, 0.0), (0.0, 0.0, 1.01))


@dataclass(frozen=True)
class Tag:
    """A tag as the radio hears it."""

    sensor: SensorId = SENSOR
    number: int = 3
    frame_s: float = 0.02
    powered: float = 100.0
    """s on this computer's clock when its counter was 0."""
    clock: float = 0.0
    """s its clock shows at that moment."""
    skew_ppm: float = 0.0
    flags: int = 0
    delay: float = 0.003
    """s from measuring to arriving."""

    def reading(self, frame: int, **other: Any) -> Reading:
        stamp = self.clock + frame * self.frame_s * (1 + self.skew_ppm * 1e-6)
        clock = int(stamp / TICK) % CLOCKS
        fields: dict[str, Any] = {
            "orientation": (1.0, 0.0, 0.0, 0.0),
            "rate": (0.1, 0.2, 0.3),
            "acceleration": (0.0, 0.0, 9.8),
        }
        fields |= other
        return Reading(
            self.sensor,
            self.number,
            frame % 256,
            clock,
            fields["orientation"],
            fields["rate"],
            fields["acceleration"],
            self.flags,
            0.75,
            fields.get("temperature", float("nan")),
            -60.0,
            fields.get("facts"),
        )

    def measured(self, frame: int) -> float:
        """Return when a frame was measured, s on this computer's clock."""
        return self.powered + frame * self.frame_s

    def heard(self, frames: Iterable[int]) -> Iterator[tuple[Reading, float]]:
        for frame in frames:
            yield self.reading(frame), self.measured(frame) + self.delay


def link() -> LinkTracker:
    return LinkTracker("receiver", tag_advert.TRAITS)


def samples(tracker: LinkTracker, heard: Iterable[tuple[Reading, float]]) -> list[Sample]:
    accepted = (tracker.accept(reading, received) for reading, received in heard)
    return [sample for sample in accepted if sample is not None]


def frames(found: list[Sample]) -> list[int]:
    return [sample.frame for sample in found]


def kinds(tracker: LinkTracker) -> list[str]:
    return [kind for kind, _ in tracker.take_events()]


def bursty(n: int, loss: float, seed: int, mean_burst: float = 8.0) -> list[int]:
    """Return the frames of ``n`` that a channel with bursts of loss lets through (Gilbert)."""
    rng = np.random.default_rng(seed)
    leave, enter = 1 / mean_burst, loss / (1 - loss) / mean_burst
    bad, kept = False, []
    for frame, draw in enumerate(rng.random(n).tolist()):
        bad = draw >= leave if bad else draw < enter
        if not bad:
            kept.append(frame)
    return kept
