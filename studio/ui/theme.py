"""Colours, type and measures of the window: one set of names, two palettes (visual-language).

Depth comes from grounds, not from frames. Every text colour has a contrast of at least 4.5 on every ground,
every graphic colour 3.0; a test computes them.
"""

from dataclasses import dataclass, fields
from typing import Literal

from PySide6.QtCore import Qt
from PySide6.QtGui import QColor, QFont, QFontDatabase, QGuiApplication, QPalette

Scheme = Literal["dark", "light", "system"]
Role = Literal["caption", "body", "section", "page", "figure"]

GRID = 4  # px; all gaps and sizes are multiples
GAP, GAP_WIDE, GAP_PAGE = 8, 16, 24  # px
CONTROL = 32  # px, height of buttons and fields
RECORD = 48  # px, height of the record button
RADIUS = 6  # px
FORM_WIDTH = 720  # px; a column of text and fields is never wider
FOCUS = 2  # px, width of the focus ring
SMALLEST_TEXT, LARGEST_TEXT = 0.8, 2.0  # of the normal text size

_POINTS: dict[Role, float] = {"caption": 11, "body": 13, "section": 16, "page": 22, "figure": 34}  # px at scale 1


@dataclass(frozen=True, slots=True)
class Tokens:
    """The colours of one palette, ``#RRGGBB``."""

    window: str
    panel: str
    raised: str
    line: str
    text: str
    muted: str
    accent: str
    good: str
    warn: str
    bad: str
    rec: str
    left: str
    right: str
    on_accent: str
    """Text on ``accent`` and on ``rec``."""


DARK = Tokens(
    window="#15181C",
    panel="#1C2026",
    raised="#252A31",
    line="#343B44",
    text="#E8ECF0",
    muted="#9AA5B1",
    accent="#4DA3FF",
    good="#3CC48D",
    warn="#F2B84B",
    bad="#FF6B5E",
    rec="#FF5A5A",
    left="#56B4E9",
    right="#E69F00",
    on_accent="#0B0E11",
)
LIGHT = Tokens(
    window="#F4F6F8",
    panel="#FFFFFF",
    raised="#FFFFFF",
    line="#D5DBE1",
    text="#1B2127",
    muted="#56616C",
    accent="#0B63CE",
    good="#0B7A53",
    warn="#8A5A00",
    bad="#B3261E",
    rec="#C21F1F",
    left="#005EA8",
    right="#A63D00",
    on_accent="#FFFFFF",
)


class Theme:
    """The palette and text size in force. Made once by the application and handed to every view."""

    def __init__(self) -> None:
        self.scheme: Scheme = "system"
        self.text_scale = 1.0
        self.reduced_motion = False

    @property
    def is_dark(self) -> bool:
        """Whether the dark palette is in force."""
        if self.scheme != "system":
            return self.scheme == "dark"
        return QGuiApplication.styleHints().colorScheme() == Qt.ColorScheme.Dark

    @property
    def tokens(self) -> Tokens:
        """The colours in force."""
        return DARK if self.is_dark else LIGHT

    def pixels(self, role: Role) -> int:
        """Return the height of a text of this role, px."""
        return round(_POINTS[role] * self.text_scale)

    def font(self, role: Role, *, bold: bool = False) -> QFont:
        """Return the system font for a role; figures have digits of one width."""
        font = QFontDatabase.systemFont(QFontDatabase.SystemFont.GeneralFont)
        font.setPixelSize(self.pixels(role))
        font.setWeight(QFont.Weight.DemiBold if bold or role in ("page", "section") else QFont.Weight.Normal)
        font.setFeature(QFont.Tag("tnum"), 1)
        return font

    def palette(self) -> QPalette:
        """Return the palette for the application: some platforms ignore the colour scheme."""
        t = self.tokens
        palette = QPalette()
        roles = {
            QPalette.ColorRole.Window: t.window,
            QPalette.ColorRole.Base: t.panel,
            QPalette.ColorRole.AlternateBase: t.raised,
            QPalette.ColorRole.Button: t.raised,
            QPalette.ColorRole.WindowText: t.text,
            QPalette.ColorRole.Text: t.text,
            QPalette.ColorRole.ButtonText: t.text,
            QPalette.ColorRole.PlaceholderText: t.muted,
            QPalette.ColorRole.Highlight: t.accent,
            QPalette.ColorRole.HighlightedText: t.on_accent,
            QPalette.ColorRole.ToolTipBase: t.raised,
            QPalette.ColorRole.ToolTipText: t.text,
            QPalette.ColorRole.Link: t.accent,
        }
        for role, colour in roles.items():
            palette.setColor(role, QColor(colour))
        for role in (QPalette.ColorRole.WindowText, QPalette.ColorRole.Text, QPalette.ColorRole.ButtonText):
            palette.setColor(QPalette.ColorGroup.Disabled, role, QColor(t.muted))
        return palette


def contrast(one: str, other: str) -> float:
    """Return the contrast ratio of two colours, 1…21 (WCAG 2.2, relative luminance)."""
    lighter, darker = sorted((_luminance(one), _luminance(other)), reverse=True)
    return (lighter + 0.05) / (darker + 0.05)


def names() -> tuple[str, ...]:
    """Return the names of all tokens."""
    return tuple(field.name for field in fields(Tokens))


def _luminance(colour: str) -> float:
    channels = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    red, green, blue = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue
