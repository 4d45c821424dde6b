"""F35: a take of a stranger, right in every checksum, claims what cannot be: refused by name, or left out and counted.

Nothing but a refusal may come of it, in reading, listing and solving; a claim cannot cost more memory than its file.
"""

import contextlib
import copy
import json
import math
import tracemalloc
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.analysis.ledger import ledger
from studio.core.body import PRESETS
from studio.core.errors import StudioError, TakeFileError, TakeUnsafe
from studio.core.sample import NO_CORRECTION
from studio.core.solver import SolveOptions, solve
from studio.core.take import Calibration, Mark
from studio.storage import limits
from studio.storage.blocks import BlockBuilder
from studio.storage.profile import BLOCK_HEAD_SIZE
from studio.storage.take_json import TakeDocument, load_document, save_document
from studio.storage.take_reader import read_events, read_take
from studio.storage.take_summary import summarise
from tests.core.worn_sensors import worn_take
from tests.storage.forged_takes import Claims, claims_of, places_in, put

MUTANTS = 1000
NAN, INF = math.nan, math.inf
IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


@pytest.fixture(scope="module")
def honest() -> Claims:
    take, _ = worn_take(PRESETS["lower"], 10.0)
    sensor = take.streams[0].info.sensor
    calibration = Calibration(sensor, NO_CORRECTION, "2026-11-24T09:00:00+00:00", "rest", (0.01, 0.01, 0.01))
    setup = replace(take.setup, calibrations=(calibration,))
    return claims_of(replace(take, name="walk", setup=setup, versions={"studio": "0"}, started="2026-11-24T10:00:00Z"))


@pytest.fixture
def claims(honest: Claims) -> Claims:
    return copy.deepcopy(honest)


def test_what_an_honest_take_says_is_believed(claims: Claims, tmp_path: Path) -> None:
    take, report = read_take(claims.write(tmp_path))

    assert (report.damaged, report.samples) == (0, len(claims.rows))
    assert solve(take).motion.measured


REFUSED: dict[str, tuple[str, Callable[[Claims], None]]] = {
    "no stature": ("stature", lambda c: put(c.identity, ("setup", "stature"), -1.0)),
    "a stature of a house": ("stature", lambda c: put(c.identity, ("setup", "stature"), 99.0)),
    "suit number 0": ("performer", lambda c: put(c.identity, ("setup", "performer"), 0)),
    "a gain without an inverse": (
        "gain",
        lambda c: put(c.identity, ("setup", "calibrations", 0, "correction", "gain"), [IDENTITY[0]] * 3),
    ),
    "a gain of a million": (
        "gain",
        lambda c: put(c.identity, ("setup", "calibrations", 0, "correction", "gain", 1, 1), 1e6),
    ),
    "an offset of a turbine": (
        "gain",
        lambda c: put(c.identity, ("setup", "calibrations", 0, "correction", "offset", 0), 1e8),
    ),
    "a novel for a date": ("setup", lambda c: put(c.identity, ("setup", "calibrations", 0, "date"), "x" * 5000)),
    "thousands of calibrations": (
        "setup",
        lambda c: put(c.identity, ("setup", "calibrations"), c.identity["setup"]["calibrations"] * 5000),
    ),
    "one sensor on two places": (
        "contradicts",
        lambda c: put(c.identity, ("setup", "assignment", "sensors", "head"), c.sensors[0]["info"]["sensor"]),
    ),
    "a clock beyond the age of the world": ("monotonic", lambda c: put(c.identity, ("anchor", "monotonic"), 1e30)),
    "a zero beyond it": ("zero_s", lambda c: put(c.sensors[0], ("zero_s",), -1e30)),
    "a frame of nothing": ("frame_s", lambda c: put(c.sensors[0], ("info", "frame_s"), 1e-9)),
    "a frame of years": ("frame_s", lambda c: put(c.sensors[0], ("info", "frame_s"), 1e9)),
    "a frame that runs backwards": ("frame_s", lambda c: put(c.sensors[0], ("info", "frame_s"), -0.02)),
}


@pytest.mark.parametrize("what", REFUSED)
def test_a_claim_about_the_whole_that_cannot_be_is_refused_by_its_name(
    claims: Claims, tmp_path: Path, what: str
) -> None:
    field, change = REFUSED[what]
    change(claims)
    folder = claims.write(tmp_path)

    with pytest.raises(TakeUnsafe, match=field):
        read_take(folder)
    assert isinstance(summarise(folder).refusal, TakeUnsafe)


def test_more_sensors_than_any_take_has_are_refused(claims: Claims, tmp_path: Path) -> None:
    claims.sensors = [{"zero_s": 0.0, "info": {"sensor": f"tag:{n:08X}", "frame_s": 0.02}} for n in range(300)]

    with pytest.raises(TakeUnsafe, match="sensors"):
        read_take(claims.write(tmp_path))


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("time", NAN),
        ("time", INF),
        ("time", 1e12),
        ("time", -1e5),
        ("time", -20.0),
        ("frame", -(2**63)),
        ("frame", 2**60),
        ("epoch", -1),
        ("epoch", 2**31 - 1),
    ],
)
def test_a_sample_that_has_no_place_in_time_is_left_out_and_counted(
    claims: Claims, tmp_path: Path, field: str, value: float
) -> None:
    claims.rows[field][2500] = value
    number = int(claims.rows["sequence"][2500])

    take, report = read_take(claims.write(tmp_path))

    assert (report.damaged, report.samples) == (1, len(claims.rows) - 1)
    assert not any(number in stream.arrival for stream in take.streams)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("orientation", 0.0),
        ("orientation", 1e200),
        ("orientation", INF),
        ("rate", 1e5),
        ("rate", -INF),
        ("acceleration", 1e9),
        ("battery", INF),
        ("temperature", 1e300),
        ("rssi", -1e20),
    ],
)
def test_a_reading_no_sensor_gives_becomes_unknown_and_is_counted(
    claims: Claims, tmp_path: Path, field: str, value: float
) -> None:
    claims.rows[field][2500] = value
    number = int(claims.rows["sequence"][2500])

    take, report = read_take(claims.write(tmp_path))

    assert (report.damaged, report.samples) == (1, len(claims.rows))
    stream = next(stream for stream in take.streams if number in stream.arrival)
    assert np.isnan(getattr(stream, field)[stream.arrival == number]).all()


def test_a_correction_no_gyroscope_needs_counts_as_not_told(claims: Claims, tmp_path: Path) -> None:
    claims.sensors[0]["info"]["correction"] = {"offset": [0, 0, 0], "gain": [[0, 0, 0]] * 3}
    claims.sensors[1]["info"]["correction"] = {"offset": [0, 0, 0], "gain": IDENTITY}

    take, _ = read_take(claims.write(tmp_path))

    assert [stream.info.correction for stream in take.streams[:2]] == [None, NO_CORRECTION]


@pytest.mark.parametrize("mark", [{"time": 1e12}, {"time": -1e12}, {"time": 1.0, "end": 1e15}])
def test_a_mark_outside_of_any_take_is_left_out_and_counted(
    claims: Claims, tmp_path: Path, mark: dict[str, Any]
) -> None:
    claims.events.append({"kind": "mark", "received": 1.0, "facts": {"kind": "marker", **mark}})

    take, report = read_take(claims.write(tmp_path))

    assert report.damaged == 1
    assert [mark.kind for mark in take.marks] == ["pose", "pose"]


def test_long_texts_are_cut_and_times_that_are_none_are_unknown(claims: Claims, tmp_path: Path) -> None:
    endless = "\u202e" + "x" * 10_000
    claims.identity |= {"name": endless, "person": endless, "source": endless, "versions": {endless: endless}}
    claims.identity["anchor"]["utc"] = endless
    claims.events.append({"kind": "mark", "received": 0, "facts": {"kind": endless, "label": endless, "time": 1.0}})
    folder = claims.write(tmp_path)

    take, _ = read_take(folder)

    cut = "x" * limits.LONGEST_LABEL
    assert (take.name, take.person, take.source, take.started) == (cut, cut, cut, "")
    assert take.versions == {cut: cut}
    assert (take.marks[-1].kind, take.marks[-1].label) == (cut, cut)
    assert summarise(folder).name == cut


def test_two_samples_a_week_apart_do_not_cost_the_memory_of_a_week(claims: Claims, tmp_path: Path) -> None:
    claims.rows = claims.rows[:200]
    claims.rows["time"][-1] = limits.LONGEST_TAKE - 1.0

    with pytest.raises(TakeUnsafe, match="time"):
        read_take(claims.write(tmp_path))


@pytest.mark.parametrize("position", [0, 100, -2])
def test_a_sample_days_ahead_of_those_around_it_is_left_out_and_counted(
    claims: Claims, tmp_path: Path, position: int
) -> None:
    row = np.flatnonzero(claims.rows["channel"] == 2)[position]
    claims.rows["time"][row] = 3 * 86400.0
    folder = claims.write(tmp_path)

    take, report = read_take(folder)

    assert (report.damaged, report.samples) == (1, len(claims.rows) - 1)
    assert take.duration() == pytest.approx(10.0, abs=0.1)


def test_a_sensor_that_was_away_for_a_minute_is_believed(claims: Claims, tmp_path: Path) -> None:
    rows = np.flatnonzero(claims.rows["channel"] == 2)
    claims.rows["time"][rows[200:]] += 60.0

    assert read_take(claims.write(tmp_path))[1].damaged == 0


def test_a_count_that_runs_ahead_of_its_samples_does_not_cost_their_memory(claims: Claims, tmp_path: Path) -> None:
    claims.sensors[0]["info"]["frame_s"] = limits.SHORTEST_FRAME
    first = claims.rows["channel"] == 2
    claims.rows["frame"][first] = np.arange(first.sum()) * 9_999

    with pytest.raises(TakeUnsafe, match="frame"):
        read_take(claims.write(tmp_path))


def test_a_take_json_that_says_what_cannot_be_counts_as_damaged(claims: Claims, tmp_path: Path) -> None:
    folder = claims.write(tmp_path)
    take, _ = read_take(folder)
    for document in (
        TakeDocument(setup=replace(take.setup, stature=-1.0)),
        TakeDocument(marks=(Mark(1e30, "marker"),)),
        TakeDocument(marks=(Mark(1.0, "marker", "x" * 100_000),)),
        TakeDocument(notes="x" * 1_000_000),
    ):
        save_document(folder, document)

        assert load_document(folder, "walk", repair=False)[1] == "damaged"
        assert repr(read_take(folder)[0].setup) == repr(take.setup)


NUMBERS = (0.0, -1.0, 1e-300, 1e-5, 0.5, 99.0, 1e5, 1e9, 1e12, 1e300, -1e300, NAN, INF, -INF)
WHOLE = (0, -1, 255, 2**31 - 1, -(2**31), 2**53, 2**63 - 1, -(2**63))
JSON: tuple[Any, ...] = (
    *NUMBERS[:11],
    *WHOLE,
    "",
    "n",
    "bow",
    "\u202e\x00",
    "x" * 3000,
    None,
    True,
    [],
    {},
    [[]],
    [1e300] * 4,
)


def mutate(claims: Claims, random: np.random.Generator) -> None:
    """Change one to three things, of any kind."""
    for _ in range(random.integers(1, 4)):
        what = random.integers(5)
        if what < 2:
            fields = [
                name for name in claims.rows.dtype.names or () if name not in ("opcode", "length", "log_time", "cdr")
            ]
            field = claims.rows[fields[random.integers(len(fields))]]
            rows = random.random(len(field)) < random.choice([2 / len(field), 0.1, 1.0])
            limit = np.iinfo(field.dtype) if field.dtype.kind in "iu" else None
            chosen = WHOLE if limit else NUMBERS
            values = np.array([chosen[random.integers(len(chosen))] for _ in range(3)])
            if limit:
                values = np.clip(values.astype(object), int(limit.min), int(limit.max)).astype(field.dtype)
            field[rows] = random.choice(values, (int(rows.sum()), *field.shape[1:]))
            continue
        text = (claims.identity, claims.sensors, claims.events)[what - 2]
        places = places_in(text)
        new = JSON[random.integers(len(JSON))]
        if places:
            put(text, places[random.integers(len(places))], copy.deepcopy(new))


def forged(honest: Claims, folder: Path, count: int, seed: int) -> Iterator[Path]:
    """Write takes with changed claims, one after the other into the same folder, and yield it each time."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        mutant = copy.deepcopy(honest)
        mutate(mutant, random)
        try:
            yield mutant.write(folder)
        except (KeyError, TypeError, AttributeError, IndexError):  # a sensor without a name has no channel
            continue


@pytest.mark.parametrize("part", range(4))
def test_nothing_but_a_refusal_comes_of_any_claim(honest: Claims, tmp_path: Path, part: int) -> None:
    used = refused = 0
    for number, folder in enumerate(forged(honest, tmp_path, MUTANTS // 4, seed=part)):
        summarise(folder)
        try:
            take, _ = read_take(folder)
            read_events(folder)
            ledger(take)
            if number % 4 == 0:
                solve(take, SolveOptions(method="live" if number % 64 == 0 else "offline"))
            used += 1
        except TakeFileError:
            refused += 1
        except StudioError:
            pass

    assert min(used, refused) >= MUTANTS // 200


def test_no_claim_costs_more_memory_than_its_file(honest: Claims, tmp_path: Path) -> None:
    peak = 0
    for folder in forged(honest, tmp_path, 100, seed=8):
        tracemalloc.start()
        summarise(folder)
        with contextlib.suppress(StudioError):
            read_take(folder)
        peak = max(peak, tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()

    assert peak < 20 << 20  # the file has 0.6 MB; the summary looks at windows of up to 16 MB


def test_samples_that_are_read_again_and_again_are_not_kept(honest: Claims, tmp_path: Path) -> None:
    """Block heads one after the other, each of a block with the same chunk in it: 100 times what the file has."""
    folder = honest.write(tmp_path)
    chunk = BlockBuilder(b"stranger", 1)
    chunk.add_rows(honest.rows)
    body = b"".join(chunk.parts)
    for number in range(200, 100, -1):
        head = BlockBuilder(b"stranger", number, [body[:-1] + b"?"]).finish().data[:BLOCK_HEAD_SIZE]  # a wrong CRC
        body = b"\x90" + BLOCK_HEAD_SIZE.to_bytes(8, "little") + head + body
    with (folder / "take.mcap").open("ab") as file:
        file.write(body)

    with pytest.raises(TakeUnsafe, match="samples"):
        read_take(folder)


def test_nothing_but_a_refusal_comes_of_any_take_json(honest: Claims, tmp_path: Path) -> None:
    random = np.random.default_rng(9)
    folder = honest.write(tmp_path)
    take, _ = read_take(folder)
    document = TakeDocument(name="walk", marks=take.marks, notes="limps", setup=take.setup)
    save_document(folder, document)
    whole = json.loads((folder / "take.json").read_text())
    states = set()
    for number in range(MUTANTS // 4):
        mutant = copy.deepcopy(whole)
        places = places_in(mutant)
        put(mutant, places[random.integers(len(places))], JSON[random.integers(len(JSON))])
        (folder / "take.json").write_text(json.dumps(mutant))
        summarise(folder)
        found, report = read_take(folder)
        states.add(report.document)
        with contextlib.suppress(StudioError):
            if number % 5 == 0:
                solve(found)

    assert {"kept", "damaged"} <= states
