"""Foreign recordings into the library, and what a take's folder is."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import studio
from studio.capture.setups import with_stature
from studio.importers.registry import import_recording
from studio.storage.profile import PROFILE
from studio.storage.take_store import write_take


def import_into(
    library: Path, paths: Sequence[Path], importer: str, map_file: Path | None, person: str, stature: float | None
) -> Path:
    """Turn a foreign recording into a take of the library and return its folder, when it has been read back.

    Parameters
    ----------
    stature : float or None, m
        Kept for the person. None: what the recording says, else what is known of the person.

    Raises
    ------
    ImportFailed, RecordingError, SetupError, TakeFileError
    """
    take = import_recording(paths, importer, map_file)
    known = with_stature(library, person, stature)
    if known is not None and (stature is not None or not take.setup.stature_known):
        take = replace(take, setup=replace(take.setup, stature=known, stature_known=True))
    versions = {**take.versions, "studio": studio.__version__, "profile": PROFILE}
    return write_take(replace(take, person=person or take.person, versions=versions), library)
