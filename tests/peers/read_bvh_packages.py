"""What the Python packages bvhio, bvh and pybvh make of a BVH, as JSON: FILE FRAME,FRAME…"""

import contextlib
import io
import json
import sys
from pathlib import Path

import bvh  # type: ignore[import-not-found]
import bvhio  # type: ignore[import-not-found]
import pybvh  # type: ignore[import-not-found]


def by_bvhio(path, frames):
    with contextlib.redirect_stdout(io.StringIO()):
        container = bvhio.readAsBvh(path)
        root = bvhio.convertBvhToHierarchy(container.Root)
    positions = {}
    for frame in frames:
        root.loadPose(frame)
        positions[frame] = {joint.Name: [float(x) for x in joint.PositionWorld] for joint, _, _ in root.layout()}
    return {"frames": container.FrameCount, "frame_time": container.FrameTime, "positions": positions}


def by_pybvh(path, frames):
    with contextlib.redirect_stdout(io.StringIO()):
        read = pybvh.read_bvh_file(path)
    everywhere = read.joint_positions() if callable(read.joint_positions) else read.joint_positions
    positions = {
        frame: {name: everywhere[frame, joint].tolist() for joint, name in enumerate(read.joint_names)}
        for frame in frames
    }
    return {"frames": int(read.frame_count), "frame_time": float(read.frame_time), "positions": positions}


def by_bvh(path):
    read = bvh.Bvh(Path(path).read_text(encoding="ascii"))
    return {"frames": read.nframes, "frame_time": read.frame_time, "joints": read.get_joints_names()}


if __name__ == "__main__":
    wanted = [int(word) for word in sys.argv[2].split(",")]
    print(
        json.dumps(
            {
                "bvhio": by_bvhio(sys.argv[1], wanted),
                "pybvh": by_pybvh(sys.argv[1], wanted),
                "bvh": by_bvh(sys.argv[1]),
            }
        )
    )
