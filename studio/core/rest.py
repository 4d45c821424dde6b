"""Finding stillness, and the gyroscope's offset in it with its uncertainty (paper 003, §2.5; GUM type A)."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

BLOCK = 0.25  # s; wire quaternions are resolved to 0.003°, so one block resolves 0.02 °/s
WINDOW = 8  # blocks: 2 s, the shortest rest worth averaging
RATE_SPREAD_TABLE = math.radians(0.3)  # rad/s, SD of block means: a tag on a table stays below 0.05 °/s
RATE_SPREAD_WORN = math.radians(3.0)  # rad/s: a standing person sways at 0.5 to 1.5 °/s
ACCELERATION_SPREAD = 0.4  # m/s², SD of block means; turning by 2.5° changes gravity by as much
RESOLUTION = math.radians(0.005)  # rad/s; a mean of 0.003° quaternions over a few seconds cannot be surer
SWAY = 3.0  # simulated sway (0.3-2 s of correlation, 2 to 10 s of standing): two sigma then cover 95 %
LARGEST_OFFSET = math.radians(25.0)  # rad/s; data sheet of the MPU-6050: ±20 °/s, and warmth on top


@dataclass(frozen=True, slots=True)
class Rest:
    """A stretch in which a sensor did not turn, and what its gyroscope said meanwhile."""

    first: int
    """First sample of the stretch."""
    last: int
    """Sample after the last one."""
    offset: NDArray[np.float64]
    """(3,), rad/s, sensor axes: mean reading."""
    sigma: NDArray[np.float64]
    """(3,), rad/s, standard uncertainty of the mean: type A over block means; worn, sway besides."""


def find_rest(
    rate: NDArray[np.float64], acceleration: NDArray[np.float64], frame_s: float, spread: float = RATE_SPREAD_TABLE
) -> Rest | None:
    """Return the stretch of at least 2 s that fixes the offset best, None when nothing is still.

    Parameters
    ----------
    rate : (n, 3), rad/s, sensor axes
    acceleration : (n, 3), m/s², sensor axes
        Rows of NaN do not count.
    frame_s : float, s
    spread : float, rad/s
        Largest standard deviation of the 0.25 s means that still counts as rest.
    """
    size = max(1, round(BLOCK / frame_s))
    blocks = len(rate) // size
    if blocks < WINDOW:
        return None
    means = rate[: blocks * size].reshape(blocks, size, 3).mean(axis=1)
    forces = _fill_gaps(acceleration[: blocks * size].reshape(blocks, size, 3))
    still = _still_windows(means, spread) & _still_windows(forces, ACCELERATION_SPREAD)
    best: Rest | None = None
    for start, stop in _stretches(still):
        inside = means[start : stop + WINDOW - 1]
        offset = inside.mean(axis=0)
        sigma = inside.std(axis=0, ddof=1) / math.sqrt(len(inside))
        if spread > RATE_SPREAD_TABLE:
            sigma = np.hypot(sigma, _sway_sigma(inside - offset))
        if np.abs(offset).max() > LARGEST_OFFSET:
            continue
        if best is None or sigma.max() < best.sigma.max():
            best = Rest(start * size, (stop + WINDOW - 1) * size, offset, sigma)
    return best


def _sway_sigma(deviation: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what swaying about a place adds to the uncertainty of a mean rate, (3,), rad/s.

    Whoever stands comes back to where they were, so that the mean rate is off by the way between first and
    last place over the time; neighbouring block means are not independent, and type A alone would be too sure.
    """
    angle = np.cumsum(deviation, axis=0) * BLOCK
    return np.asarray(SWAY * angle.std(axis=0) / (len(deviation) * BLOCK))


def _fill_gaps(blocks: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return block means (b, 3); a block without a single reading repeats the one before."""
    count = np.isfinite(blocks).sum(axis=1)
    means: NDArray[np.float64] = np.where(np.isfinite(blocks), blocks, 0.0).sum(axis=1) / np.maximum(count, 1)
    known = np.flatnonzero(count[:, 0] > 0)
    if len(known) == 0:
        return np.zeros_like(means)
    nearest = known[np.clip(np.searchsorted(known, np.arange(len(means)), side="right") - 1, 0, None)]
    return means[nearest]


def _still_windows(means: NDArray[np.float64], limit: float) -> NDArray[np.bool_]:
    """Return for each window of WINDOW blocks whether every axis scatters less than ``limit``."""
    windows = np.lib.stride_tricks.sliding_window_view(means, WINDOW, axis=0)
    return np.asarray((windows.std(axis=-1, ddof=1) < limit).all(axis=-1))


def _stretches(still: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return (first, after last) of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def combine(
    offset: NDArray[np.float64], sigma: NDArray[np.float64], prior_sigma: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return offset and sigma (3,) of a measured rest, weighed against the belief that nothing more than
    ``prior_sigma`` (rad/s) is left to subtract."""
    weight = prior_sigma**2 / (prior_sigma**2 + sigma**2)
    return weight * offset, np.sqrt(weight) * sigma
