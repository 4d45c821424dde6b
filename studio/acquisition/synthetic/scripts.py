"""What the performer does: the procedure every worn script begins with, then the script."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.postures import Excursion, posture
from studio.core.body import PLACES
from studio.core.take import Mark

Array = NDArray[np.float64]

BOW = posture(
    {
        "pelvis": (30, 0, 0),
        "trunk": (22, 0, 0),
        "neck": (5, 0, 0),
        "hip": (62, 0, 0),
        "knee": (76, 0, 0),
        "ankle": (-1, 0, 0),
        "shoulder": (102, 0, 0),
        "elbow": (20, 0, 0),
        "wrist": (5, 0, 0),
    }
)
"""Trunk 52 degrees forward, head 57, thighs 32 back to front, shanks 44 and feet 45 forward (heels lifted), arms 50 to
75 in front: every segment tilts by 25 degrees or more (contracts, section 3)."""

T_POSE = posture({"shoulder": (0, -90, 0)})

BOW_BEGINS = 4.2  # s; the upright hold before it lasts at least 4 s
SCRIPT_BEGINS = 9.4  # s; upright again after the bow
_BOW = Excursion(BOW, BOW_BEGINS, 1.4, BOW_BEGINS + 3.6, 1.4)
PRELUDE_CUES = (Mark(1.2, "pose", "n", 4.0), Mark(5.7, "pose", "bow", 7.7))
"""The steady parts of both holds, s since the suit was switched on."""


@dataclass(frozen=True, slots=True)
class Script:
    """One thing to do after the prelude, again and again."""

    once: tuple[Excursion, ...] = (_BOW,)
    repeated: tuple[Excursion, ...] = ()
    """Times within the period."""
    period: float = 1.0
    """s."""
    walks: bool = False
    cues: tuple[Mark, ...] = PRELUDE_CUES

    def angles(self, times: Array) -> Array:
        """Return the joint angles without gait, (n, 15, 3), rad, at ``times`` (n,), s."""
        total = np.zeros((len(times), len(PLACES), 3))
        for excursion in self.once:
            total += excursion.share(times)[:, None, None] * excursion.angles
        since = times - SCRIPT_BEGINS
        phase = np.where(since >= 0, np.mod(since, self.period), 0.0)
        for excursion in self.repeated:
            total += excursion.share(phase)[:, None, None] * excursion.angles
        return total


_LEAN = posture(
    {"pelvis": (25, 0, 0), "trunk": (14, 0, 0), "neck": (-16, 0, 0), "hip": (25, 0, 0), "shoulder": (20, 0, 0)}
)
_SEATED = posture(
    {
        "pelvis": (-6, 0, 0),
        "trunk": (6, 0, 0),
        "hip": (82, -6, 2),
        "knee": (88, 0, 0),
        "shoulder": (28, 0, 5),
        "elbow": (35, 0, 10),
    }
)
_TURN_LEFT = posture({"pelvis": (2, 2, 4), "trunk": (8, 4, 14), "neck": (-4, -2, 10), "hip": (2, 0, 0)})
_TURN_RIGHT = posture({"pelvis": (2, -2, -4), "trunk": (8, -4, -14), "neck": (-4, 2, -10), "hip": (2, 0, 0)})
_RIGHT_REACH = posture({"right_shoulder": (98, 12, 15), "right_elbow": (14, 0, 35), "right_wrist": (-18, 6, 0)})
_LEFT_REACH = posture({"left_shoulder": (112, -25, 10), "left_elbow": (22, 0, 20), "left_wrist": (-22, 4, 0)})
_RIGHT_DRAW = posture({"right_shoulder": (-30, 0, 0), "right_elbow": (70, 0, 0)})
_LEFT_DRAW = posture({"left_shoulder": (-35, 0, 0), "left_elbow": (75, 0, 0)})

WORN_SCRIPTS: dict[str, Script] = {
    "n": Script(),
    "bow": Script(repeated=(Excursion(BOW, 2.0, 1.4, 5.6, 1.4),), period=8.0),
    "t": Script(
        repeated=(Excursion(T_POSE, 0.0, 1.5, 5.5, 1.5),),
        period=9.0,
        cues=(*PRELUDE_CUES, Mark(SCRIPT_BEGINS + 2.2, "pose", "t", SCRIPT_BEGINS + 5.2)),
    ),
    "walk": Script(walks=True),
    "holds": Script(repeated=(Excursion(BOW, 7.0, 1.4, 13.6, 1.4),), period=16.0),
    "sit": Script(
        repeated=(
            Excursion(_LEAN, 0.0, 0.9, 1.6, 1.0),
            Excursion(_SEATED, 0.3, 1.9, 4.4, 1.8),
            Excursion(_LEAN, 3.7, 0.9, 5.0, 1.1),
        ),
        period=7.5,
    ),
    "reach": Script(
        repeated=(
            Excursion(_RIGHT_DRAW, 0.0, 0.8, 0.5, 1.1),
            Excursion(_RIGHT_REACH, 0.4, 1.1, 1.9, 1.1),
            Excursion(_TURN_LEFT, 0.4, 1.2, 1.8, 1.2),
            Excursion(_LEFT_DRAW, 3.0, 0.8, 3.5, 1.1),
            Excursion(_LEFT_REACH, 3.4, 1.1, 4.9, 1.1),
            Excursion(_TURN_RIGHT, 3.4, 1.2, 4.8, 1.2),
        ),
        period=6.5,
    ),
}
