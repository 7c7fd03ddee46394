"""Where an incident is folded: in one of the threads for that, one piece of its work at a time."""

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor
from typing import ParamSpec, TypeVar

from backend.errors import Unavailable

P = ParamSpec("P")
T = TypeVar("T")


class EstimatorFailed(Exception):  # noqa: N818 - names the condition
    """The tracker raised what it never should."""


class Computing:
    """The work of one incident.

    Args:
        threads: those for all folding.
    """

    def __init__(self, threads: Executor) -> None:
        self._threads = threads
        self._in_use = asyncio.Lock()

    async def run(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Run what reads the fold, or makes one, once nothing else of this incident runs."""
        async with self._in_use:
            loop = asyncio.get_running_loop()
            return await loop.run_in_executor(self._threads, lambda: function(*args, **kwargs))

    async def estimate(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """Run what folds readings or asks for what was folded: trackers do their work at either.

        Raises:
            EstimatorFailed: the tracker could not.
            LogUnreadable: the database failed while the log was folded anew.
        """
        try:
            return await self.run(function, *args, **kwargs)
        except Unavailable:
            raise
        except Exception as error:
            raise EstimatorFailed from error
