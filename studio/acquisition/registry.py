"""The kinds of sources that can be opened. The only place that knows the list."""

from importlib import import_module
from typing import cast

from studio.acquisition.driver import Driver, Link
from studio.core.errors import SourceUnreadable

DRIVERS: dict[str, str] = {
    "synthetic": "studio.acquisition.synthetic.link:SyntheticDriver",
    "serial": "studio.acquisition.serial_port:SerialDriver",
}
"""Name to ``module:class``; imported when chosen, so that a missing library disables one entry and not the studio."""


def driver(kind: str) -> Driver:
    """Return the driver called ``kind``."""
    module, _, attribute = DRIVERS[kind].partition(":")
    return cast(Driver, getattr(import_module(module), attribute)())


async def open_link(source: str) -> Link:
    """Open the source named by ``kind[:words]``.

    Raises
    ------
    SourceUnreadable
        The kind is not known, or its driver does not understand the words.
    LinkError
        It cannot be opened.
    """
    kind, words = kind_of(source)
    if kind not in DRIVERS:
        raise SourceUnreadable(source, f"no source is called {kind}")
    return await driver(kind).open(words)


def kind_of(source: str) -> tuple[str, str]:
    """Return the kind of a source and the words for its driver: ``synthetic?tags=8`` has the words ``?tags=8``."""
    kind, mark, words = source.partition("?")
    if ":" in kind:
        kind, _, first = kind.partition(":")
        return kind, first + mark + words
    return kind, mark + words
