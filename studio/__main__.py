"""``python -m studio``."""

import sys

STOPPED = 130  # as a shell says it of Ctrl+C: 128 and the number of the signal


def start() -> int:
    """Run one verb, or the window; Ctrl+C at a moment when nothing has begun ends in a sentence."""
    try:
        from studio.cli import main  # takes a moment, in which somebody may think better of it

        return main(sys.argv[1:])
    except KeyboardInterrupt:
        print("Stopped.", file=sys.stderr)
        return STOPPED


if __name__ == "__main__":
    sys.exit(start())
