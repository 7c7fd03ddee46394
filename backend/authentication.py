"""Who may ask: one access token per deployment, as bearer token for gateways and as cookie for screens."""

import hmac
import secrets
from http.cookies import CookieError, SimpleCookie
from pathlib import Path
from urllib.parse import parse_qs

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from backend.errors import CommandRefused, NotAuthenticated, in_reach
from backend.problems import answer, deny

COOKIE = "firethread"
SOCKET_TOKEN = "token"  # noqa: S105 - the parameter's name, not a secret
TOKEN_FILE = "access-token"  # noqa: S105 - the file's name, not a secret
PROTECTED_PREFIX = "/api/"
SESSION_PATH = "/api/v1/session"
EIGHT_HOURS_S = 8 * 3600
"""A screen stays signed in for a long shift."""


def access_token(data: Path) -> str:
    """The token of a data folder, made at first use and readable by its owner only.

    Args:
        data: folder of the deployment.

    Raises:
        CommandRefused: it cannot be read or written.
    """
    path = data / TOKEN_FILE
    if not (token := _stored_token(path)):
        token = secrets.token_urlsafe(24)
        with in_reach(path):
            path.touch(mode=0o600)
            path.chmod(0o600)
            path.write_text(token + "\n")
    return token


def existing_token(data: Path) -> str:
    """The token of a data folder that a server has served from.

    Args:
        data: folder of the deployment.

    Raises:
        CommandRefused: there is none, or it cannot be read.
    """
    path = data / TOKEN_FILE
    token = _stored_token(path)
    if not token:
        raise CommandRefused(f"there is no access token in {path}: name the folder of the server's --data")
    return token


def _stored_token(path: Path) -> str:
    """The token in a file; empty where there is none."""
    with in_reach(path):
        return path.read_text().strip() if path.is_file() else ""


class Authentication:
    """ASGI middleware: requests to the API need the token; pages, health and metrics do not.

    Args:
        app: the application behind it.
        token: the access token; None lets everybody in.
    """

    def __init__(self, app: ASGIApp, token: str | None) -> None:
        self.app = app
        self.token = None if token is None else token.encode()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if (
            self.token is None
            or scope["type"] == "lifespan"
            or not scope["path"].startswith(PROTECTED_PREFIX)
            or scope["path"] == SESSION_PATH
            or self._carries_token(scope)
        ):
            await self.app(scope, receive, send)
            return
        problem = NotAuthenticated(
            "send the header `Authorization: Bearer TOKEN`, or sign in on the screen; the token stands in "
            f"the file `{TOKEN_FILE}` of the server's data folder"
        )
        if scope["type"] == "websocket":
            await deny(WebSocket(scope, receive, send), problem)
            return
        await answer(problem)(scope, receive, send)

    def _carries_token(self, scope: Scope) -> bool:
        """Whether header, cookie or (for sockets of programs) query names the token."""
        assert self.token is not None  # noqa: S101 - callers have asked
        for name, value in scope["headers"]:
            if name == b"authorization" and value[:7].lower() == b"bearer ":
                return hmac.compare_digest(value[7:].strip(), self.token)
            if name == b"cookie":
                try:
                    cookie = SimpleCookie(value.decode("latin-1")).get(COOKIE)
                except CookieError:
                    continue
                if cookie is not None and hmac.compare_digest(cookie.value.encode(), self.token):
                    return True
        if scope["type"] == "websocket":
            given = parse_qs(scope["query_string"].decode("latin-1")).get(SOCKET_TOKEN, [""])[0]
            return hmac.compare_digest(given.encode(), self.token)
        return False


class SignIn(BaseModel):
    """What a screen sends to be let in."""

    token: str = Field(min_length=1, max_length=200, description="The access token of the deployment.")


def session_router(token: str | None) -> APIRouter:
    """The route by which a screen signs in.

    Args:
        token: the access token; None lets everybody in.
    """
    router = APIRouter(tags=["access"])

    @router.post(SESSION_PATH, status_code=204)
    def sign_in(given: SignIn, response: Response) -> None:
        """Trade the access token for a cookie that scripts of a page cannot read."""
        if token is not None:
            if not hmac.compare_digest(given.token.encode(), token.encode()):
                raise NotAuthenticated("that is not the access token of this deployment")
            response.set_cookie(COOKIE, token, max_age=EIGHT_HOURS_S, httponly=True, samesite="strict")

    return router
