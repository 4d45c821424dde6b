"""Which tag is being moved by hand: shake one, and its line lights up."""

from collections.abc import Mapping

import numpy as np

from studio.capture.live_buffer import Window
from studio.core.sample import SensorId

LATEST = 0.5  # s that speak of now
SHAKEN = 60.0  # °/s; a hand that shows a tag turns it faster, a person who stands does not
FAR_ABOVE = 4.0  # times the next: when somebody walks, many are fast and none is meant


def speed_of(window: Window) -> float:
    """Return how fast a sensor turns now, °/s, whatever its offset; 0 when it does not tell."""
    if len(window.time) == 0:
        return 0.0
    latest = window.rate[window.time > window.time[-1] - LATEST]
    latest = latest[np.isfinite(latest).all(axis=1)]
    if len(latest) < 2:
        return 0.0
    return float(np.degrees(np.linalg.norm(latest.std(axis=0))))


def shaken(speeds: Mapping[SensorId, float]) -> SensorId | None:
    """Return the one sensor that moves far more than all others."""
    if not speeds:
        return None
    order = sorted(speeds, key=speeds.__getitem__, reverse=True)
    fastest = speeds[order[0]]
    following = speeds[order[1]] if len(order) > 1 else 0.0
    return order[0] if fastest >= SHAKEN and fastest >= FAR_ABOVE * following else None
