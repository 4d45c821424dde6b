"""The line at the top: who, which session, clinic or studio, help and menu."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import QFrame, QHBoxLayout, QMenu, QSizePolicy, QToolButton, QWidget

from studio.ui.icons import SIZE, icon
from studio.ui.models.vocabulary import Vocabulary, VocabularyName, vocabulary
from studio.ui.theme import GAP, GAP_WIDE, GRID, Theme
from studio.ui.views.elided import ElidedLabel
from studio.ui.views.segments import Segments


class Header(QFrame):
    """Says what was chosen; changes nothing by itself."""

    person_chosen = Signal(str)
    person_wanted = Signal()
    """Somebody new."""
    vocabulary_changed = Signal(str)
    help_requested = Signal()
    page_requested = Signal(str)
    full_screen_requested = Signal()

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._person = ""
        self._people: tuple[str, ...] = ()
        self.words: Vocabulary = vocabulary("clinic")
        self.person = QToolButton(self)
        self.session = ElidedLabel(self)
        words = {"clinic": self.tr("Clinic"), "studio": self.tr("Studio")}
        self.switch = Segments(words, self.tr("Words for: {word}"), self)
        self.help = QToolButton(self)
        self.menu_button = QToolButton(self)
        self.menu = QMenu(self)
        self._people_menu = QMenu(self)
        self._build()
        self.show_people((), "")
        self.restyle()

    def show_people(self, codes: Sequence[str], current: str) -> None:
        """Offer these persons; ``current`` is the one being captured, empty for nobody."""
        self._people, self._person = tuple(codes), current
        self._people_menu.clear()
        for code in self._people:
            action = self._people_menu.addAction(code)
            action.setCheckable(True)
            action.setChecked(code == current)
            action.setData(code)
        if self._people:
            self._people_menu.addSeparator()
        self._people_menu.addAction(self.words.new_person)
        none = self.tr("none")
        said = f"{self.words.person}: {current or none}"
        self.person.setText(f"{said}  ▾")
        self.person.setAccessibleName(said)

    def show_session(self, name: str) -> None:
        """Show the session's name."""
        self.session.set_words(self.tr("{word}: {name}").format(word=self.words.session, name=name) if name else "")

    def show_vocabulary(self, name: VocabularyName) -> None:
        """Use the words of the clinic or of the studio."""
        self.words = vocabulary(name)
        self.switch.choose(name)
        self.show_people(self._people, self._person)

    def restyle(self) -> None:
        """Take over colours and text size."""
        tokens = self._theme.tokens
        size = round(SIZE * max(self._theme.text_scale, 1.0))
        for button, name in ((self.person, "person"), (self.help, "help"), (self.menu_button, "menu")):
            button.setIconSize(QSize(size, size))
            button.setIcon(icon(name, tokens.muted, size))
        for action in self.menu.actions():
            if action.data():
                action.setIcon(icon(action.data(), tokens.muted))

    def _build(self) -> None:
        self.setProperty("ground", "panel")
        self.setAccessibleName(self.tr("Header"))
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        self.person.setProperty("kind", "quiet")
        self.person.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.person.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.person.setMenu(self._people_menu)
        self.session.setProperty("role", "muted")
        self.switch.choose("clinic")
        self.switch.setToolTip(self.tr("Changes words, names of takes and what is exported first"))
        for button, words in ((self.help, self.tr("Keys and help")), (self.menu_button, self.tr("Menu"))):
            button.setProperty("kind", "quiet")
            button.setAccessibleName(words)
            button.setToolTip(words)
        self.menu_button.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.menu_button.setMenu(self.menu)
        self._build_menu()
        for button in (self.person, self.help, self.menu_button):
            button.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        row = QHBoxLayout(self)
        row.setContentsMargins(GAP, GRID, GAP, GRID)
        row.setSpacing(GAP)
        row.addWidget(self.person)
        row.addWidget(self.session, 1)
        row.addWidget(self.switch)
        row.addSpacing(GAP_WIDE)
        row.addWidget(self.help)
        row.addWidget(self.menu_button)
        self._people_menu.triggered.connect(self._on_person)
        self.menu.triggered.connect(self._on_menu)
        self.help.clicked.connect(self.help_requested)
        self.switch.chosen.connect(self.vocabulary_changed)

    def _build_menu(self) -> None:
        pages = (
            ("home", self.tr("Home")),
            ("settings", self.tr("Settings")),
            ("diagnostics", self.tr("Diagnostics")),
            ("help", self.tr("Keys")),
        )
        for name, words in pages:
            self.menu.addAction(words).setData(name)
        self.menu.addSeparator()
        self._full_screen = self.menu.addAction(self.tr("Full screen"))

    def _on_person(self, action: object) -> None:
        code = action.data()  # type: ignore[attr-defined]
        self.show_people(self._people, self._person)
        if code is None:
            self.person_wanted.emit()
        else:
            self.person_chosen.emit(code)

    def _on_menu(self, action: object) -> None:
        name = action.data()  # type: ignore[attr-defined]
        if name == "help":
            self.help_requested.emit()
        elif name:
            self.page_requested.emit(name)
        elif action is self._full_screen:
            self.full_screen_requested.emit()
