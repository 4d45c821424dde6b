"""A take is saved when it has been read back."""

import hashlib
from collections import Counter
from collections.abc import Set
from pathlib import Path

import numpy as np

from studio.core.errors import VerificationFailed
from studio.storage.block_reader import BlockReader
from studio.storage.blocks import message_heads
from studio.storage.ledger import Ledger
from studio.storage.sample_table import sample_rows


def verify(file: Path, written: Ledger, imu: Set[int]) -> float:
    """Read a finished take and compare it with what was written.

    Parameters
    ----------
    imu : the channels of sensors

    Returns
    -------
    s, the latest ``Sample.time`` in the file; -inf without samples

    Raises
    ------
    VerificationFailed
        Another number of messages of any channel, another content, or damage.
    """
    counts: Counter[int] = Counter()
    content = hashlib.blake2b(digest_size=16)
    latest = -np.inf
    with file.open("rb") as stream:
        reader = BlockReader(stream, file)
        for messages in reader.messages():
            content.update(messages.data)
            channels, numbers = np.unique(message_heads(messages.data)["channel"], return_counts=True)
            counts.update(dict(zip(channels.tolist(), numbers.tolist(), strict=True)))
            if messages.channel in imu:
                rows = sample_rows(messages)
                latest = latest if rows is None else np.fmax(latest, np.fmax.reduce(rows["time"]))
    as_written = counts == written.counts and content.digest() == written.digest()
    if not as_written or reader.damaged or not reader.finished:
        expected = sum(written.counts[channel] for channel in imu)
        raise VerificationFailed(str(file), expected, sum(counts[channel] for channel in imu))
    return float(latest)
