"""What this computer knows of each tag (``<user data>/tags/<serial>.json``), and files of calibrations."""

from pathlib import Path
from typing import Final

import msgspec
import platformdirs

from studio.core.body import Place
from studio.core.errors import CalibrationUnreadable, FolderNotWritable
from studio.core.sample import SensorId, is_plausible_correction
from studio.core.take import Calibration
from studio.storage import documents
from studio.storage.filesystem import FOLDER_MODE
from studio.storage.names import slug

SCHEMA: Final = 1


class Tag(msgspec.Struct, frozen=True):
    """The content of a tag's file."""

    schema: int = SCHEMA
    nickname: str = ""
    place: Place | None = None
    """Where it was worn last."""
    calibrations: tuple[Calibration, ...] = ()
    """Newest first."""


class CalibrationDocument(msgspec.Struct, frozen=True):
    """The content of a calibration file; a tag's file is one, too."""

    schema: int
    calibrations: tuple[Calibration, ...]


def tags_folder() -> Path:
    """Return where this user's tags are kept."""
    return Path(platformdirs.user_data_dir("kinetag-studio", appauthor=False)) / "tags"


def load_tag(sensor: SensorId, folder: Path) -> Tag:
    """Return what is known of a tag; nothing when there is no file or it is damaged (kept as ``….bad``).

    Raises
    ------
    WrittenByNewerStudio
    """
    tag = documents.load_own(_file(sensor, folder), Tag, SCHEMA, "tag", lambda tag: _are_plausible(tag.calibrations))
    return Tag() if tag is None else tag


def save_tag(sensor: SensorId, tag: Tag, folder: Path) -> None:
    """Write what is known of a tag.

    Raises
    ------
    WrittenByNewerStudio, FolderNotWritable
    """
    load_tag(sensor, folder)
    try:
        folder.mkdir(mode=FOLDER_MODE, parents=True, exist_ok=True)
        documents.save(_file(sensor, folder), tag)
    except OSError as error:
        raise FolderNotWritable(str(folder)) from error


def rename_tag(sensor: SensorId, nickname: str, folder: Path) -> Tag:
    """Give a tag a name on this computer and return what is known of it now.

    Raises
    ------
    WrittenByNewerStudio, FolderNotWritable
    """
    tag = msgspec.structs.replace(load_tag(sensor, folder), nickname=nickname.strip())
    save_tag(sensor, tag, folder)
    return tag


def add_calibration(calibration: Calibration, folder: Path) -> None:
    """Keep a calibration as the newest of its tag.

    Raises
    ------
    WrittenByNewerStudio, FolderNotWritable
    """
    tag = load_tag(calibration.sensor, folder)
    newest = msgspec.structs.replace(tag, calibrations=(calibration, *tag.calibrations))
    save_tag(calibration.sensor, newest, folder)


def read_calibration(file: Path) -> tuple[Calibration, ...]:
    """Return the calibrations of a file, the newest of each sensor first.

    Raises
    ------
    CalibrationUnreadable
    """
    document, state = documents.load(file, CalibrationDocument, SCHEMA)
    if document is None:
        reasons = {"missing": "there is no such file", "newer": "it was written by a newer studio"}
        raise CalibrationUnreadable(str(file), reasons.get(state, "it holds no calibrations"))
    if not _are_plausible(document.calibrations):
        raise CalibrationUnreadable(str(file), "it holds a gain or an offset that no gyroscope has")
    return document.calibrations


def write_calibration(file: Path, calibrations: tuple[Calibration, ...]) -> None:
    """Write a calibration file.

    Raises
    ------
    FolderNotWritable
    """
    try:
        documents.save(file, CalibrationDocument(SCHEMA, calibrations))
    except OSError as error:
        raise FolderNotWritable(str(file.parent)) from error


def _are_plausible(calibrations: tuple[Calibration, ...]) -> bool:
    return all(is_plausible_correction(calibration.correction) for calibration in calibrations)


def _file(sensor: SensorId, folder: Path) -> Path:
    # Colons are not allowed in names on Windows.
    return folder / f"{slug(sensor.removeprefix('tag:'))}.json"
