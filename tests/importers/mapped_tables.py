"""A table of one sensor and the map that explains it: for the tests of the importer of tables."""

from pathlib import Path

import pytest

from studio.core.errors import MapFileInvalid

RESOURCES = Path(__file__).parents[2] / "resources"
SAMPLE = RESOURCES / "samples" / "xio-lower-body"

HEADER = "t,gx,gy,gz,ax,ay,az,qw,qx,qy,qz"
ROWS = [(0.01 * i, 0.1, 0.2, 0.3, 1.0, 2.0, 9.5, 0.8, 0.6, 0.0, 0.0) for i in range(10)]
FULL = {
    "sensors": [
        {
            "file": "walk.csv",
            "sensor": "Left Knee",
            "place": "left_thigh",
            "time": {"column": "t", "unit": "s"},
            "gyroscope": {"columns": ["gx", "gy", "gz"], "unit": "rad/s"},
            "accelerometer": {"columns": ["ax", "ay", "az"], "unit": "m/s2"},
            "orientation": {
                "columns": ["qw", "qx", "qy", "qz"],
                "order": "wxyz",
                "meaning": "world_from_sensor",
                "common_world": True,
            },
        }
    ]
}


def text(rows, header=HEADER):
    return "\n".join([header, *(",".join(str(cell) for cell in row) for row in rows)]) + "\n"


def refused(read, **change):
    with pytest.raises(MapFileInvalid) as refusal:
        read(**change)
    return refusal.value.reason
