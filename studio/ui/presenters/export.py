"""Export: one file after the other is written by the worker, read back, and told."""

import contextlib
from collections.abc import Sequence
from pathlib import Path

import platformdirs
from PySide6.QtCore import QObject, Signal

from studio.capture.jobs import ExportRequest, SolveRequest, run_export
from studio.core.errors import StudioError, WorkerLost
from studio.storage.take_summary import TakeSummary
from studio.ui.models.export_choice import ExportChoice, ExportValues, Item
from studio.ui.models.studio_model import StudioModel
from studio.ui.models.vocabulary import vocabulary
from studio.ui.operation import Operation
from studio.ui.presenters.folders import choose_folder, show_folder
from studio.ui.settings import Settings
from studio.ui.views.export_page import ExportPage


def export_folder() -> Path:
    """Return where exported files go when nobody chose."""
    return Path(platformdirs.user_documents_dir()) / "Kinetag exports"


def _made(folders: Sequence[Path]) -> None:
    """Make folders that are not there; one that cannot be made is told when its file cannot be written."""
    for folder in dict.fromkeys(folders):
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)


class ExportPresenter(QObject):
    """Works through an order; the first file that cannot be written ends it."""

    takes_wanted = Signal()
    """Go where takes are chosen."""

    def __init__(self, model: StudioModel, choice: ExportChoice, page: ExportPage, settings: Settings) -> None:
        super().__init__(page)
        self._model, self._choice, self._page, self._settings = model, choice, page, settings
        self._order: ExportValues | None = None
        self._left: list[Item] = []
        self._written: list[Path] = []
        self._notes: dict[str, None] = {}
        values = settings.values
        choice.set_folder(Path(values.export_folder) if values.export_folder else export_folder())
        choice.use(values.last_preset or vocabulary(values.vocabulary).preset)
        page.export_requested.connect(self.start)
        page.folder_requested.connect(self._on_folder)
        page.takes_requested.connect(self.takes_wanted)
        page.show_requested.connect(self._on_show)
        settings.changed.connect(self._on_setting)

    @property
    def is_running(self) -> bool:
        """Whether a file is being written."""
        return self._order is not None

    def choose(self, takes: Sequence[TakeSummary]) -> None:
        """Export these takes next."""
        if not self.is_running:
            self._choice.set_takes(takes)

    def again(self, takes: Sequence[TakeSummary]) -> None:
        """Export these takes as the last ones were."""
        if takes and not self.is_running:
            self._choice.set_takes(takes)
            self.start(self._choice.values())

    def start(self, order: ExportValues) -> None:
        """Write all files of an order."""
        if self.is_running or not order.items:
            return
        self._settings.set("last_preset", self._choice.preset)
        self._order, self._left, self._written, self._notes = order, [*order.items], [], {}
        self._show_progress("read", 0.0)
        self._model.work(lambda: _made([item.target.parent for item in order.items]), self._on_made)

    def _on_made(self, _: object) -> None:
        self._next()

    def _next(self) -> None:
        order = self._order
        assert order is not None
        if not self._left:
            self._order = None
            self._page.show_done(self._written, tuple(self._notes))
            return
        item = self._left.pop(0)
        self._show_progress("read", 0.0)
        request = ExportRequest(SolveRequest(item.take), order.exporter, order.wish, item.target, item.replace)
        operation = Operation(self)
        operation.progressed.connect(self._show_progress)
        operation.done.connect(self._on_written)
        operation.refused.connect(self._on_refused)
        operation.failed.connect(self._on_failed)
        worker = self._model.worker
        self._model.run(operation, lambda tell: worker.submit(run_export, request, tell))

    def _show_progress(self, stage: str, share: float) -> None:
        if self._order is not None:
            total = len(self._order.items)
            self._page.show_progress(stage, share, total - len(self._left), total)

    def _on_written(self, written: tuple[Path, Sequence[str]]) -> None:
        file, notes = written
        self._written.append(file)
        self._notes.update(dict.fromkeys(notes))
        self._next()

    def _on_failed(self) -> None:
        self._on_refused(WorkerLost())

    def _on_refused(self, error: StudioError) -> None:
        self._order = None
        self._page.show_refusal(error)

    def _on_folder(self) -> None:
        folder = choose_folder(self._page, self.tr("Folder for exported files"), self._choice.folder)
        if folder is not None:
            self._choice.set_folder(folder)
            self._settings.set("export_folder", str(folder))

    def _on_show(self, file: Path) -> None:
        show_folder(file.parent)

    def _on_setting(self, name: str) -> None:
        if name == "vocabulary" and not self._settings.values.last_preset:
            self._choice.use(vocabulary(self._settings.values.vocabulary).preset)
