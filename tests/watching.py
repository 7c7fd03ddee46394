"""A screen for tests: a socket of a running server, and the picture that its messages make."""

import contextlib
import time
from collections.abc import Callable, Iterator
from typing import Any

import msgspec
from websockets.sync.client import ClientConnection, connect

Message = dict[str, Any]


class Screen:
    """Hears messages, and holds the picture as a screen does.

    Args:
        connection: its socket.
    """

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.messages: list[Message] = []
        self.nodes: dict[str, Message] = {}
        self.seq = 0

    def hear(self, timeout_s: float = 5.0) -> Message:
        """The next message."""
        message: Message = msgspec.json.decode(self.connection.recv(timeout=timeout_s))
        self.messages.append(message)
        if message["type"] in {"frame", "delta"}:
            self.nodes = {} if message["type"] == "frame" else self.nodes
            self.nodes |= {node["node"]: node for node in message["nodes"]}
            self.seq = message["seq"]
        return message

    def until(self, condition: Callable[[Message], object], within_s: float = 10.0) -> Message:
        """The first message that fulfils a condition."""
        deadline = time.monotonic() + within_s
        while True:
            left_s = deadline - time.monotonic()
            assert left_s > 0, f"not within {within_s} s; last heard: {self.messages[-3:]}"
            message = self.hear(left_s)
            if condition(message):
                return message

    def say(self, message: object) -> None:
        """Send a message."""
        self.connection.send(message if isinstance(message, str) else msgspec.json.encode(message).decode())


@contextlib.contextmanager
def watching(url: str, path: str) -> Iterator[Screen]:
    """A screen on a path of the API for the length of a block."""
    address = url.replace("http", "ws", 1) + "/api/v1" + path
    with connect(address, compression=None, max_size=None, open_timeout=30) as connection:
        yield Screen(connection)
