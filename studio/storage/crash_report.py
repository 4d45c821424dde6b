"""A report of our own mistake, kept on this computer and nowhere else."""

import platform
import traceback
from datetime import UTC, datetime
from pathlib import Path

import platformdirs

import studio

HIDDEN_HOME = "~"


def crash_folder() -> Path:
    """Return where this user's crash reports are kept."""
    return Path(platformdirs.user_log_dir("kinetag-studio", appauthor=False))


def write_crash_report(error: BaseException, folder: Path) -> Path:
    """Write what went wrong, without the user's name in its paths, and return the file.

    The text holds the stack and the versions; no take, no person, no arguments of functions.
    """
    now = datetime.now(UTC)
    lines = [
        f"Kinetag Studio {studio.__version__}, {now.isoformat(timespec='seconds')}",
        f"Python {platform.python_version()} on {platform.system()} {platform.release()} {platform.machine()}",
        "",
        *traceback.format_exception(error),
    ]
    text = "\n".join(lines).replace(str(Path.home()), HIDDEN_HOME)
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    file = folder / f"crash-{now:%Y%m%dT%H%M%S%f}.txt"
    file.write_text(text, encoding="utf-8")
    return file
