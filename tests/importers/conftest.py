"""The table and its map as a fixture."""

import copy
import json

import pytest

from studio.importers.csv_map import read_csv
from tests.importers.mapped_tables import FULL, ROWS, text


@pytest.fixture
def read(tmp_path):
    """Return the take of a map and its table; ``change`` edits the map's only sensor."""

    def write_and_read(rows=ROWS, content=None, **change):
        described = copy.deepcopy(FULL)
        for key, value in change.items():
            if value is None:
                del described["sensors"][0][key]
            else:
                described["sensors"][0][key] = value
        (tmp_path / "walk.csv").write_text(content or text(rows))
        (tmp_path / "map.json").write_text(json.dumps(described))
        return read_csv([tmp_path / "walk.csv"], tmp_path / "map.json")

    return write_and_read
