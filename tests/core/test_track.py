"""The attitude of one sensor through a take: what it may be believed, and what it may not."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.body import PRESETS, SEGMENT_OF, Place
from studio.core.errors import HeadingsUnknown
from studio.core.sample import Correction, Flag, SensorInfo
from studio.core.solver import SolveOptions, solve, solve_tracks
from studio.core.strapping import strap_rule
from studio.core.take import Calibration
from tests.core.altered_takes import changed, kept, rested, silent
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, RATE, mounted, sensor_of, stream, worn_take

LOWER = PRESETS["lower"]
FRAME = 1 / RATE
THIGH, SHANK = Place.RIGHT_THIGH, Place.RIGHT_SHANK
NAN = float("nan")
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def knee(motion):
    return motion.parent_from_child(SEGMENT_OF[THIGH], SEGMENT_OF[SHANK])


def true_knee(truth):
    return rotation.multiply(rotation.inverse(truth[THIGH]), truth[SHANK])


@pytest.mark.parametrize("method", ["offline", "live"])
@pytest.mark.parametrize(("from_s", "to_s"), [(12.3, 13.6), (12.3, 15.3), (14.1, 16.4)])
def test_after_a_silence_in_the_middle_of_a_swing_the_angles_are_right_at_once(method, from_s, to_s):
    """The tag's own quaternion leads across: tilt and heading both go on, and the filter need not settle."""
    take, truth = worn_take(LOWER)

    motion = solve(rested(silent(take, THIGH, from_s, to_s)), SolveOptions(method=method)).motion

    after = motion.measured[THIGH] & (motion.time > to_s)
    assert after.sum() > 100
    rows = np.round(motion.time[after] * RATE).astype(int)
    errors = np.degrees(rotation.angle_between(knee(motion)[after], true_knee(truth)[rows]))
    assert errors.max() < 1.5


def test_an_offset_is_taken_out_of_all_of_a_silence():
    """0.37 °/s over five seconds are 1.9 degrees of heading."""
    time = np.arange(1500) / RATE
    still = np.tile(mounted(np.random.default_rng(6)), (len(time), 1))
    sent = stream(sensor_of(THIGH), still, time, bias=(0.0, 0.0065, 0.0))
    take, _ = worn_take((THIGH,))
    alone = replace(take, streams=(kept(sent, (time < 12.0) | (time >= 17.0)),))

    track = solve_tracks(alone, SolveOptions(attitude="gyro"))[sensor_of(THIGH)]

    assert set(track.group) == {0}
    assert np.degrees(rotation.angle_between(track.attitude[0], track.attitude)).max() < 0.2


def told(take, truth, place, info, **changes):
    """Return the take with another kind of sensor on a place, strapped on as the pictures show."""
    world_from_sensor = rotation.multiply(truth[place], rotation.inverse(strap_rule()[place]))
    made = stream(sensor_of(place), world_from_sensor, take.streams[0].time, info=info)
    empty = {name: np.full_like(getattr(made, name), NAN) for name, gone in changes.items() if gone}
    return changed(take, place, lambda _: replace(made, **empty))


def gyroscope(place):
    return SensorInfo(sensor_of(place), FRAME, orientation="none", has_acceleration=False)


def test_a_gyroscope_alone_is_integrated_whatever_filter_was_asked_for():
    take, truth = worn_take(LOWER)
    alone = told(take, truth, THIGH, gyroscope(THIGH), orientation=True, acceleration=True)

    for wanted in ("vqf", "gyro", "device"):
        track = solve_tracks(alone, SolveOptions(attitude=wanted))[sensor_of(THIGH)]
        assert track.estimator == "gyro"
        assert not track.levelled.any()
        turned = rotation.multiply(rotation.inverse(track.attitude[500]), track.attitude[700])
        sensor = rotation.multiply(truth[THIGH], rotation.inverse(strap_rule()[THIGH]))
        true = rotation.multiply(rotation.inverse(sensor[500]), sensor[700])
        assert np.degrees(rotation.angle_between(turned, true)) < 1.5


def test_without_an_accelerometer_gravity_is_not_believed_and_the_limb_is_unknown():
    """Its level would be whatever it had when it was switched on: a bow tells nothing then."""
    take, truth = worn_take(LOWER)
    alone = told(take, truth, THIGH, gyroscope(THIGH), orientation=True, acceleration=True)

    motion = solve(alone).motion

    assert motion.alignment.limbs[THIGH].source == "unknown"
    assert not motion.measured[THIGH].any()
    assert any("right thigh" in note for note in motion.notes)


@pytest.mark.parametrize("orientation", ["none", "integrated"])
@pytest.mark.parametrize(("poses", "source"), [((N_HOLD,), "strap rule"), ((N_HOLD, BOW_HOLD), "bow")])
def test_without_an_accelerometer_the_strap_rule_levels_the_tag_at_the_hold(orientation, poses, source):
    """Level from then on, it tells by how much it tilted in the bow as any other does."""
    take, truth = worn_take(LOWER, poses=poses)
    info = replace(gyroscope(THIGH), orientation=orientation)
    alone = told(take, truth, THIGH, info, orientation=orientation == "none", acceleration=True)
    strapped = replace(alone, setup=replace(alone.setup, mounting="strapped"))

    motion = solve(strapped).motion

    assert motion.alignment.limbs[THIGH].source == source
    thigh = motion.world_from_segment[:, SEGMENT_OF[THIGH]]
    assert np.degrees(rotation.angle_between(thigh, truth[THIGH])).max() < 1.5


def test_a_device_that_levels_itself_needs_no_accelerometer_of_ours():
    take, truth = worn_take(LOWER)
    info = SensorInfo(sensor_of(THIGH), FRAME, orientation="world", has_acceleration=False)
    world_from_sensor = rotation.multiply(truth[THIGH], mounted(np.random.default_rng(4)))
    made = stream(sensor_of(THIGH), world_from_sensor, take.streams[0].time, info=info)
    filtered = replace(made, orientation=world_from_sensor, acceleration=np.full_like(made.acceleration, NAN))

    solution = solve(changed(take, THIGH, lambda _: filtered))

    assert solution.tracks[sensor_of(THIGH)].estimator == "device"
    assert solution.motion.alignment.limbs[THIGH].source == "bow"


@pytest.mark.parametrize("method", ["offline", "live"])
@pytest.mark.parametrize("rows", [0, 1])
def test_a_worn_sensor_that_hardly_sent_anything_is_unknown_and_named(method, rows):
    take, _ = worn_take(LOWER)

    motion = solve(changed(take, THIGH, lambda s: kept(s, np.arange(rows) + 600)), SolveOptions(method=method)).motion

    assert not motion.measured[THIGH].any()
    assert motion.measured[SHANK][1:-1].all()
    assert any("right thigh" in note for note in motion.notes)


def test_a_sensor_that_only_feels_gravity_has_no_attitude():
    take, truth = worn_take(LOWER)
    info = SensorInfo(sensor_of(THIGH), FRAME, orientation="none", has_rate=False)
    feeling = told(take, truth, THIGH, info, orientation=True, rate=True)

    solution = solve(feeling)

    assert len(solution.tracks[sensor_of(THIGH)].time) == 0
    assert not solution.motion.measured[THIGH].any()


def test_no_attitude_of_a_track_is_anything_but_a_rotation():
    """An accelerometer that sends infinities makes no NaN of the orientations that are exported."""
    take, truth = worn_take(LOWER)

    def spoilt(sent):
        force = sent.acceleration.copy()
        force[::7] = np.inf
        force[::11] = NAN
        return replace(sent, acceleration=force)

    for info in (None, SensorInfo(sensor_of(THIGH), FRAME, orientation="world")):
        alone = told(take, truth, THIGH, info) if info else take
        for wanted in ("vqf", "gyro", "device"):
            track = solve_tracks(changed(alone, THIGH, spoilt), SolveOptions(attitude=wanted))[sensor_of(THIGH)]
            assert len(track.time) == len(take.streams[0])
            np.testing.assert_allclose(np.linalg.norm(track.attitude, axis=1), 1.0, atol=1e-6)


def test_a_calibration_of_a_tag_whose_own_correction_is_unknown_is_not_applied_and_said_so():
    take, truth = worn_take(LOWER)
    of_a_file = Calibration(
        sensor_of(THIGH), Correction((0.0, 0.0, 0.3), IDENTITY), "", "table", (np.radians(0.01),) * 3
    )
    options = SolveOptions(calibrations={sensor_of(THIGH): of_a_file})

    def correcting(sent):
        return replace(sent, flags=sent.flags | np.uint32(Flag.CALIBRATED))

    motion = solve(changed(take, THIGH, correcting), options).motion

    (note,) = [note for note in motion.notes if "did not tell how" in note]
    assert "right thigh" in note
    assert np.degrees(rotation.angle_between(knee(motion), true_knee(truth))).max() < 1.5
    assert not any("did not tell how" in note for note in solve(take, options).motion.notes)


def test_packets_that_tell_of_the_tag_are_not_lost_in_the_motion():
    take, _ = worn_take(LOWER)

    def telling(sent):
        orientation, flags = sent.orientation.copy(), sent.flags.copy()
        orientation[300::50] = NAN
        flags[300::50] = Flag.FILLED
        return replace(sent, orientation=orientation, flags=flags)

    for method in ("offline", "live"):
        motion = solve(changed(take, THIGH, telling), SolveOptions(method=method)).motion
        assert not motion.lost[THIGH].any()
        assert motion.measured[THIGH].all()


def test_the_strap_rule_is_not_asked_where_nobody_said_that_tags_are_strapped():
    take, truth = worn_take((THIGH,), poses=(N_HOLD,))
    alone = told(take, truth, THIGH, gyroscope(THIGH), orientation=True, acceleration=True)

    with pytest.raises(HeadingsUnknown):
        solve(alone)


def frozen(acceleration):
    return np.tile(acceleration[:1], (len(acceleration), 1))


@pytest.mark.parametrize("method", ["offline", "live"])
@pytest.mark.parametrize("broken", [lambda a: np.full_like(a, np.nan), np.zeros_like, lambda a: 1.3 * a, frozen])
def test_an_accelerometer_that_feels_no_gravity_is_not_believed_and_the_limb_is_unknown(method, broken):
    take, _ = worn_take(LOWER, 20.0)
    take = changed(take, THIGH, lambda s: replace(s, acceleration=broken(s.acceleration)))

    motion = solve(take, SolveOptions(method=method)).motion

    unknown = {place for place, limb in motion.alignment.limbs.items() if limb.source == "unknown"}
    assert unknown == {THIGH}
    assert not motion.measured[THIGH].any()


@pytest.mark.parametrize("method", ["offline", "live"])
def test_an_accelerometer_at_a_fourth_of_the_rate_of_the_gyroscope_is_believed(method):
    take, _ = worn_take(LOWER, 20.0)
    rarely = changed(take, THIGH, lambda s: replace(s, acceleration=s.acceleration[np.arange(len(s)) // 4 * 4]))

    motion = solve(rarely, SolveOptions(method=method)).motion

    assert motion.alignment.limbs[THIGH].source == "bow"
