"""Every refusal reaches the operator as plain sentences: what happened, why, what to do."""

import math
import re
import typing
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from studio.core import errors
from studio.core.errors import DiskFull, MovedDuringHold, NoData, PersonCodeInvalid, PortBusy, StudioError
from studio.ui.fact_words import duration
from studio.ui.wording import MESSAGE_OF, TEMPLATES, one_line, placeholders, sentences

JARGON = re.compile(
    r"\b(exceptions?|tracebacks?|stack|null|none type|nan|inf|parsing|parsed?|invalid|illegal|abort(ed)?|fatal|"
    r"unknown error|buffer|thread|byte|bytes|crc|checksum|decode[dr]?|stderr|stdout|boolean|string|float|tuple|object|"
    r"quaternions?|mcap header|i/o)\b",
    re.IGNORECASE,
)

FACTS: dict[Any, list[Any]] = {
    str: ["left_forearm", "", "a\u202eb\x1b[31m\n", "x" * 4000, "{path}"],
    int: [0, 1, 1_234_567],
    float: [0.0, 12.34, 724.3, -1.0, math.nan, math.inf, -math.inf],
    tuple[str, ...]: [(), ("left_forearm",), ("tag:1", "tag:2"), tuple(f"tag:{n}" for n in range(40))],
    tuple[float, ...]: [(), (4.25,), (4.25, math.nan), (math.inf,) * 20],
}


def kinds(group: type[StudioError] = StudioError) -> Iterator[type[StudioError]]:
    below = group.__subclasses__()
    for kind in below:
        yield from kinds(kind)
    if not below:
        yield group


KINDS = sorted(kinds(), key=lambda kind: kind.__name__)


def examples(kind: type[StudioError]) -> Iterator[StudioError]:
    """Make errors of one kind, each fact once with each of its awkward values."""
    types = typing.get_type_hints(kind)
    names = [field.name for field in fields(kind)]
    plain = {name: FACTS[types[name]][1] for name in names}
    yield kind(**plain)
    for name in names:
        for value in FACTS[types[name]]:
            yield kind(**{**plain, name: value})


def test_the_words_cover_every_error_and_no_group():
    assert set(MESSAGE_OF) == set(KINDS)
    assert {kind.__module__ for kind in KINDS} == {errors.__name__}


def test_every_message_is_reached_by_some_error():
    reached = {sentences(error).id for kind in KINDS for error in examples(kind)}

    assert reached == set(TEMPLATES)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_a_message_asks_only_for_facts_of_its_error(kind: type[StudioError]):
    known = {field.name for field in fields(kind)}

    for error in examples(kind):
        template = TEMPLATES[sentences(error).id]
        assert set().union(*(placeholders(part) for part in template[1:])) <= known


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_each_part_is_whole_sentences_in_one_line(kind: type[StudioError]):
    for error in examples(kind):
        message = sentences(error)
        for template, part in zip(TEMPLATES[message.id][1:], message[1:], strict=True):
            assert part.endswith(".")
            assert part.isprintable()
            assert part[0] == part[0].upper() or template.startswith("{")  # a path keeps its first letter
        assert "\n" not in one_line(error)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
def test_no_message_names_a_class_or_leaves_a_number_that_is_none(kind: type[StudioError]):
    for error in examples(kind):
        text = one_line(error)
        assert kind.__name__ not in text
        assert not re.search(r"\b(nan|inf|None)\b", text)


@pytest.mark.parametrize("template", TEMPLATES.values(), ids=TEMPLATES.keys())
def test_templates_use_words_a_clinician_knows(template: tuple[str, ...]):
    name, *parts = template

    assert re.fullmatch(r"(con|cal|set|rec|open|imp|exp)\.[a-z_]+", name)
    assert not JARGON.search(" ".join(parts))
    assert all(re.fullmatch(r"[A-Z“{].*[.]", part) for part in parts)


def test_the_jargon_test_would_notice():
    assert JARGON.search("An exception was raised while parsing bytes.")


def test_a_port_in_use_says_so():
    assert one_line(PortBusy("COM5")) == (
        "COM5 is in use by another program. Only one program at a time can listen to a port. "
        "Close the other program, for example the Arduino serial monitor, and try again."
    )


def test_limbs_and_numbers_read_as_people_say_them():
    message = sentences(MovedDuringHold("n", ("left_forearm", "right_shank"), (4.04, 6.96)))

    assert message.what == "Left forearm and right shank moved while the N-pose was held."
    assert message.why == "The movement was 4.0° and 7.0°."


def test_a_full_disk_tells_whether_anything_was_kept():
    assert sentences(DiskFull("takes", 0.0)).id == "rec.no_room"
    assert sentences(DiskFull("takes", 724.3)).why == "12 min 04.3 s of the recording are safe in takes."


def test_silence_and_garbage_are_told_apart():
    assert sentences(NoData("serial:COM5", 0)).id == "con.none"
    assert sentences(NoData("serial:COM5", 1200)).why.startswith("1,200 pieces came from")


def test_words_of_strangers_can_neither_colour_nor_reverse_the_terminal():
    line = one_line(PersonCodeInvalid("\x1b[31mJohn\u202e\r\nDoe\u0007"))

    assert line.startswith("“[31mJohn  Doe” cannot stand for a person.")


@given(st.floats(allow_nan=True, allow_infinity=True, width=32))
def test_every_time_span_is_readable(seconds: float):
    assert re.fullmatch(r"-?\d+ min [0-5]\d\.\d s|-?[1-5]?\d\.\d s|an unknown time", duration(seconds))


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.0, "0.0 s"), (-0.01, "0.0 s"), (59.96, "1 min 00.0 s"), (59.94, "59.9 s"), (3599.99, "60 min 00.0 s")],
)
def test_time_spans_carry_into_minutes(seconds: float, words: str):
    assert duration(seconds) == words
