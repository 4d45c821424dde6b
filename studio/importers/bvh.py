"""BVH files, as strict as the programs that animate from them cannot afford to be.

Accepted: BOM, any line end, tabs, joints with 0 to 6 channels, duplicate, spaced and colon names, a count of
frames that differs from the rows (the rows count). Position channels replace the OFFSET of their joint, as in
Blender. Refused with the line: numbers that are not finite or carry a decimal comma, rows that are too short
or too long, no MOTION, a frame time of zero.
"""

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.errors import RecordingUnreadable
from studio.importers.table import decode_text

MOST_JOINTS = 2000  # a body with fingers and face has 200
LARGEST = 1e9  # of any number; 1000 km in mm
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_COUNT = re.compile(r"\d{1,12}", re.ASCII)
_CHANNELS = {f"{axis}{kind}".lower(): f"{axis}{kind}" for axis in "XYZ" for kind in ("position", "rotation")}
_FRAMES = re.compile(r"\s*frames\s*:(.*)", re.IGNORECASE | re.DOTALL)
_FRAME_TIME = re.compile(r"\s*frame\s+time\s*:(.*)", re.IGNORECASE | re.DOTALL)
_SHOWN = 24  # characters of a wrong word that are quoted


@dataclass(frozen=True)
class BvhFile:
    """A skeleton and its channels over time, in the file's own axes and length unit."""

    names: tuple[str, ...]
    """As written; not necessarily unique."""
    parents: tuple[int, ...]
    """Index of each joint's parent, which stands before it; -1 for a root."""
    offsets: NDArray[np.float64]
    """(j, 3), file units, in the parent's axes."""
    channels: tuple[tuple[str, ...], ...]
    """For each joint, ``Xposition`` … ``Zrotation`` in the order of the values; rotations apply in that order."""
    ends: Mapping[int, NDArray[np.float64]]
    """(3,), file units: the End Site of the joints that have one."""
    frame_time: float
    """s."""
    values: NDArray[np.float64]
    """(n, all channels), file units and degrees."""
    notes: tuple[str, ...]
    """What was unusual and how it was understood, in plain words."""


class _Refusal(Exception):
    """What is wrong at a line."""

    def __init__(self, line: int, reason: str) -> None:
        super().__init__(line, reason)
        self.line, self.reason = line, reason


def read_bvh(path: Path) -> BvhFile:
    """Read a BVH file.

    Raises
    ------
    RecordingUnreadable
        With the 1-based line, 0 when the file cannot be opened.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise RecordingUnreadable(str(path), 0, (error.strerror or "it cannot be opened").lower()) from error
    lines = decode_text(data).replace("\r\n", "\n").replace("\r", "\n").split("\n")
    try:
        return _parse(lines)
    except _Refusal as refusal:
        raise RecordingUnreadable(str(path), refusal.line, refusal.reason) from None


def joint_positions(bvh: BvhFile) -> NDArray[np.float64]:
    """Return where the joints are, (n, j, 3), in file axes and units: forward kinematics of the channels."""
    frames, joints = len(bvh.values), len(bvh.names)
    positions = np.zeros((frames, joints, 3))
    file_from_joint = np.zeros((frames, joints, 4))
    start = 0
    for joint, (parent, channels) in enumerate(zip(bvh.parents, bvh.channels, strict=True)):
        step = np.tile(bvh.offsets[joint], (frames, 1))
        turn = np.tile(rotation.IDENTITY, (frames, 1))
        for column, channel in enumerate(channels, start):
            axis = "XYZ".index(channel[0])
            if channel.endswith("position"):
                step[:, axis] = bvh.values[:, column]
            else:
                turn = rotation.multiply(turn, rotation.about(axis, np.radians(bvh.values[:, column])))
        start += len(channels)
        if parent < 0:
            positions[:, joint], file_from_joint[:, joint] = step, turn
        else:
            positions[:, joint] = positions[:, parent] + rotation.rotate(file_from_joint[:, parent], step)
            file_from_joint[:, joint] = rotation.multiply(file_from_joint[:, parent], turn)
    return positions


def _parse(lines: Sequence[str]) -> BvhFile:
    skeleton = _Hierarchy()
    motion = skeleton.read(lines)
    at, frames_told = _field(lines, motion, _FRAMES, "Frames:")
    if not _COUNT.fullmatch(frames_told):
        raise _Refusal(at, f"{_quoted(frames_told)} is no number of frames")
    at, time_told = _field(lines, at, _FRAME_TIME, "Frame Time:")
    frame_time = _number(time_told, at)
    if frame_time <= 0:
        raise _Refusal(at, "the frame time is not above zero")
    width = sum(len(channels) for channels in skeleton.channels)
    if width == 0:
        raise _Refusal(motion, "no joint has a channel")
    values = _read_values(lines[at:], at + 1, width)
    notes = list(skeleton.notes)
    if len(values) != int(frames_told):
        notes.append(f"{int(frames_told)} frames are promised, {len(values)} are there")
    repeated = sorted(name for name, count in Counter(skeleton.names).items() if count > 1)
    if repeated:
        notes.append(f"several joints are called {', '.join(repeated)}")
    return BvhFile(
        tuple(skeleton.names),
        tuple(skeleton.parents),
        np.array([skeleton.offsets[joint] for joint in range(len(skeleton.names))]),
        tuple(skeleton.channels),
        {joint: np.array(end) for joint, end in skeleton.ends.items()},
        frame_time,
        values,
        tuple(notes),
    )


class _Hierarchy:
    """The skeleton while its lines come in."""

    def __init__(self) -> None:
        self.names: list[str] = []
        self.parents: list[int] = []
        self.offsets: dict[int, list[float]] = {}
        self.channels: list[tuple[str, ...]] = []
        self.ends: dict[int, list[float]] = {}
        self.notes: list[str] = []
        self._open: list[int] = []
        """The joints whose braces are open, outermost first."""
        self._in_end = False
        self._brace_due = False
        self._started = False

    def read(self, lines: Sequence[str]) -> int:
        """Take the lines up to MOTION and return its 1-based line."""
        for line, text in enumerate(lines, 1):
            words = text.split()
            while words:
                if not self._started and words[0].upper() != "HIERARCHY":
                    raise _Refusal(line, "it does not begin with HIERARCHY")
                if words[0].upper() == "MOTION":
                    self._check_complete(line)
                    return line
                words = self._take(words, line)
        raise _Refusal(len(lines), "there is no MOTION")

    def _check_complete(self, line: int) -> None:
        if self._open or self._in_end or self._brace_due:
            raise _Refusal(line, f"{len(self._open) + self._in_end} braces are still open")
        if not self.names:
            raise _Refusal(line, "there is no joint")

    def _take(self, words: list[str], line: int) -> list[str]:
        """Take what the first word begins and return the rest of the line."""
        word = words[0].upper()
        if self._brace_due != (word == "{"):
            raise _Refusal(
                line, f"{_quoted(words[0])} stands where a brace opens" if self._brace_due else "stray brace"
            )
        if word == "HIERARCHY" and not self._started:
            self._started = True
        elif word == "{":
            self._brace_due = False
        elif word == "}":
            self._close(line)
        elif word in {"ROOT", "JOINT", "END"}:
            return self._begin(word, words, line)
        elif word == "OFFSET" and self._open:
            return self._offset(words, line)
        elif word == "CHANNELS" and self._open and not self._in_end:
            return self._channels(words, line)
        else:
            raise _Refusal(line, f"{_quoted(words[0])} has no place here")
        return words[1:]

    def _begin(self, word: str, words: list[str], line: int) -> list[str]:
        if self._in_end or bool(self._open) == (word == "ROOT"):
            raise _Refusal(line, f"{word} has no place here")
        brace = words.index("{") if "{" in words else len(words)
        self._brace_due = True
        if word == "END":
            self._in_end = True
            return words[brace:]
        if brace == 1:
            raise _Refusal(line, "a joint has no name")
        if len(self.names) == MOST_JOINTS:
            raise _Refusal(line, f"there are more than {MOST_JOINTS} joints")
        self.names.append(" ".join(words[1:brace]))
        self.parents.append(self._open[-1] if self._open else -1)
        self.channels.append(())
        self._open.append(len(self.names) - 1)
        return words[brace:]

    def _close(self, line: int) -> None:
        if self._in_end:
            self._in_end = False
            return
        if not self._open:
            raise _Refusal(line, "stray brace")
        joint = self._open.pop()
        if joint not in self.offsets:
            raise _Refusal(line, f"the joint {_quoted(self.names[joint])} has no OFFSET")

    def _offset(self, words: list[str], line: int) -> list[str]:
        if len(words) < 4:
            raise _Refusal(line, "OFFSET has fewer than three numbers")
        offset = [_number(word, line) for word in words[1:4]]
        joint = self._open[-1]
        if not self._in_end:
            self.offsets[joint] = offset
        elif joint in self.ends:
            self.notes.append(f"{self.names[joint]} has more than one End Site, the first holds")
        else:
            self.ends[joint] = offset
        return words[4:]

    def _channels(self, words: list[str], line: int) -> list[str]:
        count = int(words[1]) if len(words) > 1 and _COUNT.fullmatch(words[1]) else -1
        names = [_CHANNELS.get(word.lower(), "") for word in words[2 : 2 + count]] if count >= 0 else []
        if len(names) != count or "" in names or len(set(names)) != count:
            raise _Refusal(line, "CHANNELS does not name as many different channels as it counts")
        self.channels[self._open[-1]] = tuple(names)
        return words[2 + count :]


def _field(lines: Sequence[str], after: int, pattern: re.Pattern[str], name: str) -> tuple[int, str]:
    """Return the 1-based line and the value of the next line that is not blank, which must be the named field."""
    for line in range(after, len(lines)):
        if lines[line].strip():
            match = pattern.fullmatch(lines[line])
            if match is None:
                raise _Refusal(line + 1, f"{name} is missing")
            return line + 1, match[1].strip()
    raise _Refusal(len(lines), f"{name} is missing")


def _read_values(lines: Sequence[str], first_line: int, width: int) -> NDArray[np.float64]:
    """Return the rows of channel values, (n, width)."""
    rows = [line for line in lines if line.strip()]
    if not rows:
        return np.empty((0, width))
    try:
        values = np.loadtxt(rows, comments=None, ndmin=2)
    except ValueError:
        values = np.empty((0, 0))
    # A comparison with NaN is false: one test refuses NaN, infinite and absurd numbers.
    if values.shape == (len(rows), width) and (np.abs(values) <= LARGEST).all():
        return values
    return _read_row_by_row(lines, first_line, width)


def _read_row_by_row(lines: Sequence[str], first_line: int, width: int) -> NDArray[np.float64]:
    """Find the line that is wrong."""
    rows = []
    for line, text in enumerate(lines, first_line):
        words = text.split()
        if not words:
            continue
        numbers = [_number(word, line) for word in words]
        if len(numbers) != width:
            raise _Refusal(line, f"there are {len(numbers)} values for {width} channels")
        rows.append(numbers)
    return np.array(rows).reshape(-1, width)


def _number(word: str, line: int) -> float:
    if _NUMBER.fullmatch(word):
        value = float(word)
        if abs(value) <= LARGEST:
            return value
        raise _Refusal(line, f"{_quoted(word)} is too large")
    if "," in word and _NUMBER.fullmatch(word.replace(",", ".", 1)):
        raise _Refusal(line, f"{_quoted(word)} has a decimal comma")
    try:
        finite = math.isfinite(float(word))
    except ValueError:
        finite = True
    raise _Refusal(line, f"{_quoted(word)} is no number" if finite else f"{_quoted(word)} is no finite number")


def _quoted(word: str) -> str:
    return repr(word if len(word) <= _SHOWN else f"{word[:_SHOWN]}…")
