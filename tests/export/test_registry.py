"""The contract of every exporter: whole, read back, described, and nothing at all when it cannot."""

import json
from dataclasses import replace

import numpy as np
import pytest

from studio.core.body import Place
from studio.core.errors import CannotWrite, NothingToExport, ReadBackDiffers
from studio.core.sample import Flag
from studio.core.take import Alignment, LimbAlignment
from studio.export import bvh, csv_tables
from studio.export.material import Material, Wish
from studio.export.registry import EXPORTERS, export_file
from studio.importers.bvh import read_bvh
from tests.export.moving_body import moving_body
from tests.export.small_take import LEFT, RIGHT, small_take

PRESETS = {name: list(bvh.PRESETS if name == "bvh" else csv_tables.PRESETS) for name in EXPORTERS}
EACH = [(name, preset) for name in EXPORTERS for preset in PRESETS[name]]


def material():
    take = small_take()
    limb = LimbAlignment((1.0, 0.0, 0.0, 0.0), 0.5, "bow", np.radians(2.0), np.radians(0.4))
    motion = replace(
        moving_body(200),
        alignment=Alignment("n", 0.1, 0.4, {Place.LEFT_THIGH: limb}),
        notes=("the stature is not known",),
    )
    orientations = {stream.info.sensor: (stream.time, stream.orientation) for stream in take.streams}
    return Material(take, motion, orientations, read_bvh)


@pytest.mark.parametrize(("name", "preset"), EACH)
def test_a_file_and_its_sidecar_are_written(tmp_path, name, preset):
    path = tmp_path / f"walk.{name}"

    written = export_file(name, material(), Wish(preset), path)

    assert written == (path, tmp_path / f"walk.{name}.json")
    assert sorted(tmp_path.iterdir()) == sorted(written)
    assert path.stat().st_size > 1000


@pytest.mark.parametrize(("name", "preset"), EACH)
def test_the_sidecar_says_what_a_reader_of_the_numbers_must_know(tmp_path, name, preset):
    _, beside = export_file(name, material(), Wish(preset), tmp_path / "walk")

    said = json.loads(beside.read_text(encoding="utf-8"))

    assert said["made_by"]["version"]
    assert said["take"]["name"] == "walk"
    assert said["take"]["person"] == "P014"
    assert "left_shank" in said["places_without_sensor"]
    assert "left_thigh" not in said["places_without_sensor"]
    thigh, loose = said["sensors"]
    assert (thigh["sensor"], thigh["place"], thigh["samples"], thigh["lost"]) == (LEFT, "left_thigh", 47, 3)
    assert thigh["longest_gap_s"] == pytest.approx(0.08)  # between the samples on both sides of three lost ones
    assert thigh["bridged_share"] == pytest.approx(3 / 50)
    assert thigh["calibration"]["method"] == "whole turns"
    assert (loose["sensor"], loose["place"], loose["calibration"]) == (RIGHT, None, None)
    assert thigh["calibration"]["temperature_c"] is None  # unknown, and JSON has no NaN


def test_the_sidecar_names_no_calibration_that_is_not_in_force(tmp_path):
    """The tag corrects by itself and did not tell how."""
    whole = material()
    thigh, loose = whole.take.streams
    flags = np.full(len(thigh), Flag.CALIBRATED, np.uint32)
    corrected = replace(thigh, info=replace(thigh.info, orientation="integrated", correction=None), flags=flags)
    take = replace(whole.take, streams=(corrected, loose))

    _, beside = export_file("raw", replace(whole, take=take), Wish("plain"), tmp_path / "walk.csv")

    assert json.loads(beside.read_text(encoding="utf-8"))["sensors"][0]["calibration"] is None


@pytest.mark.parametrize("name", ["bvh", "joints", "orientations"])
def test_the_sidecar_of_what_was_solved_says_how(tmp_path, name):
    _, beside = export_file(name, material(), Wish(PRESETS[name][0]), tmp_path / "walk")

    solved = json.loads(beside.read_text(encoding="utf-8"))["solved"]

    assert (solved["method"], solved["attitude"]) == ("offline", "gyro-only")
    assert solved["notes"] == ["the stature is not known"]
    assert solved["alignment"]["pose"] == "n"
    assert solved["alignment"]["age_at_end_of_take_s"] == pytest.approx(small_take().duration() - 0.4)
    limb = solved["alignment"]["limbs"]["left_thigh"]
    assert limb == {"heading_source": "bow", "heading_sigma_deg": pytest.approx(2), "spread_deg": pytest.approx(0.4)}


def test_the_sidecar_says_how_much_of_what_counts_as_measured_is_bridged(tmp_path):
    whole = material()
    lost, measured = np.zeros(200, bool), np.ones(200, bool)
    lost[50:90], measured[80:] = True, False  # 30 of 80 are bridged, 10 are beyond any bridge
    thigh = Place.LEFT_THIGH
    motion = replace(
        whole.motion,
        lost={**whole.motion.lost, thigh: lost},
        measured={**whole.motion.measured, thigh: measured, Place.HEAD: ~np.ones(200, bool)},
    )

    _, beside = export_file("joints", replace(whole, motion=motion), Wish("plain"), tmp_path / "walk.csv")

    solved = json.loads(beside.read_text(encoding="utf-8"))["solved"]
    assert solved["bridged_share_of_measured"]["left_thigh"] == pytest.approx(30 / 80)
    assert solved["bridged_share_of_measured"]["head"] == 0.0


def test_the_sidecar_of_the_joints_explains_every_column(tmp_path):
    path, beside = export_file("joints", material(), Wish("plain"), tmp_path / "joints.csv")

    columns = json.loads(beside.read_text(encoding="utf-8"))["columns"]

    header = path.read_text(encoding="utf-8").splitlines()[0].split(",")
    assert list(columns) == header
    assert columns["left_knee_flexion_deg"] == {
        "unit": "deg",
        "positive": "shank backward",
        "sequence": "ZXY",
        "low_confidence": False,
    }


@pytest.mark.parametrize(("fps", "frame_s", "resampled"), [(None, 0.02, None), (60, 1 / 60, 0.02)])
def test_the_sidecar_of_a_bvh_says_unit_axes_and_rate(tmp_path, fps, frame_s, resampled):
    _, beside = export_file("bvh", material(), Wish("motionbuilder", fps), tmp_path / "walk.bvh")

    said = json.loads(beside.read_text(encoding="utf-8"))["bvh"]

    assert said["unit"] == "cm"
    assert said["frame_time_s"] == pytest.approx(frame_s)
    assert said["resampled_from_frame_time_s"] == resampled
    assert said["rows_held_because_not_finite"] == 0


@pytest.mark.parametrize("name", EXPORTERS)
def test_without_its_material_an_exporter_says_what_is_missing_and_writes_nothing(tmp_path, name):
    empty = Material(replace(small_take(), streams=()), None, {}, read_bvh)

    with pytest.raises(NothingToExport):
        export_file(name, empty, Wish(PRESETS[name][0]), tmp_path / "walk")

    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", EXPORTERS)
def test_a_folder_that_is_not_there_is_named(tmp_path, name):
    with pytest.raises(CannotWrite):
        export_file(name, material(), Wish(PRESETS[name][0]), tmp_path / "nowhere" / "walk")


def test_a_bvh_that_another_reader_understands_differently_never_replaces_the_old_one(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")

    def misread(written):
        return replace(read_bvh(written), frame_time=0.5)

    with pytest.raises(ReadBackDiffers, match="frame time") as refusal:
        export_file("bvh", replace(material(), read_bvh=misread), Wish("blender", 60), path)

    assert refusal.value.path == str(path)
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_bvh_that_cannot_be_read_never_replaces_the_old_one(tmp_path):
    path = tmp_path / "walk.bvh"
    path.write_bytes(b"old")
    nonsense = tmp_path / "nonsense"
    nonsense.write_bytes(b"no bvh")

    with pytest.raises(ReadBackDiffers, match="cannot be read"):
        export_file("bvh", replace(material(), read_bvh=lambda _: read_bvh(nonsense)), Wish("blender", 60), path)

    assert path.read_bytes() == b"old"
