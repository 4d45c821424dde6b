"""Poses over time: what a take is solved into. Never stored as truth."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import Place, Segment, Skeleton
from studio.core.take import Alignment

Method = Literal["live", "offline"]


@dataclass(frozen=True)
class Motion:
    """The body over time."""

    time: NDArray[np.float64]
    """(n,), s of take time, increasing; regular for method ``offline``, the moments of the frames for ``live``."""
    frame_s: float
    """s, nominal, from one row to the next."""
    world_from_segment: NDArray[np.float64]
    """(n, 23, 4)."""
    hips: NDArray[np.float64]
    """(n, 3), m, world: position of the Hips joint."""
    skeleton: Skeleton
    measured: Mapping[Place, NDArray[np.bool_]]
    """For each assigned place, (n,): True where its sensor was sending (gaps up to 1 s are bridged) and its
    heading is known."""
    lost: Mapping[Place, NDArray[np.bool_]]
    """For each assigned place, (n,): True where the sample itself was lost and stands interpolated."""
    alignment: Alignment
    method: Method
    attitude: str
    """Name of the attitude estimator."""
    notes: tuple[str, ...] = field(default=())
    """Facts a reader of the numbers must know, in plain words; shown and put into sidecars."""

    def __len__(self) -> int:
        return len(self.time)

    def joint_positions(self) -> NDArray[np.float64]:
        """Return (n, 23, 3), m, world."""
        return self.skeleton.joint_positions(self.world_from_segment, self.hips)

    def parent_from_child(self, parent: Segment, child: Segment) -> NDArray[np.float64]:
        """Return the rotation of a joint, (n, 4), in segment axes."""
        world_from_parent = self.world_from_segment[:, parent]
        return rotation.multiply(rotation.inverse(world_from_parent), self.world_from_segment[:, child])
