"""Posts telemetry as fast as it is acknowledged, over keep-alive connections; a process of its own.

Takes a `Task` as JSON on standard input, and answers with a `Result` on standard output.
"""

import asyncio
import itertools
import sys
import time
from typing import cast

import msgspec
import uvloop

from backend.bench.telemetry import NAME_LENGTH, batch_bodies, name_place

CONNECTIONS = 64


class Task(msgspec.Struct, frozen=True):
    """What to post.

    Attributes:
        host: of the server.
        port: of the server.
        path: of the telemetry route.
        readings: in each batch.
        first: number of the first batch, so that no two tasks send the same.
        connections: how many wait for an answer at any time.
        warm_s: seconds before counting.
        counted_s: seconds of counting.
    """

    host: str
    port: int
    path: str
    readings: int
    first: int
    connections: int = CONNECTIONS
    warm_s: float = 0.3
    counted_s: float = 1.5


class Result(msgspec.Struct, frozen=True):
    """What came of it.

    Attributes:
        batches: acknowledged while counting.
        seconds: of counting.
    """

    batches: int
    seconds: float


class Poster(asyncio.Protocol):
    """One connection: posts, waits for the receipt, posts the next."""

    acknowledged = 0
    faults: list[bytes] = []  # noqa: RUF012 - shared by all connections, as the count is

    def __init__(self, request: bytearray, place: slice, names: "itertools.count[int]") -> None:
        self._request = request
        self._place = place
        self._names = names

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Post the first batch."""
        self._transport = cast("asyncio.Transport", transport)
        self._post()

    def data_received(self, data: bytes) -> None:
        """Count the receipt, and post on; its head and body may come apart."""
        if data.startswith(b"HTTP/1.1 ") and not data.startswith(b"HTTP/1.1 202"):
            Poster.faults.append(data)
            self._transport.close()
        elif data.endswith(b"}"):
            Poster.acknowledged += 1
            self._post()

    def _post(self) -> None:
        self._request[self._place] = b"%0*d" % (NAME_LENGTH, next(self._names))
        self._transport.write(bytes(self._request))


async def post(task: Task) -> Result:
    """Post for the time of the task.

    Raises:
        RuntimeError: the server answered with something else than 202.
    """
    names = itertools.count(task.first)
    bodies = batch_bodies(task.readings, time.time())
    loop = asyncio.get_running_loop()
    for i in range(task.connections):
        body = bodies[i % len(bodies)]
        head = (
            f"POST {task.path} HTTP/1.1\r\nHost: {task.host}:{task.port}\r\nUser-Agent: firethread-bench\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
        ).encode()
        place = name_place(head + body)
        request = bytearray(head + body)
        await loop.create_connection(lambda r=request, p=place: Poster(r, p, names), task.host, task.port)  # type: ignore[misc]  # mypy cannot infer a lambda with defaults
    await asyncio.sleep(task.warm_s)
    batches, start = Poster.acknowledged, time.perf_counter()
    await asyncio.sleep(task.counted_s)
    batches, seconds = Poster.acknowledged - batches, time.perf_counter() - start
    if Poster.faults:
        raise RuntimeError(f"the server answered {Poster.faults[0][:500]!r}")
    return Result(batches, seconds)


if __name__ == "__main__":
    task = msgspec.json.decode(sys.stdin.buffer.read(), type=Task)
    sys.stdout.buffer.write(msgspec.json.encode(uvloop.run(post(task))))
