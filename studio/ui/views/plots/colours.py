"""Colours of the axes x, y and z.

Sides have blue and orange (theme), states green, amber and red: axes take the purple and the green of Okabe and Ito and
the colour of text, which also differ in lightness, and each line carries its letter.
"""

from typing import NamedTuple

from studio.ui.theme import Theme


class AxisColours(NamedTuple):
    """``#RRGGBB`` of each axis."""

    x: str
    y: str
    z: str


ON_DARK = AxisColours("#D98CC0", "#2FBF93", "#E8ECF0")
ON_LIGHT = AxisColours("#A3368C", "#00805E", "#1B2127")


def axis_colours(theme: Theme) -> AxisColours:
    """Return the colours for the palette in force."""
    return ON_DARK if theme.is_dark else ON_LIGHT
