"""Preferences on the disk: a text file in the user's folder, which never keeps the studio from starting."""

import contextlib
import json
import os
from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import platformdirs
from PySide6.QtCore import QByteArray, QObject, QSettings, Signal

from studio.ui.models.preferences import Keys, Preferences
from studio.ui.models.recorder import DELAYS
from studio.ui.theme import LARGEST_TEXT, SMALLEST_TEXT

_TRUE, _FALSE = "true", "false"


def settings_file() -> Path:
    """Return where this user's settings are kept."""
    return Path(platformdirs.user_config_dir("kinetag-studio", appauthor=False)) / "settings.ini"


class Settings(QObject):
    """The preferences in force, and the file they come from.

    Values the studio does not know, of a newer version or another program, stay in the file. A value it cannot read
    counts as not set. A file it cannot read is put aside as ``settings.ini.bad``.
    """

    changed = Signal(str)
    """Name of a preference that has another value now."""

    def __init__(self, file: Path, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.put_aside = _put_aside(file)
        """Whether the file was unreadable and now stands beside as ``.bad``."""
        self._store = QSettings(str(file), QSettings.Format.IniFormat, self)
        found: dict[str, Any] = {field.name: self._read(field.name) for field in fields(Preferences)}
        self.values = Preferences(**found)

    def set(self, name: str, value: Any) -> None:
        """Keep a preference; ValueError when it has no such value."""
        if not _READ[name][1](value):
            raise ValueError(f"{name} cannot be {value!r}")
        if value == getattr(self.values, name):
            return
        change: dict[str, Any] = {name: value}
        self.values = replace(self.values, **change)
        self._store.setValue(name, _written(value))
        self.changed.emit(name)

    def flush(self) -> None:
        """Write what was changed now; Qt does it by itself some time later."""
        self._store.sync()

    def _read(self, name: str) -> Any:
        default = getattr(Preferences(), name)
        stored = self._store.value(name)
        if stored is None:
            return default
        read, is_legal = _READ[name]
        # What stands in the file may have been typed by anybody.
        with contextlib.suppress(ValueError, TypeError, KeyError, AttributeError, RecursionError):
            value = read(stored)
            if is_legal(value):
                return value
        return default


def _put_aside(file: Path) -> bool:
    try:
        text = file.read_bytes().decode("utf-8")
    except FileNotFoundError:
        return False
    except (OSError, UnicodeDecodeError):
        return _rename(file)
    trial = QSettings(str(file), QSettings.Format.IniFormat)
    if "\0" in text or trial.status() is not QSettings.Status.NoError:
        return _rename(file)
    return False


def _rename(file: Path) -> bool:
    # A folder of that name, or a disk without rights: the start goes on with defaults.
    with contextlib.suppress(OSError):
        os.replace(file, file.with_name(file.name + ".bad"))
    return True


def _written(value: object) -> object:
    if isinstance(value, bool):
        return _TRUE if value else _FALSE
    if isinstance(value, bytes):
        return value.hex()
    if isinstance(value, (dict, tuple)):
        return json.dumps(value)
    return str(value)


def _truth(stored: Any) -> bool:
    return {_TRUE: True, _FALSE: False}[str(stored).lower()]


def _bytes(stored: Any) -> bytes:
    return bytes(stored.data()) if isinstance(stored, QByteArray) else bytes.fromhex(stored)


def _keys(stored: Any) -> Keys:
    return {str(action): tuple(str(key) for key in keys) for action, keys in json.loads(stored).items()}


def _names(stored: Any) -> tuple[str, ...]:
    return tuple(str(name) for name in json.loads(stored))


def _one_of(*values: object) -> Callable[[Any], bool]:
    return lambda value: value in values


def _between(least: float, most: float) -> Callable[[Any], bool]:
    return lambda value: least <= value <= most


def _is(kind: type) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, kind)


_READ: dict[str, tuple[Callable[[Any], Any], Callable[[Any], bool]]] = {
    "scheme": (str, _one_of("dark", "light", "system")),
    "text_scale": (float, _between(SMALLEST_TEXT, LARGEST_TEXT)),
    "reduced_motion": (_truth, _is(bool)),
    "vocabulary": (str, _one_of("clinic", "studio")),
    "library": (str, _is(str)),
    "delay": (int, _one_of(*DELAYS)),
    "sound": (_truth, _is(bool)),
    "volume": (float, _between(0.0, 1.0)),
    "seen_from": (str, _one_of("front", "behind")),
    "last_source": (str, _is(str)),
    "last_person": (str, _is(str)),
    "last_preset": (str, _is(str)),
    "export_folder": (str, _is(str)),
    "take_name": (str, _is(str)),
    "geometry": (_bytes, _is(bytes)),
    "clicker": (_truth, _is(bool)),
    "keys": (_keys, _is(dict)),
    "angles": (_names, _is(tuple)),
    "coach_marks_done": (_truth, _is(bool)),
}
"""For each preference: from the text in the file, and whether it may have this value."""
