"""The headless verbs: ``studio record``, ``studio export`` …

Exit codes: 0 done, 1 the operator can act (one sentence on stderr), 2 usage.
"""

import os
import sys
from collections.abc import Sequence

from studio.cli.arguments import parser
from studio.core.errors import StudioError
from studio.storage.crash_report import crash_folder, write_crash_report
from studio.ui.wording import one_line

DONE, REFUSED = 0, 1
SCREENS = ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")

NO_SCREEN = (
    "There is no screen to open the window on. Neither DISPLAY nor WAYLAND_DISPLAY is set. "
    "Start the studio from a desktop, or use a verb: {command} --help lists them."
)
NO_LIBRARY = (
    "The window cannot be opened: a library of the system that Qt needs is missing ({name}). "
    "{command} installs it when it may; otherwise install libegl1 and libxkbcommon0, then start again."
)

MISTAKE = (
    "The studio made a mistake and could not go on. What was recorded up to now is safe. "
    "A report for its makers is in {report}; it has not been sent anywhere."
)


def main(argv: Sequence[str]) -> int:
    """Run one verb and return the exit code."""
    arguments = parser().parse_args(argv)
    if arguments.verb is None:
        return _window()
    try:
        arguments.run(arguments)
    except StudioError as refusal:
        print(one_line(refusal), file=sys.stderr)
        return REFUSED
    except BrokenPipeError:  # the reader of our output, `head` for one, has seen enough
        return REFUSED
    except Exception as mistake:  # noqa: BLE001 (the outermost place: our own mistake ends in a report)
        print(MISTAKE.format(report=write_crash_report(mistake, crash_folder())), file=sys.stderr)
        return REFUSED
    return DONE


def _window() -> int:
    """Open the window; say in one sentence why that is not possible."""
    command = "studio.bat" if sys.platform == "win32" else "./studio.sh"
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in SCREENS):
        print(NO_SCREEN.format(command=command), file=sys.stderr)
        return REFUSED
    try:
        from studio.ui.application import run  # the verbs start without Qt
    except ImportError as missing:
        print(NO_LIBRARY.format(command=command, name=str(missing).partition(":")[0]), file=sys.stderr)
        return REFUSED
    return run()
