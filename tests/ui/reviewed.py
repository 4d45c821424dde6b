"""Takes for the tests of review and export: made of arithmetic, nothing on the disk."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.core.body import PLACES, Place
from studio.core.take import Alignment, LimbAlignment, Mark
from studio.storage.take_summary import TakeSummary
from studio.ui.models.take_review import review_take
from tests.export.moving_body import moving_body

FRAME_S = 0.02
MARKS = (
    Mark(1.0, "pose", "n", 3.0),
    Mark(4.0, "marker", ""),
    Mark(2.0, "record"),
    Mark(5.0, "marker", "turns round"),
)


def summary(number=1, name="walk", **facts):
    day = f"2026-11-{1 + number % 28:02d}"
    return replace(
        TakeSummary(
            folder=Path(f"/library/P014/{day}a/take-{number:03d}_{name}"),
            person="P014",
            session=f"{day}a",
            name=name,
            started=f"{day}T10:00:00+00:00",
            duration_s=5.98,
            samples=4500,
            sensors=15,
            lost=0.001,
            frame_s=FRAME_S,
            places=PLACES,
        ),
        **facts,
    )


def limb(source="bow", degrees=2.0):
    return LimbAlignment((1.0, 0.0, 0.0, 0.0), 0.0, source, math.radians(degrees), 0.01)


def review(take=None, frames=300, marks=MARKS, **masks):
    """Return a take of a moving body; ``masks`` are lost frames by the key of a place."""
    motion = moving_body(frames=frames, frame_s=FRAME_S)
    lost = {place: np.zeros(frames, bool) for place in PLACES}
    for key, rows in masks.items():
        lost[Place(key)][rows] = True
    alignment = Alignment("n", 1.0, 3.0, {place: limb() for place in PLACES})
    notes = ("Nobody entered a stature: 1.75 m is assumed for all lengths.",)
    return review_take(take or summary(), marks, replace(motion, lost=lost, alignment=alignment, notes=notes))
