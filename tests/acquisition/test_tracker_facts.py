"""What tags tell besides samples: corrections, numbers, silence; and what a stranger may make the tracker keep."""

from dataclasses import replace

import numpy as np
import pytest

from studio.acquisition.dialects import tag_advert
from studio.acquisition.dialects.dialect import Reading
from studio.acquisition.tracker import MOST_SENSORS
from studio.core.sample import Correction, Flag, SensorId
from tests.acquisition.tracked_tags import ROWS, SENSOR, Tag, frames, kinds, link, samples


def test_a_packet_in_place_of_a_sample_counts_and_is_flagged_for_filling():
    tracker, tag = link(), Tag()
    nothing = (float("nan"),) * 3
    facts = {"firmware": "1.0", "battery_volt": 3.7, "calibration_crc": 7, "serial": "12345678", "address": "c0:aa"}
    info = tag.reading(5, rate=nothing, acceleration=nothing, temperature=25.0, facts=facts)

    found = samples(tracker, [*tag.heard(range(5)), (info, tag.measured(5)), *tag.heard(range(6, 10))])

    assert frames(found) == list(range(10))
    assert [bool(s.flags & Flag.FILLED) for s in found] == [k == 5 for k in range(10)]
    assert np.isnan([*found[5].rate, *found[5].acceleration]).all()
    assert found[5].orientation == (1.0, 0.0, 0.0, 0.0)
    assert (tracker.health[SENSOR].lost, tracker.health[SENSOR].temperature) == (0, 25.0)
    assert tracker.infos[SENSOR].facts == {"link": "receiver", **facts}


def coefficient(tag: Tag, frame: int, index: int, crc: int = 99, rows=ROWS) -> tuple[Reading, float]:
    nothing = (float("nan"),) * 3
    x, y, z = rows[index]
    facts = {"coefficients": index, "coefficient_x": x, "coefficient_y": y, "coefficient_z": z, "calibration_crc": crc}
    reading = tag.reading(frame, orientation=(float("nan"),) * 4, rate=nothing, acceleration=nothing, facts=facts)
    return reading, tag.measured(frame)


def test_four_rows_with_one_crc_are_the_correction_in_force():
    tracker, tag = link(), Tag()

    samples(tracker, [coefficient(tag, k, index) for k, index in enumerate((2, 0, 0, 3))])
    assert tracker.infos[SENSOR].correction is None
    samples(tracker, [coefficient(tag, 4, 1)])

    assert tracker.infos[SENSOR].correction == Correction(ROWS[0], ROWS[1:])
    assert kinds(tracker) == ["found", "coefficients"]


@pytest.mark.parametrize(
    "rows",
    [
        ((0.0, 0.0, 0.0),) * 4,
        ((float("nan"), 0.0, 0.0), *ROWS[1:]),
        (ROWS[0], *(tuple(100.0 * c for c in row) for row in ROWS[1:])),
    ],
)
def test_a_correction_that_no_gyroscope_needs_is_unknown_until_the_tag_tells_another(rows):
    tracker, tag = link(), Tag()

    samples(tracker, [coefficient(tag, k, k, rows=rows) for k in range(4)])
    assert tracker.infos[SENSOR].correction is None
    samples(tracker, [coefficient(tag, 4 + k, k) for k in range(4)])

    assert tracker.infos[SENSOR].correction == Correction(ROWS[0], ROWS[1:])
    assert kinds(tracker) == ["found", "coefficients implausible", "coefficients"]


def test_rows_of_two_calibrations_are_never_mixed():
    tracker, tag = link(), Tag()

    samples(tracker, [coefficient(tag, k, index, crc=k // 2) for k, index in enumerate((0, 1, 2, 3))])

    assert tracker.infos[SENSOR].correction is None


def test_a_tag_calibrated_again_makes_its_correction_unknown():
    tracker, tag = link(), Tag()
    samples(tracker, [coefficient(tag, k, k) for k in range(4)])

    samples(tracker, [(tag.reading(4, facts={"calibration_crc": 100}), tag.measured(4))])

    assert tracker.infos[SENSOR].correction is None
    assert kinds(tracker) == ["found", "coefficients", "coefficients outdated"]


def test_two_tags_with_one_number_are_told_once():
    tracker = link()
    twin = Tag(tag_advert.sensor_of(7))

    samples(tracker, [item for k in range(100) for tag in (Tag(), twin) for item in tag.heard([k])])

    told = [facts for kind, facts in tracker.take_events() if kind == "duplicate number"]
    assert told == [{"number": 3, "sensors": ["tag:00000007", "tag:12345678"]}]
    assert {tracker.health[s].lost for s in tracker.health} == {0}


def test_a_number_given_to_another_tag_after_the_first_fell_silent_is_no_conflict():
    tracker = link()
    samples(tracker, Tag().heard(range(10)))

    samples(tracker, Tag(tag_advert.sensor_of(7), powered=110.0).heard(range(10)))

    assert kinds(tracker) == ["found", "found"]


def test_a_tag_given_another_number_is_the_same_sensor():
    tracker, tag = link(), Tag()

    samples(tracker, [*tag.heard(range(5)), *replace(tag, number=9).heard(range(5, 10))])

    assert tracker.infos[SENSOR].number == 9
    events = tracker.take_events()
    assert events[-1] == ("number", {"sensor": SENSOR, "before": 3, "number": 9})


def test_silence_over_half_a_second_is_an_event_with_its_ends():
    tracker, tag = link(), Tag()

    samples(tracker, tag.heard([*range(50), *range(76, 100), *range(120, 150)]))

    (kind, facts), *rest = [event for event in tracker.take_events() if event[0] != "found"]
    assert (kind, rest) == ("gap", [])
    assert facts["frames"] == 26
    assert (facts["from"], facts["to"]) == pytest.approx((100.983, 101.523), abs=1e-3)


def test_a_stream_of_invented_serials_stays_bounded():
    tracker = link()

    for serial in range(2 * MOST_SENSORS):
        tracker.accept(Tag(tag_advert.sensor_of(serial), number=0).reading(0), 100.0)

    assert len(tracker.infos) == MOST_SENSORS
    assert tracker.ignored == MOST_SENSORS


def test_packets_a_dialect_refused_are_kept_with_their_sensor():
    tracker = link()
    samples(tracker, Tag().heard(range(3)))

    tracker.note_refused({SENSOR: 5, SensorId("tag:ffffffff"): 2})

    assert tracker.health[SENSOR].snapshot(101.0).malformed == 5
    assert list(tracker.health) == [SENSOR]
