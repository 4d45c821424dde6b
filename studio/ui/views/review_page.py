"""Review: the library, the figure with its plots, the numbers, and the line that plays."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QStackedWidget, QVBoxLayout, QWidget

from studio.core.errors import AlignmentError, StudioError
from studio.ui.models.live_angles import MOST_SHOWN
from studio.ui.models.playhead import LONG_STEP, Playhead, clock
from studio.ui.models.pose_source import PoseSource
from studio.ui.models.take_review import TakeReview, in_words, side_of
from studio.ui.theme import GAP, GAP_WIDE, Theme
from studio.ui.views.measures_panel import MeasuresPanel
from studio.ui.views.plots.angle_plot import AngleCurve, AnglePlot
from studio.ui.views.stage.stage import Stage
from studio.ui.views.state_panel import StatePanel
from studio.ui.views.take_list import TakeList
from studio.ui.views.timeline import Timeline
from studio.ui.views.transport import Transport
from studio.ui.wording import sentences

LIST_WIDTH, MEASURES_WIDTH = 248, 248  # px at 100 % text
WIDEST_TEXT = 1.3  # of the text scale up to which the side columns grow; beyond, the figure would vanish
PAGE_SECONDS = 20.0  # s of the plot; longer takes turn pages


class ReviewPage(QWidget):
    """Shows the library and one take of it; the playhead is worked here, all else is a wish."""

    take_chosen = Signal(object)
    """Folder."""
    solve_requested = Signal(object)
    """Folder of a take to be computed once more."""
    export_requested = Signal(object)
    """Folders, a tuple."""
    chosen_angles_changed = Signal(object)
    """Names, a tuple of at most four."""
    rename_requested = Signal(object, str)
    verdict_requested = Signal(object, str)
    """Folder, and ``star``, ``bad`` or ``none``."""
    note_requested = Signal(object, str)
    """Folder and text."""

    def __init__(self, theme: Theme, playhead: Playhead, plot: AnglePlot, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._review: TakeReview | None = None
        self._source: PoseSource | None = None
        self._stage: Stage | None = None
        self._chosen: tuple[str, ...] = ()
        self._open: Path | None = None
        self.playhead = playhead
        self.plot = plot
        self.takes = TakeList(theme, self)
        self.measures = MeasuresPanel(theme, self)
        self.timeline = Timeline(theme, playhead, self)
        self.transport = Transport(theme, playhead, self)
        self.state = StatePanel(theme, self)
        self._pages = QStackedWidget(self)
        self._stage_place = QVBoxLayout()
        self._build()
        self._wire()
        self.restyle()
        self.show_nothing()

    def set_stage(self, stage: Stage) -> None:
        """Take the figure over; it is one for the whole window."""
        self._stage = stage
        self._stage_place.addWidget(stage)
        stage.show()
        self._dress_stage()

    def show_nothing(self) -> None:
        """No take is looked at."""
        self._forget()
        if self.takes.model.total:
            self.state.show_words(
                self.tr("Choose a take on the left."), self.tr("It is computed anew and played here.")
            )
        else:
            self.state.show_words(
                self.tr("Nothing has been recorded yet."),
                self.tr("Takes are kept in the library and can be looked at here as often as you like."),
                self.tr("Go to Capture and press R."),
            )

    def show_loading(self, folder: Path, stage: str, share: float) -> None:
        """A take is being read or computed: ``stage`` as the worker calls it, ``share`` of it done, 0…1."""
        if folder != self._open or self._review is not None:
            self._forget()
            self._open = folder
            self.takes.choose(folder)
        words = self.tr("Reading the take…") if stage == "read" else self.tr("Computing the motion…")
        self.state.show_progress(words, share)

    def show_refusal(self, folder: Path, error: StudioError) -> None:
        """A take cannot be shown; where the setup is the reason, it may have changed since."""
        self._forget()
        self._open = folder
        self.takes.choose(folder)
        self.state.show_refusal(sentences(error), self.tr("Try again") if isinstance(error, AlignmentError) else "")

    def show_take(self, review: TakeReview, source: PoseSource, chosen: Sequence[str] = ()) -> None:
        """Show a take; ``chosen`` are the angles somebody chose before."""
        same = self._open == review.summary.folder and self._review is not None
        time = self.playhead.time
        self._review, self._source, self._open = review, source, review.summary.folder
        known = tuple(name for name in chosen if name in review.degrees)[:MOST_SHOWN]
        self._chosen = known or review.first_choice()
        self.takes.choose(review.summary.folder)
        self.playhead.open(review.duration, review.motion.frame_s)
        pressed = next((mark.time for mark in review.marks if mark.kind == "record"), 0.0)
        if not same and 0.0 < pressed < review.duration:  # what came before R is there, and not what was asked for
            self.playhead.seek(pressed)
            self.playhead.range_starts_here()
        if same:
            self.playhead.seek(time)
        self.measures.show_take(review, self._chosen)
        self._pages.setCurrentIndex(1)
        self._set_playable(on=True)
        self._show_angles()
        self._dress_stage()

    def key_actions(self) -> tuple[str, ...]:
        """Return the keys this page has functions for (see ``ui.keys``)."""
        return tuple(self._acts)

    def act(self, action: str) -> bool:
        """Do what a key asks for; return whether it is done here (see ``ui.keys``)."""
        done = self._acts.get(action)
        needs_take = action not in ("star", "bad", "rename")
        if done is None or (needs_take and self._review is None):
            return False
        done()
        return True

    def tick(self, now: float) -> None:
        """Let time pass, s."""
        self.playhead.tick(now)
        if self._stage is not None:
            self._stage.tick(now)

    def restyle(self) -> None:
        """Take over colours and text sizes."""
        scale = min(max(self._theme.text_scale, 1.0), WIDEST_TEXT)
        self.takes.setFixedWidth(round(LIST_WIDTH * scale))
        self.measures.setFixedWidth(round(MEASURES_WIDTH * scale))
        for part in (self.takes, self.measures, self.timeline, self.transport, self.state, self.plot):
            part.restyle()
        if self._stage is not None:
            self._stage.restyle()

    def _build(self) -> None:
        self.plot.setParent(self)
        self._stage_place.setContentsMargins(0, 0, 0, 0)
        seen = QVBoxLayout()
        seen.setSpacing(GAP)
        seen.addLayout(self._stage_place, 3)
        seen.addWidget(self.plot, 1)
        above = QHBoxLayout()
        above.setSpacing(GAP_WIDE)
        above.addLayout(seen, 1)
        above.addWidget(self.measures)
        take = QWidget(self)
        column = QVBoxLayout(take)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(GAP)
        column.addLayout(above, 1)
        column.addWidget(self.timeline)
        column.addWidget(self.transport)
        self._pages.addWidget(self.state)
        self._pages.addWidget(take)
        page = QHBoxLayout(self)
        page.setContentsMargins(GAP_WIDE, GAP_WIDE, GAP_WIDE, GAP_WIDE)
        page.setSpacing(GAP_WIDE)
        page.addWidget(self.takes)
        page.addWidget(self._pages, 1)

    def _wire(self) -> None:
        head = self.playhead
        self.takes.take_chosen.connect(self.take_chosen)
        self.takes.rename_requested.connect(self.rename_requested)
        self.takes.verdict_requested.connect(self.verdict_requested)
        self.takes.model.modelReset.connect(self._on_library)
        self.state.acted.connect(self._on_again)
        self.timeline.scrubbed.connect(head.seek)
        self.plot.time_picked.connect(head.seek)
        head.moved.connect(self._on_moved)
        head.changed.connect(self._on_range)
        self.measures.angles_chosen.connect(self._on_angles)
        self.measures.note_changed.connect(self._on_note)
        self.measures.export_requested.connect(self._on_export)
        self._acts = {
            "go": head.toggle,
            "frame_back": self._frame_back,
            "frame_forward": self._frame_forward,
            "frames_back": self._frames_back,
            "frames_forward": self._frames_forward,
            "to_start": head.home,
            "to_end": head.to_end,
            "loop": self._toggle_loop,
            "slower": head.slower,
            "faster": head.faster,
            "trim_in": head.range_starts_here,
            "trim_out": head.range_ends_here,
            "star": self.takes.toggle_star,
            "bad": self.takes.toggle_bad,
            "note": self.measures.note.setFocus,
            "rename": self.takes.begin_rename,
        }

    def _forget(self) -> None:
        self.measures.keep_note()
        self.playhead.pause()
        self._review, self._source, self._open = None, None, None
        self._pages.setCurrentIndex(0)
        self._set_playable(on=False)
        self.timeline.show_take(None, "")

    def _set_playable(self, *, on: bool) -> None:
        for part in (self.transport, self.measures):
            part.setEnabled(on)

    def _dress_stage(self) -> None:
        """Give the figure the lengths and the path of this take."""
        if self._stage is None or self._source is None:
            return
        self._stage.set_skeleton(self._source.skeleton)
        self._stage.set_path(self._source.window(0.0, self.playhead.duration))
        self._stage.show_pose(self._source.pose_at(self.playhead.time))

    def _show_angles(self) -> None:
        review = self._review
        if review is None:
            return
        time = review.motion.time
        curves = [AngleCurve(in_words(n), side_of(n), time, review.degrees[n]) for n in self._chosen]
        self.plot.show_curves(curves)
        self.timeline.show_take(review, self._chosen[0] if self._chosen else "")
        self._on_range()
        self._on_moved(self.playhead.time)

    def _on_moved(self, time: float) -> None:
        if self._review is None:
            return
        if self._stage is not None and self._source is not None:
            self._stage.show_pose(self._source.pose_at(time))
        self._turn_page(time)
        self.plot.set_cursor(time)
        self.measures.show_time(time)

    def _turn_page(self, time: float) -> None:
        """Show the part of the plot in which the playhead is."""
        duration = self.playhead.duration
        if duration <= 1.5 * PAGE_SECONDS:
            return
        from_s, to_s = self.plot.shown_range
        if to_s - from_s > PAGE_SECONDS + 1e-6 or not from_s <= time <= to_s:
            start = min(max(time - 0.1 * PAGE_SECONDS, 0.0), duration - PAGE_SECONDS)
            self.plot.set_range(start, start + PAGE_SECONDS)

    def _on_range(self) -> None:
        head = self.playhead
        whole = head.range_from is None and head.range_to is None
        words = self.tr("degrees, over the whole take")
        if not whole:
            words = self.tr("degrees, {start} to {end}").format(start=clock(head.begin), end=clock(head.end))
        self.measures.show_range(head.begin, head.end, words)

    def _on_angles(self, names: tuple[str, ...]) -> None:
        if self._review is None or names == self._chosen:
            return
        self._chosen = names
        self.measures.choose(names)
        self._show_angles()
        self.chosen_angles_changed.emit(names)

    def _on_note(self, text: str) -> None:
        if self._open is not None:
            self.note_requested.emit(self._open, text)

    def _on_export(self) -> None:
        if self._open is not None:
            selected = self.takes.selected()
            self.export_requested.emit(selected if self._open in selected else (self._open,))

    def _on_again(self) -> None:
        if self._open is not None:
            self.solve_requested.emit(self._open)

    def _on_library(self) -> None:
        if self._open is None:
            self.show_nothing()

    def _toggle_loop(self) -> None:
        self.playhead.set_loop(not self.playhead.loops)

    def _frame_back(self) -> None:
        self.playhead.step(-1)

    def _frame_forward(self) -> None:
        self.playhead.step(1)

    def _frames_back(self) -> None:
        self.playhead.step(-LONG_STEP)

    def _frames_forward(self) -> None:
        self.playhead.step(LONG_STEP)
