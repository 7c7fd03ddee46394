"""Group commit, seen from the web process: batches go to the writer process, receipts come back."""

import asyncio
from collections import deque
from collections.abc import Callable
from contextlib import suppress

import structlog
from prometheus_client import Counter, Gauge, Histogram

from backend.errors import TooBusy
from backend.log.base import Appended, LogUnwritable, NewBatch
from backend.log.engine import RETRY_UNWRITABLE_S
from backend.log.writer_link import WriterLink, connect_writer
from backend.log.writer_wire import Written, batch_frame, problem_of

BATCH_OVERHEAD_BYTES = 1024
"""What a waiting batch holds beside its body."""

RETRY_AFTER_S = 1
"""The queue holds about a second of a fast disk's work."""

SEND_BYTES = 64 * 1024
"""Batches are sent together, once in a turn of the event loop, or as soon as they are so many bytes."""

REFUSAL_TELLS_S = 30.0
"""For so long a refusal tells that the log cannot be written: whoever is told so may send nothing more."""

HANGS_AFTER_S = 12.0
"""A writer that answers nothing for so long hangs: a group takes a slow disk some seconds, and a database
that waits for a lock gives up after 10 s and says why."""

KILLED_AFTER_S = 90.0
"""Postgres ends a statement after 60 s: whatever hangs for longer does not go on by itself."""

LOOK_EVERY_S = 1.0

RESTART_S = 0.2
MAX_RESTART_S = 5.0
STOP_S = 30.0
"""How long the writer may take for what still waits when the server stops."""

_commit_seconds = Histogram(
    "firethread_log_commit_seconds",
    "Time to write a group of batches and make it durable",
    buckets=(0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10),
)
_group_size = Histogram(
    "firethread_log_group_batches", "Batches in one transaction", buckets=(1, 2, 4, 8, 16, 32, 64, 128, 256)
)
_queued = Gauge("firethread_log_queued_bytes", "Bytes waiting to be written")
_refused = Counter("firethread_log_refused_batches", "Batches not acknowledged", ["why"])
_restarts = Counter("firethread_log_writer_restarts", "Times that the writer process was started again")

log = structlog.get_logger(__name__)


class GroupCommit:
    """Appends batches to the log for any number of waiting requests of one event loop.

    Args:
        url: of the log's database.
        queue_bytes: bodies that may wait before `TooBusy`.
        hold: handle by which this process has the database to itself; the writer holds it as well, so that
            it is given back once both have ended.
    """

    def __init__(self, url: str, queue_bytes: int, hold: int | None = None) -> None:
        self._url = url
        self._hold = hold
        self._limit = queue_bytes
        self._bytes = 0
        self._waiting: deque[tuple[asyncio.Future[Appended], int]] = deque()
        self._unsent: list[bytes] = []
        self._unsent_bytes = 0
        self._link: WriterLink | None = None
        self._keeper: asyncio.Task[None] | None = None
        self._watcher: asyncio.Task[None] | None = None
        self._answers = 0
        self._hangs = False
        self._gone = False
        self._closing = asyncio.Event()
        self._refusal: tuple[float, LogUnwritable] | None = None
        _queued.set_function(lambda: self._bytes)

    async def start(self) -> None:
        """Start the writer process, and keep one running."""
        self._loop = asyncio.get_running_loop()
        link = await self._connect()
        self._keeper = asyncio.create_task(self._keep(link))
        self._watcher = asyncio.create_task(self._watch())

    async def append(self, batch: NewBatch) -> Appended:
        """Append a batch; returns when it is durable on disk.

        Raises:
            NotFound: there is no such incident.
            Conflict: the incident is closed.
            TooBusy: too much is waiting already.
            LogUnwritable: the database cannot be written, or the writer hangs; nothing is acknowledged.
        """
        if self._link is None or self._closing.is_set():
            raise _gone()
        if self._hangs:
            _refused.labels("writer_hangs").inc()
            raise _hanging()
        size = len(batch.body) + BATCH_OVERHEAD_BYTES
        # An empty queue takes any batch: a limit below one batch would refuse it for ever.
        if self._bytes and self._bytes + size > self._limit:
            _refused.labels("too_busy").inc()
            raise TooBusy(
                f"{self._bytes} bytes wait to be written. Send the batch again after {RETRY_AFTER_S} s.",
                retry_after_s=RETRY_AFTER_S,
            )
        future: asyncio.Future[Appended] = self._loop.create_future()
        self._waiting.append((future, size))
        self._bytes += size
        if not self._unsent:
            self._loop.call_soon(self._send)
        self._unsent += batch_frame(batch)
        self._unsent_bytes += size
        if self._unsent_bytes >= SEND_BYTES:
            self._send()
        return await future

    @property
    def refusal(self) -> LogUnwritable | None:
        """Why the log cannot be written, as is known now; None where nothing speaks against it.

        The writer hangs, or has ended and the next one is not at work yet, or what came last could not be
        written, if that was lately.
        """
        if self._hangs:
            return _hanging()
        if self._gone:
            return _gone()
        if self._refusal is None:
            return None
        at, problem = self._refusal
        return problem if self._loop.time() - at < REFUSAL_TELLS_S else None

    async def close(self) -> None:
        """Have what waits written, then stop the writer process; one that hangs is killed."""
        self._closing.set()
        link = self._link
        if link is not None:
            self._send()
            link.transport.write_eof()
            try:
                async with asyncio.timeout(STOP_S):
                    await link.ended.wait()
            except TimeoutError:
                log.error("the log's writer process hangs and is killed", waiting=len(self._waiting))
                link.process.kill()
        if self._watcher is not None:
            self._watcher.cancel()
        if self._keeper is not None:
            await self._keeper

    def _send(self) -> None:
        if self._unsent and self._link is not None:
            self._link.transport.writelines(self._unsent)
        self._unsent = []
        self._unsent_bytes = 0

    def take(self, written: Written) -> None:
        """Answer the requests of a group that has been dealt with; one of nothing tells that it is there."""
        self._answers += 1
        self._hangs = self._gone = False
        if not written.outcomes:
            return
        _commit_seconds.observe(written.seconds)
        _group_size.observe(len(written.outcomes))
        for appended, refused in written.outcomes:
            future, size = self._waiting.popleft()
            self._bytes -= size
            if refused is not None:
                _refused.labels(refused.kind).inc()
                problem = problem_of(refused)
                if isinstance(problem, LogUnwritable):
                    self._refusal = self._loop.time(), problem
            elif appended is not None and not appended.duplicate:
                self._refusal = None
            if future.done():  # its request was cancelled, or told that the writer hung
                continue
            if refused is not None:
                future.set_exception(problem_of(refused))
            elif appended is not None:
                future.set_result(appended)

    def _lose(self) -> None:
        """Nobody knows whether what waits was written: say that it was not, so that it is sent again."""
        self._link = None
        self._unsent, self._unsent_bytes = [], 0
        self._hangs, self._gone = False, True
        self._refuse_waiting("writer_gone", _gone)
        self._waiting, self._bytes = deque(), 0

    def _refuse_waiting(self, why: str, problem: Callable[[], LogUnwritable]) -> None:
        for future, _ in self._waiting:
            if not future.done():
                _refused.labels(why).inc()
                future.set_exception(problem())

    async def _watch(self) -> None:
        """Refuse what waits while the writer answers nothing, and kill one that does not for long.

        What was refused so keeps its place, for the answer that may come: nobody is told of it, and whoever
        sends it again is told the same.
        """
        silent_s = 0.0
        while True:
            answers = self._answers
            await asyncio.sleep(LOOK_EVERY_S)
            # Counted by looks and not by the clock: this process may have been stopped itself.
            silent_s = silent_s + LOOK_EVERY_S if self._waiting and self._answers == answers else 0.0
            if silent_s < HANGS_AFTER_S:
                continue
            if not self._hangs:
                log.error("the log's writer process hangs", waiting=len(self._waiting), silent_s=silent_s)
            self._hangs = True
            self._refuse_waiting("writer_hangs", _hanging)
            if silent_s >= KILLED_AFTER_S and self._link is not None:
                log.error("the log's writer process hangs and is killed", waiting=len(self._waiting))
                self._link.process.kill()
                silent_s = 0.0

    async def _connect(self) -> WriterLink:
        self._link = await connect_writer(self._url, self._hold, self.take)
        return self._link

    async def _keep(self, link: WriterLink | None) -> None:
        """Start the writer again whenever it ends without having been told to."""
        pause = RESTART_S
        while True:
            if link is not None:
                started = self._loop.time()
                await link.ended.wait()
                self._lose()
                code = await asyncio.to_thread(link.process.wait)
                if not self._closing.is_set():
                    log.error("the log's writer process ended; starting it again", code=code)
                    _restarts.inc()
                if self._loop.time() - started > MAX_RESTART_S:
                    pause = RESTART_S
            with suppress(TimeoutError):
                async with asyncio.timeout(pause):
                    await self._closing.wait()
            if self._closing.is_set():
                return
            pause = min(2 * pause, MAX_RESTART_S)
            try:
                link = await self._connect()
            except OSError as error:
                link = None
                log.error("the log's writer process cannot be started", error=str(error))


def _gone() -> LogUnwritable:
    return LogUnwritable(
        "The log's writer is not there now; it starts again by itself. Send the batch again.",
        retry_after_s=RETRY_UNWRITABLE_S,
    )


def _hanging() -> LogUnwritable:
    return LogUnwritable(
        "The log's writer does not answer: the disk or the database hangs. Nothing is acknowledged; the "
        "batch may be written yet. Send it again under the same name: it is taken once.",
        retry_after_s=RETRY_UNWRITABLE_S,
    )
