"""The wire formats the studio speaks: the only place that knows the list."""

from importlib import import_module
from typing import Final, cast

from studio.acquisition.dialects.dialect import Dialect

DIALECTS: Final[dict[str, str]] = {
    "receiver_frames": "studio.acquisition.dialects.receiver_frames:ReceiverFrames",
}


def open_dialect(name: str) -> Dialect:
    """Return a new codec of the wire format ``name``; KeyError when it is none of ``DIALECTS``."""
    module, _, made_by = DIALECTS[name].partition(":")
    return cast(Dialect, getattr(import_module(module), made_by)())
