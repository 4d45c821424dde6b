"""The words of the command line."""

import argparse
import math
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import studio
from studio.cli import help_texts, record_verb, verbs
from studio.cli.help_texts import COMMAND
from studio.core.attitude import ESTIMATORS
from studio.core.take import Mark, PoseName
from studio.export.bvh import DEFAULT_RATE, RATES, rate_name
from studio.export.bvh import PRESETS as BVH_PRESETS
from studio.export.csv_tables import PRESETS as CSV_PRESETS
from studio.importers.registry import IMPORTERS

POSES: tuple[PoseName, ...] = ("n", "t", "bow", "sit")
_POSE = re.compile(r"(?P<name>[a-z]+)=(?P<first>[0-9.]+)\.\.(?P<last>[0-9.]+)")

SHORTEST, TALLEST = 0.3, 2.8  # m; as in the map of a table (resources/map.schema.json)
LOWEST_CM = 30.0  # a stature from here on is meant in cm


def parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    top = argparse.ArgumentParser(
        prog=COMMAND,
        description="Kinetag Studio: motion capture with body-worn sensors.",
        epilog=help_texts.TOP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    top.add_argument("--version", action="version", version=f"Kinetag Studio {studio.__version__}")
    add = partial(
        top.add_subparsers(dest="verb", metavar="VERB", title="verbs").add_parser,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    _devices(add)
    _record(add)
    _import(add)
    _inspect(add)
    _solve(add)
    _export(add)
    return top


AddVerb = Callable[..., argparse.ArgumentParser]


def _devices(add: AddVerb) -> None:
    verb = add("devices", help="list the sources that can be opened now", epilog=help_texts.DEVICES)
    verb.add_argument("--json", action="store_true", help="for programs")
    verb.set_defaults(run=verbs.devices)


def _record(add: AddVerb) -> None:
    verb = add("record", help="record a take and print its folder", epilog=help_texts.RECORD)
    verb.add_argument("--source", required=True, metavar="SOURCE")
    verb.add_argument("--seconds", type=_seconds, default=math.inf, help="how long (default: until Ctrl+C)")
    verb.add_argument("--library", type=Path, required=True, metavar="DIR")
    verb.add_argument("--person", default="", metavar="CODE", help="a code such as P014, never a name")
    verb.add_argument("--name", default="take", help="what the take is called")
    _add_stature(verb, "kept for the person, if one is named")
    verb.set_defaults(run=record_verb.record)


def _import(add: AddVerb) -> None:
    verb = add("import", help="turn a foreign recording into a take and print its folder", epilog=help_texts.IMPORT)
    verb.add_argument("paths", type=Path, nargs="+", metavar="PATH")
    verb.add_argument("--format", choices=("auto", *IMPORTERS), default="auto")
    verb.add_argument("--map", type=Path, metavar="FILE", help="what the columns of a table mean (csv)")
    verb.add_argument("--library", type=Path, required=True, metavar="DIR")
    verb.add_argument("--person", default="", metavar="CODE", help="a code such as P014, never a name")
    _add_stature(verb, "kept for the person, if one is named")
    verb.set_defaults(run=verbs.import_recording, usage_error=verb.error)


def _inspect(add: AddVerb) -> None:
    verb = add("inspect", help="show what became of each sensor's samples", epilog=help_texts.INSPECT)
    verb.add_argument("take", type=_take, metavar="TAKE", help="the folder that record or import printed")
    verb.add_argument("--json", action="store_true", help="for programs")
    verb.add_argument("--truth", action="store_true", help="compare with the true motion of a synthetic take")
    verb.set_defaults(run=verbs.inspect)


def _solve(add: AddVerb) -> None:
    verb = add("solve", help="compute the motion of a take and show how it was found", epilog=help_texts.SOLVE)
    verb.add_argument("take", type=_take, metavar="TAKE", help="the folder that record or import printed")
    _add_solving(verb)
    verb.set_defaults(run=verbs.solve)


def _export(add: AddVerb) -> None:
    verb = add(
        "export",
        help="write a file for another program; it is read back before it is called done",
        epilog=help_texts.EXPORT,
    )
    verb.add_argument("take", type=_take, metavar="TAKE", help="the folder that record or import printed")
    verb.add_argument("--format", choices=("bvh", "csv"), required=True)
    verb.add_argument("--table", choices=("joints", "orientations", "raw"), help="of csv (default: joints)")
    presets = "; ".join(f"{name}: {', '.join(keys)}" for name, keys in (("bvh", BVH_PRESETS), ("csv", CSV_PRESETS)))
    verb.add_argument("--preset", help=f"{presets} (default: the first)")
    verb.add_argument(
        "--fps",
        type=_fps,
        default=argparse.SUPPRESS,
        help=f"of bvh: {', '.join(map(rate_name, RATES))} or native (default: {rate_name(DEFAULT_RATE)})",
    )
    verb.add_argument("-o", "--output", type=Path, required=True, metavar="FILE")
    verb.add_argument("--overwrite", action="store_true", help="replace a file that is there, whoever made it")
    _add_solving(verb)
    verb.set_defaults(run=verbs.export, usage_error=verb.error)


def _add_solving(verb: argparse.ArgumentParser) -> None:
    _add_stature(verb, "for this run only")
    verb.add_argument("--attitude", choices=tuple(ESTIMATORS), default="vqf", help="default: vqf")
    verb.add_argument("--method", choices=("offline", "live"), default="offline", help="default: offline")
    verb.add_argument(
        "--calibration",
        default="recorded",
        metavar="recorded|latest|FILE",
        help="which gyroscope correction to use (default: recorded)",
    )
    verb.add_argument(
        "--pose",
        dest="poses",
        type=_pose,
        action="append",
        default=[],
        metavar="NAME=FROM..TO",
        help="a pose held between two times in s (n, t, bow, sit); may be repeated; replaces the recorded ones",
    )


def _add_stature(verb: argparse.ArgumentParser, effect: str) -> None:
    verb.add_argument(
        "--stature", type=_stature, metavar="METRES|CM", help=f"how tall the person is, such as 1.72 or 172; {effect}"
    )


def _stature(text: str) -> float:
    number = _number(text.replace(",", "."))
    metres = number if number < LOWEST_CM else number / 100
    if not SHORTEST <= metres <= TALLEST:
        raise argparse.ArgumentTypeError(f"{text!r} is no stature from {SHORTEST} to {TALLEST} m, nor one in cm")
    return metres


def _take(text: str) -> Path:
    if not text:  # "$(cat take.txt)" after a verb that failed
        raise argparse.ArgumentTypeError("no take was named; did the verb before this one print any?")
    return Path(text)


def _seconds(text: str) -> float:
    seconds = _number(text)
    if not seconds > 0:
        raise argparse.ArgumentTypeError(f"{text!r} is not a length of time in seconds")
    return seconds


def _fps(text: str) -> float | None:
    if text == "native":
        return None
    for rate in RATES:
        if rate_name(rate) == text:
            return rate
    raise argparse.ArgumentTypeError(f"{text!r} is none of {', '.join(map(rate_name, RATES))}, native")


def _pose(text: str) -> Mark:
    found = _POSE.fullmatch(text)
    if found is None or found["name"] not in POSES:
        raise argparse.ArgumentTypeError(f"{text!r} does not read like n=1.5..4 with one of {', '.join(POSES)}")
    first, last = _number(found["first"]), _number(found["last"])
    if not last >= first:
        raise argparse.ArgumentTypeError(f"{text!r} ends before it begins")
    return Mark(first, "pose", found["name"], last)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return math.nan
