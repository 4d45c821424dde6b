"""Take files that no studio would write: sound to every checksum, and with contents of a stranger's choice."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from mcap.records import Channel, Header, Metadata
from numpy.typing import NDArray

from studio.core.take import Take
from studio.storage.blocks import BlockBuilder, encode
from studio.storage.encoder import TakeEncoder, schema_records
from studio.storage.facts import Anchor, SensorRecord, identity, mark_event, to_json
from studio.storage.profile import EVENT_TOPIC, IMU_TOPIC, MAGIC, PROFILE
from studio.storage.take_store import take_rows

ROWS_PER_CHUNK = 1000


@dataclass
class Claims:
    """Everything a take file says; to be changed at will before it is written."""

    identity: dict[str, Any]
    sensors: list[dict[str, Any]]
    events: list[dict[str, Any]]
    rows: NDArray[np.void]

    def write(self, folder: Path) -> Path:
        """Write the file with right checksums and return its folder."""
        facts = {"profile": PROFILE, "take": json.dumps(self.identity)}
        channels = [_channel(1, EVENT_TOPIC, 3, {})]
        for number, sensor in enumerate(self.sensors):
            topic = IMU_TOPIC + str(sensor["info"]["sensor"])
            channels.append(_channel(number + 2, topic, 1, {"sensor": json.dumps(sensor)}))
        opening = BlockBuilder(b"stranger", 1)
        opening.add(encode(Metadata("kinetag", facts), *schema_records(), *channels))
        blocks = [opening]
        for start in range(0, len(self.rows), ROWS_PER_CHUNK):
            blocks.append(BlockBuilder(b"stranger", len(blocks) + 1))
            blocks[-1].add_rows(self.rows[start : start + ROWS_PER_CHUNK])
        if self.events:
            bodies = [json.dumps(event).encode() for event in self.events]
            width = max(map(len, bodies))
            blocks.append(BlockBuilder(b"stranger", len(blocks) + 1))
            blocks[-1].add_messages(1, 0, [0] * len(bodies), [body.ljust(width) for body in bodies])
        whole = b"".join(block.finish().data for block in blocks)
        folder.mkdir(exist_ok=True)
        (folder / "take.mcap").write_bytes(MAGIC + encode(Header(PROFILE, "")) + whole)
        return folder


def claims_of(take: Take) -> Claims:
    """Return what the file of an honest take says."""
    who = identity(take.name, take.person, take.source, take.setup, take.versions, Anchor(take.started, 0.0))
    encoder = TakeEncoder(who, zero=0.0)
    encoder.opening()
    rows = take_rows(take.streams, encoder)
    return Claims(
        identity=json.loads(to_json(who)),
        sensors=[json.loads(to_json(SensorRecord(0.0, stream.info))) for stream in take.streams],
        events=[json.loads(to_json(mark_event(mark))) for mark in take.marks],
        rows=rows,
    )


def places_in(value: Any, at: Sequence[Any] = ()) -> list[tuple[Any, ...]]:
    """Return the way to each value inside nested JSON."""
    if isinstance(value, Mapping):
        inner = [place for key, item in value.items() for place in places_in(item, (*at, key))]
    elif isinstance(value, list):
        inner = [place for number, item in enumerate(value) for place in places_in(item, (*at, number))]
    else:
        inner = []
    return [tuple(at), *inner] if at else inner


def put(value: Any, at: Sequence[Any], new: Any) -> None:
    """Replace what stands at a place inside nested JSON."""
    for key in at[:-1]:
        value = value[key]
    value[at[-1]] = new


def _channel(number: int, topic: str, schema: int, metadata: dict[str, str]) -> Channel:
    encoding = {1: "cdr", 3: "json"}[schema]
    return Channel(id=number, topic=topic, message_encoding=encoding, metadata=metadata, schema_id=schema)
