"""Where the samples come from: a receiver on a cable, the simulator, or a recorded take."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QButtonGroup,
    QComboBox,
    QHBoxLayout,
    QPushButton,
    QSizePolicy,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from studio.acquisition.driver import Found
from studio.ui.style_sheet import set_look
from studio.ui.theme import FORM_WIDTH, GAP, GRID, Theme

KINDS = ("serial", "synthetic", "replay")
"""In the order of the buttons; how their sources begin."""


class SourceChoice(QWidget):
    """One of three kinds, then which one, then a button."""

    chosen = Signal(str)
    """The words that open the source."""
    left = Signal()
    """Disconnect."""
    refresh_requested = Signal()
    """Look for receivers again."""
    folder_requested = Signal()
    """Choose a take somewhere else."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self.is_open = False
        """Whether the button disconnects."""
        self.kinds = QButtonGroup(self)
        self.ports, self.scripts, self.takes = QComboBox(self), QComboBox(self), QComboBox(self)
        self.refresh = QPushButton(self.tr("Look again"), self)
        self.folder = QPushButton(self.tr("Another folder…"), self)
        self.go = QPushButton(self)
        self._stack = QStackedWidget(self)
        self._build()
        self._connect()
        self.offer_ports(())
        self.offer_takes(())
        self.set_kind("serial")

    def offer_ports(self, ports: Sequence[Found]) -> None:
        """Offer these receivers."""
        rows = [(self.tr("{label}  ({port})").format(label=f.label, port=port_of(f.source)), f.source) for f in ports]
        self._fill(self.ports, rows, self.tr("No receiver found: plug it in"))

    def offer_takes(self, takes: Sequence[tuple[str, str]]) -> None:
        """Offer these takes: words and folder, newest first."""
        rows = [(words, f"replay:{folder}") for words, folder in takes]
        self._fill(self.takes, rows, self.tr("No take recorded yet"))

    def set_kind(self, kind: str) -> None:
        """Choose a kind of source: ``serial``, ``synthetic`` or ``replay``."""
        self.kinds.button(KINDS.index(kind)).setChecked(True)
        self._show_kind()

    def set_source(self, source: str) -> None:
        """Show the source that is open; one that is not offered is added to its list."""
        kind = source.partition(":")[0].partition("?")[0]
        if kind not in KINDS:
            return
        box = self._boxes()[KINDS.index(kind)]
        script = source.partition("?")[0]
        row = next((r for r in range(self.scripts.count()) if self._script_at(r) == script), -1)
        if kind == "synthetic" and row >= 0:
            self.scripts.setItemData(row, source)  # the same person, with the options that came with it
        if box.findData(source) < 0:
            box.insertItem(0, port_of(source), source)
            box.setEnabled(True)
        box.setCurrentIndex(box.findData(source))
        self.set_kind(kind)

    def show_open(self, *, is_open: bool) -> None:
        """Offer to disconnect instead of to connect."""
        self.is_open = is_open
        set_look(self.go, kind="" if is_open else "primary")
        for button in self.kinds.buttons():
            button.setEnabled(not is_open)
        self._stack.setEnabled(not is_open)
        self._show_button()

    def source(self) -> str:
        """Return the words of the chosen source; empty when there is none."""
        return str(self._boxes()[self.kinds.checkedId()].currentData() or "")

    def restyle(self) -> None:
        """Take over colours and text size."""
        self._stack.setMaximumWidth(round(FORM_WIDTH * max(self._theme.text_scale, 1.0)))

    def _script_at(self, row: int) -> str:
        return str(self.scripts.itemData(row)).partition("?")[0]

    def _boxes(self) -> tuple[QComboBox, QComboBox, QComboBox]:
        return self.ports, self.scripts, self.takes

    def _build(self) -> None:
        words = (self.tr("Receiver on a cable"), self.tr("Simulator"), self.tr("Replay a take"))
        kinds = QHBoxLayout()
        kinds.setSpacing(GRID)
        for number, said in enumerate(words):
            button = QPushButton(said, self)
            button.setCheckable(True)
            button.setProperty("kind", "segment")
            button.setAccessibleName(self.tr("Source: {kind}").format(kind=said))
            self.kinds.addButton(button, number)
            kinds.addWidget(button)
        kinds.addStretch(1)
        for script, said in self._scripts():
            self.scripts.addItem(said, f"synthetic:{script}")
        self.ports.setAccessibleName(self.tr("Receiver"))
        self.scripts.setAccessibleName(self.tr("What the simulated person does"))
        self.takes.setAccessibleName(self.tr("Take to replay"))
        self.refresh.setAccessibleName(self.tr("Look for receivers again"))
        self.folder.setAccessibleName(self.tr("Choose a take in another folder"))
        self._stack.addWidget(self._row(self.ports, self.refresh))
        self._stack.addWidget(self._row(self.scripts, None))
        self._stack.addWidget(self._row(self.takes, self.folder))
        self._stack.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        choice = QHBoxLayout()
        choice.setSpacing(GAP)
        choice.addWidget(self._stack, 1)
        choice.addWidget(self.go)
        choice.addStretch(0)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GAP)
        column.addLayout(kinds)
        column.addLayout(choice)
        self.go.setProperty("kind", "primary")
        self.restyle()

    def _row(self, box: QComboBox, button: QPushButton | None) -> QWidget:
        box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        box.setMinimumContentsLength(16)
        row = QWidget(self)
        line = QHBoxLayout(row)
        line.setContentsMargins(0, 0, 0, 0)
        line.setSpacing(GAP)
        line.addWidget(box, 1)
        if button is not None:
            line.addWidget(button)
        return row

    def _scripts(self) -> tuple[tuple[str, str], ...]:
        return (
            ("walk", self.tr("A person walks")),
            ("sit", self.tr("A person sits down and stands up")),
            ("reach", self.tr("A person reaches for something")),
            ("holds", self.tr("A person stands and bows, to practise calibrating")),
            ("n", self.tr("A person stands still")),
            ("rest", self.tr("Tags lie on a table")),
            ("turns", self.tr("Tags are turned by hand")),
        )

    def _connect(self) -> None:
        self.kinds.idToggled.connect(self._show_kind)
        for box in self._boxes():
            box.currentIndexChanged.connect(self._show_button)
        self.refresh.clicked.connect(self.refresh_requested)
        self.folder.clicked.connect(self.folder_requested)
        self.go.clicked.connect(self._tell)

    def _fill(self, box: QComboBox, rows: Sequence[tuple[str, str]], nothing: str) -> None:
        before = box.currentData()
        box.blockSignals(True)
        box.clear()
        for words, source in rows:
            box.addItem(words, source)
            box.setItemData(box.count() - 1, words, Qt.ItemDataRole.ToolTipRole)
        if not rows:
            box.addItem(nothing, "")
        box.setEnabled(bool(rows))
        box.setCurrentIndex(max(box.findData(before), 0))
        box.blockSignals(False)
        self._show_button()

    def _show_kind(self) -> None:
        self._stack.setCurrentIndex(self.kinds.checkedId())
        self._show_button()

    def _show_button(self) -> None:
        self.go.setText(self.tr("Disconnect") if self.is_open else self.tr("Connect"))
        self.go.setAccessibleName(self.go.text())
        possible = self.is_open or bool(self.kinds.checkedId() >= 0 and self.source())
        self.go.setEnabled(possible)
        self.go.setToolTip("" if possible else self._boxes()[max(self.kinds.checkedId(), 0)].currentText())

    def _tell(self) -> None:
        if self.is_open:
            self.left.emit()
            return
        self.chosen.emit(self.source())


def port_of(source: str) -> str:
    """Return what follows the kind of a source: a port, a folder."""
    return source.partition(":")[2] or source
