"""What waits to be sent over the link: bounded, and the newest of a kind wins."""

import asyncio
from collections.abc import Hashable

MAX_WAITING = 10_000
"""Distinct things that may wait; beyond, the oldest is dropped. Wake-ups and pictures are one an incident."""


class Outbox:
    """Messages by key; putting never blocks, and a slow peer finds the newest of each key.

    Args:
        max_waiting: how many keys may wait.
    """

    def __init__(self, max_waiting: int = MAX_WAITING) -> None:
        self._waiting: dict[Hashable, bytes] = {}
        self._max_waiting = max_waiting
        self._something = asyncio.Event()

    def put(self, key: Hashable, message: bytes) -> None:
        """Have a message sent; one of the same key that still waits is superseded and keeps its place."""
        self._waiting[key] = message
        if len(self._waiting) > self._max_waiting:
            del self._waiting[next(iter(self._waiting))]
        self._something.set()

    def clear(self) -> None:
        """Forget what waits."""
        self._waiting.clear()

    async def send_to(self, writer: asyncio.StreamWriter) -> None:
        """Send what is put, for ever, as fast as the peer takes it.

        Raises:
            ConnectionError: the peer is gone.
        """
        while True:
            await self._something.wait()
            self._something.clear()
            while self._waiting:
                key = next(iter(self._waiting))
                writer.write(self._waiting.pop(key))
                await writer.drain()
