"""One moment of a body as the stage draws it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.core.body import Place


@dataclass(frozen=True, eq=False)
class StagePose:
    """A body, what of it is known, and what is said of it. Replaced, never changed: the stage compares identities."""

    world_from_segment: NDArray[np.float64]
    """(23, 4); a segment with NaN is not drawn."""
    joints: NDArray[np.float64]
    """(23, 3), m, world: origin of each segment."""
    measured: frozenset[Place]
    """Places that are known; the limbs of all others are hatched."""
    silent: Mapping[Place, str] = field(default_factory=dict)
    """Places whose sensor has stopped sending, with the words shown beside the hollow limb."""
    caption: str = ""
    """Words shown below the figure and read to those who cannot see it."""
