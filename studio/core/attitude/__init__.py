"""Attitude estimators: from turning and specific force to ``world_from_sensor``, each in its own file."""

from importlib import import_module
from typing import cast

from studio.core.attitude.estimator import Estimator, EstimatorFactory

ESTIMATORS: dict[str, str] = {
    "vqf": "studio.core.attitude.vqf6d:Vqf6D",
    "gyro": "studio.core.attitude.gyro_only:GyroOnly",
    "device": "studio.core.attitude.device:DeviceOrientation",
}
"""Name to ``module:class``; imported when chosen."""


def open_estimator(name: str, frame_s: float, offset_sigma: float) -> Estimator:
    """Return a fresh estimator for one sensor.

    Parameters
    ----------
    name : str
        Key of ``ESTIMATORS``.
    frame_s : float, s
    offset_sigma : float, rad/s
        How well the gyroscope's offset is known already.
    """
    module, _, attribute = ESTIMATORS[name].partition(":")
    factory = cast(EstimatorFactory, getattr(import_module(module), attribute))
    return factory(frame_s, offset_sigma)
