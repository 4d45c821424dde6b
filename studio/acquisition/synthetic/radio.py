"""The air between tags and receiver: what is lost, and how loud the rest is."""

import numpy as np
from numpy.typing import NDArray

RSSI_RANGE = (-72.0, -48.0)  # dBm, a body's width to a room's
FADING = 2.0  # dB, SD from packet to packet


class Air:
    """Random loss, or outages after Gilbert and Elliott: a good state passes all packets and a bad one none."""

    def __init__(self, tags: int, loss: float, burst: float, generator: np.random.Generator) -> None:
        self._generator = generator
        self._loss = loss
        self._ends = 1.0 / burst if burst else 1.0
        self._begins = loss / (burst * (1.0 - loss)) if burst else loss
        self._bursts = bool(burst)
        self._bad = generator.random(tags) < loss
        self.level = generator.uniform(*RSSI_RANGE, tags)
        """(t,), dBm."""

    def passes(self, frames: int) -> NDArray[np.bool_]:
        """Return which packets of the next frames arrive, (frames, t)."""
        chance = self._generator.random((frames, len(self._bad)))
        if not self._bursts:
            return np.asarray(chance >= self._loss)
        heard = np.empty(chance.shape, np.bool_)
        for row, drawn in enumerate(chance):
            heard[row] = ~self._bad
            self._bad = np.where(self._bad, drawn >= self._ends, drawn < self._begins)
        return heard

    def strengths(self, packets: NDArray[np.int64]) -> list[float]:
        """Return the RSSI of packets of these tags, dBm."""
        strength: list[float] = (self.level[packets] + self._generator.normal(size=len(packets)) * FADING).tolist()
        return strength
