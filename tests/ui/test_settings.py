"""Settings: what was chosen is found again, and no file keeps the studio from starting."""

from dataclasses import fields

import pytest
from PySide6.QtCore import QSettings

from studio.ui.models.preferences import Preferences
from studio.ui.settings import Settings, settings_file

CHOSEN = {
    "scheme": "light",
    "text_scale": 1.5,
    "reduced_motion": True,
    "vocabulary": "studio",
    "library": "/data/Übungen, links/takes; 2026",
    "delay": 5,
    "sound": False,
    "volume": 0.25,
    "seen_from": "behind",
    "last_source": "serial:/dev/ttyACM0",
    "last_person": "P014",
    "last_preset": "bvh",
    "export_folder": "/exports",
    "take_name": "gait",
    "geometry": b"\x00\x01\xff geometry",
    "clicker": True,
    "keys": {"record": ("F9",), "marker": ()},
    "angles": ("left_knee_flexion", "right_knee_flexion"),
    "coach_marks_done": True,
}


@pytest.fixture
def file(tmp_path):
    return tmp_path / "folder that is not there yet" / "settings.ini"


def test_without_a_file_everything_has_its_default(qtbot, file):
    settings = Settings(file)

    assert settings.values == Preferences()
    assert not settings.put_aside


def test_everything_that_was_chosen_is_found_again(qtbot, file):
    first = Settings(file)
    told: list[str] = []
    first.changed.connect(told.append)
    for name, value in CHOSEN.items():
        first.set(name, value)
    first.flush()

    again = Settings(file).values

    assert {field.name for field in fields(Preferences)} == set(CHOSEN)
    assert {name: getattr(again, name) for name in CHOSEN} == CHOSEN
    assert told == list(CHOSEN)


def test_a_value_that_is_the_same_is_not_told(qtbot, file):
    settings = Settings(file)
    told: list[str] = []
    settings.changed.connect(told.append)

    settings.set("delay", 0)

    assert told == []


@pytest.mark.parametrize(
    ("name", "value"),
    [("text_scale", 3.0), ("text_scale", float("nan")), ("delay", 4), ("scheme", "pink"), ("volume", -0.1)],
)
def test_no_value_out_of_range_is_kept(qtbot, file, name, value):
    settings = Settings(file)

    with pytest.raises(ValueError, match=name):
        settings.set(name, value)

    assert settings.values == Preferences()


@pytest.mark.parametrize(
    "content",
    [
        b"\xff\xfe\x00garbage\x00",
        b"[General]\ntext_scale=1.5\n\x00\x00\x00",
        bytes(range(256)) * 40,
        b"[General\nno end",
    ],
    ids=["not text", "zeros", "all bytes", "no section"],
)
def test_a_broken_file_is_put_aside_and_the_start_goes_on(qtbot, file, content):
    file.parent.mkdir()
    file.write_bytes(content)

    settings = Settings(file)
    settings.set("delay", 3)
    settings.flush()

    assert settings.put_aside
    assert file.with_name("settings.ini.bad").read_bytes() == content
    assert Settings(file).values.delay == 3


def test_a_folder_in_the_place_of_the_file_does_not_stop_the_start(qtbot, file):
    file.mkdir(parents=True)

    assert Settings(file).values == Preferences()


@pytest.mark.parametrize(
    "line",
    [
        "text_scale=huge",
        "text_scale=9",
        "text_scale=nan",
        "delay=-3",
        "scheme=pink",
        "sound=perhaps",
        "keys=[[[",
        'keys="[1, 2]"',
        "geometry=xyz",
        "angles=7",
        'keys="' + "[" * 5000 + '"',
    ],
)
def test_a_value_that_cannot_be_read_counts_as_not_set(qtbot, file, line):
    file.parent.mkdir()
    file.write_text(f"[General]\n{line}\nlast_person=P007\n")

    settings = Settings(file)

    assert settings.values == Preferences(last_person="P007")


def test_what_a_newer_studio_wrote_survives(qtbot, file):
    file.parent.mkdir()
    file.write_text("[General]\nhologram=true\n\n[Addon]\ncolour=mauve\n")

    settings = Settings(file)
    settings.set("delay", 10)
    settings.flush()

    kept = QSettings(str(file), QSettings.Format.IniFormat)
    assert kept.value("hologram") == "true"
    assert kept.value("Addon/colour") == "mauve"


def test_the_file_is_in_the_users_folder(tmp_path_factory):
    assert settings_file().name == "settings.ini"
    assert settings_file().parent.name == "kinetag-studio"
