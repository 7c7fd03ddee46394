"""An HTTP protocol for uvicorn that does not wait for a request without end, nor without bound.

A connection on which no request comes holds a file descriptor: as many as the process may have of them shut
honest gateways out. uvicorn itself times out only what is idle after an answer, and a vehicle that drives out
of its network in the middle of a batch never closes its connection.
"""

import asyncio
from typing import Any

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from backend.errors import NotUnderstood

HEADER_WITHIN_S = 10.0
"""On a poor radio link a header of some hundred bytes takes a second or two."""

MAX_HEADER_BYTES = 64 * 1024
"""A header with the longest cookies and addresses that browsers send has a quarter of it."""

LINGER_S = 30.0
LINGER_BYTES = 64 * 1024 * 1024
"""What a refused client may still send before its connection is closed: several of the largest batches. A
socket that is closed with something unread takes the answer back, and a client that first sends all of its
body never sees why it was refused."""

BODY_SILENT_S = 60.0
"""A link that is lost for longer has lost its connection too: retransmissions come so far apart by then."""


class RequestWithin(HttpToolsProtocol):
    """uvicorn's HTTP protocol; a connection whose request does not come on in time is closed.

    What is no HTTP is refused in the form in which any request is.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # uvicorn's own signature, whatever it is
        super().__init__(*args, **kwargs)
        self._due: asyncio.TimerHandle | None = None
        self._in_body = False
        self._header_bytes = 0
        self._linger_bytes: int | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as uvicorn
        """Wait for the first request's header."""
        super().connection_made(transport)
        self._await_header()

    def data_received(self, data: bytes) -> None:
        """Wait for the header of what begins on a connection that was idle, and for the rest of a body."""
        if self._linger_bytes is not None:
            self._linger_bytes += len(data)
            if self._linger_bytes > LINGER_BYTES:
                self.transport.close()
            return
        if self.timeout_keep_alive_task is not None:
            self._await_header()
        in_header = self._due is not None and not self._in_body
        super().data_received(data)
        if self._in_body:
            self._wait(BODY_SILENT_S)
        elif in_header and self._due is not None:
            self._header_bytes += len(data)
            if self._header_bytes > MAX_HEADER_BYTES and not self.transport.is_closing():
                self.send_400_response(f"The header of the request is larger than {MAX_HEADER_BYTES} bytes.")

    def on_headers_complete(self) -> None:
        """It is here."""
        self._stop_waiting()
        self._in_body = True
        before = self.cycle
        super().on_headers_complete()
        if self.cycle is not before and not self.cycle.keep_alive:
            self.cycle.transport = _ClosedLast(self)  # type: ignore[assignment]  # all that a cycle uses of it

    def on_message_complete(self) -> None:
        """The body is here as well, if there is one."""
        self._stop_waiting()
        self._in_body = False
        super().on_message_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        """Nothing is waited for any more."""
        self._stop_waiting()
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """Go on to the next request, if there may be one."""
        super().on_response_complete()
        if self._linger_bytes is not None:
            self._unset_keepalive_if_required()

    def close(self) -> None:
        """Close once what was asked is answered; first take in the rest of its body, within bounds."""
        if not self._in_body or self.transport.is_closing() or not self.transport.can_write_eof():
            self.transport.close()
            return
        self._linger_bytes = 0
        self._stop_waiting()
        self._due = self.loop.call_later(LINGER_S, self.transport.close)
        self.transport.write_eof()
        self.flow.resume_reading()

    def send_400_response(self, msg: str) -> None:
        """Refuse what is no HTTP, and close."""
        self.transport.write(NotUnderstood(msg).last_response())
        self.transport.close()

    def _await_header(self) -> None:
        self._header_bytes = 0
        self._wait(HEADER_WITHIN_S)

    def _wait(self, within_s: float) -> None:
        self._stop_waiting()
        self._due = self.loop.call_later(within_s, self._give_up, within_s)

    def _give_up(self, within_s: float) -> None:
        if self.flow.read_paused:  # it is we who do not read
            self._wait(within_s)
        elif not self.transport.is_closing():
            self.transport.close()

    def _stop_waiting(self) -> None:
        if self._due is not None:
            self._due.cancel()
            self._due = None


class _ClosedLast:
    """The transport of a request after which the connection closes.

    Args:
        protocol: which closes it.
    """

    def __init__(self, protocol: RequestWithin) -> None:
        self.write = protocol.transport.write
        self.is_closing = protocol.transport.is_closing
        self.close = protocol.close
