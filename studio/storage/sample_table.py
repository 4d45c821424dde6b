"""The samples of a take on their way from chunks of all sensors to one table for each sensor."""

import numpy as np
from numpy.typing import NDArray

from studio.storage.block_reader import Messages
from studio.storage.profile import MESSAGE, SAMPLE_DTYPE, SAMPLE_LENGTH

STAGED = 65_536  # rows, 12 MB: few enough to hold twice, enough that sorting them costs little for each
_MESSAGE_HEAD = {"opcode", "length", "channel", "log_time", "publish_time", "cdr"}
READING_DTYPE = np.dtype([(name, SAMPLE_DTYPE[name]) for name in SAMPLE_DTYPE.names or () if name not in _MESSAGE_HEAD])
"""What of a message in ``SAMPLE_DTYPE`` tells about the sensor, and its place in the order of arrival."""

Rows = NDArray[np.void]


def sample_rows(messages: Messages) -> Rows | None:
    """Return the messages of a chunk of sensors as rows, None when they are something else."""
    if len(messages.data) % SAMPLE_DTYPE.itemsize:
        return None
    rows = np.frombuffer(messages.data, SAMPLE_DTYPE)
    if not ((rows["opcode"] == MESSAGE) & (rows["length"] == SAMPLE_LENGTH)).all():
        return None
    return rows


class SampleTable:
    """Rows of all sensors, kept apart by channel: beside the result only a piece of the take is in memory."""

    def __init__(self) -> None:
        self.rows = 0
        """How many were added."""
        self._staged: list[Rows] = []
        self._waiting = 0
        self._parts: dict[int, list[Rows]] = {}

    def add(self, rows: Rows) -> None:
        """Take the rows of one chunk."""
        self._staged.append(rows)
        self._waiting += len(rows)
        self.rows += len(rows)
        if self._waiting >= STAGED:
            self._sort()

    def count(self, channel: int) -> int:
        """Return how many rows of one channel there are."""
        self._sort()
        return sum(map(len, self._parts.get(channel, [])))

    def take(self, channel: int) -> Rows:
        """Return the rows of one channel in the order of arrival, ``READING_DTYPE``, and forget them."""
        self._sort()
        parts = self._parts.pop(channel, [])
        rows = np.concatenate(parts) if parts else np.empty(0, READING_DTYPE)
        if (np.diff(rows["sequence"].astype(np.int64)) < 0).any():
            rows = rows[np.argsort(rows["sequence"], kind="stable")]
        return rows

    def _sort(self) -> None:
        if not self._staged:
            return
        rows = np.concatenate(self._staged)
        self._staged.clear()
        self._waiting = 0
        order = np.argsort(rows["channel"], kind="stable")
        channels, starts = np.unique(rows["channel"][order], return_index=True)
        for channel, part in zip(channels.tolist(), np.split(order, starts[1:]), strict=True):
            readings = np.empty(len(part), READING_DTYPE)
            for name in READING_DTYPE.names or ():
                readings[name] = rows[name][part]
            self._parts.setdefault(channel, []).append(readings)
