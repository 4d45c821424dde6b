"""What a person writes behind ``synthetic:``, as options."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from studio.acquisition.synthetic.scripts import WORN_SCRIPTS
from studio.core.body import DEFAULT_STATURE, PLACES, PRESETS, Place
from studio.core.errors import SourceUnreadable

SCRIPTS = (*WORN_SCRIPTS, "rest", "turns")
MOST_LOSS = 0.9
MOST_SKEW = 1000.0  # ppm; a crystal has 20 to 50, an MPU-6050's own oscillator up to 50,000 and is not used
MOST_AHEAD = 60.0  # s; made at 25 times real time, and whoever opens a link waits for it
STATURES = (0.8, 2.3)  # m


@dataclass(frozen=True, slots=True)
class SuitOptions:
    """The simulated suit and what happens to it."""

    script: str = "walk"
    places: tuple[Place, ...] = PLACES
    """Where tags are worn, in the order of Table 1; tag number k belongs at row k."""
    loss: float = 0.0
    """Share of the packets lost on the air."""
    burst: float = 0.0
    """Frames, mean length of the outages; 0: each packet is lost or not by itself."""
    seed: int = 1
    calibrated: bool = False
    speed: float = 1.0
    """Times real time; infinite: as fast as it is read."""
    ahead: float = 0.0
    """s that are sent at once when the link opens, as if the studio had been listening since."""
    skew: float = 0.0
    """ppm; 0: all tags follow the receiver's clock."""
    reboot: float = math.inf
    """s after switching on; infinite: never."""
    reboot_place: Place | None = None
    """None: the pelvis, or the first tag where there is none."""
    swap: tuple[Place, Place] | None = None
    low_battery: bool = False
    rate_hz: int = 50
    stature: float = DEFAULT_STATURE
    """m."""

    @property
    def frame_s(self) -> float:
        """Time from one sample of a tag to the next, s."""
        return 1.0 / self.rate_hz


class _Refused(ValueError):
    """A value that makes no sense, with the reason in words."""


def read_words(words: str) -> SuitOptions:
    """Return the options of ``[script][?name=value&…]``; SourceUnreadable when they make no sense."""
    source = f"synthetic:{words}" if words and not words.startswith("?") else f"synthetic{words}"
    script, _, rest = words.partition("?")
    try:
        options = SuitOptions(script=_script(script or "walk"))
        for option in filter(None, rest.split("&")):
            name, _, value = option.partition("=")
            if name not in OPTIONS:
                raise _Refused(f"there is no option {name or option}")
            options = replace(options, **OPTIONS[name](value))
        _check(options)
    except _Refused as refused:
        raise SourceUnreadable(source, str(refused)) from refused
    return options


def _check(options: SuitOptions) -> None:
    if options.burst and options.loss > options.burst / (1.0 + options.burst):
        # Between two outages at least one frame is heard.
        raise _Refused(f"outages of {options.burst:g} frames cannot lose {options.loss:g} of the packets")
    named = [place for place in (*(options.swap or ()), options.reboot_place) if place is not None]
    for place in named:
        if place not in options.places:
            raise _Refused(f"no tag is worn at {place.value}")


def _script(value: str) -> str:
    if value not in SCRIPTS:
        raise _Refused(f"no script is called {value}, there are {', '.join(SCRIPTS)}")
    return value


def _number(value: str, least: float, most: float, what: str) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not least <= number <= most:
        raise _Refused(f"{what} must be a number from {least:g} to {most:g}, not {value or 'empty'}")
    return number


def _whole(value: str, least: int, most: int, what: str) -> int:
    number = _number(value, least, most, what)
    if not number.is_integer():
        raise _Refused(f"{what} must be a whole number, not {value}")
    return int(number)


def _place(value: str) -> Place:
    try:
        return Place(value)
    except ValueError as unknown:
        raise _Refused(f"no place is called {value or 'empty'}") from unknown


def _one_of(value: str, choices: dict[str, Any], what: str) -> Any:
    if value not in choices:
        raise _Refused(f"{what} must be {' or '.join(choices)}, not {value or 'empty'}")
    return choices[value]


def _tags(value: str) -> dict[str, Any]:
    if value in PRESETS:
        return {"places": PRESETS[value]}
    return {"places": PLACES[: _whole(value, 1, len(PLACES), "tags")]}


def _reboot(value: str) -> dict[str, Any]:
    seconds, mark, place = value.partition("@")
    return {
        "reboot": _number(seconds, 0.0, 1e6, "reboot"),
        "reboot_place": _place(place) if mark else None,
    }


def _swap(value: str) -> dict[str, Any]:
    first, _, second = value.partition(":")
    pair = _place(first), _place(second)
    if pair[0] is pair[1]:
        raise _Refused("a tag cannot be swapped with itself")
    return {"swap": pair}


def _speed(value: str) -> dict[str, Any]:
    return {"speed": math.inf if value == "max" else _number(value, 0.01, 1000.0, "speed")}


OPTIONS: dict[str, Callable[[str], dict[str, Any]]] = {
    "tags": _tags,
    "loss": lambda value: {"loss": _number(value, 0.0, MOST_LOSS, "loss")},
    "burst": lambda value: {"burst": _number(value, 1.0, 1000.0, "burst")},
    "seed": lambda value: {"seed": _whole(value, 0, 2**53, "seed")},
    "calibrated": lambda value: {"calibrated": _one_of(value, {"0": False, "1": True}, "calibrated")},
    "speed": _speed,
    "ahead": lambda value: {"ahead": _number(value, 0.0, MOST_AHEAD, "ahead")},
    "skew": lambda value: {"skew": _number(value, 0.0, MOST_SKEW, "skew")},
    "reboot": _reboot,
    "swap": _swap,
    "battery": lambda value: {"low_battery": _one_of(value, {"low": True}, "battery")},
    "rate": lambda value: {"rate_hz": _one_of(value, {"50": 50, "100": 100}, "rate")},
    "stature": lambda value: {"stature": _number(value, *STATURES, "stature")},
}
