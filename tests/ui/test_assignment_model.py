"""Who wears what: never two tags on one place, everything can be taken back."""

from hypothesis import given
from hypothesis import strategies as st

from studio.core.body import PLACES, PRESETS, Place
from studio.core.sample import SensorId
from studio.core.take import Assignment
from studio.ui.models.assignment_model import AssignmentModel, KnownSensor, PlaceState, SensorState


def sensor(number, state=SensorState.GOOD):
    return KnownSensor(SensorId(f"tag:{number:08x}"), number, f"tag {number:02d}", state)


def model_with(*numbers, worn=()):
    model = AssignmentModel()
    model.set_sensors([sensor(number) for number in numbers])
    model.adopt(Assignment({PLACES[number - 1]: sensor(number).sensor for number in worn}))
    return model


def told(model):
    heard: list[Assignment] = []
    model.assignment_changed.connect(heard.append)
    return heard


def test_a_place_and_then_a_tag_or_a_tag_and_then_a_place():
    model = model_with(1, 2)
    heard = told(model)

    model.choose_place(Place.CHEST)
    model.choose_sensor(sensor(1).sensor)
    model.choose_sensor(sensor(2).sensor)
    model.choose_place(Place.PELVIS)

    assert dict(heard[-1].sensors) == {Place.CHEST: sensor(1).sensor, Place.PELVIS: sensor(2).sensor}
    assert (model.place, model.sensor, model.unassigned) == (None, None, ())


def test_a_tag_that_comes_to_a_taken_place_frees_the_other():
    model = model_with(1, 2, worn=(1,))

    model.assign(Place.HEAD, sensor(2).sensor)

    assert dict(model.assignment.sensors) == {Place.HEAD: sensor(2).sensor}
    assert [known.number for known in model.unassigned] == [1]


def test_a_tag_that_is_worn_moves():
    model = model_with(1, worn=(1,))

    model.assign(Place.LEFT_FOOT, sensor(1).sensor)

    assert dict(model.assignment.sensors) == {Place.LEFT_FOOT: sensor(1).sensor}


def test_two_places_exchange_their_tags():
    model = model_with(3, 4, worn=(3, 4))

    model.choose_place(Place.LEFT_UPPER_ARM)
    model.begin_exchange()
    model.choose_place(Place.RIGHT_UPPER_ARM)

    assert model.worn_at(Place.LEFT_UPPER_ARM) == sensor(4)
    assert model.worn_at(Place.RIGHT_UPPER_ARM) == sensor(3)
    assert not model.is_exchanging


def test_shanks_and_feet_are_exchanged_in_one_step_and_back_in_one():
    model = model_with(*range(9, 16), worn=range(9, 16))
    heard = told(model)

    model.exchange_shanks_and_feet()
    crossed = {place: known.number for place in PLACES[11:] if (known := model.worn_at(place))}
    model.undo()

    assert crossed == {
        Place.LEFT_SHANK: 14,
        Place.RIGHT_SHANK: 15,
        Place.LEFT_FOOT: 12,
        Place.RIGHT_FOOT: 13,
    }
    assert model.worn_at(Place.LEFT_SHANK) == sensor(12)
    assert len(heard) == 2


def test_all_legs_are_recognised_as_the_legs():
    assert model_with(*range(9, 16), worn=range(9, 16)).preset == "lower"


def test_a_preset_takes_off_what_it_does_not_want_and_gives_it_back():
    model = model_with(*range(1, 16), worn=range(1, 16))

    model.choose_preset("upper")
    assert model.assignment.places() == PRESETS["upper"]
    assert model.look(Place.LEFT_FOOT).state is PlaceState.EMPTY
    model.undo()

    assert model.assignment.places() == PLACES
    assert model.preset == "full"


def test_numbers_lead_tags_to_their_places_unless_two_claim_one():
    model = AssignmentModel()
    twin = KnownSensor(SensorId("tag:000000aa"), 2, "tag 02", SensorState.GOOD)
    model.set_sensors([sensor(1), sensor(2), twin, sensor(5)])

    model.assign_by_number()

    assert model.assignment.places() == (Place.HEAD, Place.LEFT_FOREARM)


def test_the_moved_tag_goes_to_the_place_that_waits_and_the_next_one_waits():
    model = model_with(1, 2, 3)
    model.begin_moving()
    assert told_to_wait(model) is Place.HEAD

    model.moved(sensor(2).sensor)
    model.moved(sensor(2).sensor)  # it goes on moving while it is strapped on
    model.moved(SensorId("tag:ffffffff"))
    assert told_to_wait(model) is Place.CHEST
    model.moved(sensor(1).sensor)

    worn = {place: known.number for place in PLACES if (known := model.worn_at(place))}
    assert worn == {Place.HEAD: 2, Place.CHEST: 1}
    model.undo()
    assert model.waiting is Place.CHEST


def told_to_wait(model) -> Place | None:
    waiting: Place | None = model.waiting
    return waiting


def test_moving_ends_when_every_place_has_a_tag():
    model = model_with(*range(1, 16), worn=range(1, 15))
    model.begin_moving()

    model.moved(sensor(15).sensor)

    assert model.waiting is None


def test_a_tag_that_was_never_heard_is_silent():
    model = model_with(1)
    model.adopt(Assignment({Place.CHEST: SensorId("tag:000000bb")}))

    look = model.look(Place.CHEST)

    assert look.state is PlaceState.WARNING
    assert look.sensor is not None
    assert look.sensor.state is SensorState.SILENT


def test_what_was_decided_elsewhere_is_not_told_again():
    model = model_with(1, 2)
    heard = told(model)

    model.adopt(Assignment({Place.CHEST: sensor(1).sensor}))

    assert heard == []
    assert not model.can_undo


NAMES = (
    *("place", "place", "sensor", "sensor", "assign", "exchange", "cross", "begin", "clear_place", "clear"),
    *("undo", "redo", "preset", "move", "moved", "end", "number", "adopt"),
)
ACTIONS = st.lists(
    st.tuples(
        st.sampled_from(NAMES),
        st.integers(0, 14),
        st.integers(0, 19),
    ),
    max_size=60,
)


@given(ACTIONS)
def test_whatever_is_pressed_a_place_has_one_tag_and_undo_leads_back(actions):
    model = model_with(*range(1, 21))
    heard = told(model)
    for action, place, number in actions:
        act(model, action, PLACES[place], sensor(number + 1).sensor)
        worn = list(model.assignment.sensors.values())
        assert len(worn) == len(set(worn))
        assert {known.sensor for known in model.unassigned} | set(worn) == {sensor(n).sensor for n in range(1, 21)}
        assert model.waiting is None or model.waiting not in model.assignment.sensors
        if action != "adopt" and heard:
            assert heard[-1].sensors == model.assignment.sensors or "adopt" in [name for name, _, _ in actions]
    end = dict(model.assignment.sensors)
    steps = 0
    while model.can_undo:
        model.undo()
        steps += 1
    for _ in range(steps):
        model.redo()
    assert dict(model.assignment.sensors) == end


def act(model, action, place, who):
    plain = {
        "cross": model.exchange_shanks_and_feet,
        "begin": model.begin_exchange,
        "clear_place": model.clear_place,
        "clear": model.clear,
        "undo": model.undo,
        "redo": model.redo,
        "move": model.begin_moving,
        "end": model.end_moving,
        "number": model.assign_by_number,
    }
    if action in plain:
        plain[action]()
    elif action == "place":
        model.choose_place(place)
    elif action in ("sensor", "moved"):
        (model.choose_sensor if action == "sensor" else model.moved)(who)
    elif action == "assign":
        model.assign(place, who)
    elif action == "exchange":
        model.exchange(place, PLACES[place.number % 15])
    elif action == "preset":
        model.choose_preset(("full", "upper", "lower", "custom")[place.number % 4])
    else:
        model.adopt(Assignment({place: who}))
