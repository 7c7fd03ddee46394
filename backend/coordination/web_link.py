"""The web process's side of the link: a server that workers connect to."""

import asyncio
import contextlib
import hmac
import itertools
import socket
from collections import Counter
from collections.abc import Awaitable, Callable

import msgspec
import prometheus_client
import structlog

from backend.coordination.base import Alive, Answer, Picture, Query, Wake
from backend.coordination.framing import (
    MAX_HELLO_BYTES,
    Malformed,
    decode_hello,
    decode_to_web,
    framed,
    read_frame,
)
from backend.coordination.instance import Instance
from backend.coordination.outbox import Outbox
from backend.errors import TooSlow, Unavailable

HELLO_WITHIN_S = 5.0

SILENT_AFTER_S = 10.0
"""A worker that has told nothing for so long, not even that it is alive, is gone: it hangs, or its machine
has vanished without a word. One whose compiled loops hold its interpreter is silent for seconds."""

log = structlog.get_logger(__name__)

_connected = prometheus_client.Gauge("firethread_link_workers", "Workers connected")
_pictures = prometheus_client.Counter("firethread_link_pictures", "Pictures that workers have sent")


class _Worker:
    """A connected worker."""

    def __init__(self, holder: str, instance: Instance | None) -> None:
        self.holder = holder
        self.instance = instance
        self.outbox = Outbox()


class WebLink:
    """Listens for workers; see `backend.coordination.base.WebSide`.

    Args:
        listener: a bound, listening socket.
        token: what a worker must show.
    """

    def __init__(self, listener: socket.socket, token: str) -> None:
        self._listener = listener
        self._token = token.encode()
        self._workers: set[_Worker] = set()
        self._followed_by: dict[str, _Worker] = {}
        self._answers: dict[int, tuple[_Worker, asyncio.Future[Answer]]] = {}
        self._numbers = itertools.count(1)
        self._picture_listeners: list[Callable[[Picture], Awaitable[None] | None]] = []
        self._words: Counter[tuple[str, int]] = Counter()
        self._server: asyncio.Server | None = None
        self._connections: set[asyncio.Task[None]] = set()

    @property
    def connected(self) -> bool:
        """Whether a worker is connected."""
        return bool(self._workers)

    def words(self, pid: int) -> int:
        """How many messages have come from a process of this machine: a worker sends one each second."""
        return self._words[socket.gethostname(), pid]

    async def start(self) -> None:
        """Begin to listen."""
        self._server = await asyncio.start_server(self._serve, sock=self._listener)

    async def stop(self) -> None:
        """Stop, and cut the workers off."""
        if self._server is not None:
            self._server.close()
        for connection in list(self._connections):
            connection.cancel()
        await asyncio.gather(*self._connections, return_exceptions=True)

    def wake(self, incident: str, seq: int) -> None:
        """Tell the workers that the log has grown; harmless if none is there."""
        if self._workers:
            message = framed(Wake(incident, seq))
            for worker in self._workers:
                worker.outbox.put(("wake", incident), message)

    async def ask(self, incident: str, a: str, b: str, timeout_s: float) -> Answer:
        """Ask the worker that follows an incident where `b` is relative to `a`.

        Raises:
            Unavailable: no worker is connected that follows it, or it went away.
            TooSlow: it did not answer in time.
        """
        worker = self._followed_by.get(incident)
        if worker is None:
            raise Unavailable(
                f"No estimator follows incident {incident} just now: try again in some seconds."
            )
        number = next(self._numbers)
        answer: asyncio.Future[Answer] = asyncio.get_running_loop().create_future()
        self._answers[number] = worker, answer
        worker.outbox.put(("query", number), framed(Query(number, incident, a, b)))
        try:
            return await asyncio.wait_for(answer, timeout_s)
        except TimeoutError:
            raise TooSlow(f"The estimator did not answer within {timeout_s:g} s: try again.") from None
        finally:
            del self._answers[number]

    def on_picture(self, listener: Callable[[Picture], Awaitable[None] | None]) -> None:
        """Have every picture that comes given to `listener`."""
        self._picture_listeners.append(listener)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None  # noqa: S101 - asyncio runs this in a task
        self._connections.add(task)
        try:
            worker = await self._admit(reader)
            if worker is not None:
                await self._talk(worker, reader, writer)
        except (asyncio.CancelledError, asyncio.IncompleteReadError, ConnectionError):
            pass  # the worker has gone, or we are being closed: pictures age by themselves
        except TimeoutError:
            log.error("a worker has fallen silent, its connection is closed")
        except (Malformed, msgspec.DecodeError) as error:
            log.error("a worker sent what is no message: are both of the same version?", error=str(error))
        finally:
            self._connections.discard(task)
            writer.close()

    async def _admit(self, reader: asyncio.StreamReader) -> _Worker | None:
        try:
            hello = decode_hello(await asyncio.wait_for(read_frame(reader, MAX_HELLO_BYTES), HELLO_WITHIN_S))
        except TimeoutError:
            return None
        if not hmac.compare_digest(hello.token.encode(), self._token):
            log.error("a worker with a wrong link token was turned away", holder=hello.holder)
            return None
        log.info("worker connected", holder=hello.holder)
        return _Worker(hello.holder, hello.instance)

    async def _talk(
        self, worker: _Worker, reader: asyncio.StreamReader, writer: asyncio.StreamWriter
    ) -> None:
        self._workers.add(worker)
        _connected.set(len(self._workers))
        sending = asyncio.create_task(worker.outbox.send_to(writer))
        try:
            while True:
                async with asyncio.timeout(SILENT_AFTER_S):
                    message = decode_to_web(await read_frame(reader))
                if worker.instance is not None:
                    self._words[worker.instance.host, worker.instance.pid] += 1
                if isinstance(message, Answer):
                    self._resolve(message)
                elif not isinstance(message, Alive):
                    _pictures.inc()
                    self._followed_by[message.incident] = worker
                    await self._tell(message)
        finally:
            sending.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await sending
            self._workers.discard(worker)
            _connected.set(len(self._workers))
            self._give_up_asking(worker)
            self._followed_by = {i: w for i, w in self._followed_by.items() if w is not worker}
            log.warning("worker disconnected", holder=worker.holder)

    def _resolve(self, answer: Answer) -> None:
        _, waiting = self._answers.get(answer.number, (None, None))
        if waiting is not None and not waiting.done():  # else it came too late
            waiting.set_result(answer)

    def _give_up_asking(self, worker: _Worker) -> None:
        for asked, waiting in self._answers.values():
            if asked is worker and not waiting.done():
                waiting.set_exception(
                    Unavailable("The estimator has just gone away: try again in some seconds.")
                )

    async def _tell(self, picture: Picture) -> None:
        for listener in self._picture_listeners:
            waiting = listener(picture)
            if waiting is not None:
                await waiting
