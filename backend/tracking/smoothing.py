"""Sums that are too heavy for the web process, in a process of their own: smoothed tracks, stored states."""

import asyncio
import multiprocessing
import os
import threading
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

from backend.errors import TooSlow, Unavailable
from backend.tracking.aside import Smoothed, relative_from_state, smooth_log
from backend.tracking.heads import Head
from estimator.estimate import Relative

KEPT = 8
"""Smoothed incidents that are kept: a reviewer goes back and forth between a few."""

SMOOTH_WITHIN_S = 60.0
RELATIVE_WITHIN_S = 30.0

P = ParamSpec("P")
T = TypeVar("T")


class Smoothing:
    """Smooths whole incidents, one at a time; asking twice for the same one costs once.

    Args:
        database_url: SQLAlchemy URL of the log.
    """

    def __init__(self, database_url: str) -> None:
        self._url = database_url
        self._pool: ProcessPoolExecutor | None = None
        self._jobs: OrderedDict[tuple[str, int, object], asyncio.Task[Smoothed]] = OrderedDict()

    async def smoothed(self, head: Head) -> Smoothed:
        """The smoothed tracks of an incident with everything known now.

        Args:
            head: the incident, its newest log entry and its estimator's settings.

        Raises:
            TooSlow: it takes long; the work goes on, and asking again later finds it done.
            Unavailable: the process that does it ended.
        """
        key = (head.incident, head.last_seq, head.settings)
        job = self._jobs.get(key)
        if job is None or (job.done() and (job.cancelled() or job.exception() is not None)):
            job = self._jobs[key] = asyncio.create_task(self._aside(smooth_log, self._url, head))
        self._jobs.move_to_end(key)
        while len(self._jobs) > KEPT:
            _, oldest = self._jobs.popitem(last=False)
            oldest.cancel()
        try:
            return await asyncio.wait_for(asyncio.shield(job), SMOOTH_WITHIN_S)
        except TimeoutError:
            raise TooSlow(
                f"Smoothing takes longer than {SMOOTH_WITHIN_S:g} s; it goes on: ask again in a minute."
            ) from None

    async def relative(self, head: Head, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a` after the newest stored state; None where either is undecided.

        Raises:
            NotFound: a node is not known.
            Unavailable: there is no state that could tell.
            TooSlow: other work is in the way.
        """
        try:
            return await asyncio.wait_for(
                self._aside(relative_from_state, self._url, head, a, b), RELATIVE_WITHIN_S
            )
        except TimeoutError:
            raise TooSlow("Other sums are in the way: ask again in a minute.") from None

    def close(self) -> None:
        """End the process."""
        for job in self._jobs.values():
            job.cancel()
        if self._pool is not None:
            for process in self._pool._processes.values():  # noqa: SLF001 - shutdown() would wait for the work
                process.terminate()
            self._pool.shutdown(wait=False, cancel_futures=True)

    async def _aside(self, function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        del kwargs
        if self._pool is None:
            self._pool = ProcessPoolExecutor(
                max_workers=1, mp_context=multiprocessing.get_context("spawn"), initializer=_begin_aside
            )
        pool = self._pool
        try:
            return await asyncio.get_running_loop().run_in_executor(pool, function, *args)
        except BrokenProcessPool:
            if self._pool is pool:
                self._pool = None
            raise Unavailable("The process that does these sums has ended: ask again.") from None


def _begin_aside() -> None:
    """Yield to telemetry, and end with the web process, however suddenly that ends."""
    os.nice(10)
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
        os._exit(1)

    threading.Thread(target=watch, name="end with parent", daemon=True).start()
