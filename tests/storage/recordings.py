"""Made-up samples for the tests of takes: numbers that name their own place, and a writer that is ready."""

from datetime import date
from pathlib import Path

from studio.core.body import Place
from studio.core.sample import NAN, NO_CORRECTION, Sample, SensorId, SensorInfo
from studio.core.take import Assignment, Calibration, Setup
from studio.storage.facts import Anchor
from studio.storage.filesystem import FILES, FileSystem
from studio.storage.session_folder import open_session
from studio.storage.take_writer import TakeWriter

DAY = date(2026, 11, 24)
START = 1000.0  # s, monotonic clock
RATE = 100  # Hz
TAGS = tuple(SensorId(f"tag:{number:08X}") for number in range(15))

SETUP = Setup(
    Assignment({Place.PELVIS: TAGS[0], Place.LEFT_THIGH: TAGS[1]}),
    (Calibration(TAGS[0], NO_CORRECTION, "2026-11-24T09:00:00+00:00", "rest"),),
    stature=1.81,
    stature_known=True,
    mounting="strapped",
)


def info(sensor: SensorId) -> SensorInfo:
    return SensorInfo(sensor, 1 / RATE, label="left", number=3, facts={"firmware": 7, "range": 2000.5, "board": "nano"})


def sample(sensor: SensorId, frame: int) -> Sample:
    """Return a sample whose numbers are irrational, so that no rounding on the way can hide."""
    tag = TAGS.index(sensor)
    x = (tag + 1) / 7 + frame / 3
    return Sample(
        sensor=sensor,
        epoch=frame // 1000,
        frame=frame + (1 << 33),
        device_time=x * 1.1,
        time=START + frame / RATE + tag * 1e-4,
        received=START + frame / RATE + tag * 1e-4 + 0.007 / 3,
        orientation=(x / 9, x / 11, NAN, -0.0),
        rate=(x / 13, -x / 17, 1e-300),
        acceleration=(x / 19, 9.80665, NAN),
        flags=frame % 512,
        battery=x % 1,
        temperature=21 + x % 1,
        rssi=-60.5 if tag else NAN,
    )


def samples(frames: int, tags: int = 15) -> list[Sample]:
    return [sample(sensor, frame) for frame in range(frames) for sensor in TAGS[:tags]]


def start_writing(
    library: Path, filesystem: FileSystem = FILES, name: str = "walk", tags: int = 15, setup: Setup = SETUP
) -> TakeWriter:
    writer = TakeWriter(
        open_session(library, "P014", DAY),
        name,
        person="P014",
        source="synthetic:walk?seed=1",
        setup=setup,
        versions={"studio": "0.1.0", "protocol": "1"},
        anchor=Anchor("2026-11-24T10:00:00+00:00", START),
        filesystem=filesystem,
    )
    for sensor in TAGS[:tags]:
        writer.add_sensor(info(sensor))
    return writer
