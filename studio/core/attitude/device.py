"""The device's own orientation, as it was sent."""

import numpy as np
from numpy.typing import NDArray

from studio.core.runs import Run


class DeviceOrientation:
    """A filter on the device (x-IMU3, DOT, BNO055, DMP) is taken at its word."""

    def __init__(self, frame_s: float, offset_sigma: float) -> None:
        """Begin before the first frame.

        Parameters
        ----------
        frame_s : s, from one step to the next
        offset_sigma : rad/s, standard uncertainty of what is left of the gyroscope's offset; the device has its own
        """
        self._last = np.array([1.0, 0.0, 0.0, 0.0])

    def step(
        self, increment: NDArray[np.float64], acceleration: NDArray[np.float64], orientation: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return what the device said last."""
        if np.isfinite(orientation).all():
            self._last = orientation
        return self._last

    def forget_offset(self, offset_sigma: float) -> None:
        """Go on: the device estimates its offset by itself."""

    def learned_offset(self) -> None:
        """Return None: the device keeps its offset to itself."""

    def run(self, run: Run) -> NDArray[np.float64]:
        """Return the orientations of the run, bridged where frames are missing."""
        return run.orientation
