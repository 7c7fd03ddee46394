"""Group commit, seen from the web process: batches go to the writer process, receipts come back."""

import asyncio
import socket
import subprocess
import sys
from collections import deque
from contextlib import suppress
from typing import cast

import structlog
from prometheus_client import Counter, Gauge, Histogram

from backend.errors import TooBusy
from backend.log.base import Appended, LogUnwritable, NewBatch
from backend.log.engine import RETRY_UNWRITABLE_S
from backend.log.writer_wire import LENGTHS, Frames, Written, batch_frame, parse_written, problem_of

BATCH_OVERHEAD_BYTES = 1024
"""What a waiting batch holds beside its body."""

RETRY_AFTER_S = 1
"""The queue holds about a second of a fast disk's work."""

SEND_BYTES = 64 * 1024
"""Batches are sent together, once in a turn of the event loop, or as soon as they are so many bytes."""

SOCKET_BYTES = 4 * 1024 * 1024
"""Asked of the kernel, which may give less: what the writer finds when it is done with a group is its next
one, even while the event loop is busy with decoding."""

REFUSAL_TELLS_S = 30.0
"""For so long a refusal tells that the log cannot be written: whoever is told so may send nothing more."""

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
        self._link: _Link | None = None
        self._keeper: asyncio.Task[None] | None = None
        self._closing = asyncio.Event()
        self._refusal: tuple[float, LogUnwritable] | None = None
        _queued.set_function(lambda: self._bytes)

    async def start(self) -> None:
        """Start the writer process, and keep one running."""
        self._loop = asyncio.get_running_loop()
        link = await self._connect()
        self._keeper = asyncio.create_task(self._keep(link))

    async def append(self, batch: NewBatch) -> Appended:
        """Append a batch; returns when it is durable on disk.

        Raises:
            NotFound: there is no such incident.
            Conflict: the incident is closed.
            TooBusy: too much is waiting already.
            LogUnwritable: the database cannot be written; nothing is acknowledged.
        """
        if self._link is None or self._closing.is_set():
            raise _gone()
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
        """Why the newest batch could not be written, if that was lately; None where it was, or none came."""
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
        if self._keeper is not None:
            await self._keeper

    def _send(self) -> None:
        if self._unsent and self._link is not None:
            self._link.transport.writelines(self._unsent)
        self._unsent = []
        self._unsent_bytes = 0

    def take(self, written: Written) -> None:
        """Answer the requests of a group that has been dealt with."""
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
            if future.done():  # its request was cancelled
                continue
            if refused is not None:
                future.set_exception(problem_of(refused))
            elif appended is not None:
                future.set_result(appended)

    def _lose(self) -> None:
        """Nobody knows whether what waits was written: say that it was not, so that it is sent again."""
        self._link = None
        self._unsent, self._unsent_bytes = [], 0
        lost, self._waiting, self._bytes = self._waiting, deque(), 0
        for future, _ in lost:
            if not future.done():
                _refused.labels("writer_gone").inc()
                future.set_exception(_gone())

    async def _connect(self) -> "_Link":
        ours, theirs = socket.socketpair()
        with theirs:
            process = subprocess.Popen(  # noqa: S603, ASYNC220 - our own module; starting it does not wait
                [sys.executable, "-m", "backend.log.writer_process", str(theirs.fileno())],
                pass_fds=[theirs.fileno(), *([] if self._hold is None else [self._hold])],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
            )
        ours.setblocking(False)
        ours.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SOCKET_BYTES)
        link = _Link(self, process)
        await self._loop.create_connection(lambda: link, sock=ours)
        url = self._url.encode()
        link.transport.write(LENGTHS.pack(0, len(url)) + url)
        self._link = link
        return link

    async def _keep(self, link: "_Link | None") -> None:
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


class _Link(asyncio.Protocol):
    """The socket to one writer process."""

    transport: asyncio.Transport

    def __init__(self, owner: GroupCommit, process: "subprocess.Popen[bytes]") -> None:
        self._owner = owner
        self._frames = Frames()
        self.process = process
        self.ended = asyncio.Event()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = cast("asyncio.Transport", transport)

    def data_received(self, data: bytes) -> None:
        for payload, _ in self._frames.feed(data):
            self._owner.take(parse_written(payload))

    def eof_received(self) -> None:
        """The writer is done, or gone: close this side too."""

    def connection_lost(self, error: Exception | None) -> None:
        del error
        self.ended.set()


def _gone() -> LogUnwritable:
    return LogUnwritable(
        "The log's writer is not there now; it starts again by itself. Send the batch again.",
        retry_after_s=RETRY_UNWRITABLE_S,
    )
