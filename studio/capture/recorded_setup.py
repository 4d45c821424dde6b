"""What is written into a take of the facts in force when it begins."""

from dataclasses import replace
from datetime import UTC, datetime

from studio.core.live_solver import Solver
from studio.core.sample import SensorId
from studio.core.take import Calibration, CarriedAlignment, Setup


def calibrations_of(setup: Setup) -> dict[SensorId, Calibration]:
    """Return the calibration in force of each sensor that has one."""
    return {calibration.sensor: calibration for calibration in setup.calibrations}


def recorded_setup(setup: Setup, carried: CarriedAlignment | None, solver: Solver) -> Setup:
    """Return the setup of a take that begins now.

    A take that carries its body calibration may begin in motion: it is told what the filters have learned of the
    offsets, because none of its own samples shows them.
    """
    if carried is None:
        return replace(setup, carried=None)
    learned = {one.sensor: one for one in solver.learned_offsets(datetime.now(UTC).isoformat(timespec="seconds"))}
    return replace(setup, carried=carried, calibrations=tuple((calibrations_of(setup) | learned).values()))
