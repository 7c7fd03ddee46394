"""What nobody waits for any more is given up."""

import asyncio

import pytest
from starlette.requests import Request
from starlette.types import Message

from backend.errors import TooSlow
from backend.tracking.asked import while_asked


class Asker:
    """A client that has sent its request, and hangs up when it is told to."""

    def __init__(self) -> None:
        self._messages: asyncio.Queue[Message] = asyncio.Queue()
        self._messages.put_nowait({"type": "http.request", "body": b"", "more_body": False})
        self.request = Request({"type": "http"}, self._messages.get)

    def hangs_up(self) -> None:
        self._messages.put_nowait({"type": "http.disconnect"})


def test_who_waits_gets_what_was_asked_for_and_what_was_refused() -> None:
    async def ask() -> None:
        async def answer() -> int:
            await asyncio.sleep(0.01)
            return 7

        async def refusal() -> int:
            raise ValueError("no")

        assert await while_asked(Asker().request, answer()) == 7
        with pytest.raises(ValueError, match="no"):
            await while_asked(Asker().request, refusal())

    asyncio.run(ask())


def test_what_is_worked_out_for_who_hangs_up_or_is_given_up_is_cancelled() -> None:
    async def ask(*, hangs_up: bool) -> None:
        ended = asyncio.Event()

        async def for_ever() -> None:
            try:
                await asyncio.Event().wait()
            finally:
                ended.set()

        asker = Asker()
        asked = asyncio.create_task(while_asked(asker.request, for_ever()))
        await asyncio.sleep(0.01)
        if hangs_up:
            asker.hangs_up()
        else:
            asked.cancel()
        with pytest.raises((TooSlow, asyncio.CancelledError)):
            await asked
        async with asyncio.timeout(1.0):
            await ended.wait()

    asyncio.run(ask(hangs_up=True))
    asyncio.run(ask(hangs_up=False))
