"""Other programs read our BVH: joints where the motion has them, rates exact, a T-pose at rest.

Run with ``-m peers``; builds its environments first (400 MB, minutes) where ``environments.py`` says.
"""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.core import body
from studio.core.body import Segment
from studio.core.solver import solve
from studio.export.bvh import PRESETS, RATES, bvh_blocks
from studio.importers.bvh import joint_positions, read_bvh
from studio.storage.take_reader import read_take
from tests.export.moving_body import moving_body, standing
from tests.journeys.between_frames import joints_at
from tests.journeys.command_line import recorded, say
from tests.peers.environments import Peers, build

pytestmark = [pytest.mark.peers, pytest.mark.timeout(900)]

TOLERANCE = 1e-5  # m; a thousandth of a centimetre
FRAMES = 301
LOOKED_AT = [0, 1, 150, 299, 300]
NAMES = [segment.name for segment in Segment]
PARENT_NAMES = {name: NAMES[parent] if parent >= 0 else None for name, parent in zip(NAMES, body.PARENTS, strict=True)}
READERS = ("blender", "three", "bvhio", "pybvh", "studio")


@pytest.fixture(scope="session")
def peers() -> Peers:
    return build()


def write(folder, motion, preset, fps):
    path = folder / f"{preset}_{fps}.bvh"
    path.write_bytes(b"".join(bvh_blocks(motion, PRESETS[preset], fps)))
    return path


def asked(command, path, frames):
    done = subprocess.run(
        [*command, str(path), ",".join(map(str, frames))], capture_output=True, text=True, check=False, timeout=600
    )
    answers = [line for line in done.stdout.splitlines() if line.startswith("{")]
    assert answers, (done.stderr or done.stdout)[-1000:]
    return json.loads(answers[-1])


def by_all(peers, path, frames):
    """What every reader says of the file, by its name."""
    found: dict[str, dict[str, Any]] = {}
    for command in (peers.blender, peers.three, peers.readers):
        found |= asked(command, path, frames)
    own = joint_positions(read_bvh(path))
    found["studio"] = {
        "frames": len(own),
        "positions": {str(frame): dict(zip(NAMES, own[frame].tolist(), strict=True)) for frame in frames},
    }
    return found


@pytest.mark.parametrize("swing", [0.5, 1.5])
@pytest.mark.parametrize("preset", PRESETS)
def test_all_readers_put_every_joint_where_the_motion_has_it(peers, tmp_path, preset, swing):
    motion = moving_body(FRAMES, frame_s=1 / 60, swing=swing)
    meant = motion.joint_positions()[..., [1, 2, 0]] * PRESETS[preset].units_per_metre

    read = by_all(peers, write(tmp_path, motion, preset, None), LOOKED_AT)

    apart = {}
    for reader in READERS:
        assert read[reader]["frames"] == FRAMES, reader
        found = np.array([[read[reader]["positions"][str(f)][name] for name in NAMES] for f in LOOKED_AT])
        apart[reader] = np.abs(found - meant[LOOKED_AT]).max() / PRESETS[preset].units_per_metre
    print(f"{preset}, swing {swing}: cm apart", {reader: float(f"{100 * m:.1e}") for reader, m in apart.items()})
    assert max(apart.values()) < TOLERANCE, apart
    for reader in ("blender", "three"):
        assert read[reader]["parents"] == PARENT_NAMES
        assert read[reader]["warnings"] == []
    assert set(read["bvh"]["joints"]) == set(NAMES)


LEGS = Path(__file__).resolve().parents[2] / "resources" / "samples" / "xio-lower-body"


def real_sensors(folder):
    """Seven x-IMU3 on somebody's legs."""
    return Path(say("import", LEGS, "--library", folder).out.strip())


def simulated_walk(folder):
    return recorded("synthetic:walk?speed=max&calibrated=1&loss=0.05", 20, folder)


@pytest.mark.parametrize(("preset", "fps"), [("blender", 30), ("motionbuilder", 120)])
@pytest.mark.parametrize("made", [real_sensors, simulated_walk], ids=["real sensors", "simulated walk"])
def test_what_a_person_exports_is_read_as_the_motion_that_was_solved(peers, tmp_path, made, preset, fps):
    folder = made(tmp_path / "library")
    target = tmp_path / "exported.bvh"

    done = say("export", folder, "--format", "bvh", "--preset", preset, "--fps", fps, "-o", target)

    assert done.code == 0, done.err
    motion = solve(read_take(folder)[0]).motion
    frames = int((len(motion) - 1) * motion.frame_s * fps + 1e-6) + 1
    looked_at = [0, 1, frames // 3, frames // 2, frames - 1]
    meant = joints_at(motion, np.array(looked_at) / fps)[..., [1, 2, 0]]
    read = by_all(peers, target, looked_at)
    apart = {}
    for reader in READERS:
        assert read[reader]["frames"] == frames, reader
        found = np.array([[read[reader]["positions"][str(f)][name] for name in NAMES] for f in looked_at])
        apart[reader] = np.abs(found / PRESETS[preset].units_per_metre - meant).max()
    print(f"{made.__name__}, {preset} at {fps}: cm apart", {r: float(f"{100 * m:.1e}") for r, m in apart.items()})
    assert max(apart.values()) < TOLERANCE, apart
    assert read["blender"]["fps"] == fps
    assert read["three"]["frame_time"] == pytest.approx(1 / fps, rel=1e-4)  # its times are single floats
    assert read["bvhio"]["frame_time"] == pytest.approx(1 / fps, rel=1e-11)
    assert read["blender"]["warnings"] == read["three"]["warnings"] == []


@pytest.mark.parametrize("fps", RATES)
def test_blender_takes_exactly_the_rate_on_offer(peers, tmp_path, fps):
    read = asked(peers.blender, write(tmp_path, moving_body(26), "blender", fps), [0])["blender"]

    assert read["fps"] == pytest.approx(fps, abs=1e-4)
    assert read["frames"] == int(fps / 2) + 1


@pytest.mark.parametrize("preset", PRESETS)
def test_blenders_rest_pose_is_a_t_pose_as_tall_as_the_person(peers, tmp_path, preset):
    unit = PRESETS[preset].units_per_metre

    read = asked(peers.blender, write(tmp_path, standing("n", stature=1.83), preset, 60), [0])["blender"]

    head_and_tail = np.array([read["rest"][name] for name in NAMES]) / unit
    for arm, side in ((body.LEFT_ARM, 1), (body.RIGHT_ARM, -1)):
        along = np.concatenate([head_and_tail[list(arm), 0], head_and_tail[arm[-1:], 1]])
        np.testing.assert_allclose(np.ptp(along[:, 1:], axis=0), 0, atol=TOLERANCE)
        assert (side * np.diff(along[:, 0]) > 0.1).all()
    heights = head_and_tail[..., 1]
    assert np.ptp(heights) == pytest.approx(1.83, abs=0.001)
    assert (np.linalg.norm(head_and_tail[:, 1] - head_and_tail[:, 0], axis=1) > 0.02).all()
    assert read["warnings"] == []
