"""What has to be told, brought to the toast and the banner of the window."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import QObject

from studio.core.errors import StudioError
from studio.ui.views.main_window import MainWindow
from studio.ui.views.notices import Action, Tone
from studio.ui.wording import sentences


class Notices(QObject):
    """Shows messages; what their buttons do is said with each."""

    def __init__(self, window: MainWindow) -> None:
        super().__init__(window)
        self._window = window
        self._acts: dict[str, Callable[[], None]] = {}
        window.notice_acted.connect(self._on_acted)

    def refuse(self, error: StudioError) -> None:
        """Show why something that was asked for cannot be: what, why, what to do."""
        message = sentences(error)
        self._window.banner.put(message.id, message.what, message.why, message.do, tone="bad")

    def warn(
        self, message: str, what: str, why: str, do: str, acts: Sequence[tuple[Action, Callable[[], None]]] = ()
    ) -> None:
        """Show a message that stays, with at most two actions."""
        self._keep(acts)
        self._window.banner.put(message, what, why, do, [action for action, _ in acts])

    def withdraw(self, message: str) -> None:
        """What a message told is over."""
        self._window.banner.take_away(message)

    def say(self, text: str, acts: Sequence[tuple[Action, Callable[[], None]]] = (), tone: Tone = "good") -> None:
        """Show a short notice that leaves by itself."""
        self._keep(acts)
        self._window.toast.say(text, [action for action, _ in acts], tone)

    def _keep(self, acts: Sequence[tuple[Action, Callable[[], None]]]) -> None:
        for action, act in acts:
            self._acts[action.id] = act

    def _on_acted(self, action: str) -> None:
        act = self._acts.get(action)
        if act is not None:
            act()
