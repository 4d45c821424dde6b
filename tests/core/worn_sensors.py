"""Bodies and sensors made of geometry: what the tests of the solver hold it against.

A sensor is an exact integrator with a random mounting and a random heading. Nothing here comes from the
code under test but the arithmetic of ``rotation``, which has its own tests.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from studio.core import frames, rotation
from studio.core.body import SEGMENT_OF, Place, reference_pose
from studio.core.sample import SensorId, SensorInfo, Stream
from studio.core.take import Assignment, Mark, Setup, Take

RATE = 50.0

LIFTED = {"upper_arm", "forearm", "hand", "thigh"}

N_HOLD = Mark(1.0, "pose", "n", 4.0)
BOW_HOLD = Mark(6.0, "pose", "bow", 8.0)


def sensor_of(place: Place) -> SensorId:
    return SensorId(f"tag:{place.number:08x}")


def bow_angle(place: Place) -> float:
    """How far each segment turns about its right axis in the bow, rad: forwards is negative, lifting positive."""
    lifted = any(place.value.endswith(limb) for limb in LIFTED)
    return float(np.radians(50.0 if lifted else -35.0))


def procedure(place: Place, time: NDArray[np.float64], walking: float = 30.0) -> NDArray[np.float64]:
    """Return world_from_segment (n, 4): N-pose, a bow from 6 to 8 s, upright, then swinging from 10 s on."""
    ramp = np.clip((time - 4.5) / 1.5, 0, 1) - np.clip((time - 8.0) / 1.5, 0, 1)
    smooth = ramp * ramp * (3 - 2 * ramp)
    on = np.clip(time - 10.0, 0, 1) ** 2 * (3 - 2 * np.clip(time - 10.0, 0, 1))
    swing = np.radians(walking) * on * np.sin(2 * np.pi * (time - 10.0) + place.number)
    side = 0.3 * np.radians(walking) * on * np.sin(4 * np.pi * (time - 10.0) + 2 * place.number)
    turned = rotation.multiply(rotation.about(2, smooth * bow_angle(place) + swing), rotation.about(0, side))
    return rotation.multiply(reference_pose("n")[SEGMENT_OF[place]], turned)


def stream(
    sensor: SensorId,
    world_from_sensor: NDArray[np.float64],
    time: NDArray[np.float64],
    *,
    first_arrival: int = 0,
    arrival_step: int = 1,
    bias: tuple[float, float, float] = (0.0, 0.0, 0.0),
    info: SensorInfo | None = None,
) -> Stream:
    """Return what an exact tag sends: its own integral since the start (with ``bias`` rad/s), and gravity."""
    n = len(time)
    steps = rotation.to_rotation_vector(
        rotation.multiply(rotation.inverse(world_from_sensor[:-1]), world_from_sensor[1:])
    )
    measured = steps + np.array(bias) / RATE
    orientation = np.empty((n, 4))
    orientation[0] = rotation.IDENTITY
    for row, step in enumerate(measured):
        orientation[row + 1] = rotation.multiply(orientation[row], rotation.from_rotation_vector(step))
    # At the instant of the sample: the mean of the steps before and after it.
    rate = 0.5 * (np.concatenate([measured[:1], measured]) + np.concatenate([measured, measured[-1:]])) * RATE
    nan = np.full(n, np.nan)
    return Stream(
        info=info or SensorInfo(sensor, 1 / RATE),
        arrival=first_arrival + arrival_step * np.arange(n),
        epoch=np.zeros(n, np.int32),
        frame=np.arange(n),
        device_time=time.copy(),
        time=time.copy(),
        received=time.copy(),
        orientation=orientation,
        rate=rate,
        acceleration=rotation.rotate(rotation.inverse(world_from_sensor), frames.UP * frames.GRAVITY),
        flags=np.zeros(n, np.uint32),
        battery=nan,
        temperature=nan,
        rssi=nan,
    )


def mounted(rng: np.random.Generator) -> NDArray[np.float64]:
    """Return a rotation anywhere on the sphere of rotations."""
    return rotation.normalise(rng.normal(size=4))


def worn_take(
    places: tuple[Place, ...],
    seconds: float = 20.0,
    *,
    seed: int = 0,
    poses: tuple[Mark, ...] = (N_HOLD, BOW_HOLD),
    motion: Mapping[Place, NDArray[np.float64]] | None = None,
) -> tuple[Take, dict[Place, NDArray[np.float64]]]:
    """Return a take of exact sensors with random mountings, and the true world_from_segment of each place."""
    rng = np.random.default_rng(seed)
    time = np.arange(round(seconds * RATE) + 1) / RATE
    truth = {place: procedure(place, time) if motion is None else motion[place] for place in places}
    streams = []
    for row, place in enumerate(places):
        segment_from_sensor = mounted(rng)
        streams.append(
            stream(
                sensor_of(place),
                rotation.multiply(truth[place], segment_from_sensor),
                time,
                first_arrival=row,
                arrival_step=len(places),
            )
        )
    assignment = Assignment({place: sensor_of(place) for place in places})
    setup = Setup(assignment, stature=1.75, stature_known=True)
    return Take("test", "P001", "test", "", tuple(streams), poses, setup), truth
