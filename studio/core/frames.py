"""The three frames, the units and the errata of the sources. Nothing else exists.

World
    right-handed, z up, x where the wearer faces at the hold, y left; metres; the origin on the floor
    under the pelvis at the hold.
Segment
    origin at the proximal joint centre, x forward, y up along the bone (towards the head in N-pose),
    z right, on both sides of the body alike.
Sensor
    the tag's own: right-handed, x along the printed arrow, z out of the face.

In N-pose (palms to the thighs) every ``world_from_segment`` maps x to x, y to z and z to -y, feet the
same. In T-pose (palms down) the left arm chain is turned by +90 degrees and the right by -90 degrees
about world x. Errata of the four papers: ARCHITECTURE.md, each with a test in tests/claims.
"""

import math

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.80665
"""m/s², standard gravity: what "1 g" of a data sheet means."""

UP: NDArray[np.float64] = np.array([0.0, 0.0, 1.0])
"""World axis against gravity."""
UP.flags.writeable = False

_HALF = math.sqrt(0.5)

N_POSE: NDArray[np.float64] = np.array([_HALF, _HALF, 0.0, 0.0])
"""``world_from_segment`` of every segment in N-pose: +90 degrees about world x."""
N_POSE.flags.writeable = False

LEFT_ARM_T_POSE: NDArray[np.float64] = np.array([0.0, 1.0, 0.0, 0.0])
"""``world_from_segment`` of the left arm chain in T-pose: N-pose turned by another +90 degrees about world x."""
LEFT_ARM_T_POSE.flags.writeable = False

RIGHT_ARM_T_POSE: NDArray[np.float64] = np.array([1.0, 0.0, 0.0, 0.0])
"""``world_from_segment`` of the right arm chain in T-pose."""
RIGHT_ARM_T_POSE.flags.writeable = False

SITTING_THIGH: NDArray[np.float64] = np.array([0.5, 0.5, -0.5, 0.5])
"""``world_from_segment`` of both thighs while sitting upright: N-pose flexed by 90 degrees about the right axis."""
SITTING_THIGH.flags.writeable = False
