"""Answers that take long are given up when whoever asks has gone."""

import asyncio
from collections.abc import Coroutine
from typing import Any, TypeVar

from starlette.requests import Request

from backend.errors import TooSlow

T = TypeVar("T")


async def while_asked(request: Request, answer: Coroutine[Any, Any, T]) -> T:
    """What is asked for, as long as somebody waits for it.

    Args:
        request: by which it is asked, without a body.
        answer: works it out; it is cancelled when the client hangs up.

    Raises:
        TooSlow: the client has hung up; nobody reads that.
    """
    answering, leaving = asyncio.create_task(answer), asyncio.create_task(_left(request))
    try:
        await asyncio.wait((answering, leaving), return_when=asyncio.FIRST_COMPLETED)
        if answering.done():
            return answering.result()
        raise TooSlow("Whoever asked has gone.")
    finally:
        leaving.cancel()
        answering.cancel()


async def _left(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
