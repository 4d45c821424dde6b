"""Parts of the body on the picture: their edges, how the light falls on them, and which hides which."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.ui.views.stage.body_parts import Body
from studio.ui.views.stage.camera import NEAR, Camera

Array = NDArray[np.float64]

EDGE = 40  # points of an outline: of a circle of 100 px the corners are 0.3 px inside
_ANGLES = np.arange(EDGE) * (2 * np.pi / EDGE)
_DIRECTIONS = np.stack([np.cos(_ANGLES), np.sin(_ANGLES)], axis=-1)

LIGHT = np.array([-0.44, 0.60, 0.67]) / np.linalg.norm([-0.44, 0.60, 0.67])
"""Towards the light, along the picture's right and up and the way towards the eye: over the camera's left shoulder."""
_LIGHT_ON_PICTURE = np.array([LIGHT[0], -LIGHT[1]]) / np.hypot(LIGHT[0], LIGHT[1])

_STATIONS = np.linspace(0.0, 1.0, 4)  # along an axis; where two parts are compared
SAME_DEPTH = 0.008  # m; within this neither of two parts hides the other


@dataclass(frozen=True)
class Outlines:
    """One body on one picture; rows are parts, ``drawable`` says which rows have numbers."""

    edges: Array
    """(parts, EDGE, 2), px."""
    axis: Array
    """(parts, 2, 2), px: upper and lower end."""
    widths: Array
    """(parts, 2), px: half the width of both ends."""
    middles: Array
    """(parts, 2), px: middle of the axis."""
    across: Array
    """(parts, 2), px: from the middle line to the lit edge, where the shade runs along."""
    shade_middle: Array
    """(parts, 2), px: half-way between the lit and the dark edge."""
    light_across: Array
    """(parts,), 0…1: how much the light comes from the lit edge."""
    light_towards: Array
    """(parts,), 0…1: how much it comes from the eye's side."""
    along: Array
    """(parts, 2), unit: the axis on the picture."""
    scale: Array
    """(parts,), px per metre."""
    drawable: NDArray[np.bool_]
    """(parts,)."""
    hairline: float
    """px."""
    order: tuple[int, ...]
    """Drawable parts, farthest first."""


def outlines(body: Body, camera: Camera, world_from_segment: Array, joints: Array, leads: Array) -> Outlines:
    """Return the body on the picture of ``camera``.

    Parameters
    ----------
    world_from_segment : (23, 4)
    joints : (23, 3), m, world
    leads : (parts,), m; how much nearer a part counts where it is as deep as another
    """
    known = np.isfinite(np.concatenate([world_from_segment, joints], axis=1)).all(axis=1)
    if not known.all():
        world_from_segment = np.where(known[:, None], world_from_segment, rotation.IDENTITY)
        joints = np.where(known[:, None], joints, 0.0)
    seen = camera.seen(np.concatenate(body.posed(world_from_segment, joints), axis=1))
    drawable = np.logical_and((seen[..., 2] > NEAR).all(axis=1), body.whole(known))
    # what is not drawn gets a harmless place: nothing is projected from behind the eye
    seen[~drawable] = (0.0, 0.0, 1.0)
    points = camera.on_picture(seen)
    balls, axis, seen_balls, seen_ends = points[:, :-2], points[:, -2:], seen[:, :-2], seen[:, -2:]
    radii = body.radii * (camera.focal / seen_balls[..., 2])
    scale = 2.0 * camera.focal / (seen_ends[:, 0, 2] + seen_ends[:, 1, 2])
    widths = body.end_widths * scale[:, None]
    across, towards, lit = _light(seen_ends, axis, radii.max(axis=1))
    towards_light = balls[..., 0] * lit[:, :1] + balls[..., 1] * lit[:, 1:]
    far, near = (towards_light + radii).max(axis=1), (towards_light - radii).min(axis=1)
    middle = 0.5 * (axis[:, 0] + axis[:, 1])
    offset = 0.5 * (far + near) - (middle * lit).sum(axis=-1)
    return Outlines(
        edges=_hulls(balls, radii),
        axis=axis,
        widths=widths,
        middles=middle,
        across=lit * (0.5 * (far - near))[:, None],
        shade_middle=middle + lit * offset[:, None],
        light_across=across,
        light_towards=towards,
        along=_unit(axis[:, 1] - axis[:, 0]),
        scale=scale,
        drawable=drawable,
        hairline=camera.hairline,
        order=_painting_order(_neighbours(balls, radii), axis, seen_ends[..., 2], widths, drawable, leads),
    )


def grown(edges: Array, by: float) -> Array:
    """Return outlines that stand ``by`` px outside, (parts, EDGE, 2)."""
    return np.asarray(edges + by * _DIRECTIONS)


def distances(edges: Array, points: Array) -> Array:
    """Return how far ``points`` (n, 2), px, are outside each outline, (n, parts); inside it is negative."""
    return np.asarray(((points[:, None, None] - edges) * _DIRECTIONS).sum(axis=-1).max(axis=-1))


def _hulls(balls: Array, radii: Array) -> Array:
    """Return the edge of the hull of each row of circles: in each direction that of the outermost circle."""
    reach = balls @ _DIRECTIONS.T + radii[..., None]
    outermost = reach.argmax(axis=1)
    rows = np.arange(len(balls))[:, None]
    return np.asarray(balls[rows, outermost] + radii[rows, outermost][..., None] * _DIRECTIONS)


def _light(seen_ends: Array, axis: Array, radius: Array) -> tuple[Array, Array, Array]:
    """Return how the light falls on round limbs: its parts across and towards the eye, and the lit direction.

    A cylinder's normals lie between ``across``, in the picture, and ``towards``, as near to the eye as the limb allows.
    What is short or points at the eye is lit like a ball: the direction slides to that of the light.
    """
    along = seen_ends[:, 1] - seen_ends[:, 0]
    along[:, 2] *= -1.0
    on_picture = axis[:, 1] - axis[:, 0]
    length = np.hypot(on_picture[:, 0], on_picture[:, 1])
    slender = _share(length / (2.0 * radius) - 0.25)[:, None]
    side = _unit(np.stack([-on_picture[:, 1], on_picture[:, 0]], axis=-1))
    side *= np.where(side @ _LIGHT_ON_PICTURE < 0.0, -1.0, 1.0)[:, None]
    lit = _unit(slender * side + (1.0 - slender) * _LIGHT_ON_PICTURE)
    unit = _unit(along) * slender
    facing = np.array([0.0, 0.0, 1.0]) - unit * unit[:, 2:]
    towards = _share(_unit(facing) @ LIGHT)
    across = _share(lit[:, 0] * LIGHT[0] - lit[:, 1] * LIGHT[1])
    return across, towards, lit


def _painting_order(
    pairs: tuple[NDArray[np.intp], NDArray[np.intp]],
    axis: Array,
    depths: Array,
    widths: Array,
    drawable: NDArray[np.bool_],
    leads: Array,
) -> tuple[int, ...]:
    """Return the drawable parts so that what hides comes after what is hidden.

    Two parts are compared where they overlap on the picture: at stations along their axes, the more the closer these
    are. Parts that hide each other in a ring, which bodies do not, are taken by their middle.

    Parameters
    ----------
    axis : (parts, 2, 2), px
    depths : (parts, 2), m: of both ends of the axis
    widths : (parts, 2), px: half the width of both ends
    """
    first, second = pairs
    share = _STATIONS[None, :]
    stations = axis[:, :1] * (1 - share[..., None]) + axis[:, 1:] * share[..., None]
    width = widths[:, :1] * (1 - share) + widths[:, 1:] * share
    # 1/depth is what runs evenly on the picture
    inverse = 1.0 / depths
    depth = 1.0 / (inverse[:, :1] * (1 - share) + inverse[:, 1:] * share) - leads[:, None]
    x, y = (stations[first, :, None, way] - stations[second, None, :, way] for way in (0, 1))
    limit = width[first][:, :, None] + width[second][:, None]
    overlap = np.maximum(1.0 - (x * x + y * y) / (limit * limit), 0.0)
    behind = ((depth[first][:, :, None] - depth[second][:, None]) * overlap).sum(axis=(1, 2))
    behind /= np.maximum(overlap.sum(axis=(1, 2)), 1e-9)
    earlier = [0] * len(axis)
    for i, j, way in zip(first.tolist(), second.tolist(), behind.tolist(), strict=True):
        if way > SAME_DEPTH:
            earlier[j] |= 1 << i
        elif way < -SAME_DEPTH:
            earlier[i] |= 1 << j
    farthest = [int(row) for row in np.argsort(-depth.mean(axis=1)) if drawable[row]]
    return _in_turn(farthest, earlier)


def _neighbours(balls: Array, radii: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the pairs of parts whose boxes overlap on the picture."""
    least = (balls - radii[..., None]).min(axis=1)
    most = (balls + radii[..., None]).max(axis=1)
    touching = (least[:, None] < most[None]).all(axis=-1)
    first, second = np.nonzero(np.triu(touching & touching.T, 1))
    return first, second


def _in_turn(farthest: list[int], earlier: list[int]) -> tuple[int, ...]:
    waiting, order = farthest, []
    left = sum(1 << row for row in waiting)
    while waiting:
        row = next((row for row in waiting if not earlier[row] & left), waiting[0])
        waiting.remove(row)
        left &= ~(1 << row)
        order.append(row)
    return tuple(order)


def _share(values: Array) -> Array:
    return np.minimum(np.maximum(values, 0.0), 1.0)


def _unit(vectors: Array) -> Array:
    length = np.sqrt((vectors * vectors).sum(axis=-1, keepdims=True))
    return np.asarray(vectors / np.maximum(length, 1e-9))
