"""Sums that take long, kept by what was asked: whoever asks again finds them done."""

import asyncio
import math
from collections import OrderedDict
from collections.abc import Callable, Coroutine, Hashable
from typing import Any, Generic, TypeVar

from backend.errors import TooSlow

AGAIN_AFTER_S = 60

RETURNS_WITHIN_S = 2.0 * AGAIN_AFTER_S
"""Who was told to ask again, and has not for so long, has gone."""

T = TypeVar("T")


class _Sum(Generic[T]):
    """A sum that is done, under way, or waits for its turn.

    Args:
        seq: newest log entry in it.
        begin: begins it.
        turn: whose it is, begins.

    Attributes:
        seq: newest log entry in it.
        began: when it was asked for first, by the clock of the event loop (s).
        waiting: so many wait for it now.
        returns_until: so long may somebody ask again who was told to (s).
    """

    def __init__(self, seq: int, begin: Callable[[], Coroutine[Any, Any, T]], turn: asyncio.Lock) -> None:
        self.seq = seq
        self.began = self._ended = asyncio.get_running_loop().time()
        self.waiting = 0
        self.returns_until = -math.inf
        self.task = asyncio.create_task(self._timed(begin, turn))

    async def _timed(self, begin: Callable[[], Coroutine[Any, Any, T]], turn: asyncio.Lock) -> T:
        try:
            async with turn:
                if self.waiting == 0 and self.returns_until < asyncio.get_running_loop().time():
                    raise asyncio.CancelledError
                return await begin()
        finally:
            self._ended = asyncio.get_running_loop().time()

    @property
    def failed(self) -> bool:
        return self.task.done() and (self.task.cancelled() or self.task.exception() is not None)

    def answers(self, seq: int, within_s: float) -> bool:
        """Whether what it gave is told to who knows of log entry `seq` and would wait for another so long.

        Of a log that grows, a sum that takes longer would never be told: by then there is a newer entry. It
        is told for as long again as it took.
        """
        took_s = self._ended - self.began
        recent = asyncio.get_running_loop().time() - self._ended < took_s
        return self.seq >= seq or (took_s > within_s / 2 and recent)


class Kept(Generic[T]):
    """Sums that are done or under way, by what was asked; asking twice for the same one costs once.

    One whose turn comes when nobody waits for it any more is not begun.

    Args:
        most: as many are kept, those asked for most recently; older ones are given up.
        turn: whose it is, begins; shared by all that are done in the same process.
    """

    def __init__(self, most: int, turn: asyncio.Lock) -> None:
        self._most = most
        self._turn = turn
        self._sums: OrderedDict[Hashable, _Sum[T]] = OrderedDict()

    async def get(
        self,
        key: Hashable,
        seq: int,
        begin: Callable[[], Coroutine[Any, Any, T]],
        within_s: float,
        doing: str,
    ) -> T:
        """What a sum over a log gives: with all of it, unless that takes long, then as it was some time ago.

        Args:
            key: what is asked.
            seq: newest entry of the log.
            begin: begins the sum, where it is neither done nor under way, or has failed.
            within_s: as long is it waited for (s).
            doing: what is done, as the beginning of a sentence.

        Raises:
            TooSlow: it takes long, and goes on; or too much else was asked for since.
        """
        until = asyncio.get_running_loop().time() + within_s
        while True:
            one = self._sums.get(key)
            if one is None or one.failed or (one.task.done() and not one.answers(seq, within_s)):
                one = self._sums[key] = _Sum(seq, begin, self._turn)
            self._sums.move_to_end(key)
            while len(self._sums) > self._most:
                _, oldest = self._sums.popitem(last=False)
                oldest.task.cancel()
            given = await self._waited_for(one, until, within_s, doing)
            if one.answers(seq, within_s):
                return given

    async def _waited_for(self, one: _Sum[T], until: float, within_s: float, doing: str) -> T:
        one.waiting += 1
        try:
            async with asyncio.timeout_at(until):
                return await asyncio.shield(one.task)
        except TimeoutError:
            one.returns_until = asyncio.get_running_loop().time() + RETURNS_WITHIN_S
            so_far_s = asyncio.get_running_loop().time() - one.began
            raise TooSlow(
                f"{doing} takes longer than {within_s:g} s; it goes on, {so_far_s:.0f} s so far: "
                "ask again in a minute.",
                retry_after_s=AGAIN_AFTER_S,
            ) from None
        except asyncio.CancelledError:
            if not one.task.cancelled():
                raise  # it is the request that was given up
            raise TooSlow(
                "Other sums are in the way: ask again in a minute.", retry_after_s=AGAIN_AFTER_S
            ) from None
        finally:
            one.waiting -= 1

    def cancel(self) -> None:
        """Give up what is under way."""
        for one in self._sums.values():
            one.task.cancel()
