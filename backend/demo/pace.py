"""When what is played is due."""

import asyncio
import math

AHEAD_S = 1.0
"""Where the readings are the clock, no gateway posts what is due later than this after what another has still
to post (s of the scenario): one that waits for its answers would be late by what the others tell."""


class Pace:
    """The clock of a scenario that is played faster or slower, no faster than the server takes it.

    Args:
        speed: how fast; at 1 each gateway goes by the real time, whatever becomes of the others.
        gateways: all that post, each of which says when it has `done`.

    Attributes:
        began: when, by the event loop's clock (s).
    """

    def __init__(self, speed: float, gateways: list[str]) -> None:
        self._speed = speed
        self._ahead_s = math.inf if speed == 1.0 else AHEAD_S
        self.began = asyncio.get_running_loop().time()
        self._next_s = dict.fromkeys(gateways, 0.0)
        self._gone_on = asyncio.Condition()

    async def wait(self, gateway: str, due_s: float) -> None:
        """Wait until a batch is due, which follows when all before it of its gateway are posted.

        Args:
            gateway: whose it is.
            due_s: when it is due, in the scenario's time (s).
        """
        await self._tell(gateway, due_s)
        await asyncio.sleep(self.began + due_s / self._speed - asyncio.get_running_loop().time())
        async with self._gone_on:
            await self._gone_on.wait_for(lambda: min(self._next_s.values()) >= due_s - self._ahead_s)

    async def done(self, gateway: str) -> None:
        """Nobody waits for a gateway any more: all is posted."""
        await self._tell(gateway, math.inf)

    async def _tell(self, gateway: str, due_s: float) -> None:
        async with self._gone_on:
            self._next_s[gateway] = due_s
            self._gone_on.notify_all()
