"""The CSV exporters: a table, its check and its sidecar."""

from collections.abc import Mapping
from functools import partial
from typing import Any

from studio.analysis.joint_angles import joint_angles
from studio.core.errors import NothingToExport
from studio.core.pose import Motion
from studio.core.sample import Flag
from studio.export.csv_tables import PRESETS, Table, column_words, joints_table, orientations_table, raw_table
from studio.export.csv_text import compare_with_table, csv_blocks
from studio.export.material import Material, Product, Wish
from studio.export.sidecar import sidecar

TIME = "s from the first kept sample of the take, on the mapped clock of the sensors"


def export_joints(material: Material, wish: Wish) -> Product:
    """Return the joint angles of the motion, on its own grid."""
    motion = material.motion
    if motion is None or not len(motion):
        raise NothingToExport("motion", "it has no frames")
    facts = {
        "columns": {
            "time_s": TIME,
            **{
                f"{angle.name}_deg": {
                    "unit": "deg",
                    "positive": angle.positive,
                    "sequence": angle.sequence,
                    "low_confidence": angle.low_confidence,
                }
                for angle in joint_angles(motion)
            },
        },
        "axes": "segments x forward, y up along the bone, z right; child seen from parent",
        "frame_s": motion.frame_s,
    }
    return _product(material, wish, joints_table(motion), motion, facts)


def export_orientations(material: Material, wish: Wish) -> Product:
    """Return the attitude of each sensor."""
    table = orientations_table(material.orientations, material.take.setup.assignment)
    facts = {
        "columns": {
            "time_s": TIME,
            "<sensor>_w … _z": "world_from_sensor, unit quaternion; world z up, heading of each sensor its own",
            "<sensor>_roll_deg, _pitch_deg, _yaw_deg": "the same as Rz(yaw) Ry(pitch) Rx(roll), deg",
        },
        "column_words": column_words(material.orientations, material.take.setup.assignment),
        "interpolated": "at the sample times of the fastest sensor, where samples are at most 0.1 s apart",
    }
    return _product(material, wish, table, material.motion, facts)


def export_raw(material: Material, wish: Wish) -> Product:
    """Return the samples of the take."""
    facts = {
        "columns": {
            "time_s": TIME,
            "sample": "position among the samples of its sensor",
            "epoch": "+1 whenever the sensor started anew",
            "frame": "the sensor's own count; a missing number is a lost sample",
            "lost_before": "samples lost just before this one; nothing stands in for them",
            "device_time_s": "s, the sensor's own clock",
            "received_s": "s of take time when it arrived",
            "orientation_w … _z": "unit quaternion as the sensor sent it",
            "rate_x_rad_s …": "rad/s, sensor axes, before offset and gain",
            "acceleration_x_m_s2 …": "m/s², sensor axes, +9.81 upwards at rest, before offset and gain",
            "battery": "0…1",
            "flags": {str(flag.value): flag.name.lower() for flag in Flag if flag.name},
        },
        "orientation_is": {stream.info.sensor: stream.info.orientation for stream in material.take.streams},
    }
    return _product(material, wish, raw_table(material.take), None, facts)


def _product(material: Material, wish: Wish, table: Table, motion: Motion | None, facts: Mapping[str, Any]) -> Product:
    preset = PRESETS[wish.preset]
    described = {
        "csv": {
            "preset": preset.label,
            "rows": table.rows,
            "decimal": preset.punctuation.decimal.decode(),
            "separator": preset.punctuation.separator.decode(),
            "missing": "empty cell",
        },
        **facts,
    }
    return Product(
        csv_blocks(table, preset),
        partial(compare_with_table, table=table, preset=preset),
        sidecar(material.take, motion, described),
    )
