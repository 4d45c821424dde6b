"""A receiver on a cable, here on a real pseudo-terminal: read, asked, pulled out, plugged in, refused."""

import asyncio
import errno
import itertools
import os
import sys
import threading
import time
from collections.abc import Coroutine, Iterator
from pathlib import Path
from typing import Any

import pytest
import serial
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from studio.acquisition import serial_port
from studio.acquisition.dialects import receiver_frames
from studio.acquisition.dialects.registry import open_dialect
from studio.acquisition.driver import Arrival
from studio.acquisition.serial_port import SerialDriver, SerialLink, refusal
from studio.core.errors import LinkError, PortBusy, PortForbidden, PortGone, SourceUnreadable
from tests.acquisition.wire_vectors import VECTORS

if sys.platform == "win32":
    pytest.skip("pseudo-terminals are of POSIX", allow_module_level=True)

import tty

PATIENCE = 10.0  # s after which a test gives up; every one takes a fraction on an idle machine
STREAM = b"".join(bytes.fromhex(v["framed"]) for v in VECTORS["frames"] if v["kind"] >= 0x20)


class Bench:
    """The far end of a cable: a pty whose near end is found under a lasting name."""

    def __init__(self, name: Path) -> None:
        self.name = name
        self.master = self.slave = -1
        self.plug_in()

    def plug_in(self) -> None:
        # The slave stays open here too, or the master could not be read before the link is there.
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        self.name.unlink(missing_ok=True)
        self.name.symlink_to(os.ttyname(self.slave))

    def pull_out(self) -> None:
        if self.master >= 0:
            os.close(self.slave)
            os.close(self.master)
            self.master = -1
            self.name.unlink(missing_ok=True)

    def say(self, data: bytes) -> None:
        while data:
            data = data[os.write(self.master, data) :]

    async def hear(self, size: int) -> bytes:
        heard = b""
        while len(heard) < size:
            heard += await asyncio.to_thread(os.read, self.master, size - len(heard))
        return heard


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Bench]:
    there = Bench(tmp_path / "ttyRECEIVER")
    yield there
    there.pull_out()


def run(story: Coroutine[Any, Any, None]) -> None:
    asyncio.run(asyncio.wait_for(story, PATIENCE))


async def until(is_so: Any) -> None:
    while not is_so():  # noqa: ASYNC110  # what is waited for happens in another thread and tells nobody
        await asyncio.sleep(0.01)


async def collect(link: SerialLink, into: list[Arrival]) -> None:
    async for batch in link.arrivals():
        into.extend(item for item in batch if isinstance(item, Arrival))


def data_of(arrivals: list[Arrival]) -> bytes:
    return b"".join(arrival.data for arrival in arrivals)


def test_bytes_arrive_complete_in_order_and_stamped(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        arrivals: list[Arrival] = []
        reader = asyncio.create_task(collect(link, arrivals))
        await bench.hear(1)
        for _ in range(50):
            await asyncio.to_thread(bench.say, STREAM)
        await until(lambda: len(data_of(arrivals)) >= 50 * len(STREAM))
        await link.close()
        await reader

        assert data_of(arrivals) == 50 * STREAM
        stamps = [arrival.received for arrival in arrivals]
        assert stamps == sorted(stamps)
        assert (link.dropped, link.interruptions) == (0, 0)

    run(story())


def test_what_arrives_is_read_by_the_dialect_the_link_names(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        dialect = open_dialect(link.dialect)
        arrivals: list[Arrival] = []
        reader = asyncio.create_task(collect(link, arrivals))
        await bench.hear(1)
        bench.say(STREAM)
        await until(lambda: len(data_of(arrivals)) >= len(STREAM))
        await link.close()
        await reader

        readings = [reading for arrival in arrivals for reading in dialect.feed(arrival.data)]
        assert len(readings) == sum(v["kind"] == 0x21 and "sync" not in v["name"] for v in VECTORS["frames"])
        assert not dialect.malformed

    run(story())


def test_opening_asks_for_hello_and_orders_reach_the_receiver(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        order = receiver_frames.encode_command(0x12345678, 9)
        assert await bench.hear(1) == receiver_frames.HELLO_REQUEST

        await link.send(order)

        assert await bench.hear(len(order)) == order
        await link.close()

    run(story())


def test_a_port_pulled_out_and_plugged_in_goes_on_with_a_gap(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        arrivals: list[Arrival] = []
        reader = asyncio.create_task(collect(link, arrivals))
        await bench.hear(1)
        bench.say(b"before")
        await until(lambda: data_of(arrivals) == b"before")

        bench.pull_out()
        await until(lambda: not link.is_connected)
        with pytest.raises(PortGone):
            await link.send(b"lost")
        bench.plug_in()
        assert await bench.hear(1) == receiver_frames.HELLO_REQUEST  # asked again: it may be another receiver
        await until(lambda: link.is_connected)
        bench.say(b"after")
        await until(lambda: data_of(arrivals) == b"beforeafter")

        assert link.interruptions == 1
        await link.close()
        await reader

    run(story())


def test_a_lost_port_is_looked_for_more_and_more_seldom(bench, monkeypatch):
    """pyserial fails at once with every call when the port is gone: without pauses the reader would fill a core."""
    attempts: list[float] = []

    class Watched(serial.Serial):
        def open(self) -> None:
            attempts.append(time.perf_counter())
            super().open()

    monkeypatch.setattr(serial, "Serial", Watched)

    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        await bench.hear(1)
        bench.pull_out()
        await until(lambda: len(attempts) >= 4)
        await link.close()

        # The first opened the port; a busy machine makes the pauses longer, never shorter.
        pauses = [b - a for a, b in itertools.pairwise(attempts[1:])]
        assert pauses[0] >= 2 * serial_port.FIRST_RETRY
        assert pauses[1] >= 4 * serial_port.FIRST_RETRY

    run(story())


def test_closing_ends_the_reader_whether_the_port_is_there_or_not(bench):
    async def story() -> None:
        for pulled in (False, True):
            link = await SerialDriver().open(str(bench.name))
            await bench.hear(1)
            if pulled:
                bench.pull_out()
                await until(lambda link=link: not link.is_connected)
            await link.close()
            assert link.name not in {t.name for t in threading.enumerate()}
            assert [batch async for batch in link.arrivals()] == []

    run(story())


def test_what_came_before_closing_is_still_handed_over(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        await bench.hear(1)
        bench.say(b"last ")
        await until(lambda: link._held)  # noqa: SLF001
        bench.say(b"words")  # while the reader pauses after what it has just read
        await link.close()

        arrivals: list[Arrival] = []
        await collect(link, arrivals)
        assert data_of(arrivals) == b"last words"

    run(story())


def test_a_consumer_that_stalls_costs_counted_bytes_and_not_memory(bench, monkeypatch):
    monkeypatch.setattr(serial_port, "MOST_HELD", 1000)

    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        await bench.hear(1)
        for _ in range(20):
            await asyncio.to_thread(bench.say, bytes(500))
            await asyncio.sleep(0.01)
        await until(lambda: link.dropped > 0)
        await link.close()

        kept: list[Arrival] = []
        await collect(link, kept)
        assert len(data_of(kept)) + link.dropped == 10_000

    run(story())


def test_a_port_is_opened_once(bench):
    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))

        with pytest.raises(PortBusy) as refused:
            await SerialDriver().open(str(bench.name))

        assert refused.value.port == str(bench.name)
        await link.close()

    run(story())


def test_a_port_that_is_not_there_is_gone(tmp_path):
    with pytest.raises(PortGone):
        asyncio.run(SerialDriver().open(str(tmp_path / "ttyNONE")))


def test_a_file_is_no_port(tmp_path):
    (tmp_path / "notes.txt").write_text("no port", "ascii")

    with pytest.raises(SourceUnreadable, match="not a serial port"):
        asyncio.run(SerialDriver().open(str(tmp_path / "notes.txt")))


@pytest.mark.parametrize("words", ["", "@115200", "/dev/ttyX@fast", "/dev/ttyX@0", "/dev/ttyX@99999999", "/dev/ttyX@"])
def test_words_that_name_no_port_or_speed_are_refused(words):
    with pytest.raises(SourceUnreadable):
        asyncio.run(SerialDriver().open(words))


def test_the_speed_is_said_behind_the_port(bench):
    async def story() -> None:
        link = await SerialDriver().open(f"{bench.name}@115200")
        await bench.hear(1)
        assert link.name == "serial-ttyRECEIVER"
        await link.close()

    run(story())


@pytest.mark.parametrize(
    ("error", "meaning"),
    [
        (serial.SerialException(errno.EBUSY, "busy"), PortBusy),
        (serial.SerialException(errno.EAGAIN, "locked"), PortBusy),
        (serial.SerialException(errno.EACCES, "denied"), PortForbidden),
        (serial.SerialException(errno.EPERM, "denied"), PortForbidden),
        (serial.SerialException(errno.ENOENT, "none"), PortGone),
        (serial.SerialException(errno.ENXIO, "none"), PortGone),
        (serial.SerialException("could not open port 'COM3': FileNotFoundError(2, '', None, 2)"), PortGone),
        (serial.SerialException("could not open port 'COM3': PermissionError(13, '', None, 5)"), PortBusy),
        (serial.SerialException("Could not configure port: (25, '')"), SourceUnreadable),
    ],
)
def test_each_refusal_of_the_system_is_what_the_operator_can_act_on(error: OSError, meaning: type[LinkError]):
    assert type(refusal("COM3", error)) is meaning


def test_usb_ports_are_found_and_others_only_opened_by_name(monkeypatch):
    monkeypatch.setattr(list_ports, "comports", lambda: [_port("ttyS0"), _port("ttyACM1", "B"), _port("ttyACM0", "A")])

    assert [found.source for found in SerialDriver().find()] == ["serial:ttyACM0", "serial:ttyACM1"]


def test_a_device_that_comes_back_under_another_name_is_the_same_receiver(bench, monkeypatch, tmp_path):
    """ttyACM0 is taken by another device meanwhile, which must not be opened in its place."""
    there = {str(bench.name): "A"}
    monkeypatch.setattr(list_ports, "comports", lambda: [_port(device, number) for device, number in there.items()])

    async def story() -> None:
        link = await SerialDriver().open(str(bench.name))
        await bench.hear(1)
        bench.pull_out()
        await until(lambda: not link.is_connected)
        stranger, same = Bench(bench.name), Bench(tmp_path / "ttyOTHER")
        there.update({str(bench.name): "B", str(same.name): "A"})

        assert await same.hear(1) == receiver_frames.HELLO_REQUEST
        await until(lambda: link.is_connected)

        await link.close()
        os.set_blocking(stranger.master, False)
        with pytest.raises(BlockingIOError):
            os.read(stranger.master, 1)
        stranger.pull_out()
        same.pull_out()

    run(story())


def _port(device: str, serial_number: str | None = None) -> ListPortInfo:
    port = ListPortInfo(device)
    if serial_number is not None:
        port.vid, port.pid, port.serial_number = 0x1915, 0x520F, serial_number
        port.description = f"receiver {serial_number}"
    return port
