"""What does not come is told: a port that is gone and back, a tag that is silent and back, bytes thrown away."""

from dataclasses import dataclass

import pytest

from studio.capture.link_watch import SILENCE, LinkWatch
from studio.core.sample import SensorId

TAG, OTHER = SensorId("tag:1"), SensorId("tag:2")


@dataclass
class Port:
    """What a port says of itself."""

    name: str = "serial-A"
    dialect: str = "receiver_frames"
    paced: bool = True
    place: str = "/dev/ttyA"
    is_connected: bool = True
    interruptions: int = 0
    dropped: int = 0

    async def arrivals(self):
        for _ in ():
            yield []

    async def send(self, data):
        """Nobody listens."""

    async def close(self):
        """Nothing is open."""


@pytest.fixture
def port():
    return Port()


@pytest.fixture
def watch(port):
    return LinkWatch(port)


def test_a_tag_that_sends_nothing_for_more_than_a_second_is_told_once(watch):
    list(watch.heard(TAG, 10.0))
    list(watch.heard(OTHER, 10.5))

    assert list(watch.look(10.0 + SILENCE)) == []
    assert list(watch.look(10.01 + SILENCE)) == [("sensor silent", {"sensor": TAG})]
    assert list(watch.look(10.02 + SILENCE)) == []
    assert list(watch.look(10.51 + SILENCE)) == [("sensor silent", {"sensor": OTHER})]


def test_a_tag_that_is_back_says_after_how_long(watch):
    list(watch.heard(TAG, 10.0))
    list(watch.look(12.0))

    assert list(watch.heard(TAG, 13.5)) == [("sensor back", {"sensor": TAG, "after": 3.5})]
    assert list(watch.heard(TAG, 13.6)) == []
    assert list(watch.look(14.5)) == []
    assert list(watch.look(14.7)) == [("sensor silent", {"sensor": TAG})]


def test_a_port_that_is_gone_is_told_and_no_tag_is_blamed(port, watch):
    list(watch.heard(TAG, 10.0))
    port.is_connected, port.interruptions = False, 1

    assert list(watch.look(15.0)) == [("link lost", {"link": "serial-A"})]
    assert list(watch.look(16.0)) == []
    assert watch.lost == "/dev/ttyA"

    port.is_connected = True
    assert list(watch.look(18.0)) == [("link back", {"link": "serial-A", "after": 3.0})]
    assert watch.lost is None
    assert list(watch.look(18.0 + SILENCE)) == []
    assert list(watch.look(18.1 + SILENCE)) == [("sensor silent", {"sensor": TAG})]


def test_a_port_that_was_gone_between_two_looks_is_told_all_the_same(port, watch):
    port.interruptions = 1

    assert [kind for kind, _ in watch.look(5.0)] == ["link lost", "link back"]
    assert list(watch.look(6.0)) == []


def test_bytes_thrown_away_are_counted_from_look_to_look(port, watch):
    port.dropped = 300
    assert list(watch.look(1.0)) == [("dropped", {"link": "serial-A", "bytes": 300})]
    port.dropped = 500
    assert list(watch.look(2.0)) == [("dropped", {"link": "serial-A", "bytes": 200})]
    assert list(watch.look(3.0)) == []
