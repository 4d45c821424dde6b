"""The facts in force: who wears which sensor and how tall they are, and what is remembered of it for the next time."""

import contextlib
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import msgspec

from studio.core.body import DEFAULT_STATURE, PLACES
from studio.core.errors import RecordingError, WrittenByNewerStudio
from studio.core.rest import Rest
from studio.core.sample import NO_CORRECTION, Correction, SensorId, SensorInfo
from studio.core.take import Assignment, Calibration, Setup
from studio.storage.person_file import Person, load_person, save_person


def assigned_by_number(infos: Mapping[SensorId, SensorInfo]) -> Assignment:
    """Return tag number k on row k of paper 003's Table 1; numbers that two tags claim stay unassigned."""
    claimed = Counter(info.number for info in infos.values())
    return Assignment(
        {
            PLACES[info.number - 1]: sensor
            for sensor, info in infos.items()
            if 1 <= info.number <= len(PLACES) and claimed[info.number] == 1
        }
    )


def setup_for(infos: Mapping[SensorId, SensorInfo], offered: Setup | None, person: Person) -> Setup:
    """Return the setup of a recording that is about to start.

    Parameters
    ----------
    offered : Setup or None
        What the source itself knows; it wins.
    person : Person
        Stature, and what was worn last: used for the sensors that are there again.
    """
    if offered is not None:
        present = {place: sensor for place, sensor in offered.assignment.sensors.items() if sensor in infos}
        return replace(offered, assignment=Assignment(present))
    worn = {place: sensor for place, sensor in person.assignment.sensors.items() if sensor in infos}
    return Setup(
        Assignment(worn) if worn else assigned_by_number(infos),
        stature=DEFAULT_STATURE if person.stature is None else person.stature,
        stature_known=person.stature is not None,
        # Tags come with an arrow and pictures of the places; foreign recordings do not pass here.
        mounting="strapped",
    )


def with_stature(library: Path, code: str, stature: float | None) -> float | None:
    """Return the stature in m of a person, None when unknown; one that is told is kept for who has a code.

    Raises
    ------
    SetupError, RecordingError, TakeFileError
    """
    if not code:
        return stature
    person = load_person(library, code)
    if stature is None:
        return person.stature
    save_person(library, code, msgspec.structs.replace(person, stature=stature))
    return stature


def remember(library: Path, person: str, setup: Setup) -> None:
    """Keep stature and assignment of a person for the next time; a library that cannot be written is told elsewhere."""
    stature = setup.stature if setup.stature_known else None
    with contextlib.suppress(RecordingError, WrittenByNewerStudio):
        save_person(library, person, Person(stature=stature, assignment=setup.assignment, mounting=setup.mounting))


def rest_calibration(info: SensorInfo, rest: Rest, date: str) -> Calibration:
    """Return a gyroscope's correction by the offset it showed while it lay still; its gain stays."""
    x, y, z = (float(value) for value in rest.offset)
    sx, sy, sz = (float(value) for value in rest.sigma)
    gain = (info.correction or NO_CORRECTION).gain
    return Calibration(info.sensor, Correction((x, y, z), gain), date, "rest", offset_sigma=(sx, sy, sz))
