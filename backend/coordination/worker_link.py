"""The worker's side of the link: a client that comes back whenever the web process does."""

import asyncio
import contextlib
import random
import socket
from collections.abc import Callable

import msgspec
import structlog

from backend.coordination.base import Alive, Answer, Picture, Query, ToWorker
from backend.coordination.framing import Hello, Malformed, decode_to_worker, framed, read_frame
from backend.coordination.instance import Instance
from backend.coordination.outbox import Outbox

FIRST_PAUSE_S = 0.05
LONGEST_PAUSE_S = 5.0
CONNECT_WITHIN_S = 5.0
ALIVE_EVERY_S = 1.0
MAX_RECEIVED = 10_000
"""Messages that may wait for the worker; beyond, the oldest is dropped: it reads the log in any case."""

log = structlog.get_logger(__name__)


class WorkerLink:
    """Connects to the web process, again and again, and carries messages both ways.

    Args:
        address: host and port of the web process's link; None: there is none.
        token: the deployment's link token.
        holder: the worker's name.
        on_connect: called after each connect: the web process may have missed what was published before.
    """

    def __init__(
        self, address: tuple[str, int] | None, token: str, holder: str, on_connect: Callable[[], None]
    ) -> None:
        self._address = address
        self._hello = Hello(token, holder, Instance.this())
        self._on_connect = on_connect
        self._outbox = Outbox()
        self._received: dict[int | str, ToWorker] = {}
        self._something = asyncio.Event()
        self._connected = False
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin to connect, and to stay connected."""
        if self._address is not None:
            self._task = asyncio.create_task(
                self._stay_connected(*self._address), name="link to the web process"
            )

    async def close(self) -> None:
        """Disconnect."""
        if self._task is not None:
            self._task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._task

    def publish(self, message: Answer | Picture) -> None:
        """Send if connected; a picture that cannot be sent in time is superseded by the next."""
        if not self._connected:
            return
        key = ("picture", message.incident) if isinstance(message, Picture) else ("answer", message.number)
        self._outbox.put(key, framed(message))

    async def receive(self, timeout_s: float) -> list[ToWorker]:
        """What has come, at once if something has, else after at most `timeout_s`."""
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._something.wait(), timeout_s)
        self._something.clear()
        received = list(self._received.values())
        self._received.clear()
        return received

    async def _stay_connected(self, host: str, port: int) -> None:
        pause_s = FIRST_PAUSE_S
        while True:
            began = asyncio.get_running_loop().time()
            try:
                await self._talk(host, port)
            except (OSError, TimeoutError, asyncio.IncompleteReadError) as error:
                log.info("the web process is away", error=str(error) or type(error).__name__)
            except (Malformed, msgspec.DecodeError) as error:
                log.error(
                    "the web process sent what is no message: are both of one version?", error=str(error)
                )
            # A connection that held is tried again at once, one that is refused less and less often.
            held = asyncio.get_running_loop().time() - began > LONGEST_PAUSE_S
            pause_s = FIRST_PAUSE_S if held else min(2 * pause_s, LONGEST_PAUSE_S)
            await asyncio.sleep(pause_s * random.uniform(0.5, 1.0))  # noqa: S311 - workers must not come at once

    async def _talk(self, host: str, port: int) -> None:
        async with asyncio.timeout(CONNECT_WITHIN_S):
            reader, writer = await asyncio.open_connection(host, port)
        _notice_a_dead_peer(writer)
        tasks: list[asyncio.Task[None]] = []
        try:
            writer.write(framed(self._hello))
            self._outbox.clear()
            self._connected = True
            tasks = [asyncio.create_task(self._outbox.send_to(writer)), asyncio.create_task(self._beat())]
            self._on_connect()
            while True:
                self._take(decode_to_worker(await read_frame(reader)))
        finally:
            self._connected = False
            for task in tasks:
                task.cancel()
                with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                    await task
            writer.close()

    async def _beat(self) -> None:
        while True:
            self._outbox.put("alive", framed(Alive()))
            await asyncio.sleep(ALIVE_EVERY_S)

    def _take(self, message: ToWorker) -> None:
        key = message.number if isinstance(message, Query) else message.incident
        self._received[key] = message
        if len(self._received) > MAX_RECEIVED:
            del self._received[next(iter(self._received))]
        self._something.set()


def _notice_a_dead_peer(writer: asyncio.StreamWriter) -> None:
    """Have the kernel end a connection whose other end vanished without a word."""
    connection: socket.socket = writer.get_extra_info("socket")
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 5)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 5)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, 15_000)
