"""What is shown of a solved take: measures over a stretch, the envelope, what is missing, where headings come from."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core.body import PLACES, Place
from studio.core.take import Alignment
from studio.ui.models.take_review import (
    envelope,
    gaps,
    heading_sources,
    in_words,
    lost_share,
    measure,
    places_of,
    review_take,
    value_at,
)
from studio.ui.views.take_facts import facts_of
from tests.export.moving_body import moving_body
from tests.ui.reviewed import FRAME_S, limb, review, summary

KNEE = "left_knee_flexion"


@pytest.fixture(scope="module")
def shown():
    return review(left_shank=slice(100, 110))


def test_a_measure_is_that_of_the_numbers_in_the_stretch(shown):
    found = measure(shown, KNEE, 1.0, 3.0)
    rows = (shown.motion.time >= 1.0 - 1e-9) & (shown.motion.time <= 3.0 + 1e-9)
    values = shown.degrees[KNEE][rows]

    assert (found.least, found.most) == (values.min(), values.max())
    assert found.range == pytest.approx(np.ptp(values))
    assert shown.degrees[KNEE][round(found.most_at / FRAME_S)] == found.most
    assert found.missing == 0.0


def test_what_was_not_measured_is_told_and_not_counted():
    motion = moving_body(frames=100)
    motion.measured[Place.LEFT_SHANK][:25] = False
    take = review_take(summary(), (), motion)

    assert measure(take, KNEE, 0.0, 10.0).missing == pytest.approx(0.25)
    assert np.isnan(measure(take, KNEE, 0.0, 0.3).most)
    assert np.isnan(value_at(take, KNEE, 0.1))
    assert np.isfinite(value_at(take, KNEE, 1.0))


def test_the_value_under_the_playhead_is_that_of_the_frame(shown):
    assert value_at(shown, KNEE, 2.0 + 0.4 * FRAME_S) == shown.degrees[KNEE][100]
    assert value_at(shown, KNEE, 1e6) == shown.degrees[KNEE][-1]


@pytest.mark.parametrize("columns", [7, 100, 1500])
def test_the_envelope_loses_no_extreme_and_has_no_holes(columns):
    time = np.arange(300, dtype=np.float64) * FRAME_S
    values = (50 * np.sin(7 * time)).astype(np.float64)
    least, most = envelope(time, values, np.linspace(0.0, float(time[-1]) + FRAME_S, columns + 1).astype(np.float64))

    assert np.nanmax(most) == values.max()
    assert np.nanmin(least) == values.min()
    assert (least <= most).all()
    assert (least[1:] <= most[:-1]).all()
    assert (least[:-1] <= most[1:]).all()


def test_the_envelope_is_empty_where_nothing_was_measured():
    time = np.arange(100, dtype=np.float64) * FRAME_S
    values = np.where((time > 0.5) & (time < 1.5), np.nan, 1.0).astype(np.float64)
    least, _ = envelope(time, values, np.linspace(0.0, 2.0, 9).astype(np.float64))

    assert np.isnan(least).tolist() == [False, False, False, True, True, True, False, False]


def test_a_gap_is_found_where_it_is_long_enough(shown):
    (gap,) = gaps(shown, KNEE, 0.1)

    assert gap.from_s == pytest.approx(100 * FRAME_S - FRAME_S / 2)
    assert gap.to_s == pytest.approx(109 * FRAME_S + FRAME_S / 2)
    assert gaps(shown, KNEE, 0.21) == []
    assert gaps(shown, "right_knee_flexion", 0.0) == []


def test_the_share_of_missing_frames_of_each_column(shown):
    share = lost_share(shown, KNEE, np.array([0.0, 2.0, 2.4, 6.0]))

    assert share.tolist() == pytest.approx([0.0, 0.5, 0.0])


def test_every_angle_knows_its_sensors(shown):
    for name in shown.degrees:
        assert places_of(name)
    assert places_of(KNEE) == (Place.LEFT_SHANK, Place.LEFT_THIGH)
    assert places_of("trunk_flexion") == (Place.CHEST, Place.PELVIS)
    assert places_of("pelvis_tilt") == (Place.PELVIS,)
    assert places_of("right_shoulder_elevation") == (Place.RIGHT_UPPER_ARM, Place.CHEST)


def test_headings_are_told_by_where_they_come_from():
    limbs = {place: limb() for place in PLACES} | {Place.HEAD: limb("unknown"), Place.LEFT_HAND: limb("strap rule", 15)}
    alignment = Alignment("n", 1.0, 3.0, limbs)
    take = review()
    facts = "\n".join(facts_of(replace(take, motion=replace(take.motion, alignment=alignment))))

    assert heading_sources(alignment)["unknown"] == (Place.HEAD,)
    assert "have no angles: head." in facts
    assert "strapped on (±15°): left hand." in facts
    assert "The bow tells which way limbs face (±2°): chest, left upper arm, " in facts
    assert "and 9 more" not in facts
    assert "9 more" in facts


def test_what_the_numbers_are_relative_to_and_all_notes_are_said(shown):
    facts = " ".join(facts_of(shown))

    assert "Angles are relative to the held N-pose, 00:01.0 to 00:03.0 in this take." in facts
    assert "0.1 % of the samples of 15 sensors were lost." in facts
    assert all(note in facts for note in shown.motion.notes)


def test_a_take_that_was_cut_off_says_so_first():
    take = review(summary(recovered=True, lost=0.0))

    assert facts_of(take)[0] == (
        "▲ Recording was cut off; what was safe by then is here. No sample of 15 sensors was lost."
    )


def test_the_first_choice_are_both_knees_where_they_are_worn():
    motion = moving_body(frames=10)
    arms = {p: motion.measured[p] for p in PLACES[:8]}

    assert review().first_choice() == ("left_knee_flexion", "right_knee_flexion")
    arm_angles = review_take(summary(), (), replace(motion, measured=arms, lost=arms)).first_choice()
    assert len(arm_angles) == 2
    assert all("elbow" in name for name in arm_angles)


def test_names_of_angles_for_people():
    assert in_words("left_shoulder_plane_of_elevation") == "Left shoulder plane of elevation"
