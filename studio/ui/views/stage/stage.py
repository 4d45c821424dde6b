"""The stage: a body that moves, seen by a camera that is turned, moved and zoomed."""

import math

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QFontMetricsF,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPen,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QWidget

from studio.core.body import DEFAULT_STATURE, PLACES, Segment, Skeleton
from studio.ui.models.stage_pose import StagePose
from studio.ui.theme import FOCUS, FORM_WIDTH, GAP, GAP_WIDE, RADIUS, Theme
from studio.ui.views.stage.body_parts import Body
from studio.ui.views.stage.camera import VIEWS, Camera, View
from studio.ui.views.stage.cameraman import Cameraman, facing, has_place
from studio.ui.views.stage.figure_painter import FigurePainter
from studio.ui.views.stage.floor_painter import FloorPainter
from studio.ui.views.stage.outlines import Outlines
from studio.ui.views.stage.shading import Shading
from studio.ui.views.stage.side_letters import Letters, SideLetters
from studio.ui.views.stage.silent_names import More, SilentNames
from studio.ui.views.stage.walked_path import WalkedPath

Array = NDArray[np.float64]

SMALLEST = QSize(240, 180)
WHEEL = 0.9985  # distance per eighth of a degree of the wheel: a notch of 15 degrees brings 17 % nearer
KEY_TURN = 32.0  # px of a drag for one press of an arrow key
KEY_ZOOM = 0.85
SAID_EVERY = 1.0  # s; a description for screen readers is not changed faster
STEEP = math.radians(60.0)  # rad; from there on it is a view from above


class Stage(QWidget):
    """Renders poses; the camera is its own business."""

    view_changed = Signal(str)
    """front, side, top or free."""
    follow_changed = Signal(bool)

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._cameraman = Cameraman()
        self._path = WalkedPath()
        self._pose: StagePose | None = None
        self._ghost: StagePose | None = None
        self._empty = ""
        self._now: float | None = None
        self._said_at = -math.inf
        self._dragged_from: QPointF | None = None
        self.setMinimumSize(SMALLEST)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_OpaquePaintEvent)
        self.setAccessibleName(self.tr("Figure"))
        self.set_skeleton(Skeleton.from_stature(DEFAULT_STATURE))
        self.restyle()

    def set_skeleton(self, skeleton: Skeleton) -> None:
        """Take over the lengths of another person."""
        self._skeleton = self._cameraman.skeleton = skeleton
        self._figure, self._ghost_figure = FigurePainter(Body(skeleton)), FigurePainter(Body(skeleton))
        self._dirty = True

    def show_pose(self, pose: StagePose | None) -> None:
        """Show a body, or nothing."""
        if pose is self._pose:
            return
        self._pose, self._dirty = pose, True
        self._frame()
        self._cameraman.see(pose)
        if pose is not None and self.follow:
            self._path.add(pose.joints[Segment.Hips, :2])

    def show_ghost(self, pose: StagePose | None) -> None:
        """Show a second body as a grey outline, or none."""
        if pose is not self._ghost:
            self._ghost, self._dirty = pose, True

    def set_path(self, points: Array) -> None:
        """Show a walked path, (n, 2), m, world, instead of what is collected."""
        self._path.replace(points)
        self._dirty = True

    def clear_path(self) -> None:
        """Forget the path; while following, another one is collected."""
        self._path.clear()
        self._dirty = True

    def set_empty_text(self, words: str) -> None:
        """Say this while there is no body."""
        self._empty, self._dirty = words, True

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        self._shading = Shading(self._theme)
        self._floor = FloorPainter(self._theme)
        self._letters, self._names = SideLetters(self._theme), SilentNames(self._theme)
        self._font = self._theme.font("body")
        self._metrics = QFontMetricsF(self._font)
        self._dirty = True
        self._frame()
        self.update()

    def tick(self, now: float) -> None:
        """Move the camera, and repaint if anything is different; ``now`` in s."""
        since = 0.0 if self._now is None else max(now - self._now, 0.0)
        self._now = now
        if self._cameraman.advance(since, now):
            self._dirty = True
        if now - self._said_at >= SAID_EVERY:
            self._said_at = now
            self._say()
        if self._dirty:
            self._dirty = False
            self.update()

    def describe(self) -> str:
        """Return what is seen as words."""
        pose = self._pose
        if pose is None or not has_place(pose):
            return self._empty
        said = [self._facing(pose)]
        if pose.caption:
            said.append(pose.caption)
        said.extend(pose.silent[place] for place in PLACES if place in pose.silent)
        unknown = sum(place not in pose.measured and place not in pose.silent for place in PLACES)
        if unknown:
            said.append(self.tr("limbs not measured: {n}").format(n=unknown))
        return "; ".join(said)

    @property
    def camera(self) -> Camera:
        """Where it is seen from now."""
        return self._cameraman.camera

    @property
    def follow(self) -> bool:
        """Whether the camera goes with the hips."""
        return self._cameraman.follow

    @follow.setter
    def follow(self, on: bool) -> None:
        if on != self._cameraman.follow:
            self._cameraman.set_follow(on)
            self.follow_changed.emit(on)

    def toggle_follow(self) -> None:
        """Follow, or stay."""
        self.follow = not self.follow

    @property
    def mirrored(self) -> bool:
        """True: from behind, the wearer's left on the left as in a mirror. False: the wearer faces you."""
        return self._cameraman.mirrored

    @mirrored.setter
    def mirrored(self, on: bool) -> None:
        self._cameraman.face(on, self._moment())
        self._dirty = True

    def view(self, name: View) -> None:
        """Look from the wearer's front, right side, from above, or freely; what was moved and zoomed is forgotten."""
        self._cameraman.choose(name, self._moment())
        self._dirty = True
        self.view_changed.emit(name)

    def next_view(self) -> None:
        """Go to the next of the four views."""
        self.view(VIEWS[(VIEWS.index(self._cameraman.view) + 1) % len(VIEWS)])

    def sizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return a size that shows a body well."""
        return QSize(640, 480)

    def minimumSizeHint(self) -> QSize:  # noqa: N802 (Qt's name)
        """Return the least that shows a body."""
        return SMALLEST

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Keep the body in the picture."""
        self._frame()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        self._floor.paint(painter, self.camera, self.size())
        self._floor.paint_path(painter, self.camera, self._path.points)
        pose = self._pose
        seen = None if pose is None else self._figure.project(self.camera, pose)
        if pose is not None and seen is not None and seen.order:
            self._paint_body(painter, pose, seen)
        elif self._ghost is not None:
            self._paint_ghost(painter, self._ghost)
        else:
            away = self.tr("The figure is out of the picture. Press V or double-click to find it.")
            self._paint_empty(painter, away if has_place(pose) else self._empty)
        if self.hasFocus():
            painter.setPen(QPen(QColor(self._theme.tokens.accent), FOCUS))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(1, 1, -1, -1), RADIUS, RADIUS)
        painter.end()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Begin a drag."""
        self._dragged_from = event.position()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Orbit; with the middle button or Shift, move the picture."""
        if self._dragged_from is None:
            return
        moved = event.position() - self._dragged_from
        self._dragged_from = event.position()
        shifted = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if event.buttons() & Qt.MouseButton.MiddleButton or (shifted and event.buttons() & Qt.MouseButton.LeftButton):
            self._cameraman.pan(moved.x(), moved.y())
        elif event.buttons() & Qt.MouseButton.LeftButton:
            self._cameraman.orbit(moved.x(), moved.y())
        self._dirty = True

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """End a drag."""
        self._dragged_from = None

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:  # noqa: N802 (Qt's name)
        """Go back to the view that was chosen last."""
        self.view(self._cameraman.view)

    def wheelEvent(self, event: QWheelEvent) -> None:  # noqa: N802 (Qt's name)
        """Come nearer or go away."""
        self._cameraman.zoom(WHEEL ** event.angleDelta().y())
        self._dirty = True
        event.accept()

    def keyPressEvent(self, event: QKeyEvent) -> None:  # noqa: N802 (Qt's name)
        """Orbit by the arrow keys, zoom by + and -."""
        turns = {
            Qt.Key.Key_Left: (KEY_TURN, 0.0),
            Qt.Key.Key_Right: (-KEY_TURN, 0.0),
            Qt.Key.Key_Up: (0.0, KEY_TURN),
            Qt.Key.Key_Down: (0.0, -KEY_TURN),
        }
        zooms = {Qt.Key.Key_Plus: KEY_ZOOM, Qt.Key.Key_Equal: KEY_ZOOM, Qt.Key.Key_Minus: 1 / KEY_ZOOM}
        key = event.key()
        if key in turns:
            self._cameraman.orbit(*turns[Qt.Key(key)])
        elif key in zooms:
            self._cameraman.zoom(zooms[Qt.Key(key)])
        else:
            super().keyPressEvent(event)
            return
        self._dirty = True

    def _paint_body(self, painter: QPainter, pose: StagePose, seen: Outlines) -> None:
        args = (self._shading, self._skeleton, pose.world_from_segment, pose.joints)
        self._floor.paint_shadow(painter, self.camera, *args)
        if self._ghost is not None:
            self._paint_ghost(painter, self._ghost)
        body = self._figure.body
        self._figure.paint(painter, self._shading, pose, seen)
        self._letters.paint(painter, body, seen, Letters(self.tr("L", "left"), self.tr("R", "right")))
        self._paint_caption(painter, pose.caption)
        if pose.silent:
            room = QRectF(self.rect()).adjusted(GAP_WIDE, GAP_WIDE, -GAP_WIDE, -GAP_WIDE - self._below())
            more = More(self.tr("and {n} more"), self.tr("{n} sensors are silent"))
            self._names.paint(painter, room, self.camera, self._skeleton.stature, body.parts, seen, pose, more)

    def _paint_ghost(self, painter: QPainter, ghost: StagePose) -> None:
        self._ghost_figure.paint_ghost(painter, self._shading, self._ghost_figure.project(self.camera, ghost))

    def _paint_caption(self, painter: QPainter, words: str) -> None:
        if not words:
            return
        room = QRectF(self.rect()).adjusted(GAP_WIDE, 0, -GAP_WIDE, -GAP_WIDE)
        painter.setFont(self._font)
        painter.setPen(QColor(self._theme.tokens.muted))
        said = self._metrics.elidedText(words, Qt.TextElideMode.ElideRight, room.width())
        painter.drawText(room, Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignBottom, said)

    def _below(self) -> float:
        """Return the height that the caption takes, px."""
        if self._pose is None or not self._pose.caption:
            return 0.0
        return self._metrics.height() + GAP

    def _frame(self) -> None:
        """Give the camera the room between the list of silent sensors and the caption."""
        room = QRectF(self.rect()).adjusted(GAP_WIDE, GAP_WIDE, -GAP_WIDE, -GAP_WIDE - self._below())
        top = 0.0 if self._pose is None else self._names.list_height(room.width(), room.height(), self._pose)
        self._cameraman.frame(float(self.width()), self.height() - top - self._below(), top)

    def _paint_empty(self, painter: QPainter, words: str) -> None:
        aside = max(GAP_WIDE, (self.width() - FORM_WIDTH / 2 * self._theme.text_scale) / 2)
        room = QRectF(self.rect()).adjusted(aside, GAP_WIDE, -aside, -GAP_WIDE)
        painter.setFont(self._font)
        painter.setPen(QColor(self._theme.tokens.muted))
        painter.drawText(room, Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, words)

    def _facing(self, pose: StagePose) -> str:
        camera = self.camera
        if camera.elevation > STEEP:
            return self.tr("Figure seen from above")
        turn = math.remainder(facing(pose) - camera.azimuth, math.tau)
        if abs(turn) < math.pi / 4:
            return self.tr("Figure facing you")
        if abs(turn) > 3 * math.pi / 4:
            return self.tr("Figure seen from behind")
        return self.tr("Figure facing right") if turn > 0 else self.tr("Figure facing left")

    def _say(self) -> None:
        said = self.describe()
        if said != self.accessibleDescription():
            self.setAccessibleDescription(said)

    def _moment(self) -> float | None:
        """Return the time from which something may move: none before the first tick and with reduced motion."""
        return None if self._theme.reduced_motion else self._now
