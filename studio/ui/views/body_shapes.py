"""The drawn person: a silhouette to put tags on, and the poses to hold. 200 units high, feet at the bottom."""

import math
from collections.abc import Mapping
from functools import cache
from itertools import pairwise

from PySide6.QtCore import QPointF, QRectF
from PySide6.QtGui import QPainterPath, QPolygonF

from studio.core.body import Place
from studio.core.take import PoseName

HEIGHT = 200.0  # units
WIDTH = 110.0  # units, with the hands a little away from the body

Point = tuple[float, float]

# Of the right half as seen from behind; the left half is its mirror.
SPOTS: Mapping[Place, Point] = {
    Place.HEAD: (0.0, 7.0),
    Place.CHEST: (0.0, 50.0),
    Place.RIGHT_UPPER_ARM: (29.5, 60.0),
    Place.RIGHT_FOREARM: (39.5, 88.0),
    Place.RIGHT_HAND: (47.0, 109.0),
    Place.PELVIS: (0.0, 90.0),
    Place.RIGHT_THIGH: (12.0, 128.0),
    Place.RIGHT_SHANK: (14.5, 168.0),
    Place.RIGHT_FOOT: (18.0, 191.0),
}


def spot(place: Place, *, facing: bool) -> Point:
    """Return where a place is drawn, units from the middle of the head's top; ``facing``: the person faces us."""
    if place in (Place.HEAD, Place.CHEST, Place.PELVIS):
        return SPOTS[place]
    right = place.value.startswith("right")
    x, y = SPOTS[place if right else Place(place.value.replace("left", "right"))]
    return (x if right != facing else -x, y)


_Chain = list[tuple[Point, float]]
"""Joints with their radii."""

_AWAY: list[_Chain] = [
    [((23.0, 42.5), 6.8), ((32.5, 71.0), 5.0), ((41.5, 97.0), 3.7), ((45.2, 105.5), 4.3), ((48.2, 113.5), 2.8)]
]
_HANGING: list[_Chain] = [
    [((22.5, 43.0), 6.6), ((26.5, 73.0), 5.0), ((28.0, 100.0), 3.7), ((28.0, 108.0), 4.3), ((27.5, 116.5), 2.8)]
]
_STRETCHED: list[_Chain] = [
    [((20.0, 43.0), 6.6), ((50.0, 43.5), 5.0), ((77.0, 43.5), 3.7), ((85.0, 43.5), 4.0), ((93.0, 43.5), 2.6)]
]
_LEG: list[_Chain] = [
    [((9.5, 104.0), 9.5), ((12.4, 141.0), 6.4), ((15.0, 183.0), 4.0)],
    [((15.0, 183.0), 4.0), ((17.0, 190.5), 4.8), ((19.5, 194.5), 4.6)],
]


@cache
def silhouette() -> QPainterPath:
    """Return the outline of a standing person, the arms a little away from the body."""
    return _standing(_AWAY)


def _standing(arm: list[_Chain]) -> QPainterPath:
    body = QPainterPath()
    body.addEllipse(QPointF(0, 14), 10.5, 13.5)
    body = body.united(limb((0, 24), (0, 34), 5.5, 6.5)).united(_torso())
    for side in (-1, 1):
        for chain in (*arm, *_LEG):
            body = body.united(_chain([((side * x, y), radius) for (x, y), radius in chain]))
    return body.simplified()


def _chain(joints: _Chain) -> QPainterPath:
    path = QPainterPath()
    for (a, radius_a), (b, radius_b) in pairwise(joints):
        path = path.united(limb(a, b, radius_a, radius_b))
    return path


def _torso() -> QPainterPath:
    torso = QPainterPath(QPointF(0, 31))
    right: list[tuple[Point, Point, Point]] = [
        ((9, 33), (20, 35), (25.5, 39)),
        ((27, 46), (20.5, 55), (19.5, 62)),
        ((18, 70), (14.5, 74), (15, 80)),
        ((15.4, 87), (19.2, 89), (19.2, 100)),
        ((19, 106), (8, 109), (0, 108)),
    ]
    for c1, c2, end in right:
        torso.cubicTo(*c1, *c2, *end)
    ends = [(0.0, 31.0), *(curve[2] for curve in right[:-1])]
    for (c1, c2, _), end in zip(reversed(right), reversed(ends), strict=True):
        torso.cubicTo(-c2[0], c2[1], -c1[0], c1[1], -end[0], end[1])
    torso.closeSubpath()
    return torso


@cache
def details(*, facing: bool) -> QPainterPath:
    """Return the lines that tell front from back."""
    lines = QPainterPath()

    def curve(start: Point, control: Point, end: Point, *, both: bool = True) -> None:
        for side in (-1, 1) if both else (1,):
            lines.moveTo(side * start[0], start[1])
            lines.quadTo(side * control[0], control[1], side * end[0], end[1])

    if facing:
        curve((3.2, 15.0), (4.4, 14.0), (5.6, 15.0))
        curve((0.0, 15.5), (-2.4, 19.6), (0.8, 19.4), both=False)
        curve((-3.0, 22.4), (0.0, 24.2), (3.0, 22.4), both=False)
        curve((4.0, 36.5), (12.0, 38.5), (20.0, 40.0))
        curve((9.0, 139.0), (12.4, 143.5), (15.8, 139.0))
    else:
        curve((-9.6, 18.0), (0.0, 25.5), (9.6, 18.0), both=False)
        curve((0.0, 33.0), (0.0, 37.0), (0.0, 42.0), both=False)
        curve((0.0, 67.0), (0.0, 74.0), (0.0, 82.0), both=False)
        curve((6.5, 45.0), (14.0, 52.0), (9.5, 61.0))
        curve((2.5, 107.5), (9.0, 112.5), (16.5, 108.0))
        curve((9.5, 143.0), (12.4, 140.0), (15.6, 143.0))
    return lines


def limb(a: Point, b: Point, radius_a: float, radius_b: float) -> QPainterPath:
    """Return a rounded limb from ``a`` to ``b``."""
    path = QPainterPath()
    path.addEllipse(QPointF(*a), radius_a, radius_a)
    end = QPainterPath()
    end.addEllipse(QPointF(*b), radius_b, radius_b)
    length = math.dist(a, b)
    if length <= abs(radius_a - radius_b):
        return path.united(end)
    along = math.atan2(b[1] - a[1], b[0] - a[0])
    # The tangents of two circles lean towards the smaller one.
    lean = math.acos((radius_a - radius_b) / length)
    corners = []
    for side in (1, -1):
        direction = (math.cos(along + side * lean), math.sin(along + side * lean))
        pair = [(c[0] + r * direction[0], c[1] + r * direction[1]) for c, r in ((a, radius_a), (b, radius_b))]
        corners += pair if side == 1 else pair[::-1]
    between = QPainterPath()
    between.addPolygon(QPolygonF([QPointF(*corner) for corner in corners]))
    between.closeSubpath()
    return path.united(between).united(end)


# Seen from the wearer's left, facing left: the middle of the head, then trunk, leg, foot and arm.
_FROM_THE_SIDE: Mapping[PoseName, tuple[Point, list[_Chain]]] = {
    "bow": (
        (-47, 57),
        [
            [((-37, 66), 5.5), ((-24, 77), 12.5), ((4, 101), 12.5), ((14, 107), 12)],
            [((13, 108), 10.5), ((-12, 143), 7), ((14, 178), 4.2)],
            [((14, 178), 4.2), ((2, 193), 3.6), ((-6, 195.5), 3)],
            [((-28, 78), 6.6), ((-50, 98), 5), ((-76, 106), 3.6), ((-89, 107), 2.8)],
        ],
    ),
    "sit": (
        (0, 46),
        [
            [((1, 62), 5.5), ((3, 88), 12.5), ((5, 128), 12.5)],
            [((5, 130), 10.5), ((-36, 133), 7.5), ((-37, 184), 4.4)],
            [((-37, 190), 4), ((-52, 195), 3.4)],
        ],
    ),
}
_SITTING_ARM: _Chain = [((4, 78), 5.6), ((9, 106), 4.6), ((9, 130), 3.6), ((8, 143), 2.8)]


@cache
def pose_outline(pose: PoseName) -> QPainterPath:
    """Return a person in a pose; bow and sitting are seen from the left side."""
    if pose in ("n", "t"):
        return _standing(_HANGING if pose == "n" else _STRETCHED)
    (x, y), chains = _FROM_THE_SIDE[pose]
    outline = QPainterPath()
    outline.addEllipse(QPointF(x, y), 10.5, 13.0)
    for chain in chains:
        outline = outline.united(_chain(chain))
    return outline.simplified()


@cache
def pose_arm(pose: PoseName) -> QPainterPath:
    """Return the arm that hangs in front of the trunk, empty where none does."""
    return _chain(_SITTING_ARM).simplified() if pose == "sit" else QPainterPath()


@cache
def pose_lines(pose: PoseName) -> QPainterPath:
    """Return what belongs to a pose besides the person: the chair."""
    lines = QPainterPath()
    if pose == "sit":
        lines.addPolygon(QPolygonF([QPointF(32, 92), QPointF(28, 146), QPointF(-20, 146)]))
        for x in (25, -14):
            lines.moveTo(x, 146)
            lines.lineTo(x, 200)
    return lines


def fitted(room: QRectF, width: float = WIDTH) -> tuple[float, QPointF]:
    """Return the scale at which a person fits into ``room``, and where the middle of the head's top comes to lie."""
    scale = max(min(room.height() / HEIGHT, room.width() / width), 0.1)
    return scale, QPointF(room.center().x(), room.center().y() - scale * HEIGHT / 2)
