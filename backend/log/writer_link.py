"""The socket to the log's writer process, which is started with it."""

import asyncio
import socket
import subprocess
import sys
from collections.abc import Callable
from typing import cast

from backend.log.writer_wire import LENGTHS, Frames, Written, parse_written

SOCKET_BYTES = 4 * 1024 * 1024
"""Asked of the kernel, which may give less: what the writer finds when it is done with a group is its next
one, even while the event loop is busy with decoding."""


class WriterLink(asyncio.Protocol):
    """The socket to one writer process.

    Args:
        process: the writer.
        take: called with what became of each group.
    """

    transport: asyncio.Transport

    def __init__(self, process: "subprocess.Popen[bytes]", take: Callable[[Written], None]) -> None:
        self._take = take
        self._frames = Frames()
        self.process = process
        self.ended = asyncio.Event()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Keep the way to it."""
        self.transport = cast("asyncio.Transport", transport)

    def data_received(self, data: bytes) -> None:
        """Hand on what became of groups."""
        for payload, _ in self._frames.feed(data):
            self._take(parse_written(payload))

    def eof_received(self) -> None:
        """The writer is done, or gone: close this side too."""

    def connection_lost(self, error: Exception | None) -> None:
        """Tell whoever waits for its end."""
        del error
        self.ended.set()


async def connect_writer(url: str, hold: int | None, take: Callable[[Written], None]) -> WriterLink:
    """Start a writer process.

    Args:
        url: of the log's database.
        hold: handle of the data folder that it shall hold as well.
        take: called with what became of each group.

    Raises:
        OSError: it cannot be started.
    """
    ours, theirs = socket.socketpair()
    with theirs:
        process = subprocess.Popen(  # noqa: S603, ASYNC220 - our own module; starting it does not wait
            [sys.executable, "-m", "backend.log.writer_process", str(theirs.fileno())],
            pass_fds=[theirs.fileno(), *([] if hold is None else [hold])],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
        )
    ours.setblocking(False)
    ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BYTES)
    link = WriterLink(process, take)
    await asyncio.get_running_loop().create_connection(lambda: link, sock=ours)
    encoded = url.encode()
    link.transport.write(LENGTHS.pack(0, len(encoded)) + encoded)
    return link
