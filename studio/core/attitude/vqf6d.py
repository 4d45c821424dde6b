"""VQF without magnetometer (Laidig & Seel 2023): the default."""

import math

import numpy as np
import vqf
from numpy.typing import NDArray

from studio.core.runs import Run

# The library's defaults (2 °/s) make a raw MPU-6050 (±20 °/s) drift by 90-470° in 30 s at rest, silently.
BIAS_CLIP = 25.0  # °/s
# A standing person passes the library's rest test (2 °/s) while swaying, and sway would be taken for offset.
REST_RATE = 0.5  # °/s, deviation from the low-passed rate
REST_ACCELERATION = 0.3  # m/s²
SMALLEST_SIGMA = 0.01  # °/s; nothing cheap keeps its offset better than that


class Vqf6D:
    """Gyroscope and accelerometer; tilt bounded by gravity, heading only by the offset's quality."""

    def __init__(self, frame_s: float, offset_sigma: float) -> None:
        self._frame_s = frame_s
        self._parameters = {
            "biasClip": BIAS_CLIP,
            "biasSigmaInit": max(math.degrees(offset_sigma), SMALLEST_SIGMA),
            "restThGyr": REST_RATE,
            "restThAcc": REST_ACCELERATION,
        }
        self._filter = vqf.VQF(frame_s, **self._parameters)
        self._rate = np.zeros(3)

    def step(
        self, increment: NDArray[np.float64], acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Advance by one frame; a frame without accelerometer turns by the gyroscope alone."""
        np.divide(increment, self._frame_s, out=self._rate)
        if math.isfinite(acceleration[0]):
            self._filter.update(self._rate, acceleration)
        else:
            self._filter.updateGyr(self._rate)
        return np.asarray(self._filter.getQuat6D())

    def run(self, run: Run) -> NDArray[np.float64]:
        """Return the acausal estimate: forward and backward through the run."""
        rate = run.increments / self._frame_s
        if len(rate) > 1:
            rate[0] = rate[1]
        result = vqf.offlineVQF(rate, np.ascontiguousarray(run.acceleration), None, self._frame_s, self._parameters)
        return np.asarray(result["quat6D"])
