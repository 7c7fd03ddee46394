"""How large the body of a request may be, telemetry aside: that route has limits of its own."""

from starlette.routing import BaseRoute, Match
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from backend.authentication import SESSION_PATH
from backend.errors import TooLarge
from backend.problems import answer

SESSION_BYTES = 64 * 1024
"""Whoever signs in has shown no token yet."""

MAX_BYTES = 1024 * 1024


class BodyLimit:
    """ASGI middleware: takes a body in whole before the application hears of it, and refuses a large one.

    Args:
        app: the application behind it.
        telemetry: the route whose bodies pass unread.
    """

    def __init__(self, app: ASGIApp, telemetry: BaseRoute) -> None:
        self.app = app
        self.telemetry = telemetry

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it with 413."""
        if not _has_body(scope) or self.telemetry.matches(scope)[0] is Match.FULL:
            await self.app(scope, receive, send)
            return
        limit = SESSION_BYTES if scope["path"] == SESSION_PATH else MAX_BYTES
        try:
            body = await _whole(scope, receive, limit)
        except TooLarge as problem:
            await answer(problem)(scope, receive, send)
            return
        if body is None:
            return  # the client hung up, and nobody is there to be answered
        given = False

        async def receive_whole() -> Message:
            nonlocal given
            if given:
                return await receive()
            given = True
            return {"type": "http.request", "body": body, "more_body": False}

        await self.app(scope, receive_whole, send)


def _has_body(scope: Scope) -> bool:
    return scope["type"] == "http" and any(
        name == b"transfer-encoding" or (name == b"content-length" and value != b"0")
        for name, value in scope["headers"]
    )


async def _whole(scope: Scope, receive: Receive, limit: int) -> bytes | None:
    """The body of a request; None where the client hung up before it was whole.

    Raises:
        TooLarge: it is over the limit (bytes), or is announced to be.
    """
    for name, value in scope["headers"]:
        if name == b"content-length" and value.isdigit() and int(value) > limit:
            raise _too_large(limit)
    body = bytearray()
    more = True
    while more:
        message = await receive()
        if message["type"] == "http.disconnect":
            return None
        body += message.get("body", b"")
        if len(body) > limit:
            raise _too_large(limit)
        more = message.get("more_body", False)
    return bytes(body)


def _too_large(limit: int) -> TooLarge:
    return TooLarge(f"The body is larger than the {limit} bytes that this page takes. Send less at once.")
