"""Receivers on a cable: a reader thread per port, which opens it again after it was pulled out."""

import asyncio
import errno
import re
import sys
import threading
import time
from collections.abc import AsyncIterator, Callable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeVar

import serial
from serial.tools import list_ports

from studio.acquisition.dialects.receiver_frames import BAUD, HELLO_REQUEST
from studio.acquisition.driver import Arrival, Cue, Found, Known
from studio.core.errors import LinkError, PortBusy, PortForbidden, PortGone, SourceUnreadable

READ_TIMEOUT = 0.1  # s; closing waits at most so long for the reader
GATHER = 0.01  # s between two reads: 1000 bytes at 1 Mbaud, a quarter of the smallest buffer of a system
WRITE_TIMEOUT = 0.5  # s; an order is 20 bytes
BUFFER = 1 << 20  # bytes asked of Windows, whose own 4096 hold 0.04 s
MOST_HELD = 8 << 20  # bytes kept for a consumer that stalls: 80 s of a full line
FIRST_RETRY = 0.1  # s after the port was lost
LAST_RETRY = 1.0  # s; looking through the ports costs a millisecond

SLOWEST_BAUD = 300
FASTEST_BAUD = 4_000_000

News = TypeVar("News")


class UsbIdentity(NamedTuple):
    """What stays the same when a device comes back under another name."""

    vendor: int
    product: int
    serial_number: str


class SerialDriver:
    """Finds and opens serial ports; the words are ``PORT[@BAUD]``."""

    def find(self) -> list[Found]:
        """Return the USB ports there are; others can still be opened by name."""
        ports = sorted(port for port in list_ports.comports() if port.vid is not None)
        return [Found(f"serial:{port.device}", port.description) for port in ports]

    async def open(self, words: str) -> "SerialLink":
        """Open a port and have its receiver introduce itself.

        Raises
        ------
        SourceUnreadable
            The words name no port, or no possible speed.
        PortGone, PortBusy, PortForbidden
            The system does not let us.
        """
        path, baud = _parse(words)
        port = await asyncio.to_thread(_open, path, baud)
        identity = await asyncio.to_thread(_identity_of, path)
        return SerialLink(port, path, baud, identity)


class SerialLink:
    """An open port; made inside the running event loop that reads it."""

    def __init__(self, port: serial.Serial, path: str, baud: int, identity: UsbIdentity | None) -> None:
        self.name = "serial-" + re.sub(r"[^A-Za-z0-9_-]+", "-", Path(path).name)
        self.dialect = "receiver_frames"
        self.paced = True
        self.is_connected = True
        """False while the port is gone and looked for."""
        self.interruptions = 0
        """How often the port was lost."""
        self.dropped = 0
        """Bytes thrown away because nobody took what came before."""
        self._port = port
        self.place = path
        """The name of the port now; it may come back under another."""
        self._baud = baud
        self._identity = identity
        self._loop = asyncio.get_running_loop()
        self._held: list[Arrival] = []
        self._held_bytes = 0
        self._news = asyncio.Event()
        self._closing = threading.Event()
        self._ended = False
        self._reader = threading.Thread(target=self._read, name=self.name, daemon=True)
        self._reader.start()

    async def arrivals(self) -> AsyncIterator[Sequence[Arrival | Known | Cue]]:
        """Yield what came in since the last time until the link is closed, however often the port is lost."""
        while self._held or not self._ended:
            await self._news.wait()
            self._news.clear()
            held, self._held, self._held_bytes = self._held, [], 0
            if held:
                yield held

    async def send(self, data: bytes) -> None:
        """Send bytes to the receiver.

        Raises
        ------
        PortGone
            The port is lost at the moment, or takes nothing.
        """
        if not self.is_connected:
            raise PortGone(self.place)
        try:
            await asyncio.to_thread(self._port.write, data)
        except OSError as error:
            raise PortGone(self.place) from error

    async def close(self) -> None:
        """Close the port; returns when the reader has ended."""
        self._closing.set()
        await asyncio.to_thread(self._reader.join)
        self._ended = True
        self._news.set()

    def _read(self) -> None:
        """Hand over bytes until closing; the reader's thread, the only one that opens and closes the port."""
        self._greet()
        last = waited = False
        while True:
            waited = last  # once more for what the system has not passed on yet
            last = self._closing.is_set()  # asked before reading: what came until then is still handed over
            try:
                data = self._port.read(self._port.in_waiting or (0 if waited else 1))
            except OSError:
                # pyserial: SerialException from read, OSError(5) from in_waiting, again with every call.
                self._port.close()
                if last or not self._reopen():
                    return
                continue
            if data:
                self._tell(self._take, Arrival(time.perf_counter(), data))
                self._closing.wait(GATHER)
            elif last:
                break
        self._port.close()

    def _greet(self) -> None:
        try:
            self._port.write(HELLO_REQUEST)
        except OSError:
            return  # the next read tells what is wrong

    def _reopen(self) -> bool:
        """Open the port again when it is back; False when the link is closed meanwhile."""
        self._tell(self._note_connection, False)
        delay = FIRST_RETRY
        while not self._closing.wait(delay):
            delay = min(2 * delay, LAST_RETRY)
            path = self.place if self._identity is None else _path_of(self._identity)
            if path is None:
                continue
            try:
                self._port = _open(path, self._baud)
            except LinkError:
                continue
            self.place = path
            self._tell(self._note_connection, True)
            self._greet()
            return True
        return False

    def _tell(self, callback: Callable[[News], None], news: News) -> None:
        try:
            self._loop.call_soon_threadsafe(callback, news)
        except RuntimeError:
            self._closing.set()  # the loop is closed: nobody is left to read

    def _take(self, arrival: Arrival) -> None:
        if self._held_bytes > MOST_HELD:
            self.dropped += len(arrival.data)
            return
        self._held.append(arrival)
        self._held_bytes += len(arrival.data)
        self._news.set()

    def _note_connection(self, is_connected: bool) -> None:
        self.is_connected = is_connected
        self.interruptions += not is_connected


def _parse(words: str) -> tuple[str, int]:
    path, mark, speed = words.rpartition("@")
    if not mark:
        path, speed = words, str(BAUD)
    if not path:
        raise SourceUnreadable(f"serial:{words}", "no port is named")
    if not (speed.isascii() and speed.isdigit() and SLOWEST_BAUD <= int(speed) <= FASTEST_BAUD):
        raise SourceUnreadable(f"serial:{words}", f"{speed} is no speed from {SLOWEST_BAUD} to {FASTEST_BAUD} baud")
    return path, int(speed)


def _open(path: str, baud: int) -> serial.Serial:
    # DTR and RTS are asserted once, by opening: CDC receivers send nothing without DTR.
    try:
        port = serial.Serial(path, baud, timeout=READ_TIMEOUT, write_timeout=WRITE_TIMEOUT, exclusive=True)
    except ValueError as error:
        raise SourceUnreadable(f"serial:{path}@{baud}", "the port does not have this speed") from error
    except OSError as error:
        raise refusal(path, error) from error
    if sys.platform == "win32":
        port.set_buffer_size(rx_size=BUFFER)
    return port


def refusal(path: str, error: OSError) -> LinkError:
    """Return what the system's refusal to open ``path`` means to the operator."""
    text = str(error)
    if error.errno in (errno.EBUSY, errno.EAGAIN, errno.EWOULDBLOCK):
        return PortBusy(path)
    if error.errno in (errno.EACCES, errno.EPERM):
        return PortForbidden(path)
    if error.errno is not None or "FileNotFoundError" in text:
        return PortGone(path)
    if "PermissionError" in text:
        return PortBusy(path)  # Windows refuses the second who opens a port in these words (pyserial 3.5)
    return SourceUnreadable(f"serial:{path}", "it is not a serial port")


def _identity_of(path: str) -> UsbIdentity | None:
    """Return what to find a USB device by when it comes back, None for what has no serial number."""
    real = str(Path(path).resolve())
    for port in list_ports.comports():
        if port.device in (path, real) and port.vid is not None and port.serial_number:
            return UsbIdentity(port.vid, port.pid, port.serial_number)
    return None


def _path_of(identity: UsbIdentity) -> str | None:
    for port in list_ports.comports():
        if (port.vid, port.pid, port.serial_number) == identity:
            return str(port.device)
    return None
