"""The screens of `bench fanout`: a process with many sockets that counts the bytes that come.

It takes host, port, path and number of sockets as arguments, prints `ready`, and answers each line on
standard input with the bytes that have come so far and the processor time spent (s).
"""

import asyncio
import base64
import os
import sys
import time

import uvloop

HANDSHAKES_AT_ONCE = 50


class Screen(asyncio.BufferedProtocol):
    """One socket: after the handshake it only counts."""

    received = 0
    _buffer = memoryview(bytearray(256 * 1024))

    def __init__(self, ready: asyncio.Future[None]) -> None:
        self._ready = ready

    def get_buffer(self, sizehint: int) -> memoryview:
        """One buffer for all: what comes is not looked at."""
        del sizehint
        return self._buffer

    def buffer_updated(self, nbytes: int) -> None:
        """Count."""
        if not self._ready.done():
            head = bytes(self._buffer[:nbytes])
            if head.startswith(b"HTTP/1.1 101"):
                self._ready.set_result(None)
            else:
                self._ready.set_exception(RuntimeError(f"no socket: {head[:200]!r}"))
        Screen.received += nbytes

    def connection_lost(self, exc: Exception | None) -> None:
        """The server has closed it: that is a fault."""
        if not self._ready.done():
            self._ready.set_exception(exc or ConnectionError("closed during the handshake"))


async def main(host: str, port: int, path: str, count: int) -> None:
    """Connect, then answer questions until standard input ends."""
    loop = asyncio.get_running_loop()
    key = base64.b64encode(os.urandom(16)).decode()
    request = (
        f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n"
    ).encode()
    for first in range(0, count, HANDSHAKES_AT_ONCE):
        waiting = []
        for _ in range(min(HANDSHAKES_AT_ONCE, count - first)):
            ready: asyncio.Future[None] = loop.create_future()
            transport, _screen = await loop.create_connection(lambda r=ready: Screen(r), host, port)  # type: ignore[misc]  # mypy cannot infer a lambda with defaults
            transport.write(request)
            waiting.append(ready)
        await asyncio.gather(*waiting)
    print("ready", flush=True)
    commands = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(commands), sys.stdin)
    while await commands.readline():
        print(Screen.received, time.process_time(), flush=True)


if __name__ == "__main__":
    uvloop.run(main(sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])))
