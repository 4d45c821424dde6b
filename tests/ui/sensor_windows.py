"""Windows of sensors whose motion is known."""

from dataclasses import replace

import numpy as np

from studio.acquisition.health import HealthSnapshot
from studio.capture.live_buffer import Window
from studio.core import rotation
from studio.core.sample import NAN, SensorId, SensorInfo


def sensor(number):
    return SensorId(f"tag:{number:08x}")


def info(number, **known):
    return replace(SensorInfo(sensor(number), 0.02, f"tag {number:02d}", number), **known)


def health(number, **known):
    facts = {
        "received": 1000, "lost": 0, "malformed": 0, "duplicates": 0, "late": 0, "clipped": 0, "reboots": 0,
        "rate": 50.0, "jitter": 0.0, "battery": NAN, "temperature": NAN, "rssi": NAN, "silent_for": 0.02,
        "offset": 0.0, "skew": 0.0, **known,
    }  # fmt: skip
    return HealthSnapshot(sensor=sensor(number), **facts)


def window(until, seconds=11.0, rate=0.0, missing=(), clipped=(), turned=(0.0, 0.0, 0.0)):
    """Return 50 Hz until a moment: ``rate`` °/s to and fro about x, tilted by ``turned`` (°), lying otherwise.

    ``missing`` are frames that were lost, ``clipped`` those at the end of the range, from the window's beginning.
    """
    frames = np.arange(round(seconds * 50))
    time = until - seconds + (frames + 1) / 50
    kept = ~np.isin(frames, missing)
    turning = np.zeros((len(frames), 3))
    turning[:, 0] = np.radians(rate) * np.sin(2 * np.pi * 1.3 * time)
    world_from_sensor = rotation.from_rotation_vector(np.radians(np.array(turned)))
    force = rotation.rotate(rotation.inverse(world_from_sensor), np.array([0.0, 0.0, 9.81]))
    lost = np.zeros(len(frames), np.int64)
    lost[kept] = np.diff(frames[kept], prepend=frames[kept][:1] - 1) - 1
    lost[np.flatnonzero(kept)[0]] = 0
    return Window(
        time[kept],
        np.tile(world_from_sensor, (int(kept.sum()), 1)),
        turning[kept],
        np.tile(force, (int(kept.sum()), 1)),
        lost[kept],
        np.isin(frames, clipped)[kept],
        np.zeros(int(kept.sum()), np.int64),
    )
