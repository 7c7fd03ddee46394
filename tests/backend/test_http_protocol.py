"""Connections on which no request comes, or only a part of one, are closed."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import msgspec
import pytest
import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send
from websockets.asyncio.client import connect

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
async def served(app: ASGIApp) -> AsyncIterator[int]:
    """A server on a free port."""
    with listen("127.0.0.1", 0) as listener:
        config = uvicorn.Config(
            app,
            http="backend.http_protocol:RequestWithin",
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


class Reading:
    """An application that reads a body and says how it ended."""

    def __init__(self) -> None:
        self.ended: asyncio.Queue[str] = asyncio.Queue()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        del scope
        message = await receive()
        while message["type"] == "http.request" and message.get("more_body", False):
            message = await receive()
        await self.ended.put(message["type"])
        if message["type"] == "http.request":
            await send({"type": "http.response.start", "status": 204, "headers": []})
            await send({"type": "http.response.body", "body": b""})


@pytest.mark.parametrize("part", [b"", b"half of what was announced"])
def test_a_body_that_stops_coming_is_given_up(monkeypatch: pytest.MonkeyPatch, part: bytes) -> None:
    monkeypatch.setattr(http_protocol, "BODY_SILENT_S", 0.05)

    async def go() -> None:
        app = Reading()
        async with asyncio.timeout(PATIENCE_S), served(app) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(HEADER + b"content-length: 1000\r\n\r\n" + part)
            assert await reader.read() == b""
            assert await app.ended.get() == "http.disconnect"
            writer.close()

    asyncio.run(go())


def test_a_body_that_comes_slowly_is_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_protocol, "BODY_SILENT_S", 0.5)

    async def go() -> None:
        app = Reading()
        async with asyncio.timeout(PATIENCE_S), served(app) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(HEADER + b"content-length: 8\r\n\r\n")
            for _ in range(8):
                await asyncio.sleep(0.1)
                writer.write(b"x")
            assert b"204" in await reader.readuntil(b"\r\n\r\n")
            assert await app.ended.get() == "http.request"
            # What was waited for is forgotten: an idle connection stays.
            await asyncio.sleep(0.7)
            writer.write(HEADER + b"\r\n")
            assert b"204" in await reader.readuntil(b"\r\n\r\n")
            writer.close()

    asyncio.run(go())


@pytest.mark.parametrize("sent", [b"no HTTP\r\n\r\n", HEADER + b"x: " + 70_000 * b"x"])
def test_what_is_no_request_is_refused_in_the_form_of_any_refusal(sent: bytes) -> None:
    async def go() -> None:
        async with asyncio.timeout(PATIENCE_S), served(Answering()) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(sent)
            head = await reader.readuntil(b"\r\n\r\n")
            assert head.startswith(b"HTTP/1.1 400 ")
            assert b"content-type: application/problem+json\r\n" in head
            assert msgspec.json.decode(await reader.read())["status"] == 400
            writer.close()

    asyncio.run(go())


async def hearing(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that takes a socket and says back what it hears."""
    del scope
    await receive()
    await send({"type": "websocket.accept"})
    while (message := await receive())["type"] == "websocket.receive":
        await send({"type": "websocket.send", "text": message["text"]})


def test_a_socket_may_be_silent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(http_protocol, "HEADER_WITHIN_S", 1.0)
    monkeypatch.setattr(http_protocol, "BODY_SILENT_S", 1.0)

    async def go() -> None:
        async with (
            asyncio.timeout(PATIENCE_S),
            served(hearing) as port,
            connect(f"ws://127.0.0.1:{port}/", proxy=None) as screen,
        ):
            await asyncio.sleep(1.5)
            await screen.send("still here")
            assert await screen.recv() == "still here"

    asyncio.run(go())


async def refusing(scope: Scope, receive: Receive, send: Send) -> None:
    """An application that refuses what is announced to be too large, unread."""
    del scope, receive
    await send({"type": "http.response.start", "status": 413, "headers": [(b"content-length", b"3")]})
    await send({"type": "http.response.body", "body": b"no!"})


BODY_BYTES = 16 * 1024 * 1024
POSTED = b"POST / HTTP/1.1\r\nhost: x\r\nconnection: close\r\ncontent-length: %d\r\n\r\n" % BODY_BYTES


def test_who_sends_all_before_it_reads_is_told_why_it_was_refused() -> None:
    async def go() -> None:
        async with asyncio.timeout(PATIENCE_S), served(refusing) as port:
            reader, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(POSTED + bytes(BODY_BYTES))
            await writer.drain()
            answer = await reader.read()
            assert answer.startswith(b"HTTP/1.1 413 ")
            assert b"connection: close\r\n" in answer
            assert answer.endswith(b"no!")
            writer.close()

    asyncio.run(go())


async def without_end(writer: asyncio.StreamWriter) -> None:
    """Send on for ever."""
    while True:
        writer.write(bytes(100))
        await writer.drain()
        await asyncio.sleep(0.01)


@pytest.mark.parametrize(("bound", "least"), [("LINGER_S", 0.1), ("LINGER_BYTES", 1000)])
def test_what_a_refused_client_still_sends_is_taken_in_within_bounds(
    monkeypatch: pytest.MonkeyPatch, bound: str, least: float
) -> None:
    monkeypatch.setattr(http_protocol, bound, least)

    async def go() -> None:
        async with asyncio.timeout(PATIENCE_S), served(refusing) as port:
            _, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(POSTED)
            with pytest.raises(ConnectionError):
                await without_end(writer)
            writer.close()

    asyncio.run(go())
