"""A WebSocket protocol for uvicorn that takes ready-made frames: serialised once, written to every screen.

uvicorn's own protocol builds a WebSocket frame for each client and each message. Here a message is built
once, and written to each connection that has taken the last one; one that has not is passed over, and told
apart when it can take more. So no screen waits for another, and no backlog arises.
"""

import asyncio
import socket
import struct
from collections.abc import Callable
from typing import Any

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from backend.errors import NotUnderstood

EXTENSION = "firethread.push"
"""Under this name of the ASGI scope's extensions a route finds its connection, a `PushProtocol`."""

UNSENT_BYTES = 32 * 1024
"""What the kernel may hold unsent for a connection: more would be a backlog of old pictures."""

NO_HANDSHAKE = NotUnderstood(
    "This is no handshake of a WebSocket: send one without a body, and no line of it longer than 8 KiB."
)

GOING_AWAY = 1001
_TEXT = 0x81
_SHORT, _MEDIUM = 125, 0xFFFF


def text_frame(payload: bytes) -> bytes:
    """An unmasked WebSocket text frame (RFC 6455, section 5.2), final and whole.

    Args:
        payload: UTF-8.
    """
    size = len(payload)
    if size <= _SHORT:
        return bytes((_TEXT, size)) + payload
    if size <= _MEDIUM:
        return struct.pack("!BBH", _TEXT, 126, size) + payload
    return struct.pack("!BBQ", _TEXT, 127, size) + payload


class PushProtocol(WebSocketsSansIOProtocol):
    """uvicorn's WebSocket protocol with a way past its queue for messages that go to many."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:  # uvicorn's own signature, whatever it is
        super().__init__(*args, **kwargs)
        self.on_writable: Callable[[], None] | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Bound what may wait for this connection."""
        super().connection_made(transport)
        self.transport.set_write_buffer_limits(high=0)
        connection = transport.get_extra_info("socket")
        if connection is not None and connection.family in {socket.AF_INET, socket.AF_INET6}:
            connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT_BYTES)

    async def run_asgi(self) -> None:
        """Run the application, with `push` among what it is told of the connection."""
        extensions = self.scope["extensions"]
        assert extensions is not None  # noqa: S101 - uvicorn sets it
        extensions[EXTENSION] = {"connection": self}
        await super().run_asgi()

    def handle_events(self) -> None:
        """Refuse what is no handshake, where uvicorn would neither answer nor close."""
        super().handle_events()
        if self.conn.handshake_exc is not None and not self.transport.is_closing():
            self.close_sent = True
            self.transport.write(NO_HANDSHAKE.last_response())
            self.transport.close()

    async def send(self, message: Any) -> None:  # an ASGI event
        """Do what the application asks; a handshake that it has denied is over."""
        await super().send(message)
        if self.initial_response is not None and self.close_sent:
            self.handshake_complete = (
                True  # or uvicorn logs an error for each, and whoever knocks fills the log
            )

    def push(self, frame: bytes) -> bool:
        """Write a ready-made frame, if the connection has taken what was written before.

        Returns:
            False where it has not, or is closing: nothing is written.
        """
        if not self.writable.is_set() or self.close_sent or self.transport.is_closing():
            return False
        self.transport.write(frame)
        return True

    def resume_writing(self) -> None:
        """The connection has taken what was written."""
        super().resume_writing()
        if self.on_writable is not None:
            self.on_writable()

    def shutdown(self) -> None:
        """Say goodbye when the server stops: 1001, going away, where uvicorn says 1012."""
        if self.handshake_complete and not self.close_sent:
            self.stop_keepalive()
            self.queue.put_nowait({"type": "websocket.disconnect", "code": GOING_AWAY})
            self.conn.send_close(GOING_AWAY)
            self.close_sent = True
            self.transport.write(b"".join(self.conn.data_to_send()))
            self.transport.close()
        else:
            super().shutdown()
