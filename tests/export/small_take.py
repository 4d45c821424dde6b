"""A take of two sensors and a second, enough to see every column."""

import numpy as np

from studio.core import rotation
from studio.core.body import Place
from studio.core.sample import NO_CORRECTION, SensorId, SensorInfo, Stream
from studio.core.take import Assignment, Calibration, Setup, Take

LEFT, RIGHT = SensorId("tag:1a2b"), SensorId("tag:3c4d")
FORMULA_SENSOR = SensorId('=HYPERLINK("x")')


def stream_of(sensor, frames, epochs, first_arrival=0, every=1):
    """Return a stream whose numbers tell its rows apart; temperature and RSSI are unknown."""
    frame, epoch = np.array(frames, np.int64), np.array(epochs, np.int32)
    count = len(frame)
    time = (frame - min(frames, default=0)) * 0.02
    row = np.arange(count, dtype=np.float64)[:, None]
    return Stream(
        info=SensorInfo(sensor, 0.02, label="Ä", correction=NO_CORRECTION),
        arrival=first_arrival + every * np.arange(count),
        epoch=epoch,
        frame=frame,
        device_time=100 + time,
        time=time,
        received=time + 0.005,
        orientation=rotation.about(2, time),
        rate=row * [0.01, 0.02, 0.03] - 0.1,
        acceleration=row * [0.1, 0.2, 0.3] + [0, 0, 9.81],
        flags=np.full(count, 65, np.uint32),
        battery=np.full(count, 0.75),
        temperature=np.full(count, np.nan),
        rssi=np.full(count, np.nan),
    )


def small_take():
    """Return a take with a thigh sensor that lost three frames and one that is not worn."""
    left = [*range(20), *range(23, 50)]
    return Take(
        name="walk",
        person="P014",
        source="synthetic:walk",
        started="2025-01-01T10:00:00Z",
        streams=(
            stream_of(LEFT, left, [0] * 47, 0, 2),
            stream_of(RIGHT, range(50), [0] * 50, 1, 2),
        ),
        setup=Setup(
            assignment=Assignment({Place.LEFT_THIGH: LEFT}),
            calibrations=(Calibration(LEFT, NO_CORRECTION, "2024-12-01", "whole turns", gain_sigma=0.001),),
        ),
    )
