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


LARGE_SIGMA = 0.5  # °/s; an offset known no better is estimated in a pass of its own before looking back


class Vqf6D:
    """Gyroscope and accelerometer; tilt bounded by gravity, heading only by the offset's quality."""

    def __init__(self, frame_s: float, offset_sigma: float) -> None:
        """Begin before the first frame.

        Parameters
        ----------
        frame_s : s, from one step to the next
        offset_sigma : rad/s, standard uncertainty of what is left of the gyroscope's offset
        """
        self._frame_s = frame_s
        self._sigma = max(math.degrees(offset_sigma), SMALLEST_SIGMA)
        self._filter = self._fresh()
        self._levelled = False
        self._rate = np.zeros(3)

    def step(
        self, increment: NDArray[np.float64], acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Advance by one frame; a frame without accelerometer turns by the gyroscope alone."""
        np.divide(increment, self._frame_s, out=self._rate)
        if not math.isfinite(acceleration[0]):
            self._filter.updateGyr(self._rate)
        elif self._levelled:
            self._filter.update(self._rate, acceleration)
        else:
            _level(self._filter, self._rate, acceleration)
            self._levelled = True
        return np.asarray(self._filter.getQuat6D())

    def forget_offset(self, offset_sigma: float) -> None:
        """Go on from here: nothing is left to subtract, and that is known to ``offset_sigma`` rad/s."""
        self._filter.setBiasEstimate(np.zeros(3), offset_sigma)

    def learned_offset(self) -> tuple[NDArray[np.float64], float] | None:
        """Return the offset found so far, rad/s, and its sigma."""
        offset, sigma = self._filter.getBiasEstimate()
        return np.asarray(offset), float(sigma)

    def run(self, run: Run) -> NDArray[np.float64]:
        """Return the acausal estimate: forward and backward through the run."""
        rate = run.increments / self._frame_s
        rate[0] = rate[min(1, len(rate) - 1)]
        # A reading of zero is no reading to this library: the gyroscope alone leads across silences.
        force = np.nan_to_num(np.ascontiguousarray(run.acceleration))
        sigma = self._sigma
        if sigma > LARGE_SIGMA:
            forward = self._fresh()
            _level(forward, rate[0], force[0])
            forward.updateBatch(rate, force)
            offset, sigma = forward.getBiasEstimate()
            rate, sigma = rate - offset, max(math.degrees(sigma), SMALLEST_SIGMA)
        return np.asarray(vqf.offlineVQF(rate, force, None, self._frame_s, self._parameters(sigma))["quat6D"])

    def _fresh(self) -> "vqf.VQF":
        return vqf.VQF(self._frame_s, **self._parameters(self._sigma))

    def _parameters(self, sigma: float) -> dict[str, float]:
        return {
            "biasClip": BIAS_CLIP,
            "biasSigmaInit": sigma,
            "restThGyr": REST_RATE,
            "restThAcc": REST_ACCELERATION,
        }


def _level(fresh: "vqf.VQF", rate: NDArray[np.float64], force: NDArray[np.float64]) -> None:
    """Give a filter its first tilt; vqf 2.1 would take that first correction for 20 °/s of offset."""
    fresh.setMotionBiasEstEnabled(False)
    fresh.update(rate, force)
    fresh.setMotionBiasEstEnabled(True)
