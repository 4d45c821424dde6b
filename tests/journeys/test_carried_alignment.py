"""The body is calibrated, time passes, and only then a take begins: it is solved all the same."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest

from studio.capture.live_session import LiveSession
from studio.core import rotation
from studio.core.body import SEGMENT_OF
from studio.core.sample import NO_CORRECTION
from studio.core.solver import SolveOptions, solve
from studio.core.take import Calibration
from studio.storage.take_reader import read_take
from tests.capture.known_suit import LOWER, HandFed, between, run, told
from tests.core.worn_sensors import BOW_HOLD, N_HOLD, sensor_of, worn_take

SINCE, UNTIL = 20.0, 28.0  # s since the sensors were switched on; both holds were over at 8 s


def rested(place):
    """Return what a rest on a table tells of an exact sensor: nobody rests in a take that begins in motion."""
    return Calibration(sensor_of(place), NO_CORRECTION, "", "rest", (radians(0.03),) * 3)


@pytest.mark.parametrize("knows", ["rest", "nothing but the holds"])
@pytest.mark.parametrize("method", ["offline", "live"])
def test_a_take_without_any_pose_is_solved_by_the_calibration_it_carries(tmp_path, method, knows):
    worn, truth = worn_take(LOWER, UNTIL + 1)
    rests = tuple(rested(place) for place in LOWER) if knows == "rest" else ()
    take = replace(worn, setup=replace(worn.setup, calibrations=rests))
    pieces = told(take)
    folders = []

    async def story():
        link = HandFed(paced=False)
        session = LiveSession()
        await session.connect("hand", link)
        await link.give(between(pieces, 0, 1))
        await session.sensors_known()
        session.adopt(take.setup)
        await link.give(between(pieces, 1, 8.5))
        await session.held(N_HOLD)
        await session.held(BOW_HOLD)
        await link.give(between(pieces, 8.5, SINCE))
        await session.start_recording(tmp_path, "P014", "walk", "hand")
        await link.give(between(pieces, SINCE, UNTIL))
        folders.append((await session.stop_recording()).folder)
        await session.disconnect()

    run(story())
    kept, _ = read_take(folders[0])
    motion = solve(kept, SolveOptions(method=method)).motion

    assert kept.poses() == ()
    began = round((SINCE - 2.0) * 50)
    rows = np.arange(50, len(motion) - 1)
    for place in LOWER:
        found = motion.world_from_segment[rows, SEGMENT_OF[place]]
        errors = [
            np.degrees(rotation.angle_between(found, truth[place][began + shift + rows])).max() for shift in (-1, 0, 1)
        ]
        assert min(errors) < 3.0, place
