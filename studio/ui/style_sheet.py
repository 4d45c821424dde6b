"""The look of Qt's own widgets: one style sheet, filled in from the theme.

Views choose by property and write no style sheet of their own::

    QPushButton, QToolButton   kind    primary | quiet | record | recorder | segment
    QPushButton                state   of the strip: ready | check | countdown | recording | saving | saved | problem
    QLabel                     role    caption | section | page | figure | muted | strong
    QLabel                     tone    good | warn | bad | accent | rec
    QFrame                     ground  window | panel | raised | floating

``set_look(widget, kind="primary")`` sets them at any time; setting a property alone acts only before the first show.
A font given with ``setFont`` is lost in between: weights and sizes come from ``role``.
"""

from string import Template

from PySide6.QtWidgets import QApplication, QWidget

from studio.ui.icons import icon_file
from studio.ui.theme import CONTROL, FOCUS, GAP, GRID, RADIUS, RECORD, Theme

INDICATOR = 20  # px; with the gap to its words a tick box is a target of 24 px and more
HANDLE = 20  # px; of sliders
BAR = 12  # px; scroll bars


def dress(application: QApplication, theme: Theme) -> None:
    """Give the whole application the theme's style, palette, font and style sheet."""
    # Fusion draws alike on every system; the native styles ignore half of a palette.
    if application.style().name() != "fusion":
        application.setStyle("Fusion")
    application.setPalette(theme.palette())
    application.setFont(theme.font("body"))
    application.setStyleSheet(style_sheet(theme))


def set_look(widget: QWidget, **properties: str) -> None:
    """Set properties the style sheet asks for, also on a widget that is already shown."""
    for name, value in properties.items():
        widget.setProperty(name, value)
    widget.style().unpolish(widget)
    widget.style().polish(widget)
    widget.update()


def mixed(one: str, other: str, share: float) -> str:
    """Return the colour ``one`` with a ``share`` (0…1) of ``other``."""
    channels = (round(_channel(one, i) * (1 - share) + _channel(other, i) * share) for i in (1, 3, 5))
    return "#{:02X}{:02X}{:02X}".format(*channels)


def style_sheet(theme: Theme) -> str:
    """Return the style sheet for the application."""
    return Template(_SHEET).substitute(_values(theme))


def _values(theme: Theme) -> dict[str, object]:
    t = theme.tokens
    # Half as much as the text, because large text needs its room in width and in number of lines.
    growth = max(1.0, (1 + theme.text_scale) / 2)
    control, indicator = round(CONTROL * growth), round(INDICATOR * growth)
    return {
        "window": t.window,
        "panel": t.panel,
        "raised": t.raised,
        "line": t.line,
        "text": t.text,
        "muted": t.muted,
        "accent": t.accent,
        "good": t.good,
        "warn": t.warn,
        "bad": t.bad,
        "rec": t.rec,
        "on_accent": t.on_accent,
        # Edges of fields must be seen (3:1), and shall be quieter than their text.
        "edge": mixed(t.muted, t.panel, 0.24),
        "hover": mixed(t.raised, t.text, 0.07),
        "pressed": mixed(t.raised, t.text, 0.14),
        "selected": mixed(t.panel, t.accent, 0.18),
        "accent_hover": mixed(t.accent, t.text if theme.is_dark else t.window, 0.12),
        "rec_hover": mixed(t.rec, t.text if theme.is_dark else t.window, 0.12),
        "caption_px": theme.pixels("caption"),
        "body_px": theme.pixels("body"),
        "section_px": theme.pixels("section"),
        "page_px": theme.pixels("page"),
        "figure_px": theme.pixels("figure"),
        "control": control - 2 * FOCUS,  # without the border
        "field": control - 2,
        "segment": control - GAP,
        "record": round(RECORD * growth) - 2 * FOCUS,
        "focus": FOCUS,
        "radius": RADIUS,
        "grid": GRID,
        "gap": GAP,
        "side": GAP + GRID,
        "indicator": indicator - 2 * FOCUS,
        "indicator_radius": GRID,
        "radio_radius": indicator // 2,
        "radio_edge": indicator * 3 // 10,
        "radio_dot": indicator - 2 * (indicator * 3 // 10),
        "handle": HANDLE,
        "handle_radius": HANDLE // 2,
        "handle_out": -(HANDLE - GRID) // 2,
        "bar": BAR,
        "bar_radius": (BAR - GRID) // 2,
        "tick": icon_file("tick-on-blue" if theme.is_dark else "tick-on-navy").as_posix(),
        "down": icon_file("arrow-down").as_posix(),
        "up": icon_file("arrow-up").as_posix(),
    }


def _channel(colour: str, at: int) -> int:
    return int(colour[at : at + 2], 16)


_SHEET = """
QLabel { background: transparent; }
QLabel[role="caption"] { font-size: ${caption_px}px; color: $muted; }
QLabel[role="muted"] { color: $muted; }
QLabel[role="strong"] { font-weight: 600; }
QLabel[role="section"] { font-size: ${section_px}px; font-weight: 600; }
QLabel[role="page"] { font-size: ${page_px}px; font-weight: 600; }
QLabel[role="figure"] { font-size: ${figure_px}px; }
QLabel[tone="good"] { color: $good; }
QLabel[tone="warn"] { color: $warn; }
QLabel[tone="bad"] { color: $bad; }
QLabel[tone="rec"] { color: $rec; }
QLabel[tone="accent"] { color: $accent; }

QFrame[ground="window"] { background-color: $window; border: none; }
QFrame[ground="panel"] { background-color: $panel; border: none; }
QFrame[ground="raised"] { background-color: $raised; border: none; border-radius: ${radius}px; }

QFrame[ground="floating"] { background-color: $raised; border: 1px solid $edge; border-radius: ${radius}px; }

QPushButton, QToolButton {
    color: $text; background-color: $raised; border: ${focus}px solid $line; border-radius: ${radius}px;
    min-height: ${control}px; padding: 0 ${side}px;
}
QToolButton { padding: 0 ${gap}px; }
QPushButton:hover, QToolButton:hover { background-color: $hover; }
QPushButton:pressed, QToolButton:pressed { background-color: $pressed; }
QPushButton:checked, QToolButton:checked { background-color: $selected; border-color: $accent; }
QPushButton:disabled, QToolButton:disabled { color: $muted; background-color: $panel; border-style: dashed; }
QPushButton:focus, QToolButton:focus { border-color: $accent; }

QPushButton[kind="primary"], QToolButton[kind="primary"] {
    color: $on_accent; background-color: $accent; border-color: $accent; font-weight: 600;
}
QPushButton[kind="primary"]:hover { color: $on_accent; background-color: $accent_hover; }
QPushButton[kind="primary"]:focus { border-color: $text; }
QPushButton[kind="primary"]:disabled { color: $muted; background-color: $panel; border-color: $line; }

QPushButton[kind="quiet"], QToolButton[kind="quiet"] { background-color: transparent; border-color: transparent; }
QPushButton[kind="quiet"]:hover, QToolButton[kind="quiet"]:hover { background-color: $hover; }
QPushButton[kind="quiet"]:pressed, QToolButton[kind="quiet"]:pressed { background-color: $pressed; }
QPushButton[kind="quiet"]:checked, QToolButton[kind="quiet"]:checked { background-color: $selected; }
QPushButton[kind="quiet"]:focus, QToolButton[kind="quiet"]:focus { border-color: $accent; }

QPushButton[kind="line"] { background-color: transparent; border-color: transparent; text-align: left; padding: 0 8px; }
QPushButton[kind="line"]:hover { background-color: $hover; }
QPushButton[kind="line"]:focus { border-color: $accent; }

QPushButton[kind="segment"], QToolButton[kind="segment"] {
    color: $muted; background-color: transparent; border-color: transparent; min-height: ${segment}px;
}
QPushButton[kind="segment"]:hover { color: $text; background-color: $hover; }
QPushButton[kind="segment"]:checked { color: $text; background-color: $selected; }
QPushButton[kind="segment"]:focus { border-color: $accent; }

QPushButton[kind="record"] {
    color: $on_accent; background-color: $rec; border-color: $rec; font-weight: 600;
    min-height: ${record}px;
}
QPushButton[kind="recorder"] { min-height: ${record}px; font-weight: 600; }
QPushButton[kind="record"]:hover { color: $on_accent; background-color: $rec_hover; }
QPushButton[kind="record"]:focus { border-color: $text; }
QPushButton[kind="record"]:disabled { color: $muted; background-color: $panel; border-color: $line; }

QPushButton[kind="state"] {
    color: $text; background-color: transparent; border-color: transparent; font-weight: 600; text-align: left;
}
QPushButton[kind="state"]:focus { border-color: $accent; }
QPushButton[state="ready"], QPushButton[state="saved"] { color: $good; }
QPushButton[state="check"], QPushButton[state="countdown"] { color: $warn; }
QPushButton[state="saving"] { color: $accent; }
QPushButton[state="problem"] { color: $bad; }
QPushButton[state="recording"] { color: $on_accent; background-color: $rec; }

QToolButton[kind="rail"] {
    color: $muted; background-color: transparent; font-size: ${caption_px}px; border: ${focus}px solid transparent;
    border-left: 4px solid transparent; padding: ${gap}px ${grid}px; min-height: 24px;
}
QToolButton[kind="rail"]:hover { color: $text; background-color: $hover; }
QToolButton[kind="rail"]:checked { color: $text; background-color: $selected; border-left-color: $accent; }
QToolButton[kind="rail"]:focus { border-color: $accent; }

QToolButton::menu-indicator { image: none; width: 0; }
QPushButton::menu-indicator {
    image: url("$down"); width: 12px; height: 12px; subcontrol-position: right center; right: ${gap}px;
}

QLineEdit, QPlainTextEdit, QTextEdit, QSpinBox, QDoubleSpinBox, QComboBox {
    color: $text; background-color: $panel; border: 1px solid $edge; border-radius: ${radius}px;
    padding: 0 ${gap}px; selection-background-color: $accent; selection-color: $on_accent;
}
QLineEdit, QSpinBox, QDoubleSpinBox, QComboBox { min-height: ${field}px; }
QPlainTextEdit, QTextEdit { padding: ${gap}px; }
QLineEdit:hover, QSpinBox:hover, QDoubleSpinBox:hover, QComboBox:hover { border-color: $muted; }
QLineEdit:focus, QPlainTextEdit:focus, QTextEdit:focus, QSpinBox:focus, QDoubleSpinBox:focus, QComboBox:focus {
    border: ${focus}px solid $accent; padding: 0 7px;
}
QPlainTextEdit:focus, QTextEdit:focus { padding: 7px; }
QLineEdit:focus, QSpinBox:focus, QDoubleSpinBox:focus, QComboBox:focus { min-height: ${control}px; }
QLineEdit:disabled, QSpinBox:disabled, QDoubleSpinBox:disabled, QComboBox:disabled {
    color: $muted; border-style: dashed;
}
QComboBox { padding-right: 28px; }
QComboBox::drop-down { subcontrol-origin: padding; subcontrol-position: center right; width: 28px; border: none; }
QComboBox::down-arrow { image: url("$down"); width: 12px; height: 12px; }
QComboBox QAbstractItemView { color: $text; background-color: $raised; border: 1px solid $line; padding: ${grid}px; }
QSpinBox::up-button, QDoubleSpinBox::up-button {
    subcontrol-origin: border; subcontrol-position: top right; width: 24px; border: none;
}
QSpinBox::down-button, QDoubleSpinBox::down-button {
    subcontrol-origin: border; subcontrol-position: bottom right; width: 24px; border: none;
}
QSpinBox::up-arrow, QDoubleSpinBox::up-arrow { image: url("$up"); width: 10px; height: 10px; }
QSpinBox::down-arrow, QDoubleSpinBox::down-arrow { image: url("$down"); width: 10px; height: 10px; }

QCheckBox, QRadioButton { color: $text; background: transparent; spacing: ${gap}px; min-height: 24px; }
QCheckBox, QRadioButton { border: ${focus}px solid transparent; border-radius: ${radius}px; padding: 0 ${grid}px 0 0; }
QCheckBox:focus, QRadioButton:focus { border-color: $accent; }
QCheckBox:disabled, QRadioButton:disabled { color: $muted; }
QCheckBox::indicator, QRadioButton::indicator {
    width: ${indicator}px; height: ${indicator}px; border: ${focus}px solid $edge; background-color: $panel;
}
QCheckBox::indicator { border-radius: ${indicator_radius}px; }
QRadioButton::indicator { border-radius: ${radio_radius}px; }
QCheckBox::indicator:checked { background-color: $accent; border-color: $accent; image: url("$tick"); }
QRadioButton::indicator:checked {
    width: ${radio_dot}px; height: ${radio_dot}px; border: ${radio_edge}px solid $accent; background-color: $on_accent;
}
QCheckBox::indicator:disabled, QRadioButton::indicator:disabled { border-color: $line; }

QSlider { background: transparent; min-height: 24px; }
QSlider::groove:horizontal { height: ${grid}px; border-radius: 2px; background-color: $edge; }
QSlider::sub-page:horizontal { height: ${grid}px; border-radius: 2px; background-color: $accent; }
QSlider::handle:horizontal {
    width: ${handle}px; margin: ${handle_out}px 0; border-radius: ${handle_radius}px; background-color: $accent;
}
QSlider::handle:horizontal:focus, QSlider::handle:horizontal:hover { background-color: $text; }
QSlider::handle:horizontal:disabled { background-color: $muted; }

QProgressBar {
    color: $text; background-color: $pressed; border: none; border-radius: ${grid}px; min-height: ${gap}px;
    text-align: center;
}
QProgressBar::chunk { background-color: $accent; border-radius: ${grid}px; }

QAbstractItemView {
    color: $text; background-color: $panel; border: none; outline: none; gridline-color: $line;
    selection-background-color: $selected; selection-color: $text;
}
QAbstractItemView::item { min-height: 28px; padding: 0 ${gap}px; border: none; }
QAbstractItemView::item:hover { background-color: $hover; }
QAbstractItemView::item:selected { color: $text; background-color: $selected; }
QAbstractItemView::item:focus { border: ${focus}px solid $accent; }
QHeaderView { background-color: transparent; }
QHeaderView::section {
    color: $muted; background-color: $panel; font-size: ${caption_px}px; font-weight: 400; border: none;
    border-bottom: 1px solid $line; padding: ${grid}px ${gap}px; min-height: 20px;
}
QTableCornerButton::section { background-color: $panel; border: none; }

QTabBar::tab {
    color: $muted; background-color: transparent; border: none; border-bottom: ${focus}px solid transparent;
    min-height: 28px; padding: 0 ${side}px;
}
QTabBar::tab:selected { color: $text; border-bottom-color: $accent; }
QTabBar::tab:hover { color: $text; }
QTabBar::tab:focus { border-bottom-color: $text; }
QTabWidget::pane { border: none; }

QScrollArea, QScrollArea > QWidget > QWidget { background: transparent; border: none; }
QScrollBar { background: transparent; border: none; }
QScrollBar:vertical { width: ${bar}px; }
QScrollBar:horizontal { height: ${bar}px; }
QScrollBar::handle { background-color: $edge; border-radius: ${bar_radius}px; margin: 2px; }
QScrollBar::handle:vertical { min-height: 24px; }
QScrollBar::handle:horizontal { min-width: 24px; }
QScrollBar::handle:hover { background-color: $muted; }
QScrollBar::add-line, QScrollBar::sub-line { width: 0; height: 0; }
QScrollBar::add-page, QScrollBar::sub-page { background: transparent; }

QMenu { color: $text; background-color: $raised; border: 1px solid $line; padding: ${grid}px; }
QMenu::item { min-height: 24px; padding: ${grid}px 24px ${grid}px ${side}px; border-radius: ${grid}px; }
QMenu::item:selected { color: $text; background-color: $selected; }
QMenu::item:disabled { color: $muted; }
QMenu::separator { height: 1px; background-color: $line; margin: ${grid}px ${gap}px; }
QToolTip { color: $text; background-color: $raised; border: 1px solid $line; padding: ${grid}px ${gap}px; }
QSplitter::handle { background-color: $line; }
QSplitter::handle:horizontal { width: 1px; }
QSplitter::handle:vertical { height: 1px; }
"""
