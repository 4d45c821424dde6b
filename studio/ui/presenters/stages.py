"""The figures of home, capture and review: one is seen at a time, and all are seen from the same side."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from PySide6.QtCore import QObject

from studio.core.body import Skeleton
from studio.ui.live_show import LiveShow
from studio.ui.settings import Settings
from studio.ui.views.stage.stage import Stage

LIVE = frozenset({"home", "capture"})


class Stages(QObject):
    """Brings the running body to the figure that is looked at."""

    keys = ("follow", "views")

    def __init__(self, stages: Mapping[str, Stage], show: LiveShow, settings: Settings) -> None:
        super().__init__(show)
        self._stages, self._show, self._settings = stages, show, settings
        self._page = ""
        self._skeleton: Skeleton | None = None
        settings.changed.connect(self._on_setting)
        self._on_setting("seen_from")
        for name in LIVE:
            stages[name].set_empty_text(self.tr("No body yet: connect sensors and calibrate."))

    def stage(self, page: str) -> Stage:
        """Return the figure of a page."""
        return self._stages[page]

    def show_page(self, page: str) -> None:
        """Another page is looked at."""
        self._page = page
        if page in LIVE:
            self._stages[page].show_pose(None)
            self._skeleton = None
            self._show.forget_newest()

    def act(self, action: str, page: str) -> bool:
        """Do what a key asks for."""
        stage = self._stages.get(page)
        if stage is None or action not in self.keys:
            return False
        if action == "follow":
            stage.toggle_follow()
        else:
            stage.next_view()
        return True

    def tick(self, now: float) -> None:
        """Let time pass. The angles are followed where they are seen: they cost as much as the figure."""
        if self._page not in LIVE:
            return
        pose = self._show.next_pose(now, with_angles=self._page == "capture")
        stage = self._stages[self._page]
        skeleton = self._show.skeleton()
        if skeleton is not self._skeleton:
            self._skeleton = skeleton
            stage.set_skeleton(skeleton)
            stage.clear_path()
        if pose is not None and np.isfinite(pose.joints).any():
            # Home says below the figure that nobody wears it.
            stage.show_pose(replace(pose, caption="") if self._page == "home" else pose)
        elif not self._show.has_body():
            stage.show_pose(None)
        stage.tick(now)

    def _on_setting(self, name: str) -> None:
        if name == "seen_from":
            for stage in self._stages.values():
                stage.mirrored = self._settings.values.seen_from == "behind"
