"""What is exported, as which file, how large it will be: the choice of the export page."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from PySide6.QtCore import QObject, Signal

from studio.analysis.joint_angles import joint_angles
from studio.core.body import PLACES, Place, Skeleton
from studio.core.pose import Motion
from studio.core.take import Alignment
from studio.export.bvh import DEFAULT_RATE, RATES, rate_name
from studio.export.material import Wish
from studio.storage.names import slug
from studio.storage.take_summary import TakeSummary

Family = Literal["bvh", "csv"]
Rate = float | None
"""Frames a second; None keeps the rate of the recording."""

# Bytes of a cell with its separator, as real files have them on average (tests/ui/test_export_choice.py).
BVH_ROTATION = 9.45
BVH_POSITION = {"blender": 12.2, "motionbuilder": 10.8}
BVH_HEAD = 5000.0
TIME = 9.4
JOINT_ANGLE = 9.45
ORIENTATION = 4 * 12.6 + 3 * 10.9  # of one sensor
RAW_ROW = 208.0
MOST_NUMBERS = 999  # of files of one name, before the last is replaced


class Format(NamedTuple):
    """A card of the page."""

    key: str
    exporter: str
    family: Family
    bvh_preset: str
    """Empty for tables."""
    suffix: str


FORMATS = (
    Format("blender", "bvh", "bvh", "blender", ".bvh"),
    Format("motionbuilder", "bvh", "bvh", "motionbuilder", ".bvh"),
    Format("joints", "joints", "csv", "", "_joints.csv"),
    Format("orientations", "orientations", "csv", "", "_orientations.csv"),
    Format("raw", "raw", "csv", "", "_raw.csv"),
)


class Estimate(NamedTuple):
    """About what a file will be."""

    rows: int
    size: float
    """bytes"""


class Item(NamedTuple):
    """One file to be made."""

    take: Path
    target: Path
    replace: bool
    """Something stands there, and the page said that it will be replaced."""


@dataclass(frozen=True)
class ExportValues:
    """What an export is asked for with."""

    items: tuple[Item, ...]
    exporter: str
    """A key of ``export.registry.EXPORTERS``."""
    wish: Wish


class ExportChoice(QObject):
    """The takes, the format, and where the files go."""

    changed = Signal()

    def __init__(self, exists: Callable[[Path], bool], parent: QObject | None = None) -> None:
        """``exists`` tells whether there is a file at a path: ``export.file_target.is_taken``."""
        super().__init__(parent)
        self.takes: tuple[TakeSummary, ...] = ()
        self.format = FORMATS[0]
        self.rate: Rate = DEFAULT_RATE
        self.for_excel = False
        self.folder = Path()
        self._name = ""
        self._exists = exists

    @property
    def preset(self) -> str:
        """The choice as words that ``use`` understands: what is remembered."""
        if self.format.family == "bvh":
            return f"{self.format.key}:{'own' if self.rate is None else rate_name(self.rate)}"
        return f"{self.format.key}:{'excel' if self.for_excel else 'plain'}"

    def use(self, preset: str) -> None:
        """Take over a remembered choice, or the first format of an exporter; anything else changes nothing."""
        key, _, detail = preset.partition(":")
        found = next((f for f in FORMATS if f.key == key), next((f for f in FORMATS if f.exporter == key), None))
        if found is None:
            return
        self.format = found
        if found.family == "csv":
            self.for_excel = detail == "excel"
        elif detail == "own":
            self.rate = None
        else:
            self.rate = next((rate for rate in RATES if rate_name(rate) == detail), self.rate)
        self.changed.emit()

    def set_takes(self, takes: Sequence[TakeSummary]) -> None:
        """Export these; takes that cannot be read are left out. The name is suggested anew."""
        self.takes = tuple(take for take in takes if take.refusal is None)
        self._name = ""
        self.changed.emit()

    def remove_take(self, folder: Path) -> None:
        """Do not export this one."""
        self.set_takes([take for take in self.takes if take.folder != folder])

    def set_format(self, key: str) -> None:
        """Choose a card."""
        self.format = next(f for f in FORMATS if f.key == key)
        self.changed.emit()

    def set_rate(self, rate: Rate) -> None:
        """Choose the frames a second of a BVH."""
        self.rate = rate
        self.changed.emit()

    def set_for_excel(self, on: bool) -> None:
        """Write tables with semicolons and decimal commas, or as RFC 4180 says."""
        self.for_excel = on
        self.changed.emit()

    def set_folder(self, folder: Path) -> None:
        """Choose where the files go."""
        self.folder = folder
        self.changed.emit()

    def set_name(self, name: str) -> None:
        """Choose the name of the only file; empty for the suggested one."""
        self._name = name.strip()
        self.changed.emit()

    @property
    def name(self) -> str:
        """The name of the only file, without folder."""
        items = self.items()
        return items[0].target.name if len(items) == 1 else ""

    def items(self) -> tuple[Item, ...]:
        """Return what goes where: no file stands in for another, unless its name was typed."""
        taken: set[Path] = set()
        items = []
        for take in self.takes:
            target = self._typed() if self._name and len(self.takes) == 1 else self._suggested(take, taken)
            taken.add(target)
            items.append(Item(take.folder, target, self._exists(target)))
        return tuple(items)

    def replaced(self) -> tuple[Path, ...]:
        """Return the files that stand there now and will be replaced."""
        return tuple(item.target for item in self.items() if item.replace)

    def values(self) -> ExportValues:
        """Return the order."""
        return ExportValues(self.items(), self.format.exporter, self._wish())

    def estimates(self) -> tuple[Estimate, ...]:
        """Return about how large each file will be."""
        return tuple(estimate(take, self.format, self.rate) for take in self.takes)

    def _wish(self) -> Wish:
        if self.format.family == "bvh":
            return Wish(self.format.bvh_preset, self.rate)
        return Wish("excel" if self.for_excel else "plain")

    def _typed(self) -> Path:
        ending = ".bvh" if self.format.family == "bvh" else ".csv"
        stem = self._name.removesuffix(".bvh").removesuffix(".csv")
        safe = "".join("-" if c in '\\/:*?"<>|' or not c.isprintable() else c for c in stem).strip(". ")
        return self.folder / f"{safe or 'export'}{ending}"

    def _suggested(self, take: TakeSummary, taken: set[Path]) -> Path:
        number = take.folder.name.split("_")[0]
        parts = (take.person, take.session, number, slug(take.name))
        stem = "_".join(part for part in parts if part)
        ending = self.format.suffix
        for attempt in range(1, MOST_NUMBERS):
            target = self.folder / f"{stem}{'' if attempt == 1 else f'-{attempt}'}{ending}"
            if target not in taken and not self._exists(target):
                break
        return target


def estimate(take: TakeSummary, kind: Format, rate: Rate) -> Estimate:
    """Return about how many rows and bytes a file of a take will have."""
    own = _frames(take)
    if kind.family == "bvh":
        rows = own if rate is None else math.floor(take.duration_s * rate + 1e-6) + 1
        return Estimate(rows, BVH_HEAD + rows * (3 * BVH_POSITION[kind.bvh_preset] + 69 * BVH_ROTATION))
    if kind.exporter == "raw":
        return Estimate(take.samples, take.samples * RAW_ROW)
    cells = JOINT_ANGLE * angle_count(take.places) if kind.exporter == "joints" else ORIENTATION * take.sensors
    return Estimate(own, own * (TIME + cells))


def angle_count(places: Sequence[Place]) -> int:
    """Return how many joint angles sensors on these places give."""
    worn = {place: np.ones(1, np.bool_) for place in PLACES if place in places}
    still = np.tile([1.0, 0.0, 0.0, 0.0], (1, 23, 1))
    motion = Motion(
        time=np.zeros(1), frame_s=1.0, world_from_segment=still, hips=np.zeros((1, 3)),
        skeleton=Skeleton.from_stature(1.0), measured=worn, lost=worn, alignment=Alignment("n", 0.0, 1.0, {}),
        method="offline", attitude="",
    )  # fmt: skip
    return len(joint_angles(motion))


def _frames(take: TakeSummary) -> int:
    """Return how many frames the fastest sensor has between start and end."""
    if not take.samples:
        return 0
    return math.floor(take.duration_s / take.frame_s + 1e-6) + 1 if take.frame_s > 0 else take.samples
