"""Foreign recordings into the library, and what a take's folder is."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import studio
from studio.importers.registry import import_recording
from studio.storage.profile import PROFILE
from studio.storage.take_store import write_take


def import_into(library: Path, paths: Sequence[Path], importer: str, map_file: Path | None, person: str) -> Path:
    """Turn a foreign recording into a take of the library and return its folder, when it has been read back.

    Raises
    ------
    ImportFailed, RecordingError, SetupError
    """
    take = import_recording(paths, importer, map_file)
    versions = {**take.versions, "studio": studio.__version__, "profile": PROFILE}
    return write_take(replace(take, person=person or take.person, versions=versions), library)
