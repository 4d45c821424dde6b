"""The solver while samples are coming in."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import PLACES, SEGMENT_OF, Skeleton, reference_pose
from studio.core.full_body import FullBody
from studio.core.headings import GroupHeadings, headings_of
from studio.core.live_frames import Frame, FrameBlock, FrameLog, Pose, Rows
from studio.core.live_track import LiveTrack
from studio.core.pose import Motion
from studio.core.root import Root, put_under_hold
from studio.core.runs import longest_bridge
from studio.core.sample import Flag, Sample, SensorId, SensorInfo, Stream
from studio.core.take import Alignment, Calibration, Setup, Take
from studio.core.track import SensorTrack, tells_gravity

EVER = (float("-inf"), float("inf"))  # s
CHUNK = 1024  # frames at a time: the working set stays in the cache
FORGOTTEN_AT_ONCE = 1024  # rows of a sensor; shifting what is kept costs more than keeping


class _Headings(NamedTuple):
    """The headings in force, ready to be looked up by group."""

    turns: NDArray[np.float64]
    """(sensors, groups + 1, 4); where a heading is unknown a known one stands in, and so in the last column."""
    known: NDArray[np.bool_]
    """(sensors, groups + 1)."""


class Solver:
    """Steps all sensors and, once aligned, the body. Not thread-safe: the acquisition thread owns it."""

    def __init__(
        self, setup: Setup, attitude: str, calibrations: Mapping[SensorId, Calibration], keep_s: float = float("inf")
    ) -> None:
        """Begin without any sensor.

        Parameters
        ----------
        attitude : key of ``attitude.ESTIMATORS``
        calibrations : offset and gain to be in force, of the sensors that have one
        keep_s : s, how far back attitudes are kept for holds
        """
        self._setup = setup
        self._attitude = attitude
        self._calibrations = dict(calibrations)
        self._keep_s = keep_s
        self._tracks: dict[SensorId, LiveTrack] = {}
        self._history: dict[SensorId, Rows] = {}
        self._place_of = {sensor: place for place, sensor in setup.assignment.sensors.items()}
        self._fresh: set[SensorId] = set()
        self._heard: dict[SensorId, float] = {}
        self._time = float("-inf")
        self._closed = float("-inf")
        self._alignment: Alignment | None = None

    def add_sensor(self, info: SensorInfo) -> None:
        """Meet a sensor, or learn more about a known one (its correction)."""
        if info.sensor in self._tracks:
            self._tracks[info.sensor].info = info
            return
        self._tracks[info.sensor] = LiveTrack(info, self._attitude, self._calibrations.get(info.sensor))
        self._history[info.sensor] = Rows(15)

    def forget_body(self) -> None:
        """End the alignment: frames are no poses until there is another one."""
        self._alignment = None

    def adopt(self, setup: Setup, arrived: Iterable[Sample]) -> None:
        """Put another setup in force; other places on the body end the alignment, what each sensor did stays.

        Parameters
        ----------
        arrived : iterable of Sample
            What a take that began now would hold already, in order: its frames are formed as in that take.
        """
        same, before = setup.assignment == self._setup.assignment, self._setup.stature
        self._setup = setup
        if same:
            if self._alignment is not None and setup.stature != before:
                self._root = Root(Skeleton.from_stature(setup.stature))
            return
        self._alignment = None
        self._place_of = {sensor: place for place, sensor in setup.assignment.sensors.items()}
        self._fresh.clear()
        stepped = {
            sensor: set(self._history[sensor].values()[:, 0].tolist())
            for sensor in self._place_of
            if sensor in self._history
        }
        for sample in arrived:
            if sample.sensor not in stepped:
                continue
            if sample.time in stepped[sample.sensor] or sample.flags & Flag.FILLED:
                self._hear(sample)

    def recalibrate(self, calibration: Calibration) -> None:
        """Correct a sensor from its next sample on; its heading goes on where the device's quaternion tells."""
        self._calibrations[calibration.sensor] = calibration
        if calibration.sensor in self._tracks:
            self._tracks[calibration.sensor].recalibrate(calibration)

    def restart(self, sensor: SensorId, calibration: Calibration | None, arrived: Iterable[Sample]) -> None:
        """Correct a sensor (None: as it corrects itself) as if it always had been, over what it sent before."""
        self._calibrations.pop(sensor, None)
        if calibration is not None:
            self._calibrations[sensor] = calibration
        if sensor not in self._tracks:
            return
        track = self._tracks[sensor] = LiveTrack(self._tracks[sensor].info, self._attitude, calibration)
        self._history[sensor] = Rows(15)
        for sample in arrived:
            if track.push(sample):
                self._remember(sample, track)

    def learned_offsets(self, date: str) -> tuple[Calibration, ...]:
        """Return what the filters have learned of the gyroscopes' offsets since they began, as calibrations."""
        found = {sensor: track.learned() for sensor, track in self._tracks.items()}
        return tuple(
            Calibration(sensor, learned[0], date, "filter", offset_sigma=(learned[1],) * 3)
            for sensor, learned in found.items()
            if learned is not None
        )

    def push(self, sample: Sample) -> list[Frame]:
        """Take the next sample and return the frames it completes (none, one, rarely two).

        A frame is complete when every worn sensor has sent once, or when one sends again: both depend on
        the samples and their order alone, so that a replay forms the very same frames.
        """
        track = self._tracks[sample.sensor]
        worn = sample.sensor in self._place_of
        if not track.accepts(sample):
            return self._hear(sample) if worn and track.is_heard(sample) else []
        # The frame is closed before the sample is stepped: that belongs to the next one.
        done = self._close() if sample.sensor in self._fresh else []
        track.push(sample)
        self._remember(sample, track)
        return [*done, *self._hear(sample)] if worn else done

    def use(self, alignment: Alignment, headings: GroupHeadings | None = None) -> None:
        """Put an alignment in force: from now on frames become poses.

        Parameters
        ----------
        headings : mapping or None
            What ``headings_of`` tells of this solver's own tracks. None: those of the alignment, which was found
            on these tracks and whose hold is among them.
        """
        if headings is None:
            worn = {p: self._track(s, (EVER,)) for s, p in self._place_of.items() if s in self._tracks}
            headings = headings_of(worn, alignment, (), 0.0)
        self._alignment = alignment
        self._known = [place for place in PLACES if headings.get(place)]
        self._sensors = [self._setup.assignment.sensors[place] for place in self._known]
        limbs = [alignment.limbs[place] for place in self._known]
        self._sensor_from_segment = np.array([limb.sensor_from_segment for limb in limbs]).reshape(-1, 4)
        self._headings = _look_up([headings[place] for place in self._known])
        self._body = FullBody(self._known, alignment.pose)
        self._resting = reference_pose(alignment.pose)[[SEGMENT_OF[place] for place in self._known]]
        self._root = Root(Skeleton.from_stature(self._setup.stature))
        self._last_time: float | None = None

    def pose(self, frame: Frame) -> Pose | None:
        """Return the body at a frame; None before there is an alignment. Frames must come in order."""
        if self._alignment is None:
            return None
        log = FrameLog(self._sensors)
        log.extend([frame])
        (block,) = log.blocks(self._sensors, 1)
        world, hips, known = self._bodies(block)
        is_heard = known[0] & (frame.time - block.heard[0] <= longest_bridge(self._frame_s()))
        measured = frozenset(place for place, there in zip(self._known, is_heard.tolist(), strict=True) if there)
        return Pose(frame.time, world[0], hips[0], measured)

    def tracks(
        self, spans: Sequence[tuple[float, float]] = (EVER,), sensors: Collection[SensorId] | None = None
    ) -> dict[SensorId, SensorTrack]:
        """Return what was estimated, of all sensors or of some, for alignment.

        Parameters
        ----------
        spans : sequence of (from, to), s
            Only these stretches are looked at: a minute of 15 sensors takes longer to copy than to align.
            Sensors that share one world are given without holes, because bending between the holds tells
            which way the wearer faced.
        """
        return {sensor: self._track(sensor, spans) for sensor in (self._tracks if sensors is None else sensors)}

    def newest(self, sensor: SensorId) -> tuple[SensorInfo, int]:
        """Return what is known of a sensor, and the flags of its last sample."""
        track = self._tracks[sensor]
        return track.info, 0 if track.last is None else track.last.flags

    def kept(self) -> float:
        """Return how far back ``tracks`` reaches, s."""
        times = [history.values()[:, 0] for history in self._history.values() if len(history)]
        return float(max((t[-1] for t in times), default=0.0) - min((t[0] for t in times), default=0.0))

    def motion(self, frames: FrameLog, notes: tuple[str, ...]) -> Motion:
        """Return the poses of all frames as a motion, its origin under the reference hold."""
        if self._alignment is None:
            raise ValueError("no alignment is in force")
        count = len(frames)
        time, world, hips = np.empty(count), np.empty((count, 23, 4)), np.empty((count, 3))
        known, heard = np.zeros((count, len(self._known)), bool), np.empty((count, len(self._known)))
        row = 0
        for block in frames.blocks(self._sensors, CHUNK):
            part = slice(row, row + len(block.time))
            time[part], heard[part] = block.time, block.heard
            world[part], hips[part], known[part] = self._bodies(block)
            row = part.stop
        put_under_hold(hips, time, self._alignment)
        places = [place for place in PLACES if place in self._alignment.limbs]
        measured, lost = ({place: np.full(count, value) for place in places} for value in (False, True))
        for column, place in enumerate(self._known):
            fresh, bridged = _coverage(heard[:, column], self._frame_s())
            measured[place], lost[place] = known[:, column] & bridged, ~fresh
        return Motion(
            time=time,
            frame_s=self._frame_s(),
            world_from_segment=world,
            hips=hips,
            skeleton=Skeleton.from_stature(self._setup.stature),
            measured=measured,
            lost=lost,
            alignment=self._alignment,
            method="live",
            attitude=self._attitude,
            notes=notes,
        )

    def _bodies(self, block: FrameBlock) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
        """Return world_from_segment (n, 23, 4), Hips (n, 3), m, and whose heading is known (n, sensors)."""
        rows = np.arange(len(self._sensors))
        groups = np.clip(block.group, 0, self._headings.known.shape[1] - 1)
        headed = rotation.multiply(self._headings.turns[rows, groups], block.attitude)
        segments = rotation.multiply(headed, self._sensor_from_segment)
        # Who has not sent anything yet is shown as in the held pose.
        world = self._body.complete(np.where((block.group < 0)[..., None], self._resting, segments))
        before = block.time[0] if self._last_time is None else self._last_time
        self._last_time = float(block.time[-1])
        hips = self._root.run(world, np.diff(block.time, prepend=before))
        return world, hips, self._headings.known[rows, groups] & (block.group >= 0)

    def _frame_s(self) -> float:
        return min(self._tracks[sensor].info.frame_s for sensor in self._place_of if sensor in self._tracks)

    def _hear(self, sample: Sample) -> list[Frame]:
        """Note that a worn sensor sent, and return the frame that this completes."""
        done = self._close() if sample.sensor in self._fresh else []
        self._fresh.add(sample.sensor)
        self._heard[sample.sensor] = sample.time
        self._time = max(self._time, sample.time)
        return [*done, *(self._close() if len(self._fresh) == len(self._place_of) else [])]

    def _close(self) -> list[Frame]:
        """End the frame; one that is no newer than the last goes into the next."""
        self._fresh.clear()
        if self._time <= self._closed:
            return []
        self._closed = self._time
        started = {s: t for s, t in self._tracks.items() if s in self._place_of and t.last is not None}
        return [
            Frame(
                self._time,
                {sensor: track.attitude for sensor, track in started.items()},
                {sensor: self._heard.get(sensor, float("-inf")) for sensor in started},
                {sensor: track.group for sensor, track in started.items()},
            )
        ]

    def _remember(self, sample: Sample, track: LiveTrack) -> None:
        history = self._history[sample.sensor]
        seen = (*track.attitude, *sample.orientation, track.speed, track.run, track.group)
        history.append(sample.time, *seen, *sample.acceleration)
        history.forget(sample.time - self._keep_s, FORGOTTEN_AT_ONCE)

    def _track(self, sensor: SensorId, spans: Sequence[tuple[float, float]]) -> SensorTrack:
        live, kept = self._tracks[sensor], self._history[sensor].values()
        levelled = tells_gravity(kept[:, 12:], kept[:, 9]) & live.info.has_acceleration | (live.estimator == "device")
        if live.info.common_world:
            spans = [(min(start for start, _ in spans), max(end for _, end in spans))]
        if EVER not in spans:
            time = kept[:, 0]
            looked_at = np.any([(time >= start) & (time <= end) for start, end in spans], axis=0)
            kept, levelled = kept[looked_at], levelled[looked_at]
        return SensorTrack(
            info=live.info,
            estimator=live.estimator,
            time=kept[:, 0],
            attitude=kept[:, 1:5],
            device=kept[:, 5:9],
            speed=kept[:, 9],
            lost=np.zeros(len(kept), bool),
            run=kept[:, 10].astype(np.int32),
            group=kept[:, 11].astype(np.int32),
            offset=np.zeros(3),
            offset_sigma=float("nan"),
            levelled=levelled,
        )


def _look_up(headings: Sequence[Mapping[int, float]]) -> _Headings:
    groups = 1 + max((max(known) for known in headings), default=0)
    turns = np.empty((len(headings), groups + 1, 4))
    known = np.zeros((len(headings), groups + 1), bool)
    for row, of_groups in enumerate(headings):
        turns[row] = rotation.about(2, next(iter(of_groups.values())))
        for group, heading in of_groups.items():
            turns[row, group] = rotation.about(2, heading)
            known[row, group] = True
    return _Headings(turns, known)


def _coverage(heard: NDArray[np.float64], frame_s: float) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return in which frames (n,) a sensor was heard, and in which it was, or the silence around them is bridged."""
    fresh = np.isfinite(heard) & (np.diff(heard, prepend=np.nan) != 0)
    source = np.minimum.accumulate(np.where(fresh, np.arange(len(heard)), len(heard))[::-1])[::-1]
    silent_for = np.append(heard, np.inf)[source] - heard
    return fresh, fresh | (silent_for <= longest_bridge(frame_s))


def samples_of(take: Take) -> Iterator[Sample]:
    """Yield the samples of a take in their order of arrival; times are take times."""
    if not take.streams:
        return
    arrival = np.concatenate([stream.arrival for stream in take.streams])
    stream_of = np.repeat(np.arange(len(take.streams)), [len(stream) for stream in take.streams])
    row_of = np.concatenate([np.arange(len(stream)) for stream in take.streams])
    order = np.argsort(arrival, kind="stable")
    for start in range(0, len(order), CHUNK):
        part = order[start : start + CHUNK]
        for index, row in zip(stream_of[part].tolist(), row_of[part].tolist(), strict=True):
            yield sample_at(take.streams[index], row)


def sample_at(stream: Stream, row: int) -> Sample:
    """Return one row of a stream as the sample it was."""
    w, x, y, z = stream.orientation[row].tolist()
    gx, gy, gz = stream.rate[row].tolist()
    ax, ay, az = stream.acceleration[row].tolist()
    return Sample(
        sensor=stream.info.sensor,
        epoch=int(stream.epoch[row]),
        frame=int(stream.frame[row]),
        device_time=float(stream.device_time[row]),
        time=float(stream.time[row]),
        received=float(stream.received[row]),
        orientation=(w, x, y, z),
        rate=(gx, gy, gz),
        acceleration=(ax, ay, az),
        flags=int(stream.flags[row]),
        battery=float(stream.battery[row]),
        temperature=float(stream.temperature[row]),
        rssi=float(stream.rssi[row]),
    )
