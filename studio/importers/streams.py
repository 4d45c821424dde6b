"""From the columns of several sensors on one clock to the streams of a take."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.sample import SensorInfo, Stream


@dataclass(frozen=True)
class Measured:
    """What one sensor measured, in the order of time, in SI units and sensor axes."""

    info: SensorInfo
    frame: NDArray[np.int64]
    device_time: NDArray[np.float64]
    """(n,), s, on the clock all sensors of the recording share."""
    orientation: NDArray[np.float64]
    """(n, 4), as ``info.orientation`` says."""
    rate: NDArray[np.float64]
    """(n, 3), rad/s."""
    acceleration: NDArray[np.float64]
    """(n, 3), m/s²."""
    battery: NDArray[np.float64]
    """(n,), 0…1."""
    temperature: NDArray[np.float64]
    """(n,), °C."""


def line_up(sensors: Sequence[Measured]) -> tuple[Stream, ...]:
    """Return the streams on one take time, whose 0 is the earliest sample.

    Files do not tell when a sample arrived: each counts as received when it was measured.
    """
    start = min(float(sensor.device_time[0]) for sensor in sensors)
    times = [sensor.device_time - start for sensor in sensors]
    # Ties go to the sensor named first, so that the same files always give the same take.
    order = np.argsort(np.concatenate(times), kind="stable")
    arrival = np.empty(len(order), np.int64)
    arrival[order] = np.arange(len(order))
    ends = np.cumsum([len(time) for time in times])
    return tuple(
        Stream(
            info=sensor.info,
            arrival=arrival[end - len(time) : end],
            epoch=np.zeros(len(time), np.int32),
            frame=sensor.frame,
            device_time=sensor.device_time,
            time=time,
            received=time.copy(),
            orientation=sensor.orientation,
            rate=sensor.rate,
            acceleration=sensor.acceleration,
            flags=np.zeros(len(time), np.uint32),
            battery=sensor.battery,
            temperature=sensor.temperature,
            rssi=np.full(len(time), np.nan),
        )
        for sensor, time, end in zip(sensors, times, ends, strict=True)
    )
