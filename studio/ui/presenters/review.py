"""Review: the library is listed, a take is computed by the worker and looked at, and what people say of it is kept."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Signal

from studio.capture.jobs import SolveRequest
from studio.capture.review_job import Solved, run_review
from studio.core.body import Place
from studio.core.errors import Damaged, StudioError, WorkerLost
from studio.storage.motion_file import load_motion
from studio.storage.take_json import Verdict
from studio.storage.take_summary import TakeSummary, keep_summary, summaries, summarise
from studio.ui.models.pose_source import MotionSource
from studio.ui.models.studio_model import StudioModel
from studio.ui.models.take_review import TakeReview, review_take
from studio.ui.operation import Operation
from studio.ui.presenters.notices import Notices
from studio.ui.settings import Settings
from studio.ui.views.review_page import ReviewPage

Change = Callable[[TakeSummary], TakeSummary]


class ReviewPresenter(QObject):
    """One take at a time; answers about another one than was asked for last count for nothing."""

    library_read = Signal(object)
    """All TakeSummary of the library, newest first."""
    export_wanted = Signal(object)
    """TakeSummary, a tuple."""

    def __init__(
        self, model: StudioModel, page: ReviewPage, words: Mapping[Place, str], settings: Settings, notices: Notices
    ) -> None:
        super().__init__(page)
        self._model, self._page, self._words = model, page, words
        self._settings, self._notices = settings, notices
        self._wanted = Path()
        self.is_current = False
        """Whether the list shows the library as it was read last."""
        page.take_chosen.connect(self.open_take)
        page.solve_requested.connect(self.open_take)
        page.export_requested.connect(self._on_export)
        page.chosen_angles_changed.connect(self._on_angles)
        page.rename_requested.connect(self._on_rename)
        page.verdict_requested.connect(self.judge)
        page.note_requested.connect(self._on_note)

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys this page has functions for."""
        return self._page.key_actions()

    def act(self, action: str) -> bool:
        """Do what a key asks for."""
        return self._page.act(action)

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass."""
        if shown:
            self._page.tick(now)

    def read_library(self) -> None:
        """List the takes of the library anew."""
        library = self._model.library
        self._page.takes.set_loading(True)
        self._model.work(lambda: summaries(library), self._on_library, self._on_library_refused)

    def open_newest(self) -> None:
        """Look at the newest take, when none is looked at."""
        takes = [take for take in self._page.takes.model.newest() if take.refusal is None]
        if takes and self._wanted == Path():
            self.open_take(takes[0].folder)

    def put(self, summary: TakeSummary) -> None:
        """A take is new in the library, or something is said of it."""
        self._page.takes.model.put(summary)

    def open_take(self, folder: Path) -> None:
        """Look at a take."""
        self._wanted = folder
        summary = self._page.takes.model.summary(folder)
        if summary is not None and summary.refusal is not None:
            self._page.show_refusal(folder, summary.refusal)
            return
        self._page.show_loading(folder, "read", 0.0)
        operation = Operation(self)
        operation.progressed.connect(partial(self._on_progress, folder))
        operation.done.connect(self._on_solved)
        operation.refused.connect(partial(self._on_refused, folder))
        operation.failed.connect(partial(self._on_refused, folder, WorkerLost()))
        worker = self._model.worker
        self._model.run(operation, lambda tell: worker.submit(run_review, SolveRequest(folder), tell))

    def judge(self, folder: Path, verdict: Verdict) -> None:
        """Keep what the operator thinks of a take."""
        self._keep(folder, lambda known: replace(known, verdict=verdict))

    def _on_progress(self, folder: Path, stage: str, share: float) -> None:
        if folder == self._wanted:
            self._page.show_loading(folder, stage, share)

    def _on_solved(self, solved: Solved) -> None:
        if solved.folder == self._wanted:
            self._model.work(lambda: _reviewed(solved), self._on_review, partial(self._on_refused, solved.folder))

    def _on_review(self, review: TakeReview) -> None:
        if review.summary.folder != self._wanted:
            return
        self.put(review.summary)
        self._page.show_take(review, MotionSource(review.motion, self._words), self._settings.values.angles)

    def _on_refused(self, folder: Path, error: StudioError) -> None:
        if folder == self._wanted:
            self._page.show_refusal(folder, error)
            self.is_current = False  # it may be gone, and others with it

    def _on_library(self, takes: Sequence[TakeSummary]) -> None:
        self._page.takes.set_loading(False)
        self._page.takes.model.set_takes(takes)
        self.is_current = True
        self.library_read.emit(tuple(takes))
        if self._page.isVisible():
            self.open_newest()

    def _on_library_refused(self, error: StudioError) -> None:
        self._page.takes.set_loading(False)
        self._notices.refuse(error)

    def _on_export(self, folders: Sequence[Path]) -> None:
        known = [self._page.takes.model.summary(folder) for folder in folders]
        self.export_wanted.emit(tuple(summary for summary in known if summary is not None))

    def _on_angles(self, names: tuple[str, ...]) -> None:
        self._settings.set("angles", names)

    def _on_rename(self, folder: Path, name: str) -> None:
        self._keep(folder, lambda known: replace(known, name=name.strip() or known.name))

    def _on_note(self, folder: Path, text: str) -> None:
        self._keep(folder, lambda known: replace(known, notes=text))

    def _keep(self, folder: Path, change: Change) -> None:
        def kept() -> TakeSummary:
            changed = change(summarise(folder))
            keep_summary(changed)
            return changed

        self._model.work(kept, self.put, self._notices.refuse)


def _reviewed(solved: Solved) -> TakeReview:
    motion = load_motion(solved.folder, solved.key) if solved.motion is None else solved.motion
    if motion is None:  # somebody removed it meanwhile
        raise Damaged(str(solved.folder), 0.0)
    return review_take(summarise(solved.folder), solved.marks, motion)
