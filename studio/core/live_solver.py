"""The solver while samples are coming in."""

from bisect import bisect_left
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from studio.core import rotation
from studio.core.body import PLACES, SEGMENT_OF, Place, Skeleton, reference_pose
from studio.core.full_body import FullBody
from studio.core.live_track import LiveTrack
from studio.core.pose import Motion
from studio.core.root import Root
from studio.core.sample import Quaternion, Sample, SensorId, SensorInfo, Stream
from studio.core.take import Alignment, Calibration, Setup, Take
from studio.core.track import SensorTrack

T = TypeVar("T")

EVER = (float("-inf"), float("inf"))  # s


class Frame(NamedTuple):
    """All worn sensors at one moment: one step of the solver."""

    time: float
    """s, of the newest sample."""
    attitudes: dict[SensorId, Quaternion]
    """world_from_sensor as far as each sensor got."""
    fresh: frozenset[SensorId]
    """Those that sent a sample in this frame."""
    groups: dict[SensorId, int]
    """Heading group of each sensor."""


class Pose(NamedTuple):
    """The body at one moment."""

    time: float
    world_from_segment: NDArray[np.float64]
    """(23, 4)."""
    hips: NDArray[np.float64]
    """(3,), m, world."""
    measured: frozenset[Place]
    """Places whose sensor sent in this frame and whose heading is known."""


@dataclass
class _History:
    time: list[float] = field(default_factory=list)
    attitude: list[Quaternion] = field(default_factory=list)
    device: list[Quaternion] = field(default_factory=list)
    speed: list[float] = field(default_factory=list)
    run: list[int] = field(default_factory=list)
    group: list[int] = field(default_factory=list)

    def forget_before(self, row: int) -> None:
        for values in (self.time, self.attitude, self.device, self.speed, self.run, self.group):
            del values[:row]


class Solver:
    """Steps all sensors and, once aligned, the body. Not thread-safe: the acquisition thread owns it."""

    def __init__(
        self, setup: Setup, attitude: str, calibrations: Mapping[SensorId, Calibration], keep_s: float = float("inf")
    ) -> None:
        self._setup = setup
        self._attitude = attitude
        self._calibrations = dict(calibrations)
        self._keep_s = keep_s
        self._tracks: dict[SensorId, LiveTrack] = {}
        self._history: dict[SensorId, _History] = {}
        self._place_of = {sensor: place for place, sensor in setup.assignment.sensors.items()}
        self._fresh: set[SensorId] = set()
        self._time = 0.0
        self._alignment: Alignment | None = None

    def add_sensor(self, info: SensorInfo) -> None:
        """Meet a sensor, or learn more about a known one (its correction)."""
        if info.sensor in self._tracks:
            self._tracks[info.sensor].info = info
            return
        self._tracks[info.sensor] = LiveTrack(info, self._attitude, self._calibrations.get(info.sensor))
        self._history[info.sensor] = _History()

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
        stepped = {sensor: set(self._history[sensor].time) for sensor in self._place_of if sensor in self._history}
        for sample in arrived:
            if sample.sensor not in stepped:
                continue
            if sample.sensor in self._fresh:
                self._fresh.clear()
            if sample.time in stepped[sample.sensor]:
                self._note_fresh(sample)
            if len(self._fresh) == len(self._place_of):
                self._fresh.clear()

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
        self._history[sensor] = _History()
        for sample in arrived:
            if track.push(sample):
                self._remember(sample, track)

    def push(self, sample: Sample) -> list[Frame]:
        """Take the next sample and return the frames it completes (none, one, rarely two).

        A frame is complete when every worn sensor has sent once, or when one sends again: both depend on
        the samples and their order alone, so that a replay forms the very same frames.
        """
        track = self._tracks[sample.sensor]
        done: list[Frame] = []
        worn = sample.sensor in self._place_of
        if worn and sample.sensor in self._fresh:
            done.append(self._close())
        if not track.push(sample):
            return done
        self._remember(sample, track)
        if worn:
            self._note_fresh(sample)
            if len(self._fresh) == len(self._place_of):
                done.append(self._close())
        return done

    def use(self, alignment: Alignment, headings: Mapping[Place, Mapping[int, float]] | None = None) -> None:
        """Put an alignment in force: from now on frames become poses.

        Parameters
        ----------
        headings : mapping or None
            For each limb its heading, rad, by heading group of its track. None: the alignment was found on these
            tracks, and each limb's group is that of the hold.
        """
        self._alignment = alignment
        known = [p for p in PLACES if p in alignment.limbs and alignment.limbs[p].source != "unknown"]
        self._known = known
        self._sensors = [self._setup.assignment.sensors[place] for place in known]
        self._sensor_from_segment = np.array([alignment.limbs[p].sensor_from_segment for p in known]).reshape(-1, 4)
        self._headings = rotation.about(2, np.array([alignment.limbs[p].heading for p in known]))
        self._groups = {sensor: self._group_at(sensor, alignment.from_s) for sensor in self._sensors}
        for place, sensor in zip(known, self._sensors, strict=True):
            self._groups[sensor] = next(iter((headings or {}).get(place, ())), self._groups[sensor])
        self._body = FullBody(known, alignment.pose)
        self._resting = [reference_pose(alignment.pose)[SEGMENT_OF[place]] for place in known]
        self._root = Root(Skeleton.from_stature(self._setup.stature))
        self._last_time: float | None = None

    def pose(self, frame: Frame) -> Pose | None:
        """Return the body at a frame; None before there is an alignment. Frames must come in order."""
        if self._alignment is None:
            return None
        attitudes = np.empty((len(self._sensors), 4))
        for row, sensor in enumerate(self._sensors):
            attitudes[row] = frame.attitudes.get(sensor, (np.nan,) * 4)
        segments = rotation.multiply(rotation.multiply(self._headings, attitudes), self._sensor_from_segment)
        for row, sensor in enumerate(self._sensors):
            if sensor not in frame.attitudes:  # it has not sent anything yet: shown as in the held pose
                segments[row] = self._resting[row]
        world = self._body.complete(segments)
        dt = 0.0 if self._last_time is None else frame.time - self._last_time
        self._last_time = frame.time
        measured = frozenset(
            place
            for place, sensor in zip(self._known, self._sensors, strict=True)
            if sensor in frame.fresh and frame.groups[sensor] == self._groups[sensor]
        )
        return Pose(frame.time, world, self._root.step(world, dt), measured)

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
        ends = [(h.time[0], h.time[-1]) for h in self._history.values() if h.time]
        return max((end for _, end in ends), default=0.0) - min((start for start, _ in ends), default=0.0)

    def motion(self, frames: Sequence[Frame], notes: tuple[str, ...]) -> Motion:
        """Return the poses of frames as a motion."""
        if self._alignment is None:
            raise ValueError("no alignment is in force")
        poses = [pose for frame in frames if (pose := self.pose(frame)) is not None]
        places = [place for place in PLACES if place in self._alignment.limbs]
        fresh = {
            place: np.array([self._setup.assignment.sensors[place] in f.fresh for f in frames], bool)
            for place in places
        }
        return Motion(
            time=np.array([pose.time for pose in poses]),
            frame_s=min(self._tracks[sensor].info.frame_s for sensor in self._place_of if sensor in self._tracks),
            world_from_segment=np.array([pose.world_from_segment for pose in poses]).reshape(-1, 23, 4),
            hips=np.array([pose.hips for pose in poses]).reshape(-1, 3),
            skeleton=Skeleton.from_stature(self._setup.stature),
            measured={place: np.array([place in pose.measured for pose in poses], bool) for place in places},
            lost={place: ~fresh[place] for place in places},
            alignment=self._alignment,
            method="live",
            attitude=self._attitude,
            notes=notes,
        )

    def _note_fresh(self, sample: Sample) -> None:
        self._fresh.add(sample.sensor)
        self._time = max(self._time, sample.time)

    def _close(self) -> Frame:
        started = {s: t for s, t in self._tracks.items() if s in self._place_of and t.last is not None}
        frame = Frame(
            self._time,
            {sensor: track.attitude for sensor, track in started.items()},
            frozenset(self._fresh),
            {sensor: track.group for sensor, track in started.items()},
        )
        self._fresh.clear()
        return frame

    def _remember(self, sample: Sample, track: LiveTrack) -> None:
        history = self._history[sample.sensor]
        history.time.append(sample.time)
        history.attitude.append(track.attitude)
        history.device.append(sample.orientation)
        history.speed.append(track.speed)
        history.run.append(track.run)
        history.group.append(track.group)
        kept = len(history.time)
        if kept > 1024 and history.time[kept // 2] < sample.time - self._keep_s:
            history.forget_before(kept // 2)

    def _group_at(self, sensor: SensorId, time: float) -> int:
        history = self._history[sensor]
        row = bisect_left(history.time, time)
        return history.group[min(row, len(history.group) - 1)] if history.group else 0

    def _track(self, sensor: SensorId, spans: Sequence[tuple[float, float]]) -> SensorTrack:
        live, kept = self._tracks[sensor], self._history[sensor]
        if live.info.common_world:
            spans = [(min(start for start, _ in spans), max(end for _, end in spans))]
        time = np.array(kept.time)
        rows = np.concatenate([np.flatnonzero((time >= start) & (time <= end)) for start, end in sorted(spans)])
        chosen = np.unique(rows).tolist()

        def column(values: list[T]) -> list[T]:
            return [values[row] for row in chosen]

        return SensorTrack(
            info=live.info,
            estimator=live.estimator,
            time=time[chosen],
            attitude=np.array(column(kept.attitude)).reshape(-1, 4),
            device=np.array(column(kept.device)).reshape(-1, 4),
            speed=np.array(column(kept.speed)),
            lost=np.zeros(len(chosen), bool),
            run=np.array(column(kept.run), np.int32),
            group=np.array(column(kept.group), np.int32),
            offset=np.zeros(3),
            offset_sigma=float("nan"),
        )


def samples_of(take: Take) -> Iterator[Sample]:
    """Yield the samples of a take in their order of arrival; times are take times."""
    rows = [(int(arrival), stream, row) for stream in take.streams for row, arrival in enumerate(stream.arrival)]
    for _, stream, row in sorted(rows, key=lambda item: item[0]):
        yield sample_at(stream, row)


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
