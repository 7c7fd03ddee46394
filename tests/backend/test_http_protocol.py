"""Connections on which no request comes are closed."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest
import uvicorn
from starlette.types import Receive, Scope, Send

from backend import http_protocol
from backend.serving import listen

HEADER = b"GET / HTTP/1.1\r\nhost: x\r\n"
PATIENCE_S = 10.0


class Answering:
    """An application that answers when it is told to."""

    def __init__(self) -> None:
        self.asked, self.go = asyncio.Event(), asyncio.Event()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        del scope, receive
        self.asked.set()
        await self.go.wait()
        await send({"type": "http.response.start", "status": 204, "headers": []})
        await send({"type": "http.response.body", "body": b""})


@asynccontextmanager
async def served(app: Answering) -> AsyncIterator[int]:
    """A server on a free port."""
    with listen("127.0.0.1", 0) as listener:
        config = uvicorn.Config(
            app,
            http="backend.http_protocol:HeaderWithin",
            lifespan="off",
            log_level="error",
            timeout_keep_alive=3600,
        )
        server = uvicorn.Server(config)
        config.load()
        server.lifespan = config.lifespan_class(config)
        await server.startup(sockets=[listener])
        try:
            yield listener.getsockname()[1]
        finally:
            await server.shutdown(sockets=[listener])


@pytest.mark.parametrize("begun", [b"", b"GET ", b"\r\n", HEADER])
def test_a_connection_whose_request_never_comes_is_closed(
    monkeypatch: pytest.MonkeyPatch, begun: bytes
) -> None:
    monkeypatch.setattr(http_protocol, "HEADER_WITHIN_S", 0.05)

    async def go() -> None:
        async with asyncio.timeout(PATIENCE_S), served(Answering()) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(begun)
            assert await reader.read() == b""
            writer.close()

    asyncio.run(go())


@pytest.mark.parametrize("begun", [b"GET ", b"\r\n", HEADER])
def test_a_second_request_that_never_comes_is_not_waited_for_either(
    monkeypatch: pytest.MonkeyPatch, begun: bytes
) -> None:
    monkeypatch.setattr(http_protocol, "HEADER_WITHIN_S", 0.05)

    async def go() -> None:
        app = Answering()
        app.go.set()
        async with asyncio.timeout(PATIENCE_S), served(app) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(HEADER + b"\r\n")
            assert b"204" in await reader.readuntil(b"\r\n\r\n")
            writer.write(begun)
            assert await reader.read() == b""
            writer.close()

    asyncio.run(go())


def test_who_has_told_its_request_waits_for_the_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_protocol, "HEADER_WITHIN_S", 0.05)

    async def go() -> None:
        app = Answering()
        async with asyncio.timeout(PATIENCE_S), served(app) as port:
            first = await asyncio.open_connection("127.0.0.1", port)
            first[1].write(HEADER + b"\r\n")
            await app.asked.wait()
            # Once one that came later is closed for want of a header, the time of the first is over too.
            later = await asyncio.open_connection("127.0.0.1", port)
            assert await later[0].read() == b""
            app.go.set()
            assert b"204" in await first[0].readuntil(b"\r\n\r\n")
            for _, writer in (first, later):
                writer.close()

    asyncio.run(go())
