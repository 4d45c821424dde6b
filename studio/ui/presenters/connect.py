"""Connect: sources are found, opened and left; the sensors' health, rest and signals are brought to the page."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import QObject

from studio.acquisition.driver import Found
from studio.capture.sources import find_sources
from studio.core.body import Place
from studio.core.errors import StudioError
from studio.core.rest import Rest
from studio.core.sample import SensorId
from studio.storage.tag_file import Tag, load_tag, rename_tag, tags_folder
from studio.storage.take_summary import TakeSummary
from studio.ui.models.rest_watch import RestWatch
from studio.ui.models.studio_model import StudioModel
from studio.ui.models.take_list_model import length
from studio.ui.presenters.folders import choose_folder
from studio.ui.views.connect_page import ConnectPage
from studio.ui.wording import sentences

TABLE_EVERY = 0.25  # s
SIGNAL_EVERY = 0.04  # s
REST_SECONDS = 11.0  # s; what RestWatch wants to see
SIGNAL_SECONDS = 10.5  # s
MOTION_SECONDS = 0.5  # s


class ConnectPresenter(QObject):
    """Feeds the page four times a second, its plot 25 times."""

    keys = ("rename",)

    def __init__(self, model: StudioModel, page: ConnectPage, library: Path) -> None:
        super().__init__(page)
        self._model, self._page, self._library = model, page, library
        self.rest = RestWatch(self)
        self._selected = SensorId("")
        self._table_at = self._signal_at = -math.inf
        self._found: dict[SensorId, Rest] = {}
        self._names: dict[SensorId, str] = {}
        self._was = ""
        page.offer(rename=True, blink=False)
        page.source_chosen.connect(model.open)
        page.disconnect_requested.connect(model.close_source)
        page.refresh_requested.connect(self.look_for_ports)
        page.folder_requested.connect(self._on_folder)
        page.rename_requested.connect(self._on_rename)
        page.select_changed.connect(self._on_select)
        model.source_changed.connect(self._on_source)
        model.source_refused.connect(self._on_refused)
        model.sensors_changed.connect(self._on_sensors)
        self.rest.rested.connect(self._on_rested)

    def shown(self) -> None:
        """The page is looked at now."""
        self.look_for_ports()

    def look_for_ports(self) -> None:
        """Look for receivers."""
        self._model.work(find_sources, self._offer)

    def show_takes(self, takes: Sequence[TakeSummary]) -> None:
        """Offer takes for replay."""
        words = self.tr("{name} · {length} · {session}")
        readable = [take for take in takes if take.refusal is None]
        self._page.offer_takes(
            [
                (words.format(name=t.name, length=length(t.duration_s), session=t.session), str(t.folder))
                for t in readable
            ]
        )

    def act(self, action: str) -> bool:
        """Do what a key asks for."""
        sensor = self._page.selected()
        if action == "rename" and sensor is not None:
            self._page.list.rename()
            return True
        return False

    def tick(self, now: float, *, shown: bool) -> None:
        """Let time pass; the rest is watched whatever page is shown."""
        if now - self._table_at >= TABLE_EVERY:
            self._table_at = now
            self._watch_rest()
            if shown:
                self._show_table(now)
        if shown:
            self._page.tick(now)
            if self._selected and now - self._signal_at >= SIGNAL_EVERY:
                self._signal_at = now
                window = self._model.buffer.snapshot((self._selected,), SIGNAL_SECONDS).get(self._selected)
                if window is not None:
                    self._page.show_signal(window, now)

    def _show_table(self, now: float) -> None:
        model = self._model
        infos = {s: replace(info, label=self._names.get(s) or info.label) for s, info in model.infos.items()}
        places: Mapping[SensorId, Place] = {s: place for place, s in model.setup.assignment.sensors.items()}
        self._page.show_sensors(model.health, infos, places, now)
        self._page.sensors.is_worn = model.alignment is not None
        self._page.show_rest(self.rest)
        if model.alignment is not None:
            self._page.show_worn()
        self._page.show_motion(model.buffer.snapshot(tuple(infos), MOTION_SECONDS), now)

    def _watch_rest(self) -> None:
        """Measure offsets of tags that lie still, as long as nobody wears them."""
        model = self._model
        if not model.infos or model.alignment is not None or model.is_recording:
            return
        self.rest.feed(model.buffer.snapshot(tuple(model.infos), REST_SECONDS), model.infos)
        if self._found:
            found, self._found = self._found, {}
            model.keep_rests(found)

    def _on_rested(self, sensor: str, rest: Rest) -> None:
        self._found[SensorId(sensor)] = rest

    def _on_select(self, sensor: str) -> None:
        self._selected = SensorId(sensor)
        self._signal_at = -math.inf

    def _on_source(self) -> None:
        model, page = self._model, self._page
        if model.source != self._was:
            self._was = model.source
            self.rest.forget()
            self._found.clear()
        if not model.source:
            page.show_sensors({}, {}, {}, 0.0)
            page.show_idle()
        elif model.connecting:
            page.show_sensors({}, {}, {}, 0.0)
            page.show_connecting(model.source, model.now())
        else:
            page.show_connected(model.source)

    def _on_refused(self, error: StudioError) -> None:
        self._page.show_refusal(sentences(error))

    def _on_sensors(self) -> None:
        unknown = [sensor for sensor in self._model.infos if sensor not in self._names]
        if not unknown:
            return
        self._names.update(dict.fromkeys(unknown, ""))
        self._model.work(lambda: {sensor: load_tag(sensor, tags_folder()) for sensor in unknown}, self._on_tags)

    def _on_tags(self, tags: Mapping[SensorId, Tag]) -> None:
        self._names.update({sensor: tag.nickname for sensor, tag in tags.items()})

    def _on_rename(self, sensor: str, name: str) -> None:
        known = SensorId(sensor)
        self._model.work(lambda: {known: rename_tag(known, name, tags_folder())}, self._on_tags)

    def _on_folder(self) -> None:
        folder = choose_folder(self._page, self.tr("Take to replay"), self._library)
        if folder is not None:
            self._page.choose_source(f"replay:{folder}")

    def _offer(self, found: Sequence[Found]) -> None:
        self._page.offer_ports([source for source in found if source.source.startswith("serial:")])
