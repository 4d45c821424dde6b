"""What every attitude estimator offers."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.core.runs import Run


class Estimator(Protocol):
    """Attitude of one sensor through one run, z up, heading free.

    ``step`` and ``run`` differ only in that ``run`` may look ahead.
    """

    def step(
        self, increment: NDArray[np.float64], acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Advance by one frame.

        Parameters
        ----------
        increment : (3,), rad, sensor axes
            Rotation since the frame before.
        acceleration : (3,), m/s², sensor axes
            NaN when this frame carries none.
        orientation : (4,)
            What the device said; NaN when it says nothing.

        Returns
        -------
        (4,), world_from_sensor
        """

    def forget_offset(self, offset_sigma: float) -> None:
        """Go on from here with a gyroscope that is corrected anew, its offset known to ``offset_sigma`` rad/s."""

    def learned_offset(self) -> tuple[NDArray[np.float64], float] | None:
        """Return what ``step`` has found to be offset, (3,), rad/s, and its sigma; None when it looks for none."""

    def run(self, run: Run) -> NDArray[np.float64]:
        """Return ``world_from_sensor`` (n, 4) for a whole run."""


class EstimatorFactory(Protocol):
    """Makes an estimator for one sensor."""

    def __call__(self, frame_s: float, offset_sigma: float) -> Estimator:
        """Return a fresh estimator."""
