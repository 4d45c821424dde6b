"""Where a body has walked."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEP = 0.1  # m; a point is kept when it is that far from the last one
JUMP = 0.5  # m; nobody walks that far from one picture to the next: the path is parted
KEPT = 1000  # points; 100 m, more than a clinic's corridor


class WalkedPath:
    """Collects points, unless it was given some."""

    def __init__(self) -> None:
        self._points = np.empty((KEPT, 2))
        self._count = 0
        self._given: Array | None = None

    @property
    def points(self) -> Array:
        """(n, 2), m, world; a NaN row parts two ways."""
        return self._points[: self._count] if self._given is None else self._given

    def add(self, point: Array) -> None:
        """Take the next place, (2,), m, world."""
        if self._given is not None or not np.isfinite(point).all():
            return
        if self._count:
            step = float(np.hypot(*(point - self._points[self._count - 1])))
            if step < STEP:
                return
            if step > JUMP:
                self._keep(np.full(2, np.nan))
        self._keep(point)

    def replace(self, points: Array) -> None:
        """Show these, (n, 2), m, world, and collect no more."""
        self._given = np.array(points, np.float64).reshape(-1, 2)

    def clear(self) -> None:
        """Forget all and collect again."""
        self._count, self._given = 0, None

    def _keep(self, point: Array) -> None:
        if self._count == KEPT:
            half = KEPT // 2
            self._points[:half] = self._points[KEPT - half :]
            self._count = half
        self._points[self._count] = point
        self._count += 1
