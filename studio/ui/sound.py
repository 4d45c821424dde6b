"""Tones for whoever cannot look at the screen. A computer without sound loses nothing: each has a visual twin."""

import shutil
import sys
import wave
from collections.abc import Mapping
from enum import Enum
from io import BytesIO
from pathlib import Path

import numpy as np
from PySide6.QtCore import QObject, QProcess, QTemporaryDir
from PySide6.QtWidgets import QApplication

from studio.capture.procedures.held_pose import Cue, Kind

SAMPLE_RATE = 22_050  # Hz; five times the highest overtone that matters
FADE = 0.008  # s; without it a tone begins and ends with a click
PLAYERS = ("afplay", "paplay", "pw-play", "aplay")  # macOS, PulseAudio, PipeWire, ALSA; the first that is there


class Tone(Enum):
    """What is to be heard: (Hz, s, how often, s between)."""

    COUNT = (880.0, 0.12, 1, 0.0)
    SUCCESS = (1320.0, 0.8, 1, 0.0)
    FAILURE = (220.0, 0.22, 2, 0.14)


TONES: Mapping[Kind, Tone] = {Kind.COUNT: Tone.COUNT, Kind.DONE: Tone.SUCCESS, Kind.FAILED: Tone.FAILURE}
"""``HOLD`` is silent: it begins where the fourth tone would come."""


class Sound(QObject):
    """Plays tones, and never fails: what cannot be played becomes the system's beep, or nothing."""

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.volume = 0.7
        """0…1; 0 is off."""
        self._player = next((found for name in PLAYERS if (found := shutil.which(name))), "")
        self._folder: QTemporaryDir | None = None

    def cue(self, cue: Cue) -> None:
        """Play what belongs to a cue."""
        if cue.kind in TONES:
            self.play(TONES[cue.kind])

    def play(self, tone: Tone) -> None:
        """Start a tone and return at once."""
        if self.volume <= 0:
            return
        try:
            started = self._start(self._file(tone))
        except (OSError, RuntimeError):
            started = False
        if not started:
            QApplication.beep()

    def _start(self, file: Path) -> bool:
        if sys.platform == "win32":
            import winsound

            winsound.PlaySound(str(file), winsound.SND_FILENAME | winsound.SND_ASYNC | winsound.SND_NODEFAULT)
            return True
        if not self._player:
            return False
        process = QProcess()
        process.setProgram(self._player)
        process.setArguments([str(file)])
        # Players talk about missing devices on the terminal of whoever started the studio.
        process.setStandardOutputFile(QProcess.nullDevice())
        process.setStandardErrorFile(QProcess.nullDevice())
        # PySide6 6.10 returns a truth value here, its type stub promises a pair.
        started: object = process.startDetached()
        return bool(started[0] if isinstance(started, tuple) else started)

    def _file(self, tone: Tone) -> Path:
        if self._folder is None:
            self._folder = QTemporaryDir()  # goes away with this object
        file = Path(self._folder.path()) / f"{tone.name.lower()}-{round(self.volume * 100)}.wav"
        if not file.exists():
            file.write_bytes(_wave_file(samples(tone, self.volume)))
        return file


def _wave_file(mono: np.ndarray[tuple[int], np.dtype[np.int16]]) -> bytes:
    memory = BytesIO()
    with wave.open(memory, "wb") as out:
        out.setnchannels(1)
        out.setsampwidth(2)
        out.setframerate(SAMPLE_RATE)
        out.writeframes(mono.tobytes())
    return memory.getvalue()


def samples(tone: Tone, volume: float) -> np.ndarray[tuple[int], np.dtype[np.int16]]:
    """Return a tone as 16-bit samples at ``SAMPLE_RATE``."""
    frequency, length, times, between = tone.value
    time = np.arange(round(length * SAMPLE_RATE)) / SAMPLE_RATE
    envelope = np.clip(np.minimum(time, time[-1] - time) / FADE, 0.0, 1.0)
    once = np.sin(2 * np.pi * frequency * time) * envelope * min(max(volume, 0.0), 1.0)
    silence = np.zeros(round(between * SAMPLE_RATE))
    whole = np.concatenate([part for _ in range(times) for part in (once, silence)])
    return np.round(whole * np.iinfo(np.int16).max).astype("<i2")
