"""The window: header, rail, one page at a time with its inspector, and the strip that is always there."""

from collections.abc import Mapping

from PySide6.QtCore import QByteArray, Qt, Signal
from PySide6.QtGui import QCloseEvent, QColor, QPainter, QPaintEvent, QPen, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QStackedWidget, QVBoxLayout, QWidget

from studio.ui.keys import Keys
from studio.ui.models.readiness import ReadinessState, StripPhase, clock_seconds
from studio.ui.models.vocabulary import VocabularyName
from studio.ui.theme import Theme
from studio.ui.views.announcement import announce
from studio.ui.views.header import Header
from studio.ui.views.inspector import Inspector
from studio.ui.views.key_overlay import KeyOverlay
from studio.ui.views.notices import Action, Banner, Toast
from studio.ui.views.rail import PAGES, Rail
from studio.ui.views.readiness_strip import ReadinessStrip
from studio.ui.views.sheet import Sheet

FRAME = 4  # px around everything; painted while recording, kept free otherwise so that nothing moves
LEAST = (1024, 640)  # px

_CLOSE, _PERSON, _EXPORT = "close", "person", "export"


class MainWindow(QWidget):
    """Renders; what is wanted of the studio goes out as signals."""

    page_requested = Signal(str)
    record_requested = Signal()
    fix_requested = Signal(str)
    """Fix id of a problem in the strip."""
    key_pressed = Signal(str)
    """Action of a key, except those of pages, record and help, which have signals of their own or act here."""
    vocabulary_changed = Signal(str)
    person_chosen = Signal(str)
    person_created = Signal(str)
    """Code typed for somebody new."""
    notice_acted = Signal(str)
    """Action of a toast or banner."""
    close_requested = Signal()
    """The window is to be closed: answer with ``close_now`` or ``ask_before_close``."""
    close_confirmed = Signal()
    """Stop and save, then close."""
    export_end_confirmed = Signal()
    """Close although files are still being written."""
    close_refused = Signal()
    """Keep recording."""

    def __init__(self, theme: Theme, pages: Mapping[str, QWidget], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._pages = dict(pages)
        self._shown = ""
        self._state = ReadinessState()
        self._may_close = False
        self.header = Header(theme, self)
        self.rail = Rail(theme, self)
        self.banner = Banner(theme, self)
        self.stack = QStackedWidget(self)
        # Tab goes the way the window is read: the pages before the inspector and the strip.
        for page in self._pages.values():
            self.stack.addWidget(page)
        self.inspector = Inspector(theme, self)
        for page in self._pages.values():
            self.inspector.add_panel(getattr(page, "inspector", None))
        self.strip = ReadinessStrip(theme, self)
        self.toast = Toast(theme, self.stack)
        self.sheet = Sheet(theme, self)
        self.overlay = KeyOverlay(theme, self)
        self.keys = Keys(self)
        self._build()
        self._wire()
        self._show_title()

    @property
    def shown_page(self) -> str:
        """Name of the page that is shown."""
        return self._shown

    def show_page(self, name: str) -> None:
        """Show a page and its inspector."""
        page = self._pages[name]
        self._shown = name
        self.stack.setCurrentWidget(page)
        self.rail.show_page(name)
        self.inspector.show_panel(getattr(page, "inspector", None))
        self.toast.raise_()

    def show_state(self, state: ReadinessState) -> None:
        """Show how ready the studio is, in the strip, the frame and the title."""
        was = self._state
        self._state = state
        self.strip.show_state(state)
        if state.is_recording != was.is_recording:
            self.update()
        if state.phase is not was.phase:
            self._announce(state)
            if state.phase not in (StripPhase.RECORDING, StripPhase.COUNTDOWN) and self.sheet.question == _CLOSE:
                self.sheet.withdraw()
        self._show_title()

    def show_people(self, codes: tuple[str, ...], current: str) -> None:
        """Offer persons in the header."""
        self.header.show_people(codes, current)

    def show_session(self, name: str) -> None:
        """Show the session in the header."""
        self.header.show_session(name)

    def show_vocabulary(self, name: VocabularyName) -> None:
        """Use the words of the clinic or of the studio."""
        self.header.show_vocabulary(name)

    def show_safe_start(self) -> None:
        """Tell that the last source and take were left closed; the answer is ``notice_acted("open_last")``."""
        self.banner.put(
            "app.safe",
            self.tr("Started in safe mode."),
            self.tr("The last two starts did not end well. What was open then, may be the cause."),
            self.tr("The last source and the last take were left closed."),
            (Action("open_last", self.tr("Open them anyway")),),
        )

    def ask_before_close(self) -> None:
        """Ask, once, whether to stop the recording; it goes on meanwhile."""
        take = self._state.next_take or self.header.words.take
        self.sheet.ask(
            _CLOSE,
            self.tr("{take} is still being recorded.").format(take=take[:1].upper() + take[1:]),
            self.tr("Closing now stops it. What was recorded is saved and checked first."),
            self.tr("Stop and save"),
            self.tr("Keep recording"),
        )

    def ask_before_ending_export(self) -> None:
        """Ask, once, whether to end an export that is under way."""
        self.sheet.ask(
            _EXPORT,
            self.tr("Files are still being written."),
            self.tr("Closing now leaves out those that are not done. The takes are safe."),
            self.tr("Stop and close"),
            self.tr("Keep exporting"),
        )

    def close_now(self) -> None:
        """Close: nothing can be lost."""
        self._may_close = True
        self.close()

    def geometry_state(self) -> bytes:
        """Return place and size of the window, for the next start."""
        return bytes(self.saveGeometry().data())

    def restore_geometry_state(self, state: bytes) -> None:
        """Take place and size of the last time, when they still fit on a screen."""
        if not state or not self.restoreGeometry(QByteArray(state)):
            self.resize(1280, 800)

    def toggle_full_screen(self) -> None:
        """Fill the screen, or stop doing so."""
        self.setWindowState(self.windowState() ^ Qt.WindowState.WindowFullScreen)

    def show_keys(self) -> None:
        """Open or close the list of keys."""
        if self.overlay.isVisible():
            self.overlay.close_overlay()
        else:
            self.overlay.open_with(self.keys.offered, self.keys.in_force)

    def tick(self, now: float) -> None:
        """Let time pass."""
        self.toast.tick(now)

    def restyle(self) -> None:
        """Take over colours and text size, here and in every page that was handed in."""
        parts: list[QWidget] = [self.header, self.rail, self.banner, self.inspector, self.strip]
        for part in (*parts, *self._pages.values(), self.toast, self.sheet, self.overlay):
            restyle = getattr(part, "restyle", None)
            if restyle is not None:
                restyle()
        self.update()

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 (Qt's name)
        """Ask whether the window may close."""
        if self._may_close:
            event.accept()
            return
        self.close_requested.emit()
        # ``close_now`` may have been the answer: Qt does not begin a second close inside the first.
        event.setAccepted(self._may_close)

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 (Qt's name)
        """Keep what floats in its place."""
        super().resizeEvent(event)
        self.strip.problems.close_list()
        for floating in (self.toast, self.sheet, self.overlay):
            floating.place()

    def paintEvent(self, event: QPaintEvent) -> None:  # noqa: N802 (Qt's name)
        """Paint the frame that tells from across the room that a recording runs."""
        if not self._state.is_recording:
            return
        painter = QPainter(self)
        painter.setPen(QPen(QColor(self._theme.tokens.rec), 2 * FRAME))
        painter.drawRect(self.rect())
        painter.end()

    def _build(self) -> None:
        self.setMinimumSize(*LEAST)
        self.resize(1280, 800)
        middle = QVBoxLayout()
        middle.setSpacing(0)
        middle.addWidget(self.banner)
        middle.addWidget(self.stack, 1)
        row = QHBoxLayout()
        row.setSpacing(0)
        row.addWidget(self.rail)
        row.addLayout(middle, 1)
        row.addWidget(self.inspector)
        column = QVBoxLayout(self)
        column.setContentsMargins(FRAME, FRAME, FRAME, FRAME)
        column.setSpacing(0)
        column.addWidget(self.header)
        column.addLayout(row, 1)
        column.addWidget(self.strip)
        self.toast.keep_clear_of(self.strip.record)

    def _wire(self) -> None:
        self.rail.page_requested.connect(self.page_requested)
        self.header.page_requested.connect(self.page_requested)
        self.header.help_requested.connect(self.show_keys)
        self.header.full_screen_requested.connect(self.toggle_full_screen)
        self.header.vocabulary_changed.connect(self.vocabulary_changed)
        self.header.person_chosen.connect(self.person_chosen)
        self.header.person_wanted.connect(self._on_person_wanted)
        self.overlay.settings_requested.connect(self._on_settings_wanted)
        self.strip.record_requested.connect(self.record_requested)
        self.strip.fix_requested.connect(self.fix_requested)
        self.toast.acted.connect(self.notice_acted)
        self.banner.acted.connect(self.notice_acted)
        self.sheet.accepted.connect(self._on_answered)
        self.sheet.refused.connect(self._on_refused)
        self.keys.triggered.connect(self._on_key)
        self.setFocus()  # else the first control of the header wears the focus ring at each start
        self.keys.offer((*PAGES, "record", "cancel", "help", "full_screen"))

    def _show_title(self) -> None:
        state = self._state
        name = self.tr("Kinetag Studio")
        if state.is_recording:
            name = f"● {clock_seconds(state.elapsed)} {state.next_take}".rstrip()
        if name != self.windowTitle():
            self.setWindowTitle(name)

    def _announce(self, state: ReadinessState) -> None:
        words = {
            StripPhase.RECORDING: self.tr("Recording"),
            StripPhase.SAVING: self.tr("Saving"),
            StripPhase.SAVED: self.tr("Saved and verified"),
            StripPhase.PROBLEM: self.tr("Problem"),
        }
        if state.phase in words:
            announce(self.strip, words[state.phase])

    def _on_key(self, action: str) -> None:
        if self.overlay.isVisible() and action not in ("help", "cancel"):
            self.overlay.close_overlay()  # who reads the list tries a key: it acts on what is seen then
        elif action in PAGES:
            self.page_requested.emit(action)
        elif action == "record":
            self.record_requested.emit()
        elif action == "help":
            self.show_keys()
        elif action == "full_screen":
            self.toggle_full_screen()
        elif action == "cancel" and self._close_floating():
            return
        else:
            self.key_pressed.emit(action)

    def _close_floating(self) -> bool:
        """Esc closes what lies on top first."""
        if self.overlay.isVisible():
            self.overlay.close_overlay()
        elif self.sheet.question:
            self.sheet.refuse()
        elif self.strip.problems.isVisible():
            self.strip.problems.close_list()
        elif self.isFullScreen():
            self.toggle_full_screen()
        else:
            return False
        return True

    def _on_person_wanted(self) -> None:
        words = self.header.words
        self.sheet.ask(
            _PERSON,
            words.new_person.rstrip("…"),
            self.tr("A code of up to 16 letters and digits, such as P014. Names stay out of the recordings."),
            self.tr("Add"),
            self.tr("Cancel"),
            line=self.tr("Code"),
        )

    def _on_answered(self, question: str, line: str) -> None:
        if question == _CLOSE:
            self.close_confirmed.emit()
        elif question == _EXPORT:
            self.export_end_confirmed.emit()
        else:
            self.person_created.emit(line)

    def _on_refused(self, question: str) -> None:
        if question == _CLOSE:
            self.close_refused.emit()

    def _on_settings_wanted(self) -> None:
        self.page_requested.emit("settings")
