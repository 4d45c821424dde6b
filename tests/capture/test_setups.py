"""Who wears which sensor when nobody says so now."""

from studio.capture.setups import assigned_by_number, setup_for
from studio.core.body import Place
from studio.core.sample import SensorId, SensorInfo
from studio.core.take import Assignment, Setup
from studio.storage.person_file import Person


def tags(*numbers):
    infos = [SensorInfo(SensorId(f"tag:{index:08x}"), 0.02, number=number) for index, number in enumerate(numbers)]
    return {info.sensor: info for info in infos}


def test_the_number_on_the_tag_is_its_row_in_table_1():
    worn = assigned_by_number(tags(1, 9, 15)).sensors

    assert [place.value for place in worn] == ["head", "pelvis", "right_foot"]


def test_two_tags_with_one_number_and_tags_without_stay_unassigned():
    assert list(assigned_by_number(tags(2, 2, 0, 3)).sensors) == [Place.LEFT_UPPER_ARM]


def test_what_was_worn_last_wins_for_the_tags_that_are_there_again():
    infos = tags(1, 2)
    first = next(iter(infos))
    gone = SensorId("tag:ffffffff")
    person = Person(stature=1.62, assignment=Assignment({Place.PELVIS: first, Place.HEAD: gone}))

    setup = setup_for(infos, None, person)

    assert dict(setup.assignment.sensors) == {Place.PELVIS: first}
    assert (setup.stature, setup.stature_known, setup.mounting) == (1.62, True, "strapped")


def test_a_source_that_knows_its_body_is_believed():
    infos = tags(5)
    sensor = next(iter(infos))
    offered = Setup(
        Assignment({Place.CHEST: sensor, Place.HEAD: SensorId("tag:ffffffff")}), stature=1.8, mounting="unknown"
    )

    setup = setup_for(infos, offered, Person())

    assert dict(setup.assignment.sensors) == {Place.CHEST: sensor}
    assert (setup.stature, setup.mounting) == (1.8, "unknown")
