"""Holding a pose: what is counted, held, asked and told, in any order of events."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.capture.procedures.held_pose import DELAYS, HOLDS, PATIENCE, SETTLE, Cue, HeldPose, Kind, Phase, Wish
from studio.capture.procedures.judged_hold import Judged
from studio.core.body import PLACES, Place
from studio.core.errors import HeadingsUnknown, MovedDuringHold, PoseNotHeld, PoseTooShort
from studio.core.take import Alignment, LimbAlignment

LEGAL = {
    Phase.IDLE: {Phase.COUNTDOWN},
    Phase.COUNTDOWN: {Phase.HOLDING, Phase.IDLE},
    Phase.HOLDING: {Phase.JUDGING, Phase.IDLE},
    Phase.JUDGING: {Phase.JUDGED},
    Phase.JUDGED: {Phase.COUNTDOWN, Phase.IDLE},
}


def alignment(spread=0.5, source="bow"):
    limb = LimbAlignment((1.0, 0.0, 0.0, 0.0), 0.0, source, math.radians(3), math.radians(spread))
    return Alignment("n", 0.0, 3.0, dict.fromkeys(PLACES, limb))


def moved(*places, pose="n"):
    return MovedDuringHold(pose, tuple(place.value for place in places), tuple(5.0 for _ in places))


def run(hold, start, seconds, step=0.02):
    """Return what is told from ``start`` on, with its times."""
    told = []
    for n in range(round(seconds / step) + 1):
        now = start + n * step
        told += [(round(now, 2), piece) for piece in hold.tick(now)]
    return told


def held(hold, answer, start=0.0):
    """Hold the next pose and answer; return the time after it."""
    hold.start(start, 3)
    end = start + 3 + HOLDS[hold.pose] + SETTLE + 0.1
    run(hold, start, end - start)
    hold.answer(answer)
    return end


@pytest.mark.parametrize("delay", DELAYS)
def test_three_beeps_then_the_hold_then_the_mark(delay):
    hold = HeldPose()
    first = [(0.0, piece) for piece in hold.start(0.0, delay)]

    told = first + run(hold, 0.0, delay + 4.0)

    cues = [(time, piece) for time, piece in told if isinstance(piece, Cue)]
    assert [piece for _, piece in cues] == [Cue(Kind.COUNT, 3), Cue(Kind.COUNT, 2), Cue(Kind.COUNT, 1), Cue(Kind.HOLD)]
    assert [time for time, _ in cues] == pytest.approx([delay - 3, delay - 2, delay - 1, delay], abs=0.03)
    wishes = [piece for _, piece in told if isinstance(piece, Wish)]
    assert len(wishes) == 1
    mark = wishes[0].mark
    assert (mark.kind, mark.label) == ("pose", "n")
    assert mark.end - mark.time == pytest.approx(3.0)
    assert mark.time == pytest.approx(delay, abs=0.03)
    assert hold.phase is Phase.JUDGING


def test_a_bow_follows_and_is_held_for_two_seconds():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), None))
    assert (hold.done, hold.next_pose) == (("n",), "bow")

    hold.start(now, 3)
    wishes = [piece for _, piece in run(hold, now, 6.0) if isinstance(piece, Wish)]
    told = hold.answer(Judged(alignment(), None))

    assert wishes[0].mark.end - wishes[0].mark.time == pytest.approx(2.0)
    assert told == (Cue(Kind.DONE),)
    assert hold.next_pose is None


def test_each_limb_is_told_in_degrees_with_its_heading():
    hold = HeldPose()
    held(hold, Judged(alignment(spread=0.6), None))
    assert hold.outcome is not None
    assert [limb.place for limb in hold.outcome.limbs] == list(PLACES)
    assert {limb.grade for limb in hold.outcome.limbs} == {"good"}
    assert hold.outcome.worst == pytest.approx(0.6)
    assert {(limb.source, round(limb.heading_sigma)) for limb in hold.outcome.limbs} == {("bow", 3)}

    fair = HeldPose()
    held(fair, Judged(alignment(spread=1.4), None))
    assert fair.outcome is not None
    assert {limb.grade for limb in fair.outcome.limbs} == {"fair"}


def test_a_limb_that_moved_can_be_repeated_alone():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), moved(Place.LEFT_FOREARM)))
    assert hold.outcome is not None
    assert hold.outcome.moved == (Place.LEFT_FOREARM,)
    assert (hold.done, hold.phase) == ((), Phase.JUDGED)

    hold.start(now, 3, "n", hold.outcome.moved)
    wishes = [piece for _, piece in run(hold, now, 7.0) if isinstance(piece, Wish)]
    hold.answer(Judged(alignment(), None))

    assert wishes[0].only == {Place.LEFT_FOREARM}
    assert hold.done == ("n",)


def test_without_any_limb_that_held_still_the_whole_body_is_repeated():
    hold = HeldPose()
    now = held(hold, Judged(None, moved(*PLACES)))

    hold.start(now, 3, "n", (Place.LEFT_FOREARM,))

    assert hold.only == frozenset()


def test_unknown_headings_are_no_failure_while_a_pose_that_tells_them_is_to_come():
    unknown = HeadingsUnknown(tuple(place.value for place in PLACES))
    hold = HeldPose()
    now = held(hold, Judged(alignment(source="unknown"), unknown))
    assert hold.done == ("n",)

    hold.start(now, 3)
    run(hold, now, 6.0)
    told = hold.answer(Judged(alignment(source="unknown"), unknown))

    assert told == (Cue(Kind.FAILED),)
    assert hold.done == ("n",)


def test_a_reference_that_lies_too_far_back_is_held_again():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), None))

    held(hold, Judged(None, PoseTooShort("n", 0.0, 3.0, 120.0)), now)

    assert hold.next_pose == "n"


def test_a_reference_that_was_another_pose_is_held_again():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), None))

    held(hold, Judged(None, PoseNotHeld("n", ("left_thigh", "right_thigh"), "sit")), now)

    assert hold.next_pose == "n"


def test_repeating_the_reference_asks_for_the_bow_again():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), None))
    now = held(hold, Judged(alignment(), None), now)
    assert hold.next_pose is None

    hold.start(now, 3, "n")

    assert hold.next_pose == "n"


def test_a_repeated_reference_needs_no_bow_where_the_bow_from_before_still_tells():
    hold = HeldPose()
    now = held(hold, Judged(alignment(), None))
    now = held(hold, Judged(alignment(), None), now)
    hold.start(now, 3, "n")
    run(hold, now, 7.0)

    hold.answer(Judged(alignment(source="bow"), None))

    assert hold.done == ("n", "bow")
    assert hold.next_pose is None


def test_a_hold_that_nobody_judges_ends_by_itself():
    hold = HeldPose()
    hold.start(0.0, 3)

    told = run(hold, 0.0, 6.0 + SETTLE + PATIENCE + 0.5)

    assert told[-1][1] == Cue(Kind.FAILED)
    assert hold.outcome is not None
    assert not hold.outcome.answered
    assert hold.answer(Judged(alignment(), None)) == ()


def test_a_stall_beeps_once_and_holds_in_full():
    hold = HeldPose()
    hold.start(0.0, 10)

    assert hold.tick(8.5) == (Cue(Kind.COUNT, 2),)
    assert hold.tick(30.0) == (Cue(Kind.HOLD),)
    assert hold.tick(31.0) == ()
    assert hold.phase is Phase.HOLDING


EVENTS = st.lists(
    st.tuples(
        st.sampled_from(
            ["start", "tick", "tick", "tick", "cancel", "good", "bad", "partly", "choose", "repeat", "reset"]
        ),
        st.floats(0.0, 4.0),
    ),
    max_size=60,
)


@given(EVENTS)
def test_any_order_of_events_leaves_a_legal_state(events):
    hold = HeldPose()
    now, asked, answered = 0.0, 0, 0
    for event, passed in events:
        now += passed
        before = hold.phase
        told = act(hold, event, now)
        asked += sum(isinstance(piece, Wish) for piece in told)
        answered += sum(isinstance(piece, Cue) and piece.kind in (Kind.DONE, Kind.FAILED) for piece in told)
        after = hold.phase
        assert after is before or after in reachable(before), (event, before, after)
        assert (hold.outcome is not None) == (after is Phase.JUDGED) or after is Phase.IDLE
        assert set(hold.done) <= set(hold.sequence)
        assert hold.next_pose not in hold.done
        assert answered <= asked <= answered + 1 + sum(kind == "cancel" for kind, _ in events)
        assert 0.0 <= hold.progress(now) <= 1.0
        assert hold.is_running or not hold.only


def reachable(phase):
    """Return where one event may lead: a long step passes through a state."""
    return LEGAL[phase] | {further for near in LEGAL[phase] for further in LEGAL[near]}


def act(hold, event, now):
    if event == "tick":
        return hold.tick(now)
    if event in ("start", "repeat"):
        return hold.start(now, 3, hold.pose if event == "repeat" else None, PLACES[:1] if event == "repeat" else ())
    answers = {
        "good": Judged(alignment(), None),
        "bad": Judged(None, moved(*PLACES)),
        "partly": Judged(alignment(), moved(Place.HEAD)),
    }
    if event in answers:
        return hold.answer(answers[event])
    if event == "cancel":
        hold.cancel()
    elif event == "choose":
        hold.choose(("t", "bow"))
    elif not hold.is_running:
        hold.reset()
    return ()
