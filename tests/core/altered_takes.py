"""What happens to sensors: they start anew, fall silent, or send something else. Takes of ``worn_sensors``, altered."""

from dataclasses import replace

import numpy as np

from studio.core import rotation
from studio.core.sample import NO_CORRECTION
from studio.core.take import Calibration, Take
from tests.core.worn_sensors import RATE, sensor_of


def changed(take: Take, place, change) -> Take:
    """Return the take with one sensor's stream replaced by ``change(stream)``."""
    return replace(take, streams=tuple(change(s) if s.info.sensor == sensor_of(place) else s for s in take.streams))


def kept(stream, rows):
    """Return a stream of some rows."""
    return replace(stream, **{name: getattr(stream, name)[rows] for name in stream.__slots__ if name != "info"})


def silent(take: Take, place, from_s, to_s) -> Take:
    """Return the take without what a sensor sent between two times."""
    return changed(take, place, lambda s: kept(s, (s.time < from_s) | (s.time >= to_s)))


def restarted(take: Take, place, at) -> Take:
    """Return the take with a tag that starts anew: its orientation is the identity then, and its heading another."""

    def restart(stream):
        row = int(np.searchsorted(stream.time, at))
        orientation, epoch = stream.orientation.copy(), stream.epoch.copy()
        orientation[row:] = rotation.multiply(rotation.inverse(stream.orientation[row]), orientation[row:])
        epoch[row:] += 1
        return replace(stream, orientation=orientation, epoch=epoch)

    return changed(take, place, restart)


def cut(take: Take, from_s) -> Take:
    """Return what a recording that began later would hold; its time 0 is then."""
    streams = []
    for stream in take.streams:
        part = kept(stream, stream.time >= from_s - 0.5 / RATE)
        streams.append(replace(part, time=part.time - from_s, received=part.received - from_s))
    return replace(take, streams=tuple(streams), marks=())


def rested(take: Take) -> Take:
    """Return the take of tags whose offsets were measured on a table: none is left, to 0.03 °/s."""
    known = tuple(
        Calibration(sensor, NO_CORRECTION, "", "rest", (np.radians(0.03),) * 3)
        for sensor in take.setup.assignment.sensors.values()
    )
    return replace(take, setup=replace(take.setup, calibrations=known))
