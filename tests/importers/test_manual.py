"""The manual's example of a map is one."""

import re
from pathlib import Path

from studio.importers.map_file import read_map

PAGE = Path(__file__).resolve().parents[2] / "resources" / "manual" / "import-tables.md"


def test_the_example_map_is_read(tmp_path):
    example = re.findall(r"```json\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[0]
    file = tmp_path / "legs.json"
    file.write_text(example, encoding="utf-8")

    found = read_map(file)

    assert found.sensors[0].place is not None
    assert found.poses[0].name == "n"
