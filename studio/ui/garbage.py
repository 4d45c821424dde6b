"""Python's garbage is collected on the Qt thread only: widgets must not be taken apart by another one.

Automatic collection runs on whichever thread happens to allocate; on the acquisition thread it would delay samples.
"""

import gc

EVERY = 1.0  # s; the studio makes few cycles, so that a young collection takes less than a millisecond


class GarbageCollector:
    """Stands in for the automatic one, with its thresholds, when it is told the time."""

    def __init__(self) -> None:
        self._at = float("-inf")

    def begin(self) -> None:
        """Take over; what lives now lives until the end and is not looked at again."""
        gc.collect()
        gc.freeze()
        gc.disable()

    def end(self) -> None:
        """Give back."""
        gc.unfreeze()
        gc.enable()

    def tick(self, now: float) -> None:
        """Collect the oldest generation that is due."""
        if now - self._at < EVERY:
            return
        self._at = now
        due = [
            n for n, (count, most) in enumerate(zip(gc.get_count(), gc.get_threshold(), strict=True)) if count > most
        ]
        if due:
            gc.collect(due[-1])
