"""The built screen, served with headers that keep it to itself."""

from pathlib import Path

from starlette.middleware.gzip import GZipMiddleware
from starlette.responses import PlainTextResponse, Response
from starlette.staticfiles import StaticFiles
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket

from backend.errors import NotFound
from backend.problems import deny

FOLDER = Path(__file__).parent / "screen"
CONTENT_SECURITY_POLICY = (
    "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
    "connect-src 'self' ws: wss:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
)
"""Nothing is loaded from elsewhere; Svelte's transitions set inline styles."""


class Screen(StaticFiles):
    """Static files of the built front end, compressed; the browser keeps those with a hash in their name."""

    def __init__(self) -> None:
        super().__init__(directory=FOLDER, html=True, check_dir=False)
        self._compressed = GZipMiddleware(super().__call__, compresslevel=6)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer with a file; a socket that no route of the API takes ends here, as not found."""
        if scope["type"] == "websocket":
            await deny(WebSocket(scope, receive, send), NotFound(f"there is no socket at {scope['path']}"))
            return
        await self._compressed(scope, receive, send)

    async def check_config(self) -> None:
        """Nothing: a screen that is not built yet is answered below, page by page."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """The file at a path; instead of the first page of a screen that is not built, how to build it."""
        if path in {".", "index.html"} and not (FOLDER / "index.html").is_file():
            return PlainTextResponse("The screen is not built yet: run `make screen`.\n", 503)
        response = await super().get_response(path, scope)
        response.headers["Content-Security-Policy"] = CONTENT_SECURITY_POLICY
        response.headers["X-Content-Type-Options"] = "nosniff"
        response.headers["Referrer-Policy"] = "no-referrer"
        immutable = path.startswith("assets/")
        response.headers["Cache-Control"] = "max-age=31536000, immutable" if immutable else "no-cache"
        return response
