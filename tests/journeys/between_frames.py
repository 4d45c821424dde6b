"""A second way from the rows of a motion to the frames of a file: scipy's interpolation of rotations."""

import numpy as np

from studio.core.body import SEGMENTS


def joints_at(motion, times):
    """Return the joints of a motion at times between its rows, (n, 23, 3), m, world; along the shortest way."""
    from scipy.spatial.transform import Rotation, Slerp

    own = np.arange(len(motion)) * motion.frame_s
    times = np.minimum(times, own[-1])
    turned = np.empty((len(times), SEGMENTS, 4))
    for segment in range(SEGMENTS):
        turns = Rotation.from_quat(motion.world_from_segment[:, segment], scalar_first=True)
        turned[:, segment] = Slerp(own, turns)(times).as_quat(scalar_first=True)
    hips = np.stack([np.interp(times, own, motion.hips[:, axis]) for axis in range(3)], axis=1)
    return motion.skeleton.joint_positions(turned, hips)
