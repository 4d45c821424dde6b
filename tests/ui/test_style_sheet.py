"""The style sheet: every colour of it can be read on the ground it stands on, in both palettes."""

import re

import pytest
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QPushButton

from studio.ui.icons import ICONS, icon_file, pixmap
from studio.ui.style_sheet import dress, mixed, set_look, style_sheet
from studio.ui.theme import Theme, contrast

# The plugin that paints into memory has no window manager to tell sizes to.
pytestmark = pytest.mark.qt_log_ignore("propagateSizeHints")

TEXT, GRAPHIC = 4.5, 3.0  # WCAG 2.2, 1.4.3 and 1.4.11


def theme_of(scheme) -> Theme:
    theme = Theme()
    theme.scheme = scheme
    return theme


def rules(theme: Theme) -> list[tuple[str, dict[str, str]]]:
    sheet = style_sheet(theme)
    found = re.findall(r"([^{}]+)\{([^{}]*)\}", sheet)
    pairs = [(selector.strip(), dict(re.findall(r"([\w-]+)\s*:\s*([^;]+)", body))) for selector, body in found]
    assert len(pairs) > 50
    return pairs


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_every_text_colour_can_be_read_on_its_own_ground(scheme):
    faint = [
        (selector, ratio)
        for selector, values in rules(theme_of(scheme))
        if values.get("color", "").startswith("#") and values.get("background-color", "").startswith("#")
        if (ratio := contrast(values["color"], values["background-color"])) < TEXT
    ]

    assert faint == []


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_text_without_a_ground_of_its_own_can_be_read_on_every_ground(scheme):
    theme = theme_of(scheme)
    grounds = (theme.tokens.window, theme.tokens.panel, theme.tokens.raised)
    faint = [
        (selector, ground)
        for selector, values in rules(theme)
        if values.get("color", "").startswith("#") and not values.get("background-color", "").startswith("#")
        if "indicator" not in selector
        for ground in grounds
        if contrast(values["color"], ground) < TEXT
    ]

    assert faint == []


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_edges_focus_rings_and_marks_stand_out_from_every_ground(scheme):
    t = theme_of(scheme).tokens
    edge = next(
        v["border"].split()[-1] for s, v in rules(theme_of(scheme)) if s.startswith("QLineEdit, QPlainTextEdit")
    )
    colours = {"edge": edge, "accent": t.accent, "good": t.good, "warn": t.warn, "bad": t.bad, "rec": t.rec}
    faint = [
        (name, ground)
        for name, colour in colours.items()
        for ground in (t.window, t.panel, t.raised)
        if contrast(colour, ground) < GRAPHIC
    ]

    assert faint == []
    assert contrast(t.on_accent, t.rec) >= TEXT
    assert contrast(t.on_accent, t.accent) >= TEXT


@pytest.fixture
def undressed(qapp):
    """Let the application look as before afterwards."""
    font, palette = QFont(qapp.font()), qapp.palette()
    yield qapp
    qapp.setStyleSheet("")
    qapp.setPalette(palette)
    qapp.setFont(font)


def test_large_text_makes_larger_text_and_higher_controls(qtbot, undressed):
    theme, heights = theme_of("light"), []
    button = QPushButton("Use my sensors")
    qtbot.addWidget(button)
    for scale in (1.0, 2.0):
        theme.text_scale = scale
        dress(undressed, theme)
        button.ensurePolished()
        heights.append(button.sizeHint().height())

    assert heights[0] == 32
    assert heights[1] >= 44


def test_a_look_can_change_while_it_is_shown(qtbot, undressed):
    theme = theme_of("dark")
    dress(undressed, theme)
    button = QPushButton("Record")
    qtbot.addWidget(button)
    button.show()
    set_look(button, kind="record")
    middle = button.grab().toImage().pixelColor(6, button.height() // 2)

    assert middle.name().upper() == theme.tokens.rec


def test_a_mix_lies_between_its_colours():
    assert mixed("#000000", "#FFFFFF", 0.0) == "#000000"
    assert mixed("#000000", "#FF8000", 0.5) == "#804000"


@pytest.mark.parametrize("file", sorted(ICONS.glob("*.svg")), ids=lambda file: file.stem)
def test_every_icon_is_drawn_in_the_colour_asked_for(qtbot, file):
    image = pixmap(file.stem, "#FF0000", 40).toImage()
    seen = {
        image.pixelColor(x, y).name() for x in range(40) for y in range(40) if image.pixelColor(x, y).alpha() == 255
    }

    assert seen
    if not file.stem.startswith(("arrow-", "tick-on-")):  # those are read by the style sheet, which tints nothing
        assert seen == {"#ff0000"}


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_icons_of_the_style_sheet_are_there_and_stand_out(scheme):
    theme = theme_of(scheme)
    files = re.findall(r'url\("([^"]+)"\)', style_sheet(theme))

    assert files
    assert all(icon_file(name.rpartition("/")[2].removesuffix(".svg")).is_file() for name in files)
    arrow = re.search(r"#[0-9A-F]{6}", icon_file("arrow-down").read_text())
    assert arrow is not None
    assert contrast(arrow[0], theme.tokens.panel) >= GRAPHIC
