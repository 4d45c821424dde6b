"""The whole studio in a window, with folders of its own, for tests and for photographs."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEvent
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QApplication

from studio.ui.settings import Settings
from studio.ui.studio_window import StudioWindow
from studio.ui.style_sheet import dress
from studio.ui.theme import Theme

WALKS = "synthetic:walk?calibrated=1&ahead=9"


@contextmanager
def running_studio(folder: Path, source: str = WALKS, **preferences: object) -> Iterator[StudioWindow]:
    """Start the studio at 1280×800; the application looks as before afterwards."""
    application = QApplication.instance()
    assert isinstance(application, QApplication)
    before = application.palette(), QFont(application.font())
    settings = Settings(folder / "settings.ini")
    defaults = {"library": str(folder / "takes"), "export_folder": str(folder / "exports"), "sound": False}
    for name, value in {**defaults, **preferences}.items():
        settings.set(name, value)
    theme = Theme()
    values = settings.values
    theme.scheme, theme.text_scale, theme.reduced_motion = values.scheme, values.text_scale, values.reduced_motion
    dress(application, theme)
    studio = StudioWindow(application, theme, settings)
    try:
        studio.start(source)
        studio.window.resize(1280, 800)
        yield studio
    finally:
        studio.shut_down()
        studio.window.close_now()
        # Qt's side goes first and now: else a later garbage collection takes it apart in an order of its own.
        for part in (studio.window, studio):
            part.deleteLater()
        QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        application.setStyleSheet("")
        application.setPalette(before[0])
        application.setFont(before[1])
