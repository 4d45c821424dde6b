"""One sensor, and a whole body, while a pose is held."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Place
from studio.core.errors import PoseTooShort
from studio.core.frames import UP
from studio.core.take import Mark
from studio.core.track import SensorTrack

STILLEST = 1.0  # s of the hold that decide
SWAY_RANGE = math.radians(1.5)  # around the stillest second; a standing person sways with an SD of 0.5°
LARGEST_DEVIATION = math.radians(3.0)  # from the mean during that second
LARGEST_SPEED = math.radians(10.0)  # rad/s, root mean square during that second


@dataclass(frozen=True)
class Hold:
    """One sensor while a pose was held."""

    attitude: NDArray[np.float64]
    """(4,), world_from_sensor, Markley's mean over the stillest second."""
    device: NDArray[np.float64]
    """(4,), what the device said meanwhile; NaN when nothing."""
    spread: float
    """rad, root mean square deviation from the mean."""
    largest: float
    """rad, largest deviation from the mean."""
    speed: float
    """rad/s, root mean square."""
    group: int
    """Heading group of the track."""
    levelled: bool
    """False: nothing told of gravity meanwhile, so that world z need not point up."""

    def is_still(self) -> bool:
        """Return whether the limb moved so little that the hold can be used."""
        return self.largest <= LARGEST_DEVIATION and self.speed <= LARGEST_SPEED

    def up(self) -> NDArray[np.float64]:
        """Return the upward direction (3,) in sensor axes."""
        return rotation.rotate(rotation.inverse(self.attitude), UP)


def hold_all(
    worn: Mapping[Place, SensorTrack], mark: Mark, take_s: float, *, required: bool = True
) -> dict[Place, Hold]:
    """Return each place's hold over the second in which the whole body was stillest."""
    start = stillest_second(list(worn.values()), mark)
    holds: dict[Place, Hold] = {}
    for place, track in worn.items():
        rows = track.rows(start, min(start + STILLEST, max(mark.end, mark.time)))
        if len(rows) == 0 and mark.end - mark.time < STILLEST:
            rows = _nearest(track, mark.time)
        if len(rows) == 0 or len(set(track.group[rows].tolist())) != 1:
            continue
        whole = track.rows(mark.time, max(mark.end, mark.time))
        holds[place] = _hold(track, rows, whole[track.group[whole] == track.group[rows[0]]])
    if required and not holds:
        raise PoseTooShort(mark.label, mark.time, mark.end, take_s)
    return holds


def _nearest(track: SensorTrack, time: float) -> NDArray[np.intp]:
    """Return the one frame next to an instant: a pose given as a single moment."""
    if len(track.time) == 0:
        return np.array([], np.intp)
    row = int(np.argmin(np.abs(track.time - time)))
    near = abs(track.time[row] - time) <= 2 * track.info.frame_s
    return np.array([row] if near else [], np.intp)


def stillest_second(tracks: Sequence[SensorTrack], mark: Mark) -> float:
    """Return the start of the second of a hold in which all sensors together turned least, s."""
    latest = mark.end - STILLEST
    if not latest > mark.time:
        return mark.time
    starts = np.linspace(mark.time, latest, max(2, round((latest - mark.time) / 0.1) + 1))
    cost = np.zeros(len(starts))
    for track in tracks:
        energy = np.concatenate([[0.0], np.cumsum(track.speed**2)])
        a, b = np.searchsorted(track.time, starts), np.searchsorted(track.time, starts + STILLEST)
        cost += (energy[b] - energy[a]) / np.maximum(b - a, 1)
    return float(starts[int(np.argmin(cost))])


def _hold(track: SensorTrack, still: NDArray[np.intp], whole: NDArray[np.intp]) -> Hold:
    """Return one sensor's hold: the stillest second decides, and what agrees with it is averaged in."""
    centre = rotation.mean(track.attitude[still])
    deviation = rotation.angle_between(centre, track.attitude[still])
    # Sway wanders within a second; three seconds of it average to half (biomechanics-and-formats §3).
    agreeing = whole[rotation.angle_between(centre, track.attitude[whole]) <= SWAY_RANGE]
    rows = agreeing if len(agreeing) > len(still) else still
    attitude = rotation.mean(track.attitude[rows])
    device = track.device[rows]
    known = np.isfinite(device).all(axis=1)
    return Hold(
        attitude=attitude,
        device=rotation.mean(device[known]) if known.any() else np.full(4, np.nan),
        spread=float(np.sqrt(np.mean(rotation.angle_between(attitude, track.attitude[rows]) ** 2))),
        largest=float(deviation.max()),
        speed=float(np.sqrt(np.mean(track.speed[still] ** 2))) if len(still) > 1 else 0.0,
        group=int(track.group[still[0]]),
        levelled=bool(track.levelled[rows].any()),
    )
