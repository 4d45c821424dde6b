"""The golden bytes of firmware/protocol/vectors.json and the neighbourhood of other people's devices."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
VECTORS: dict[str, list[dict[str, Any]]] = json.loads((ROOT / "firmware/protocol/vectors.json").read_text("utf-8"))
HCIDUMP = ROOT / "tests/data/ble-hci/hcidump-3.x.txt"
LE_ADVERTISING_REPORT = bytes.fromhex("043e"), 0x02  # HCI event packet, LE meta event; subevent


def advert(name: str) -> bytes:
    """Return the advert called ``name`` in the vectors."""
    return bytes.fromhex(next(v["advert"] for v in VECTORS["payloads"] if v["name"] == name))


def neighbourhood() -> Iterator[bytes]:
    """Yield the advertising data of each real report."""
    packets: list[str] = []
    for line in HCIDUMP.read_text("ascii").splitlines():
        if line.startswith("> "):
            packets.append(line[2:])
        elif line.startswith("  ") and packets:
            packets[-1] += line
    for packet in map(bytes.fromhex, packets):
        event, subevent = LE_ADVERTISING_REPORT
        if packet.startswith(event) and packet[3] == subevent:
            size = packet[13]  # after the header, one report: type, address type, address
            yield packet[14 : 14 + size]
