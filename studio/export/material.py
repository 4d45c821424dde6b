"""What an exporter is given and what it gives back."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.core.pose import Motion
from studio.core.sample import SensorId
from studio.core.take import Take
from studio.export.bvh_check import BvhFile

Orientations = Mapping[SensorId, tuple[NDArray[np.float64], NDArray[np.float64]]]
"""For each sensor its sample times, (n,) in s of take time, and ``world_from_sensor``, (n, 4)."""


@dataclass(frozen=True)
class Material:
    """All an exporter may draw on; each takes what it needs and raises NothingToExport when that is missing."""

    take: Take
    motion: Motion | None
    """None when nothing was solved."""
    orientations: Orientations
    """Empty when no attitude was estimated."""
    read_bvh: Callable[[Path], BvhFile]
    """A reader of BVH files that shares nothing with the writer: ``importers.bvh.read_bvh``."""


@dataclass(frozen=True)
class Wish:
    """What the operator chose."""

    preset: str
    """A key of the exporter's PRESETS."""
    fps: float | None = None
    """Frames a second of a BVH, one of ``bvh.RATES``; None keeps the motion's own rate."""


@dataclass(frozen=True)
class Product:
    """A file about to be written."""

    blocks: Iterable[bytes]
    read_back: Callable[[Path], None]
    """Raises ReadBackDiffers unless the file at the path says what was meant."""
    sidecar: Mapping[str, Any]
    """What ``sidecar.sidecar`` returned."""
