"""Answers compressed for those who take gzip: a tablet's link is weak where a processor is not."""

from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Receive, Scope, Send

LONG_ONES = "/api/v1/incidents/"
"""What is asked of an incident may be long: its log, tracks, frames."""

LEAST_BYTES = 4096

LEVEL = 1
"""Of 5 MB of a log it leaves 18 % in 50 ms, where level 6 leaves 11 % in 400 ms; of tracks 46 and 43 %."""


class Compression:
    """Middleware that compresses what is asked of incidents; what comes in passes by it, untouched.

    Args:
        app: what it is put around.
    """

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._compressed = GZipMiddleware(app, minimum_size=LEAST_BYTES, compresslevel=LEVEL)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on."""
        asks = scope["type"] == "http" and scope["method"] == "GET" and scope["path"].startswith(LONG_ONES)
        await (self._compressed if asks else self._app)(scope, receive, send)
