"""The headless verbs: ``studio record``, ``studio export`` …

Exit codes: 0 done, 1 the operator can act (one sentence on stderr), 2 usage.
"""

import sys
from collections.abc import Sequence

from studio.cli.arguments import parser
from studio.core.errors import StudioError
from studio.storage.crash_report import crash_folder, write_crash_report
from studio.ui.wording import one_line

DONE, REFUSED = 0, 1

NO_WINDOW_YET = (
    "The window of Kinetag Studio is not part of this version yet. "
    "Everything works from the command line: studio --help lists the verbs."
)

MISTAKE = (
    "The studio made a mistake and could not go on. What was recorded up to now is safe. "
    "A report for its makers is in {report}; it has not been sent anywhere."
)


def main(argv: Sequence[str]) -> int:
    """Run one verb and return the exit code."""
    arguments = parser().parse_args(argv)
    if arguments.verb is None:
        print(NO_WINDOW_YET)
        return DONE
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
