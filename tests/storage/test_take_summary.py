"""The list of takes shows what reading the whole take would, and lists what cannot be read with the reason."""

import math
import shutil
from dataclasses import replace
from datetime import date
from pathlib import Path

import numpy as np
import pytest

from studio.analysis.ledger import ledger
from studio.core.body import Place
from studio.core.errors import NotATake, WrittenByNewerStudio
from studio.core.take import Take
from studio.storage.encoder import TakeEncoder
from studio.storage.facts import Anchor, identity
from studio.storage.filesystem import FILES
from studio.storage.recovery import recover
from studio.storage.take_ends import WINDOWS
from studio.storage.take_file import TakeFile
from studio.storage.take_json import TakeDocument, load_document, save_document
from studio.storage.take_reader import read_take
from studio.storage.take_store import write_take
from studio.storage.take_summary import TakeSummary, keep_summary, summaries, summarise
from tests.export.small_take import small_take
from tests.storage.recordings import RATE, SETUP, START, TAGS, info, samples, start_writing

MUTANTS = 300


def record(library: Path, frames: int = 50, name: str = "walk", lose: int = 0) -> Path:
    writer = start_writing(library, name=name)
    for number, one in enumerate(samples(frames)):
        if not lose or number % lose or number < 15 or number >= (frames - 1) * 15:
            writer.sample(one)
    writer.raw("usb0", START + 0.3, bytes(27))
    return writer.stop().result().folder


def record_in_blocks(library: Path, frames: int) -> Path:
    """Record as a slow hand would: ten frames in each block."""
    encoder = TakeEncoder(identity("walk", "P014", "synthetic", SETUP, {"studio": "0"}, Anchor("", START)))
    file = TakeFile(library / "P014" / "2026-11-24a", "walk", encoder, FILES)
    for tag in TAGS:
        encoder.add_sensor(info(tag))
    kept = samples(frames)
    for first in range(0, len(kept), 150):
        for block in encoder.blocks(kept[first : first + 150], [], []):
            file.append(block)
    return file.finish().folder


def share_lost(take: Take) -> float:
    accounts = ledger(take)
    lost = sum(account.lost for account in accounts)
    return lost / (lost + sum(account.samples for account in accounts))


def test_a_finished_take_is_summed_up_as_it_would_be_read(tmp_path: Path) -> None:
    folder = record(tmp_path, frames=300, lose=7)

    summary = summarise(folder)

    take, report = read_take(folder)
    assert (summary.name, summary.person, summary.session) == ("walk", "P014", "2026-11-24a")
    assert summary.started == take.started
    assert summary.duration_s == take.duration()
    assert (summary.samples, summary.sensors) == (report.samples, len(take.streams))
    assert summary.lost == pytest.approx(share_lost(take))
    assert 0.1 < summary.lost < 0.2
    assert summary.frame_s == 1 / RATE
    assert summary.places == (Place.PELVIS, Place.LEFT_THIGH)
    assert not summary.recovered
    assert summary.refusal is None


def test_an_imported_take_whose_blocks_are_larger_is_summed_up_too(tmp_path: Path) -> None:
    take = small_take()
    long = replace(take, streams=tuple(replace(s, received=s.time) for s in take.streams))
    folder = write_take(long, tmp_path, attachments=(("truth", "application/octet-stream", bytes(3 * WINDOWS[0])),))

    summary = summarise(folder)

    assert summary.samples == sum(map(len, take.streams))
    assert summary.duration_s == pytest.approx(take.duration())
    assert summary.lost == pytest.approx(3 / 100)


def test_a_take_that_was_cut_off_is_summed_up_and_says_so(tmp_path: Path) -> None:
    folder = record_in_blocks(tmp_path, frames=200)
    whole = (folder / "take.mcap").read_bytes()
    (folder / "take.mcap").unlink()
    (folder / "take.part.mcap").write_bytes(whole[: len(whole) // 2])

    cut_off = summarise(folder)
    take, report = read_take(folder)
    assert cut_off.recovered
    assert 0 < cut_off.samples < 3000
    assert (cut_off.samples, cut_off.duration_s) == (report.samples, take.duration())
    assert cut_off.lost == pytest.approx(0.0, abs=1e-9)

    recover(folder)
    given_its_end = summarise(folder)
    assert given_its_end.recovered
    assert given_its_end.samples == report.samples


def test_a_take_without_samples_has_no_length_and_no_loss(tmp_path: Path) -> None:
    summary = summarise(start_writing(tmp_path).stop().result().folder)

    assert (summary.samples, summary.duration_s) == (0, 0.0)
    assert math.isnan(summary.lost)
    assert summary.refusal is None


def test_a_folder_without_a_take_is_listed_with_the_reason(tmp_path: Path) -> None:
    folder = tmp_path / "P014" / "2026-11-24a" / "take-001_walk"
    folder.mkdir(parents=True)
    (folder / "take.mcap").write_bytes(b"not a take at all")

    (summary,) = summaries(tmp_path)

    assert isinstance(summary.refusal, NotATake)
    assert (summary.person, summary.session, summary.name) == ("P014", "2026-11-24a", "take-001_walk")


def test_whatever_was_done_to_a_file_it_is_listed(tmp_path: Path) -> None:
    folder = record(tmp_path, frames=12)
    original = (folder / "take.mcap").read_bytes()
    random = np.random.default_rng(1)
    damaged = tmp_path / "P014" / "2026-11-24a" / "take-002"
    damaged.mkdir()

    for _ in range(MUTANTS):
        mutant = bytearray(original)
        place = int(random.integers(len(mutant))) if random.random() < 0.5 else -int(random.integers(1, 4000))
        width = int(random.integers(1, 60))
        mutant[place : place + width] = random.bytes(len(mutant[place : place + width]))
        if random.random() < 0.2:
            del mutant[int(random.integers(len(mutant))) :]
        (damaged / "take.mcap").write_bytes(mutant)

        summary = summarise(damaged)

        assert isinstance(summary, TakeSummary)
        assert summary.refusal is not None or summary.duration_s >= 0.0


def test_the_newest_take_comes_first(tmp_path: Path) -> None:
    take = small_take()
    days = [("2025-01-03T10:00:00Z", 3), ("", 1), ("2025-01-02T10:00:00+00:00", 2)]
    for started, day in days:
        write_take(replace(take, started=started, name=f"day {day}"), tmp_path, day=date(2025, 1, day))

    assert [summary.name for summary in summaries(tmp_path)] == ["day 3", "day 2", "day 1"]


def test_names_notes_and_verdict_are_kept_and_nothing_else_changes(tmp_path: Path) -> None:
    folder = record(tmp_path)
    document, _ = load_document(folder, "walk", repair=False)
    take = (folder / "take.mcap").read_bytes()

    keep_summary(replace(summarise(folder), name="slow walk", notes="limps", verdict="star"))

    assert summarise(folder) == replace(summarise(folder), name="slow walk", notes="limps", verdict="star")
    assert read_take(folder)[0].name == "slow walk"
    assert load_document(folder, "", repair=False)[0].setup == document.setup
    assert (folder / "take.mcap").read_bytes() == take


def test_what_a_newer_studio_wrote_is_not_changed(tmp_path: Path) -> None:
    folder = record(tmp_path)
    (folder / "take.json").write_bytes(b'{"schema": 2, "name": {"en": "walk"}}')

    with pytest.raises(WrittenByNewerStudio):
        keep_summary(replace(summarise(folder), verdict="bad"))


def test_a_lost_take_json_says_as_recorded_and_is_not_made_by_looking(tmp_path: Path) -> None:
    folder = record(tmp_path)
    (folder / "take.json").unlink()

    assert summarise(folder).name == "walk"
    assert not (folder / "take.json").exists()


def test_a_take_in_the_library_that_is_gone_meanwhile_is_listed_with_the_reason(tmp_path: Path) -> None:
    folder = record(tmp_path)
    shutil.rmtree(folder)

    assert isinstance(summarise(folder).refusal, NotATake)


def test_a_library_that_is_gone_meanwhile_is_not_called_read_only(tmp_path: Path) -> None:
    library = tmp_path / "library"
    summary = summarise(record(library))
    shutil.rmtree(library)

    with pytest.raises(NotATake):
        keep_summary(replace(summary, verdict="bad"))
    assert not library.exists()
    assert summaries(library) == []


def test_a_verdict_survives_a_change_of_the_document(tmp_path: Path) -> None:
    folder = record(tmp_path)
    save_document(folder, TakeDocument(name="walk", verdict="bad"))

    assert summarise(folder).verdict == "bad"
