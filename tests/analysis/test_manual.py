"""The manual's table of joint angles says what the code does."""

import re
from pathlib import Path

from studio.analysis.joint_angles import joint_angles
from tests.export.moving_body import moving_body

PAGE = Path(__file__).resolve().parents[2] / "resources" / "manual" / "joint-angles.md"


def test_each_column_and_its_sign_stand_in_the_manual():
    told = dict(re.findall(r"^\| `(\S+)` \| (.*) \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE))
    meant = {}
    for angle in joint_angles(moving_body(3)):
        name = re.sub(r"^(left|right)_", "…_", angle.name) + "_deg"
        meant[name] = angle.positive + (" (low confidence)" if angle.low_confidence else "")

    assert told == meant
