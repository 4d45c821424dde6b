"""The formats a foreign recording may have. The only place that knows the list."""

from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import cast

from studio.core.errors import FormatUnknown, MapMissing, RecordingMissing
from studio.core.take import Take
from studio.importers.xio import looks_like_xio

IMPORTERS = {
    "xio": "studio.importers.xio:read_xio",
    "csv": "studio.importers.csv_map:read_csv",
}
"""Name to module and function. ``csv`` needs a map file as well."""

_TABLES = frozenset({".csv", ".tsv", ".txt"})


def detect(paths: Sequence[Path]) -> str:
    """Return which importer reads these paths; FormatUnknown when none does."""
    if looks_like_xio(paths):
        return "xio"
    if paths and all(path.suffix.lower() in _TABLES for path in paths):
        return "csv"
    raise FormatUnknown(tuple(str(path) for path in paths))


def import_recording(paths: Sequence[Path], name: str, map_file: Path | None) -> Take:
    """Read a foreign recording.

    Parameters
    ----------
    name : key of ``IMPORTERS``, or ``auto``
    map_file
        What the columns mean; None for formats that tell themselves. Whoever gives one means ``csv``.

    Raises
    ------
    RecordingMissing, FormatUnknown, MapMissing, MapFileInvalid, RecordingUnreadable
    """
    for path in (*paths, *([map_file] if map_file else [])):
        if not path.exists():
            raise RecordingMissing(str(path))
    if name == "auto":
        name = "csv" if map_file is not None else detect(paths)
    module, _, function = IMPORTERS[name].partition(":")
    read = cast("Callable[..., Take]", getattr(import_module(module), function))
    if name != "csv":
        return read(*paths)
    if map_file is None:
        raise MapMissing(tuple(str(path) for path in paths))
    return read(paths, map_file)
