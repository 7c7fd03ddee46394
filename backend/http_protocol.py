"""An HTTP protocol for uvicorn that does not wait for a request's header without end.

A connection on which no request comes holds a file descriptor: as many as the process may have of them shut
honest gateways out. uvicorn itself times out only what is idle after an answer.
"""

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

HEADER_WITHIN_S = 10.0
"""On a poor radio link a header of some hundred bytes takes a second or two."""


class HeaderWithin(HttpToolsProtocol):
    """uvicorn's HTTP protocol; a connection whose request has no whole header in time is closed."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # uvicorn's own signature, whatever it is
        super().__init__(*args, **kwargs)
        self._header_due: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn
        """Wait for the first request's header."""
        super().connection_made(transport)
        self._await_header()

    def data_received(self, data: bytes) -> None:
        """Wait for the header of what begins on a connection that was idle."""
        if self.timeout_keep_alive_task is not None:
            self._await_header()
        super().data_received(data)

    def on_headers_complete(self) -> None:
        """It is here."""
        self._stop_waiting()
        super().on_headers_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is waited for any more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def _await_header(self) -> None:
        self._stop_waiting()
        # The handler that closes what is idle does the same here.
        self._header_due = self.loop.call_later(HEADER_WITHIN_S, self.timeout_keep_alive_handler)

    def _stop_waiting(self) -> None:
        if self._header_due is not None:
            self._header_due.cancel()
            self._header_due = None
