"""Takes that several claims are shown on."""

from pathlib import Path

import pytest

from tests.journeys.command_line import minute_of_walking, recorded


@pytest.fixture(scope="session")
def t_pose_take(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a take of a person who stands in N-pose, bows, and holds the T-pose from 11.6 s to 14.6 s."""
    return recorded("synthetic:t?speed=max&calibrated=1", 16, tmp_path_factory.mktemp("t pose"))


@pytest.fixture(scope="session")
def walk_take(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a take of a person who stands, bows, and then walks until 60 s."""
    return minute_of_walking(1, 0.0, tmp_path_factory)
