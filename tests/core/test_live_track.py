"""One sensor while it sends: late packets, silences, restarts and a new correction."""

from dataclasses import replace

import numpy as np
import pytest

from studio.core import rotation
from studio.core.live_solver import sample_at
from studio.core.live_track import LiveTrack
from studio.core.sample import Correction, Flag, SensorId, SensorInfo
from studio.core.take import Calibration
from tests.core.altered_takes import kept
from tests.core.worn_sensors import RATE, mounted, stream

FRAME = 1 / RATE
ID = SensorId("tag:00000001")
TIME = np.arange(1500) / RATE
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
KNOWN = Calibration(ID, Correction((0.0, 0.0, 0.0), IDENTITY), "", "rest", (np.radians(0.03),) * 3)


def swinging(info=None, bias=(0.0, 0.0, 0.0), still=0.0):
    """A sensor mounted anyhow on something that swings by 40° at 0.5 Hz and turns on; the true attitude, too."""
    moving = np.maximum(TIME - still, 0.0)
    swing = rotation.multiply(rotation.about(2, 0.3 * moving), rotation.about(0, 0.7 * np.sin(np.pi * moving)))
    truth = rotation.multiply(swing, mounted(np.random.default_rng(3)))
    return stream(ID, truth, TIME, info=info, bias=bias), truth


def followed(sent, calibration=KNOWN, wanted="vqf", track=None):
    """Push all samples; return the track, and attitude, group and run after each sample that was taken."""
    live = track or LiveTrack(sent.info, wanted, calibration)
    rows = [
        (sent.time[row], live.attitude, live.group, live.run)
        for row in range(len(sent))
        if live.push(sample_at(sent, row))
    ]
    time, attitude, group, run = zip(*rows, strict=True)
    return live, np.array(time), np.array(attitude), np.array(group), np.array(run)


def off_heading(attitude, truth):
    """Return tilt errors and the change of heading against the truth since the first row, degrees."""
    turn = rotation.multiply(attitude, rotation.inverse(truth))
    heading = rotation.twist_about(turn, 2)
    tilt = rotation.angle_between(turn, rotation.about(2, heading))
    return np.degrees(tilt), np.degrees(np.unwrap(heading) - heading[0])


def test_a_packet_that_comes_twice_or_too_late_is_not_stepped():
    sent, _ = swinging()
    live, _, attitude, _, _ = followed(kept(sent, np.arange(100)))

    for row in (99, 98, 0):
        assert not live.accepts(sample_at(sent, row))
        assert not live.push(sample_at(sent, row))
    assert live.attitude == tuple(attitude[-1])
    assert live.push(sample_at(sent, 100))


def test_a_packet_of_before_the_restart_is_too_late_as_well():
    sent, _ = swinging()
    epoch = (np.arange(len(sent)) >= 50).astype(np.int32)
    again = replace(sent, epoch=epoch, frame=np.where(epoch, np.arange(len(sent)) - 50, np.arange(len(sent))))
    live, *_ = followed(kept(again, (np.arange(len(sent)) < 60) & (np.arange(len(sent)) != 49)))

    assert not live.push(sample_at(again, 49))
    assert live.group == 1


@pytest.mark.parametrize("seconds", [0.5, 2.0, 8.0, 20.0])
@pytest.mark.parametrize("wanted", ["vqf", "gyro"])
def test_in_a_silence_the_tags_own_quaternion_tells_how_it_turned(wanted, seconds):
    """In the middle of a swing a filter that began anew would be wrong by tens of degrees."""
    sent, truth = swinging()
    heard = (TIME < 7.3) | (7.3 + seconds <= TIME)

    _, _, attitude, group, run = followed(kept(sent, heard), wanted=wanted)

    tilt, heading = off_heading(attitude, truth[heard])
    after = TIME[heard] > 7.3
    assert tilt[after].max() < 2.0
    assert np.abs(heading[after] - heading[~after][-1]).max() < 2.0
    assert set(group) == {0}
    assert run[-1] == (1 if seconds > 1 else 0)


def test_a_tag_that_started_anew_has_another_heading():
    sent, _ = swinging()
    row = 400
    orientation, epoch = sent.orientation.copy(), sent.epoch.copy()
    orientation[row:] = rotation.multiply(rotation.inverse(orientation[row]), orientation[row:])
    epoch[row:] = 1

    _, _, _, group, run = followed(replace(sent, orientation=orientation, epoch=epoch))

    assert set(group[:row]) == set(run[:row]) == {0}
    assert set(group[row:]) == set(run[row:]) == {1}


def test_a_raw_offset_turns_a_tags_quaternion_by_too_much_in_a_silence():
    sent, _ = swinging()
    heard = (TIME < 7.3) | (TIME >= 9.3)

    _, time, _, group, _ = followed(kept(sent, heard), calibration=None)

    assert set(group[time > 9.0]) == {1}


def test_an_offset_known_to_a_thirtieth_of_a_degree_a_second_carries_a_minute_and_no_further():
    """2 degrees are what may come in: 0.03 °/s times 66 s."""
    sent, _ = swinging()
    later = np.arange(len(sent)) >= 500
    for silent_for, groups in ((64.0, {0}), (69.0, {0, 1})):
        frame = sent.frame + later * round(silent_for * RATE)
        _, _, _, group, _ = followed(replace(sent, frame=frame, time=frame * FRAME))
        assert set(group) == groups


def test_a_source_with_a_common_heading_tells_it_after_any_silence():
    """A gyroscope of which nobody knows the offset; the device's own orientation leads across."""
    info = SensorInfo(ID, FRAME, orientation="world", common_world=True)
    sent, truth = swinging(info)
    heard = (TIME < 7.3) | (TIME >= 17.3)
    told = replace(kept(sent, heard), orientation=truth[heard])

    _, _, attitude, group, _ = followed(told, calibration=None)

    tilt, heading = off_heading(attitude, truth[heard])
    after = TIME[heard] > 17.0
    assert tilt[after].max() < 2.0
    assert np.abs(heading[after] - heading[~after][-1]).max() < 3.0
    assert set(group) == {0}


def test_corrected_anew_the_attitude_goes_on_and_the_old_offset_is_forgotten():
    """Raw at first, so that the filter learns an offset of 6 °/s; then the calibration takes it out."""
    bias = (0.1, -0.05, 0.08)
    sent, truth = swinging(bias=bias, still=6.0)
    first, rest = kept(sent, TIME < 5.0), kept(sent, TIME >= 5.0)
    live, _, before, _, _ = followed(first, calibration=None)

    live.recalibrate(Calibration(ID, Correction(bias, IDENTITY), "", "rest", (np.radians(0.01),) * 3))
    _, _, attitude, group, _ = followed(rest, track=live)

    assert np.degrees(rotation.angle_between(before[-1], attitude[0])) < 0.5
    _, heading = off_heading(attitude, truth[TIME >= 5.0])
    assert np.abs(heading).max() < 1.0
    assert set(group) == {0}


def test_samples_of_a_broken_chip_are_not_stepped():
    sent, _ = swinging()
    flags = sent.flags.copy()
    flags[50] = Flag.IMU_ERROR

    _, time, _, _, _ = followed(replace(sent, flags=flags))

    assert sent.time[50] not in time


def test_a_tag_that_corrects_by_itself_and_does_not_tell_how_is_not_corrected_twice():
    """Its quaternion is right already; offset and gain of a file would turn it away."""
    sent, truth = swinging()
    fast = Calibration(ID, Correction((0.2, 0.2, 0.2), IDENTITY), "", "table", (np.radians(0.01),) * 3)
    flags = sent.flags | np.uint32(Flag.CALIBRATED)

    _, _, silently, _, _ = followed(replace(sent, flags=flags), calibration=fast)
    told = replace(sent, flags=flags, info=replace(sent.info, correction=Correction((0.0,) * 3, IDENTITY)))
    _, _, corrected, _, _ = followed(told, calibration=fast)

    assert np.abs(off_heading(silently, truth)[1]).max() < 3.0
    assert np.abs(off_heading(corrected, truth)[1]).max() > 30.0


@pytest.mark.parametrize("step_back", [0.0, 1.0, 5.0])
def test_a_device_whose_clock_is_fitted_anew_when_it_starts_again_goes_on(step_back):
    sent, truth = swinging(SensorInfo(ID, FRAME, orientation="world", common_world=True))
    row = 700
    epoch, time = sent.epoch.copy(), sent.time.copy()
    epoch[row:] += 1
    time[row:] -= time[row] - time[row - 1] + step_back

    live, _, attitude, _, _ = followed(replace(sent, orientation=truth, epoch=epoch, time=time))

    tilt, heading = off_heading(attitude, truth)
    assert live.group == 0
    assert np.isfinite(attitude).all()
    assert max(np.abs(heading[200:] - heading[200]).max(), tilt[200:].max()) < 3.0
