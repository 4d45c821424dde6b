"""The synthetic suit behind a pseudo-terminal: what a receiver on a cable looks like to the studio.

``python -m tests.journeys.pty_suit WORDS SECONDS`` prints the port's name, waits for the studio to greet it,
and then sends in real time what ``synthetic:WORDS`` says. It answers commands as the suit does.
"""

import asyncio
import os
import signal
import sys
import tty

from studio.acquisition.driver import Arrival
from studio.acquisition.synthetic.link import SyntheticDriver


async def send(words: str, seconds: float, master: int) -> None:
    link = await SyntheticDriver().open(words)
    loop = asyncio.get_running_loop()
    greeted = asyncio.Event()
    answers: set[asyncio.Task[None]] = set()

    def hear() -> None:
        heard = os.read(master, 4096)
        greeted.set()
        answers.add(loop.create_task(link.send(heard)))

    loop.add_reader(master, hear)
    await asyncio.wait_for(greeted.wait(), 30)
    first = None
    async for batch in link.arrivals():
        for piece in batch:
            if not isinstance(piece, Arrival):
                continue
            first = piece.received if first is None else first
            if piece.received - first > seconds:
                await link.close()
                return
            data = piece.data
            while data:
                data = data[os.write(master, data) :]


def main() -> None:
    words, seconds = sys.argv[1], float(sys.argv[2])
    master, slave = os.openpty()
    tty.setraw(slave)
    print(os.ttyname(slave), flush=True)
    asyncio.run(send(words, seconds, master))
    signal.pause()  # the port stays until the other side has read everything and ends this process


if __name__ == "__main__":
    main()
