"""What became of each sensor's samples: the honest account of a take."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core.runs import longest_bridge
from studio.core.sample import NO_CORRECTION, Flag, SensorId, Stream
from studio.core.take import Take
from studio.core.track import flags_of, in_force

SKEW_SPAN = 5.0  # s; over less, the jitter of arrivals hides the clocks' difference


@dataclass(frozen=True)
class SensorLedger:
    """The account of one sensor."""

    sensor: SensorId
    label: str
    place: str | None
    samples: int
    lost: int
    """Frames that the counter says were sent and that never arrived."""
    gaps: int
    """Stretches of lost frames."""
    longest_gap_s: float
    """s, between the samples on both sides of the longest stretch; 0 when nothing is lost."""
    bridged_share: float
    """Lost frames among those that count as measured, 0…1: of stretches short enough to be bridged."""
    rate_hz: float
    """Samples per second that arrived."""
    clipped: int
    """Samples whose gyroscope or accelerometer was at its limit."""
    restarts: int
    battery: float
    """0…1, last known; NaN when never told."""
    clock_skew_ppm: float
    """The sensor's clock against this computer's; NaN when both are one, or the take is short."""
    calibration: str
    """What corrects the gyroscope: ``in the tag``, ``none``, ``unknown`` or the date of a stored calibration."""


def ledger(take: Take) -> tuple[SensorLedger, ...]:
    """Return the account of all sensors, in the order of the take."""
    return tuple(_account(take, stream) for stream in take.streams)


def missing_before(stream: Stream) -> NDArray[np.int64]:
    """Return how many frames were lost just before each sample, (n,); 0 where a sensor started anew."""
    order = np.lexsort((stream.frame, stream.epoch))  # samples may arrive out of order
    steps = np.diff(stream.frame[order]) - 1
    steps[np.diff(stream.epoch[order]) != 0] = 0
    missing = np.zeros(len(stream), np.int64)
    missing[order[1:]] = np.maximum(steps, 0)
    return missing


def _account(take: Take, stream: Stream) -> SensorLedger:
    missing = missing_before(stream)
    place = take.setup.assignment.place_of(stream.info.sensor)
    span = float(stream.time.max() - stream.time.min()) if len(stream) else 0.0
    known = stream.battery[np.isfinite(stream.battery)]
    return SensorLedger(
        sensor=stream.info.sensor,
        label=stream.info.label,
        place=place.value if place else None,
        samples=len(stream),
        lost=int(missing.sum()),
        gaps=int((missing > 0).sum()),
        longest_gap_s=_longest_gap(stream, missing),
        bridged_share=_bridged_share(stream, missing),
        rate_hz=(len(stream) - 1) / span if span > 0 else 0.0,
        clipped=int((stream.flags & Flag.CLIPPED > 0).sum()),
        restarts=int(stream.epoch.max() - stream.epoch.min()) if len(stream) else 0,
        battery=float(known[-1]) if len(known) else math.nan,
        clock_skew_ppm=_skew(stream, span),
        calibration=_calibration(take, stream),
    )


def _longest_gap(stream: Stream, missing: NDArray[np.int64]) -> float:
    if not missing.any():
        return 0.0
    order = np.lexsort((stream.frame, stream.epoch))
    across = np.diff(stream.time[order])[missing[order[1:]] > 0]
    return float(across.max())


def _bridged_share(stream: Stream, missing: NDArray[np.int64]) -> float:
    short = (missing + 1) * stream.info.frame_s <= longest_bridge(stream.info.frame_s)
    bridged = int(missing[short].sum())
    return bridged / max(bridged + len(stream), 1)


def _skew(stream: Stream, span: float) -> float:
    """Return the slope of arrival against the sensor's clock, less one, in ppm; over the last epoch."""
    rows = stream.epoch == stream.epoch.max() if len(stream) else np.array([], bool)
    device, received = stream.device_time[rows], stream.received[rows]
    if span < SKEW_SPAN or len(device) < 2 or np.ptp(device) < SKEW_SPAN:
        return math.nan
    offset = device - device[0]
    if np.allclose(received - received[0], offset, rtol=0, atol=1e-9):
        return math.nan
    # The lower envelope: arrivals are late by chance, never early.
    blocks = np.array_split(np.arange(len(offset)), min(50, len(offset) // 10 or 1))
    delay = received - received[0] - offset
    lowest = np.array([block[np.argmin(delay[block])] for block in blocks])
    at, late = offset[lowest] - offset[lowest].mean(), delay[lowest] - delay[lowest].mean()
    spread = float(at @ at)
    return float(at @ late) / spread * 1e6 if spread > 0 else math.nan


def _calibration(take: Take, stream: Stream) -> str:
    stored = [c for c in take.setup.calibrations if c.sensor == stream.info.sensor]
    if stored and in_force(stream.info, flags_of(stream), stored[-1]) is not None:
        return stored[-1].date
    if stream.info.orientation != "integrated":
        return "unknown"
    if stream.info.correction is None:
        calibrated = len(stream) and bool(np.bitwise_and.reduce(stream.flags) & Flag.CALIBRATED)
        return "in the tag" if calibrated else "unknown"
    return "none" if stream.info.correction == NO_CORRECTION else "in the tag"
