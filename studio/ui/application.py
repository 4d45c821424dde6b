"""Start of the window: one application, one studio, and what happens when either breaks."""

import sys
import threading
import traceback
from pathlib import Path
from queue import SimpleQueue
from types import TracebackType

import platformdirs
from PySide6.QtWidgets import QApplication

import studio
from studio.storage.crash_report import crash_folder, write_crash_report
from studio.ui.garbage import GarbageCollector
from studio.ui.presenters.folders import show_folder
from studio.ui.settings import Settings, settings_file
from studio.ui.start_guard import StartGuard
from studio.ui.studio_window import FIRST_SOURCE, StudioWindow
from studio.ui.style_sheet import dress
from studio.ui.theme import Theme
from studio.ui.views.crash_dialog import CrashDialog

MOST_REPORTS = 3  # dialogs of one run: a mistake in every tick must not fill the screen


def run(source: str = "") -> int:
    """Open the window, optionally with a source, and return the exit code when it was closed."""
    application = QApplication.instance() or QApplication(sys.argv[:1])
    assert isinstance(application, QApplication)
    application.setApplicationName("kinetag-studio")
    application.setApplicationDisplayName("Kinetag Studio")
    application.setApplicationVersion(studio.__version__)
    settings = Settings(settings_file())
    theme = Theme()
    values = settings.values
    theme.scheme, theme.text_scale, theme.reduced_motion = values.scheme, values.text_scale, values.reduced_motion
    dress(application, theme)
    guard = StartGuard(Path(platformdirs.user_state_dir("kinetag-studio", appauthor=False)))
    guard.begin()
    window = StudioWindow(application, theme, settings)
    reporter = CrashReporter(window, theme)
    reporter.install()
    window.tick.ticked.connect(reporter.tick)
    window.start(source or _first_source(settings, guard, window))
    garbage = GarbageCollector()
    window.tick.ticked.connect(garbage.tick)
    garbage.begin()
    try:
        code = application.exec()
        window.shut_down()
    finally:
        garbage.end()
        reporter.remove()
    guard.end()
    return code


def _first_source(settings: Settings, guard: StartGuard, window: StudioWindow) -> str:
    """Return what to open at the start; receivers are never opened unasked, and nothing after two crashes."""
    last = settings.values.last_source
    if guard.offers_safe_start:
        window.offer_last(last or FIRST_SOURCE)
        return ""
    return last if last.startswith("synthetic") else FIRST_SOURCE


class CrashReporter:
    """Our own mistakes end here: a report on this computer, and a dialog beside the window."""

    def __init__(self, window: StudioWindow, theme: Theme) -> None:
        self._window = window
        self._theme = theme
        self._told = 0
        self._waiting: SimpleQueue[BaseException] = SimpleQueue()
        self._before = sys.excepthook, threading.excepthook

    def install(self) -> None:
        """Take over what nobody caught."""
        sys.excepthook = self._on_mistake
        threading.excepthook = self._on_thread

    def remove(self) -> None:
        """Give it back."""
        sys.excepthook, threading.excepthook = self._before

    def _on_mistake(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            QApplication.quit()
            return
        sys.stderr.write("".join(traceback.format_exception(kind, error, trace)))
        self._told += 1
        if self._told > MOST_REPORTS:
            return
        try:
            file = write_crash_report(error, crash_folder())
        except OSError:
            return
        dialog = CrashDialog(self._theme, str(file), file.read_text(encoding="utf-8"), self._window.window)
        dialog.folder_requested.connect(_show_reports)
        dialog.show()

    def _on_thread(self, told: threading.ExceptHookArgs) -> None:
        if told.exc_value is not None:
            self._waiting.put(told.exc_value)

    def tick(self, now: float) -> None:
        """Tell what broke on another thread: a dialog belongs to the Qt thread."""
        while not self._waiting.empty():
            error = self._waiting.get()
            self._on_mistake(type(error), error, error.__traceback__)


def _show_reports() -> None:
    show_folder(crash_folder())
