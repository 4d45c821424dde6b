"""The judge: how far a solved motion is from the true motion of the synthetic suit.

Only ``studio inspect --truth`` comes here; that nothing else reads the truth is an executed contract.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.acquisition.synthetic.truth import Truth, decode_truth
from studio.core import rotation
from studio.core.body import MEASURED_PARENT, PLACES, SEGMENT_OF, Place
from studio.core.errors import TruthMissing
from studio.core.pose import Motion
from studio.core.solver import SolveOptions, solve
from studio.storage.take_reader import read_attachment, read_take, take_zero

ATTACHMENT = "truth"


LARGEST_SHIFT = 0.03  # s; what a radio and a cable may take to deliver at least
SHIFTS = 31  # tried between both ends of it
THINNING = 5  # frames between those looked at for the shift


@dataclass(frozen=True)
class TruthReport:
    """Rotation errors of the joints between measured segments."""

    joint_rms_deg: Mapping[Place, float]
    """By the child's place; a joint that is never measured has none."""
    measured_share: Mapping[Place, float]
    """By the child's place, of all joints between worn segments: of the frames, how many are measured and so judged."""
    from_s: float
    to_s: float
    shift_s: float
    """How much later than it was measured the studio believes each sample to be: the transport's shortest delay,
    which arrivals cannot tell. Taken out before the comparison."""

    def median(self) -> float:
        """Return the median over the joints, degrees."""
        return float(np.median(list(self.joint_rms_deg.values())))

    def worst(self) -> float:
        """Return the largest of the joints, degrees."""
        return max(self.joint_rms_deg.values())


def compare_with_truth(folder: Path, options: SolveOptions | None = None) -> TruthReport:
    """Solve a synthetic take and return its errors over all its frames.

    Raises
    ------
    TruthMissing
        The take has no true motion beside it, or no two neighbouring segments are measured.
    TakeFileError, AlignmentError
    """
    take, _ = read_take(folder)
    attached = read_attachment(folder, ATTACHMENT)
    if attached is None:
        raise TruthMissing(str(folder))
    try:
        truth = decode_truth(attached)
    except ValueError:
        raise TruthMissing(str(folder)) from None
    report = judge(solve(take, options).motion, truth, take_zero(folder))
    if not report.joint_rms_deg:
        raise TruthMissing(str(folder))
    return report


def judge(motion: Motion, truth: Truth, zero: float) -> TruthReport:
    """Return the errors of a motion whose time 0 is ``zero`` s on the clock of the truth."""
    joints = [
        (parent, child)
        for child, parent in MEASURED_PARENT.items()
        if child in motion.measured and parent in motion.measured
    ]
    some = slice(None, None, THINNING)
    tried = np.linspace(-LARGEST_SHIFT, LARGEST_SHIFT, SHIFTS)
    costs = [
        sum(
            float(np.sum(_errors(motion, truth, joint, motion.time[some] + zero - shift, some) ** 2))
            for joint in joints
        )
        for shift in tried
    ]
    shift = float(tried[int(np.argmin(costs))])
    rms, shares = {}, {}
    for joint in joints:
        errors = _errors(motion, truth, joint, motion.time + zero - shift, slice(None))
        shares[joint[1]] = len(errors) / len(motion)
        if len(errors):
            rms[joint[1]] = float(np.degrees(np.sqrt(np.mean(errors**2))))
    return TruthReport(rms, shares, float(motion.time[0]), float(motion.time[-1]), shift)


def _errors(
    motion: Motion, truth: Truth, joint: tuple[Place, Place], time: NDArray[np.float64], rows: slice
) -> NDArray[np.float64]:
    """Return the angle between found and true rotation of a joint, rad, where both sensors are measured."""
    parent, child = joint
    known = motion.measured[parent][rows] & motion.measured[child][rows]
    found = motion.parent_from_child(SEGMENT_OF[parent], SEGMENT_OF[child])[rows]
    true = rotation.multiply(rotation.inverse(_true_at(truth, parent, time)), _true_at(truth, child, time))
    return rotation.angle_between(found, true)[known]


def _true_at(truth: Truth, place: Place, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the true world_from_segment (n, 4) at times on the truth's clock."""
    after = np.clip(np.searchsorted(truth.time, time), 1, len(truth.time) - 1)
    before = after - 1
    fraction = np.clip((time - truth.time[before]) / (truth.time[after] - truth.time[before]), 0.0, 1.0)
    segments = truth.world_from_segment[:, PLACES.index(place)]
    return rotation.slerp(segments[before], segments[after], fraction)
