"""What Blender makes of a BVH, as JSON: run by a Python that has bpy, with FILE FRAME,FRAME…

Positions are in the file's axes and unit (the importer's turn to z up is undone). Frame i of the file is
Blender's frame 1 + i. The frame rate is the one Blender takes from the file when asked to.
"""

import contextlib
import io
import json
import os
import sys

import bpy  # type: ignore[import-not-found]
from bpy_extras.io_utils import axis_conversion  # type: ignore[import-not-found]

FORWARD, UP = "-Z", "Y"  # the importer's defaults


def main(path, frames):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    log = io.StringIO()
    with contextlib.redirect_stdout(log):
        bpy.ops.import_anim.bvh(
            filepath=os.path.abspath(path),
            axis_forward=FORWARD,
            axis_up=UP,
            rotate_mode="NATIVE",
            update_scene_fps=True,
            update_scene_duration=True,
        )
    armature = next(thing for thing in bpy.data.objects if thing.type == "ARMATURE")
    scene = bpy.context.scene
    file_from_blender = axis_conversion(from_forward=FORWARD, from_up=UP).to_4x4().inverted()

    def in_file_axes(vector):
        return list(file_from_blender @ (armature.matrix_world @ vector))

    positions = {}
    for frame in frames:
        scene.frame_set(1 + frame)
        positions[frame] = {bone.name: in_file_axes(bone.head) for bone in armature.pose.bones}
    curves = armature.animation_data.action.fcurves
    bones = armature.data.bones
    print(
        json.dumps(
            {
                "blender": {
                    "version": bpy.app.version_string,
                    "frames": max(len(curve.keyframe_points) for curve in curves),
                    "fps": scene.render.fps / scene.render.fps_base,
                    "joints": [bone.name for bone in bones],
                    "parents": {bone.name: bone.parent.name if bone.parent else None for bone in bones},
                    "rest": {
                        bone.name: [in_file_axes(bone.head_local), in_file_axes(bone.tail_local)] for bone in bones
                    },
                    "positions": positions,
                    "warnings": [
                        line for line in log.getvalue().splitlines() if "zero length" in line or "WARN" in line
                    ],
                }
            }
        )
    )


if __name__ == "__main__":
    main(sys.argv[1], [int(word) for word in sys.argv[2].split(",")])
