"""The BVH exporter: the file, its check and its sidecar."""

from pathlib import Path

from studio.core.errors import ImportFailed, NothingToExport, ReadBackDiffers
from studio.export.bvh import PRESETS, SEQUENCE, bvh_blocks
from studio.export.bvh_check import compare_with_motion
from studio.export.material import Material, Product, Wish
from studio.export.resampling import is_even, timing_of, unfinished
from studio.export.sidecar import sidecar


def export_bvh(material: Material, wish: Wish) -> Product:
    """Return the motion as a BVH file."""
    motion = material.motion
    if motion is None or not len(motion):
        raise NothingToExport("motion", "it has no frames")
    preset = PRESETS[wish.preset]

    def read_back(path: Path) -> None:
        try:
            written = material.read_bvh(path)
        except ImportFailed as refusal:
            raise ReadBackDiffers(str(path), f"the file cannot be read: {refusal}") from refusal
        compare_with_motion(written, str(path), motion, preset, wish.fps)

    timing = timing_of(motion, wish.fps)
    facts = {
        "bvh": {
            "preset": preset.label,
            "unit": "m" if preset.units_per_metre == 1 else "cm",
            "axes": "y up, z forward, x to the wearer's left",
            "rest_pose": "T",
            "rotations": SEQUENCE,
            "frames": timing.frames,
            "frame_time_s": timing.frame_s,
            "resampled_from_frame_time_s": None if wish.fps is None and is_even(motion) else motion.frame_s,
            "first_frame_s": float(motion.time[0]),
            "rows_held_because_not_finite": unfinished(motion),
        }
    }
    return Product(bvh_blocks(motion, preset, wish.fps), read_back, sidecar(material.take, motion, facts))
