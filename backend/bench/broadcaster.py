"""What `bench fanout` compares with: a process that does nothing but write ready-made frames to sockets.

It prints its port, answers WebSocket handshakes, and reads from standard input, a line each, how many frames
a second to write to every socket that has taken the last one.
"""

import asyncio
import base64
import hashlib
import socket
import sys
from typing import cast

import uvloop

from backend.live.push_protocol import UNSENT_BYTES, text_frame

GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


class Screen(asyncio.Protocol):
    """One socket."""

    everyone: set["Screen"] = set()  # noqa: RUF012 - shared by all

    def __init__(self) -> None:
        self._head = b""
        self._takes = True

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Bound what may wait, as the product does."""
        self._transport = cast("asyncio.Transport", transport)
        self._transport.set_write_buffer_limits(high=0)
        connection: socket.socket = transport.get_extra_info("socket")
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT_BYTES)

    def data_received(self, data: bytes) -> None:
        """Answer the handshake."""
        self._head += data
        if self not in self.everyone and b"\r\n\r\n" in self._head:
            lines = self._head.split(b"\r\n")
            key = next(line[18:].strip() for line in lines if line.lower().startswith(b"sec-websocket-key:"))
            accept = base64.b64encode(hashlib.sha1(key.strip() + GUID).digest())  # noqa: S324 - RFC 6455
            self._transport.write(
                b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                b"Sec-WebSocket-Accept: " + accept + b"\r\n\r\n"
            )
            self.everyone.add(self)

    def pause_writing(self) -> None:
        """The socket is full."""
        self._takes = False

    def resume_writing(self) -> None:
        """The socket has taken what was written."""
        self._takes = True

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget it."""
        del exc
        self.everyone.discard(self)

    def push(self, frame: bytes) -> None:
        """Write a frame, unless the last one has not been taken."""
        if self._takes:
            self._transport.write(frame)


async def main(size: int) -> None:
    """Serve until standard input ends."""
    loop = asyncio.get_running_loop()
    server = await loop.create_server(Screen, "127.0.0.1", 0, backlog=4096)
    print(server.sockets[0].getsockname()[1], flush=True)
    commands = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(commands), sys.stdin)
    frame = text_frame(b"x" * size)
    period: float | None = None
    reading = asyncio.create_task(commands.readline())
    while True:
        began = loop.time()
        if period is not None:
            for screen in Screen.everyone:
                screen.push(frame)
        pause_s = None if period is None else max(0.0, began + period - loop.time())
        await asyncio.wait([reading], timeout=pause_s)
        if reading.done():
            line = reading.result()
            if not line:
                return
            rate_hz = float(line)
            period = 1.0 / rate_hz if rate_hz else None
            reading = asyncio.create_task(commands.readline())


if __name__ == "__main__":
    uvloop.run(main(int(sys.argv[1])))
