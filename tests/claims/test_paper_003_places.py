"""Paper 003, Table 1: the fifteen sensors, where they sit and what each is there to measure (row 3-07)."""

import json
from pathlib import Path

from studio.core.body import PLACES, SEGMENT_OF, Place, Segment

TABLE = json.loads((Path(__file__).parents[2] / "resources" / "places.json").read_text(encoding="utf-8"))["places"]

# Copied by hand from the printed table: number, sensor, measurand ("supintion" in row 13 put right).
PRINTED = (
    (1, "Forehead", "Rotation and side-bend relating to the origin"),
    (2, "Chest", "Anterior/posterior tilt and lateral tilt to left/right"),
    (3, "Left arm", "Abduction/adduction, flexion/extension"),
    (4, "Right arm", "Abduction/adduction, flexion/extension"),
    (5, "Left wrist", "Abduction/adduction, flexion/extension"),
    (6, "Right wrist", "Abduction/adduction, flexion/extension"),
    (7, "Left hand", "Abduction/adduction, flexion/extension"),
    (8, "Right hand", "Abduction/adduction, flexion/extension"),
    (9, "Sacral(back)", "Rotation and side-bend relating to the origin"),
    (10, "Left knee", "Flexion/extension"),
    (11, "Right knee", "Flexion/extension"),
    (12, "Left ankle", "Plantar-flexion/dorsi-flexion and supination/pronation"),
    (13, "Right ankle", "Plantar-flexion/dorsi-flexion and supination/pronation"),
    (14, "Left ankle", "Rotation and side-bend"),
    (15, "Right ankle", "Rotation and side-bend"),
)

# Figure 2: the sensor of a limb sits on the segment above the joint its row names.
SEGMENTS = (
    (Place.HEAD, Segment.Head),
    (Place.CHEST, Segment.Spine3),
    (Place.LEFT_UPPER_ARM, Segment.LeftArm),
    (Place.RIGHT_UPPER_ARM, Segment.RightArm),
    (Place.LEFT_FOREARM, Segment.LeftForeArm),
    (Place.RIGHT_FOREARM, Segment.RightForeArm),
    (Place.LEFT_HAND, Segment.LeftHand),
    (Place.RIGHT_HAND, Segment.RightHand),
    (Place.PELVIS, Segment.Hips),
    (Place.LEFT_THIGH, Segment.LeftUpLeg),
    (Place.RIGHT_THIGH, Segment.RightUpLeg),
    (Place.LEFT_SHANK, Segment.LeftLeg),
    (Place.RIGHT_SHANK, Segment.RightLeg),
    (Place.LEFT_FOOT, Segment.LeftFoot),
    (Place.RIGHT_FOOT, Segment.RightFoot),
)


def test_3_07_the_body_map_shows_the_fifteen_rows_of_table_1_with_their_measurands():
    shown = tuple((row["number"], row["table_1"]["sensor"], row["table_1"]["measurand"]) for row in TABLE)

    assert shown == PRINTED


def test_3_07_rows_and_places_of_the_program_stand_in_the_same_order():
    assert [(row["number"], row["key"]) for row in TABLE] == [(place.number, place.value) for place in PLACES]


def test_3_07_each_row_moves_its_own_segment():
    assert tuple((place, SEGMENT_OF[place]) for place in PLACES) == SEGMENTS
