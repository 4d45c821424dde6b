"""Bodies for the tests of the stage: reference poses and the simulated performer."""

import numpy as np
from PySide6.QtGui import QImage

from studio.acquisition.synthetic.body_truth import Performer
from studio.acquisition.synthetic.scripts import SCRIPT_BEGINS, WORN_SCRIPTS
from studio.core import rotation
from studio.core.body import PLACES, Skeleton, reference_pose
from studio.ui.models.stage_pose import StagePose
from studio.ui.theme import Theme
from studio.ui.views.stage import Stage

SKELETON = Skeleton.from_stature(1.75)
FRAME = 1 / 60


def standing(name="n", *, at=(0.0, 0.0), turned=0.0, measured=PLACES, silent=None, caption=""):
    """A reference pose at ``at`` (m), turned by ``turned`` (rad) to its left."""
    world = rotation.multiply(rotation.about(2, turned), reference_pose(name))
    hips = np.array([*at, SKELETON.hips_height()])
    joints = SKELETON.joint_positions(world, hips)
    return StagePose(world, joints, frozenset(measured), silent or {}, caption)


def walking(seconds, rate=60.0):
    """The poses of the simulated walk."""
    performer = Performer(WORN_SCRIPTS["walk"], SKELETON.stature, np.random.default_rng(1))
    world, hips = performer.true_pose(SCRIPT_BEGINS + np.arange(0.0, seconds, 1 / rate))
    joints = SKELETON.joint_positions(world, hips)
    return [StagePose(w, j, frozenset(PLACES)) for w, j in zip(world, joints, strict=True)]


def stage(qtbot, *, dark=True, size=(640, 480), scale=1.0, reduced_motion=False):
    """A shown stage of a size in px."""
    theme = Theme()
    theme.scheme, theme.text_scale, theme.reduced_motion = ("dark" if dark else "light"), scale, reduced_motion
    widget = Stage(theme)
    qtbot.addWidget(widget)
    widget.resize(*size)
    widget.show()
    return widget


def picture(widget):
    """What is painted, (height, width, 3), 0…255."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB888)
    rows = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return rows[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def changed(one, other):
    """How many pixels differ."""
    return int((np.abs(one - other).max(axis=2) > 8).sum())
