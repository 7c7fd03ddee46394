"""Web process and worker tell each other what they know, and neither waits for the other."""

import asyncio
import socket
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager

import pytest

from backend.coordination import web_link, worker_link
from backend.coordination.base import Answer, Picture, Query, ToWorker, Wake
from backend.coordination.framing import Hello, framed
from backend.coordination.web_link import WebLink
from backend.coordination.worker_link import WorkerLink
from backend.errors import TooSlow, Unavailable
from tests.running import free_port

TOKEN = "a shared secret"  # noqa: S105 - of a test


def listener(port: int = 0) -> socket.socket:
    return socket.create_server(("127.0.0.1", port))


@asynccontextmanager
async def web_side(pictures: list[Picture], port: int = 0) -> AsyncIterator[tuple[WebLink, tuple[str, int]]]:
    with listener(port) as sock:
        web = WebLink(sock, TOKEN)
        web.on_picture(pictures.append)
        await web.start()
        try:
            yield web, sock.getsockname()
        finally:
            await web.stop()


@asynccontextmanager
async def worker_side(
    address: tuple[str, int], token: str = TOKEN
) -> AsyncIterator[tuple[WorkerLink, asyncio.Event]]:
    connected = asyncio.Event()
    worker = WorkerLink(address, token, "north", connected.set)
    worker.start()
    try:
        yield worker, connected
    finally:
        await worker.close()


async def until(condition: Callable[[], object], within_s: float = 5.0) -> None:
    async with asyncio.timeout(within_s):
        while not condition():  # noqa: ASYNC110 - what is waited for has no event
            await asyncio.sleep(0.005)


async def heard(worker: WorkerLink) -> list[ToWorker]:
    return await worker.receive(2.0)


def run(test: Awaitable[None]) -> None:
    async def whole() -> None:
        async with asyncio.timeout(30.0):
            await test

    asyncio.run(whole())


def test_a_picture_reaches_the_web_process_and_a_wake_up_the_worker() -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        async with web_side(pictures) as (web, address), worker_side(address) as (worker, connected):
            await connected.wait()
            await until(lambda: web.connected)
            worker.publish(Picture("i1", 7, b"record"))
            await until(lambda: pictures)
            assert pictures == [Picture("i1", 7, b"record")]
            web.wake("i1", 8)
            assert await heard(worker) == [Wake("i1", 8)]

    run(go())


def test_a_worker_that_falls_silent_is_no_longer_taken_to_be_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_link, "SILENT_AFTER_S", 0.2)

    async def go() -> None:
        async with web_side([]) as (web, address):
            reader, writer = await asyncio.open_connection(*address)
            writer.write(framed(Hello(TOKEN, "hangs")))
            await until(lambda: web.connected)
            await until(lambda: not web.connected)
            assert await reader.read() == b""
            writer.close()

    run(go())


def test_a_worker_with_nothing_to_tell_stays_connected(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(web_link, "SILENT_AFTER_S", 0.2)
    monkeypatch.setattr(worker_link, "ALIVE_EVERY_S", 0.05)

    async def go() -> None:
        times = 0

        def connected() -> None:
            nonlocal times
            times += 1

        async with web_side([]) as (web, address):
            worker = WorkerLink(address, TOKEN, "north", connected)
            worker.start()
            await until(lambda: web.connected)
            await asyncio.sleep(0.6)
            assert (web.connected, times) == (True, 1)
            await worker.close()

    run(go())


def test_a_question_is_answered_by_the_worker_that_follows_the_incident() -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        async with web_side(pictures) as (web, address), worker_side(address) as (worker, connected):
            await connected.wait()
            worker.publish(Picture("i1", 1, b""))
            await until(lambda: pictures)
            asking = asyncio.create_task(web.ask("i1", "ff1", "ff2", 2.0))
            (query,) = await heard(worker)
            assert isinstance(query, Query)
            assert (query.incident, query.a, query.b) == ("i1", "ff1", "ff2")
            worker.publish(Answer(query.number, found=True, delta_m=(1.0, 2.0, 3.0)))
            assert (await asking).delta_m == (1.0, 2.0, 3.0)

    run(go())


def test_a_question_without_a_worker_or_without_an_answer_ends_in_a_clear_refusal() -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        async with web_side(pictures) as (web, address):
            with pytest.raises(Unavailable):
                await web.ask("i1", "a", "b", 1.0)
            async with worker_side(address) as (worker, connected):
                await connected.wait()
                worker.publish(Picture("i1", 1, b""))
                await until(lambda: pictures)
                with pytest.raises(TooSlow):
                    await web.ask("i1", "a", "b", 0.05)

    run(go())


def test_a_worker_comes_back_after_the_web_process_has_started_again() -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        port = free_port()
        async with worker_side(("127.0.0.1", port)) as (worker, connected):
            for round_ in range(3):
                connected.clear()
                async with web_side(pictures, port) as (web, _):
                    await connected.wait()
                    await until(lambda web=web: web.connected)  # type: ignore[misc]  # mypy cannot infer a lambda with defaults
                    worker.publish(Picture("i1", round_, b""))
                    await until(lambda wanted=round_: len(pictures) > wanted)  # type: ignore[misc]  # mypy cannot infer a lambda with defaults
        assert [picture.seq for picture in pictures] == [0, 1, 2]

    run(go())


def test_a_worker_with_a_wrong_token_is_not_heard() -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        async with (
            web_side(pictures) as (web, address),
            worker_side(address, "a guess") as (stranger, connected),
            worker_side(address) as (worker, _),
        ):
            await connected.wait()
            stranger.publish(Picture("i1", 666, b""))
            await until(lambda: web.connected)
            worker.publish(Picture("i1", 1, b""))
            await until(lambda: pictures)
            await asyncio.sleep(0.1)
            assert {picture.seq for picture in pictures} == {1}

    run(go())


@pytest.mark.parametrize(
    "noise",
    [b"GET / HTTP/1.1\r\n\r\n", b"\xff" * 64, b"\x00\x00\x00\x01\xc1", framed(Wake("i1", 1)), b"\x00\x00"],
)
def test_noise_on_the_port_harms_nobody(noise: bytes) -> None:
    async def go() -> None:
        pictures: list[Picture] = []
        async with web_side(pictures) as (_, address):
            _, writer = await asyncio.open_connection(*address)
            writer.write(noise)
            async with worker_side(address) as (worker, connected):
                await connected.wait()
                worker.publish(Picture("i1", 1, b""))
                await until(lambda: pictures)
            writer.close()

    run(go())


def test_a_web_process_that_does_not_read_never_stops_the_worker_and_then_gets_the_newest() -> None:
    async def go() -> None:
        seen: list[Picture] = []
        may_read = asyncio.Event()

        async def slowly(picture: Picture) -> None:
            await may_read.wait()
            seen.append(picture)

        with listener() as sock:
            web = WebLink(sock, TOKEN)
            web.on_picture(slowly)
            await web.start()
            async with worker_side(sock.getsockname()) as (worker, connected):
                await connected.wait()
                for seq in range(1, 2001):
                    worker.publish(Picture("i1", seq, bytes(100_000)))
                    if seq % 100 == 0:
                        await asyncio.sleep(0)
                may_read.set()
                await until(lambda: seen and seen[-1].seq == 2000, within_s=20.0)
            await web.stop()
        assert len(seen) < 500, "a backlog was kept"

    run(go())


def test_wake_ups_for_a_worker_that_does_not_read_are_one_an_incident() -> None:
    async def go() -> None:
        async with web_side([]) as (web, address), worker_side(address) as (worker, connected):
            await connected.wait()
            await until(lambda: web.connected)
            for seq in range(50_000):
                web.wake(f"i{seq % 3}", seq)
            newest: dict[str, int] = {}
            while len(newest) < 3 or min(newest.values()) < 49_997:
                for message in await heard(worker):
                    assert isinstance(message, Wake)
                    newest[message.incident] = message.seq

    run(go())
