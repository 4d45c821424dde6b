"""How a tag sits when it was strapped on as the pictures show (contracts §3c), and that they show the same rule."""

import json
from pathlib import Path

import numpy as np
import pytest

from studio.core import frames, rotation
from studio.core.body import PLACES, Place
from studio.core.strapping import STRAPS, strap_rule

ARROW, FACE = np.array([1.0, 0, 0]), np.array([0, 0, 1.0])
FORWARD, LEFT, UP = np.eye(3)  # world axes of the wearer
PLACES_FILE = Path(__file__).parents[2] / "resources" / "places.json"


def in_the_world(place, axis):
    """Return where an axis of the tag points while its wearer stands in N-pose."""
    world_from_sensor = rotation.multiply(frames.N_POSE, rotation.inverse(strap_rule()[place]))
    return rotation.rotate(world_from_sensor, axis)


def test_the_pictures_and_the_arithmetic_follow_one_rule():
    rows = json.loads(PLACES_FILE.read_text(encoding="utf-8"))["places"]

    assert {row["key"]: (row["strap"]["arrow"], row["strap"]["face"]) for row in rows} == {
        place.value: tuple(strap) for place, strap in STRAPS.items()
    }


def test_every_place_has_names_and_a_band():
    rows = json.loads(PLACES_FILE.read_text(encoding="utf-8"))["places"]

    assert all(row["names"]["clinic"] and row["names"]["plain"] and row["strap"]["band"] for row in rows)
    assert len({row["names"]["clinic"] for row in rows}) == len({row["names"]["plain"] for row in rows}) == 15


@pytest.mark.parametrize("place", [place for place in PLACES if "foot" not in place.value])
def test_arrows_point_to_the_head_while_the_wearer_stands(place):
    assert in_the_world(place, ARROW) == pytest.approx(UP)


@pytest.mark.parametrize("place", [Place.LEFT_FOOT, Place.RIGHT_FOOT])
def test_on_a_foot_the_arrow_points_to_the_toes_and_the_face_up(place):
    assert in_the_world(place, ARROW) == pytest.approx(FORWARD)
    assert in_the_world(place, FACE) == pytest.approx(UP)


@pytest.mark.parametrize(
    ("places", "outwards"),
    [
        ((Place.HEAD, Place.CHEST, Place.LEFT_THIGH, Place.RIGHT_THIGH, Place.LEFT_SHANK, Place.RIGHT_SHANK), FORWARD),
        ((Place.PELVIS,), -FORWARD),
        ((Place.LEFT_UPPER_ARM, Place.LEFT_FOREARM, Place.LEFT_HAND), LEFT),
        ((Place.RIGHT_UPPER_ARM, Place.RIGHT_FOREARM, Place.RIGHT_HAND), -LEFT),
    ],
)
def test_faces_point_away_from_the_body(places, outwards):
    for place in places:
        assert in_the_world(place, FACE) == pytest.approx(outwards)
