"""From a link to samples: questions to tags, and several links that come through one."""

import asyncio
from pathlib import Path

import numpy as np
import pytest

from studio.acquisition.driver import Arrival
from studio.acquisition.synthetic.link import SyntheticDriver
from studio.capture.link_intake import QUESTIONS, LinkIntake
from studio.capture.sources import open_source
from studio.core.errors import PortGone
from studio.core.take import Setup
from studio.storage.facts import Anchor
from studio.storage.session_folder import open_session
from studio.storage.take_reader import read_take
from studio.storage.take_writer import TakeWriter
from tests.storage.recordings import DAY


class Deaf:
    """A port that is gone whenever something is to be sent."""

    name = "deaf"
    dialect = "receiver_frames"
    paced = True

    def __init__(self) -> None:
        self.asked = 0

    async def arrivals(self):
        for _ in ():
            yield []

    async def send(self, data: bytes) -> None:
        self.asked += 1
        raise PortGone(self.name)

    async def close(self) -> None:
        """Nothing is open."""


async def heard(words: str, seconds: float) -> list[Arrival]:
    """Return what a simulated receiver sends."""
    link = await SyntheticDriver().open(words)
    pieces: list[Arrival] = []
    async for batch in link.arrivals():
        pieces += [piece for piece in batch if isinstance(piece, Arrival)]
        if pieces and pieces[-1].received - pieces[0].received > seconds:
            await link.close()
    return pieces


def test_a_question_that_a_lost_port_does_not_take_is_a_lost_question():
    pieces = asyncio.run(heard("walk?tags=2&speed=max", 1.0))

    async def story() -> int:
        intake = LinkIntake(deaf := Deaf())
        assert [sample for piece in pieces for sample in intake.samples(piece)]
        await intake.ask(-1.0)
        assert deaf.asked == 1  # nobody else is asked while the port is gone
        for now in range(3 * QUESTIONS):
            await intake.ask(float(now))
        return deaf.asked

    assert QUESTIONS <= asyncio.run(story()) <= 2 * QUESTIONS


def two_receivers(library: Path) -> Path:
    """Return a take from two receivers whose bytes came in turn, in blocks that hold both."""
    pieces = {
        name: asyncio.run(heard(f"walk?tags=2&seed={seed}&speed=max", 3.0)) for name, seed in (("east", 1), ("west", 2))
    }
    zero = {name: arrived[0].received for name, arrived in pieces.items()}
    writer = TakeWriter(
        open_session(library, "P014", DAY),
        "two",
        person="P014",
        source="two",
        setup=Setup(),
        versions={},
        anchor=Anchor("2026-11-24T10:00:00+00:00", 0.0),
    )
    for number, name in enumerate(pieces):
        writer.event("link", {"link": name, "dialect": "receiver_frames"}, 0.1 * number)
    intakes = {name: LinkIntake(Named(name)) for name in pieces}
    every = sorted(
        (piece.received - zero[name] + 0.003 * (name == "west"), name, piece.data)
        for name, arrived in pieces.items()
        for piece in arrived
    )
    for received, name, data in every:
        writer.raw(name, received, data)
        for sample in intakes[name].samples(Arrival(received, data)):
            writer.add_sensor(intakes[name].infos[sample.sensor])
            writer.sample(sample)
    return writer.stop().result(30).folder


class Named(Deaf):
    """A receiver by name."""

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name


def test_a_take_of_two_receivers_is_played_again_whole_and_in_order(tmp_path):
    folder = two_receivers(tmp_path)
    take, _ = read_take(folder)
    assert len(take.streams) == 4

    async def played() -> tuple[LinkIntake, list[float], dict[str, int]]:
        link = (await open_source(f"replay:{folder}?speed=max")).link
        intake = LinkIntake(link)
        times: list[float] = []
        counts: dict[str, int] = {}
        async for batch in link.arrivals():
            for piece in batch:
                assert isinstance(piece, Arrival)
                times.append(piece.received)
                for sample in intake.samples(piece):
                    counts[sample.sensor] = counts.get(sample.sensor, 0) + 1
        return intake, times, counts

    intake, times, counts = asyncio.run(played())

    assert set(intake.dialects) == {"east", "west"}
    assert counts == {stream.info.sensor: len(stream) for stream in take.streams}
    assert (np.diff(times) >= -1e-9).all()
    assert set(intake.health()) == set(counts)
    assert intake.malformed() == 0
    assert intake.foreign_version() is None


def test_bytes_of_a_link_nobody_announced_are_our_mistake():
    intake = LinkIntake(Named("east"))

    with pytest.raises(ValueError, match="west"):
        list(intake.samples(Arrival(0.0, b"x", "west")))


def test_the_suit_alone_knows_the_truth():
    async def story() -> tuple[bytes | None, bytes | None]:
        suit = LinkIntake(await SyntheticDriver().open("walk?speed=max"))
        async for _ in suit.link.arrivals():
            await suit.link.close()
        return suit.truth(), LinkIntake(Deaf()).truth()

    truth, nothing = asyncio.run(story())

    assert truth
    assert nothing is None


def test_a_device_that_sends_words_is_not_called_silent():
    """No dialect takes them for a damaged message of its own; still something arrived, and nothing was a sensor."""
    intake = LinkIntake(Deaf())

    for number in range(5):
        assert list(intake.samples(Arrival(0.1 * number, b"temperature 21.5 C\r\n"))) == []

    assert intake.malformed() == 5
