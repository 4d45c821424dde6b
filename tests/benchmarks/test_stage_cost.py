"""What a frame of the figure costs: following a walk, shaded, with floor, path and shadow, at 1000 x 700 px."""

import statistics
import time
from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QLineF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPen

from studio.core.body import PARENTS, SEGMENTS, Segment
from studio.ui.views.stage.side_letters import Letters
from tests.ui.stage_poses import FRAME, SKELETON, stage, walking

pytestmark = [pytest.mark.benchmark, pytest.mark.qt_log_ignore("propagateSizeHints")]

WIDTH, HEIGHT = 1000, 700
SECONDS = 8.0
PLAIN = (
    12.0  # times a plain figure: 22 lines over a plain ground and nothing else; a regression shows, a busy computer not
)


def test_cost_of_a_frame(qtbot):
    """CPU time of all threads, so that other work on this computer does not count; a plain figure as measure."""
    widget = stage(qtbot, size=(WIDTH, HEIGHT))
    image = QImage(WIDTH, HEIGHT, QImage.Format.Format_RGB32)
    shaded, plain, share = [], [], {}
    for frame, pose in enumerate(walking(SECONDS)):
        widget.show_pose(pose)
        before = time.process_time()
        widget.tick(frame * FRAME)
        widget.render(image)
        shaded.append(time.process_time() - before)
        before = time.process_time()
        _lines(image, widget.camera, pose.joints)
        plain.append(time.process_time() - before)
    for name, work in _stages(widget, pose).items():
        share[name] = statistics.median(_costs(image, work))

    median, fastest = statistics.median(shaded), np.percentile(shaded, 10)
    ratio = median / statistics.median(plain)
    print(
        f"\n{WIDTH} x {HEIGHT}: {1e3 * median:.2f} ms a frame (best tenth {1e3 * fastest:.2f}), "
        f"{ratio:.1f} times a figure of lines ({1e3 * statistics.median(plain):.2f} ms); "
        + ", ".join(f"{name} {1e3 * cost:.2f}" for name, cost in share.items())
    )
    assert ratio < PLAIN


def test_cost_of_a_frame_while_the_camera_stands(qtbot):
    """The same steps on one spot: the floor is seen again in each frame."""
    widget = stage(qtbot, size=(WIDTH, HEIGHT))
    widget.follow = False
    image = QImage(WIDTH, HEIGHT, QImage.Format.Format_RGB32)
    costs = []
    for frame, pose in enumerate(walking(SECONDS)):
        widget.show_pose(replace(pose, joints=pose.joints - pose.joints[Segment.Hips] * (1.0, 1.0, 0.0)))
        seen = widget.camera
        before = time.process_time()
        widget.tick(frame * FRAME)
        widget.render(image)
        costs.append(time.process_time() - before)
        assert widget.camera == seen

    median, fastest = statistics.median(costs), np.percentile(costs, 10)
    print(f"\n{WIDTH} x {HEIGHT}, camera stands: {1e3 * median:.2f} ms a frame (best tenth {1e3 * fastest:.2f})")


def _lines(image, camera, joints):
    """Paint the same body as lines over a ground of one colour."""
    points = camera.project(joints)
    painter = QPainter(image)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.fillRect(image.rect(), QColor("#15181C"))
    pen = QPen(QColor("#E8ECF0"), 12.0)
    pen.setCapStyle(Qt.PenCapStyle.RoundCap)
    painter.setPen(pen)
    for row in range(1, SEGMENTS):
        painter.drawLine(QLineF(*points[PARENTS[row]], *points[row]))
    painter.end()


def _stages(widget, pose):
    """The parts of a frame, by name."""
    figure, floor, camera = widget._figure, widget._floor, widget.camera  # noqa: SLF001 (to say where time goes)
    seen = figure.project(camera, pose)
    shading, path, size = widget._shading, widget._path.points, widget.size()  # noqa: SLF001
    letters = widget._letters  # noqa: SLF001
    return {
        "projection and order": lambda painter: figure.project(camera, pose),
        "limbs": lambda painter: figure.paint(painter, shading, pose, seen),
        "floor seen from elsewhere": lambda painter: floor._paint_anew(painter, camera, size),  # noqa: SLF001
        "floor seen again": lambda painter: floor.paint(painter, camera, size),
        "path": lambda painter: floor.paint_path(painter, camera, path),
        "shadow": lambda painter: floor.paint_shadow(
            painter, camera, shading, SKELETON, pose.world_from_segment, pose.joints
        ),
        "letters": lambda painter: letters.paint(painter, figure.body, seen, Letters("L", "R")),
    }


def _costs(image, work, times=100):
    costs = []
    for _ in range(times):
        painter = QPainter(image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        before = time.process_time()
        work(painter)
        costs.append(time.process_time() - before)
        painter.end()
    return costs
