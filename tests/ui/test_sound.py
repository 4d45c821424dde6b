"""Tones: the right pitch and length; and no computer on which they could do harm."""

import sys

import numpy as np
import pytest
from PySide6.QtCore import QProcess, QTemporaryDir
from PySide6.QtWidgets import QApplication

from studio.capture.procedures.held_pose import Cue, Kind
from studio.ui import sound
from studio.ui.sound import SAMPLE_RATE, Sound, Tone, samples


def pitch(wave):
    spectrum = np.abs(np.fft.rfft(wave.astype(float)))
    return np.fft.rfftfreq(len(wave), 1 / SAMPLE_RATE)[int(np.argmax(spectrum))]


@pytest.mark.parametrize(("tone", "hertz"), [(Tone.COUNT, 880), (Tone.SUCCESS, 1320), (Tone.FAILURE, 220)])
def test_tones_have_their_pitch(tone, hertz):
    assert pitch(samples(tone, 1.0)) == pytest.approx(hertz, abs=10)


def test_success_is_long_and_failure_is_two_tones():
    assert len(samples(Tone.SUCCESS, 1.0)) > 5 * len(samples(Tone.COUNT, 1.0))
    loud = np.abs(samples(Tone.FAILURE, 1.0)) > 1000
    smooth = np.convolve(loud, np.ones(400), "same") > 0
    assert int((np.diff(smooth.astype(int)) == 1).sum()) + int(smooth[0]) == 2


def test_volume_makes_it_quieter_and_nothing_clicks():
    loud, quiet = samples(Tone.COUNT, 1.0), samples(Tone.COUNT, 0.25)
    assert np.abs(quiet).max() == pytest.approx(0.25 * np.abs(loud).max(), rel=0.01)
    assert abs(int(loud[0])) < 50
    assert abs(int(loud[-1])) < 50


@pytest.fixture
def beeps(monkeypatch, qapp):
    heard: list[bool] = []
    monkeypatch.setattr(QApplication, "beep", lambda: heard.append(True))
    return heard


@pytest.mark.skipif(sys.platform == "win32", reason="Windows plays by itself")
def test_without_a_player_the_system_beeps(monkeypatch, beeps):
    monkeypatch.setattr(sound, "PLAYERS", ())

    Sound().play(Tone.COUNT)

    assert beeps == [True]


@pytest.mark.skipif(sys.platform == "win32", reason="Windows plays by itself")
def test_a_player_is_given_a_file_that_is_a_wave(monkeypatch, beeps, tmp_path):
    copy = tmp_path / "copy.wav"
    player = tmp_path / "player"
    player.write_text(f'#!/bin/sh\ncp "$1" "{copy}.part" && mv "{copy}.part" "{copy}"\n')
    player.chmod(0o755)
    monkeypatch.setattr(sound, "PLAYERS", (str(player),))
    playing = Sound()

    playing.play(Tone.FAILURE)
    for _ in range(500):
        if copy.exists():
            break
        QProcess.execute("true")  # gives the player time

    assert copy.read_bytes()[:4] == b"RIFF"
    assert beeps == []


def test_volume_nought_is_silence(monkeypatch, beeps):
    monkeypatch.setattr(sound, "PLAYERS", ())
    silent = Sound()
    silent.volume = 0.0

    silent.play(Tone.SUCCESS)

    assert beeps == []


@pytest.mark.skipif(sys.platform == "win32", reason="Windows plays by itself")
def test_a_folder_that_cannot_be_written_only_beeps(monkeypatch, beeps):
    monkeypatch.setattr(QTemporaryDir, "path", lambda self: "not/there")

    Sound().play(Tone.COUNT)

    assert beeps == [True]


def test_counts_and_ends_are_heard_and_the_hold_is_silent(monkeypatch, qapp):
    heard: list[Tone] = []
    playing = Sound()
    monkeypatch.setattr(playing, "play", heard.append)

    for kind in (Kind.COUNT, Kind.HOLD, Kind.DONE, Kind.FAILED):
        playing.cue(Cue(kind))

    assert heard == [Tone.COUNT, Tone.SUCCESS, Tone.FAILURE]
