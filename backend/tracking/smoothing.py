"""Sums over whole logs, too heavy for the web process: one beside it does them, see `sums_process.py`."""

import asyncio
import multiprocessing
import os
import threading
from collections.abc import Callable, Hashable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from typing import ParamSpec, TypeVar

from backend.errors import NotFound, TooSlow, Unavailable
from backend.tracking.fold import OtherState
from backend.tracking.heads import Head
from backend.tracking.long_sums import Kept
from backend.tracking.sums_process import (
    Smoothed,
    advice_of_log,
    evidence_of_log,
    read_ahead,
    relative_from_state,
    relative_of_log,
    smooth_log,
    smoothed_of,
)
from estimator.estimate import Relative
from estimator.evidence import Advice, Evidence
from estimator.warm import warm_up

KEPT = 8
"""Smoothed incidents that are kept: a reviewer goes back and forth between a few."""

EXPLAINED = 32
"""Answers about single nodes that are kept: they are small, and some responders are looked at together."""

PREPARED_AFTER_S = 10.0
"""Its process is started when a server has begun its other work: whoever asks first does not wait for it."""

AHEAD_EVERY_S = 10.0
"""So often the logs of running incidents are read on, should somebody ask: what has come since is then folded
in a tenth of a second."""

SMOOTH_WITHIN_S = 60.0
EXPLAIN_WITHIN_S = 60.0
RELATIVE_WITHIN_S = 30.0

P = ParamSpec("P")
T = TypeVar("T")


class Smoothing:
    """Smooths whole incidents, and tells what a smoothed one says: evidence, advice, relative positions.

    One sum at a time; asking twice for the same one costs once.

    Args:
        database_url: SQLAlchemy URL of the log.
    """

    def __init__(self, database_url: str) -> None:
        self._url = database_url
        self._pool: ProcessPoolExecutor | None = None
        self._turn = turn = asyncio.Lock()
        self._tracks: Kept[Smoothed] = Kept(KEPT, turn)
        self._evidence: Kept[Evidence | None] = Kept(EXPLAINED, turn)
        self._advice: Kept[Advice | None] = Kept(EXPLAINED, turn)
        self._relative: Kept[Relative | None] = Kept(EXPLAINED, turn)
        self._preparing: asyncio.Task[None] | None = None
        self._reading: asyncio.Task[None] | None = None

    def start(self) -> asyncio.Task[None]:
        """Have the process ready before it is asked for: what is returned ends when it is."""
        self._preparing = asyncio.create_task(self._prepare())
        return self._preparing

    async def _prepare(self) -> None:
        await asyncio.sleep(PREPARED_AFTER_S)
        with suppress(Unavailable):
            await self._aside(os.getpid)
        self._reading = asyncio.create_task(self._read_ahead())

    async def _read_ahead(self) -> None:
        """Have running incidents read and folded before anybody asks, while nobody does."""
        while True:
            more = False
            if not self._turn.locked():
                async with self._turn:
                    with suppress(Unavailable):
                        more = await self._aside(read_ahead, self._url)
            await asyncio.sleep(0.0 if more else AHEAD_EVERY_S)

    async def smoothed(self, head: Head) -> Smoothed:
        """The smoothed tracks of an incident with everything known now.

        Args:
            head: the incident, its newest log entry and its estimator's settings.

        Raises:
            TooSlow: it takes long; the work goes on, and asking again later finds it done.
            Unavailable: the process that does it ended.
        """
        return await self._tracks.get(
            _told(head), head.last_seq, lambda: self._smooth(head), SMOOTH_WITHIN_S, "Smoothing"
        )

    async def _smooth(self, head: Head) -> Smoothed:
        return smoothed_of(await self._aside(smooth_log, self._url, head))

    async def evidence(self, head: Head, node: str, t: float | None) -> Evidence | None:
        """What holds a node's fix at a moment; None where its position is not decided then.

        It is what the whole log says of everything up to `t`: an entry that came later than `t` but tells of
        epochs before it counts.

        Args:
            head: the incident, its newest log entry and its estimator's settings.
            node: the node.
            t: the moment, Unix seconds; None: the newest epoch.

        Raises:
            NotFound: no reading up to that moment names the node.
            TooSlow: it takes long, or other work is in the way.
            Unavailable: the process that does it ended.
        """
        _refuse_where_nothing_came(head)
        return await self._evidence.get(
            (_told(head), node, t),
            head.last_seq,
            lambda: self._aside(evidence_of_log, self._url, head, node, t),
            EXPLAIN_WITHIN_S,
            "Weighing the measurements",
        )

    async def advice(self, head: Head, node: str) -> Advice | None:
        """What would make a node's newest position surer; None where it is not decided.

        Args:
            head: the incident, its newest log entry and its estimator's settings.
            node: the node.

        Raises:
            NotFound: no reading names the node.
            TooSlow: it takes long, or other work is in the way.
            Unavailable: the process that does it ended.
        """
        _refuse_where_nothing_came(head)
        return await self._advice.get(
            (_told(head), node),
            head.last_seq,
            lambda: self._aside(advice_of_log, self._url, head, node),
            EXPLAIN_WITHIN_S,
            "Weighing what could be done",
        )

    async def relative(self, head: Head, a: str, b: str) -> Relative | None:
        """Where `b` is relative to `a` after the newest stored state; None where either is undecided.

        Where there is none yet, or it cannot be used, the whole log is folded anew for it.

        Raises:
            NotFound: a node is not known.
            Unavailable: the process that does it ended.
            TooSlow: it takes long, or other sums are in the way.
        """
        _refuse_where_nothing_came(head)
        try:
            return await asyncio.wait_for(
                self._aside(relative_from_state, self._url, head, a, b), RELATIVE_WITHIN_S
            )
        except TimeoutError:
            raise TooSlow(
                "The process for such sums is busy, or not up yet on a busy machine: ask again in a minute."
            ) from None
        except OtherState:
            return await self._relative.get(
                (_told(head), a, b),
                head.last_seq,
                lambda: self._aside(relative_of_log, self._url, head, a, b),
                RELATIVE_WITHIN_S,
                "Folding the log anew",
            )

    def close(self) -> None:
        """End the process."""
        for task in (self._preparing, self._reading):
            if task is not None:
                task.cancel()
        self._tracks.cancel()
        self._evidence.cancel()
        self._advice.cancel()
        self._relative.cancel()
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


def _told(head: Head) -> Hashable:
    """The incident, and with what its sums are done."""
    return head.incident, head.tracker, head.settings, head.live


def _refuse_where_nothing_came(head: Head) -> None:
    """Answer at once what needs no sum: on a busy machine their process takes a minute to start."""
    if head.last_seq == 0:
        raise NotFound("No reading of this incident has named a node yet.")


def _begin_aside() -> None:
    """Yield to telemetry, and end with the web process, however suddenly that ends."""
    os.nice(10)
    warm_up()
    parent = multiprocessing.parent_process()

    def watch() -> None:
        if parent is not None:
            parent.join()
        os._exit(1)

    threading.Thread(target=watch, name="end with parent", daemon=True).start()
