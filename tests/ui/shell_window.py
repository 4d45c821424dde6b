"""The window with its own pages and simple ones in the place of the others, for tests."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtGui import QFont
from PySide6.QtWidgets import QApplication, QLabel, QLineEdit, QListWidget, QPushButton, QVBoxLayout, QWidget

from studio.ui.keys import TABLE
from studio.ui.models.preferences import Preferences
from studio.ui.style_sheet import dress
from studio.ui.theme import Scheme, Theme
from studio.ui.views.diagnostics_page import DiagnosticsPage
from studio.ui.views.home_page import HomePage, Recovered
from studio.ui.views.main_window import MainWindow
from studio.ui.views.rail import PAGES
from studio.ui.views.settings_page import SettingsPage


class Page(QWidget):
    """A page with a field, a list, a button and an inspector."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.field, self.list, self.button = QLineEdit(self), QListWidget(self), QPushButton(f"Do {name}", self)
        self.field.setAccessibleName(f"Note of {name}")
        self.list.setAccessibleName(f"List of {name}")
        self.button.setAccessibleName(f"Do {name}")
        self.list.addItems(["one", "two"])
        column = QVBoxLayout(self)
        for part in (self.field, self.list, self.button):
            column.addWidget(part)
        self.inspector: QWidget | None = None
        if name == "capture":
            self.inspector = QLabel("selected")


class Shell:
    """The window and what it was made of."""

    def __init__(self, theme: Theme) -> None:
        self.theme = theme
        self.home = HomePage(theme)
        self.settings = SettingsPage(theme)
        self.diagnostics = DiagnosticsPage(theme)
        self.pages = {name: Page(name) for name in PAGES}
        pages = {**self.pages, "home": self.home, "settings": self.settings, "diagnostics": self.diagnostics}
        self.window = MainWindow(theme, pages)
        self.strip = self.window.strip
        self.window.keys.offer(key.action for key in TABLE)
        self.window.page_requested.connect(self.window.show_page)
        self.settings.show_keys(self.window.keys.offered, Preferences())
        self.settings.show_preferences(Preferences(), "/data/takes of a study with a long name/kinetag")
        self.diagnostics.show_rows([("Versions", ""), ("studio", "0.2.0"), ("Qt", "6.10.3")])
        takes = [Recovered(f"take-{n}", f"take {n}", "12 min 04 s · ended by a crash") for n in range(3)]
        self.home.show_recovered(takes)
        self.window.show_people(("P001", "P014"), "P014")
        self.window.show_session("24 Nov 2026 a")


@contextmanager
def shell(qtbot, scheme: Scheme = "dark", text_scale: float = 1.0) -> Iterator[Shell]:
    """Show the window at 1280×800; the application looks as before afterwards."""
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    theme = Theme()
    theme.scheme, theme.text_scale = scheme, text_scale
    before = application.palette(), QFont(application.font())
    dress(application, theme)
    shown = Shell(theme)
    qtbot.addWidget(shown.window)
    shown.window.resize(1280, 800)
    shown.window.show_page("capture")
    try:
        with qtbot.waitActive(shown.window):
            shown.window.show()
            shown.window.activateWindow()
        yield shown
    finally:
        shown.window.close_now()
        application.setStyleSheet("")
        application.setPalette(before[0])
        application.setFont(before[1])
