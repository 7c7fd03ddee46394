"""`firethread serve`: sockets, the web process, and the children beside it."""

import asyncio
import fcntl
import ipaddress
import os
import secrets
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

import structlog
import uvicorn

from backend.authentication import Authentication, access_token
from backend.errors import CommandRefused, in_reach
from backend.ingest.front import TelemetryFirst
from backend.interpreter import tune_for_serving
from backend.main import build_app
from backend.open_files import raise_open_files
from backend.settings import LINK_TOKEN_VARIABLE, Settings, host_and_port
from backend.supervision import Child

log = structlog.get_logger(__name__)


class ConfigurationRefused(CommandRefused):
    """Settings that would be unsafe or cannot work."""


def check(settings: Settings) -> None:
    """Refuse settings that would be unsafe.

    Raises:
        ConfigurationRefused: open access on an address that others can reach.
    """
    if settings.open_access and not is_loopback(settings.host):
        raise ConfigurationRefused(
            f"--open lets everybody in and is refused on {settings.host}: use a loopback address such as "
            "127.0.0.1, or leave --open away"
        )


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach an address."""
    if host == "localhost":
        return True
    with suppress(ValueError):
        return ipaddress.ip_address(host).is_loopback
    return False


def listen(host: str, port: int) -> socket.socket:
    """A listening TCP socket.

    Raises:
        ConfigurationRefused: the address cannot be used.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(family, socket.SOCK_STREAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address)
        # Thousands of screens may reconnect at once after a restart.
        listener.listen(4096)
    except OSError as error:
        raise ConfigurationRefused(
            f"cannot listen on {host} port {port}: {error.strerror or error}; choose another --host or --port"
        ) from error
    listener.setblocking(False)
    return listener


HANDED_OVER_WITHIN_S = 5.0
"""The writer of a server that was killed first writes what came: a second or two where the disk is slow."""


@contextmanager
def held(folder: Path, within_s: float = HANDED_OVER_WITHIN_S) -> Iterator[int]:
    """Have a folder to this process alone, and to whom it gives the handle, until they end, however suddenly.

    Two servers on one SQLite database would both move its WAL into it, and pages may be lost by that: see
    `make_engine`.

    Args:
        folder: which.
        within_s: how long another that has it is waited for (s).

    Raises:
        ConfigurationRefused: another server has it.
    """
    with in_reach(folder):
        handle = os.open(folder, os.O_RDONLY)
    try:
        if not _locked(handle, within_s):
            raise ConfigurationRefused(
                f"another firethread serves from {folder}: stop it, or give this one another --data"
            )
        yield handle
    finally:
        os.close(handle)


def _locked(handle: int, within_s: float) -> bool:
    """Whether a folder is this process's now: of a file system that knows no locks it is taken to be."""
    until = time.monotonic() + within_s
    while True:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if time.monotonic() > until:
                return False
            time.sleep(0.05)
        except OSError as error:
            log.warning("the data folder cannot be held: see that no other server uses it", why=str(error))
            return True
        else:
            return True


def url_of(listener: socket.socket) -> str:
    """The HTTP address of a listening socket."""
    host, port = listener.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def serve(settings: Settings) -> None:
    """Serve until told to stop.

    Raises:
        ConfigurationRefused: settings that would be unsafe or cannot work, or the folder is another server's.
        CommandRefused: an address or the database's URL is none, or the folder cannot be used.
        LogUnwritable: the database cannot be reached or written.
        SchemaTooNew: a newer version has written the database.
    """
    check(settings)
    raise_open_files()
    settings.make_folder()
    # On Postgres nothing under the folder is written but the token, once.
    with held(settings.data) if settings.database is None else nullcontext() as hold:
        _serve(settings, hold)


def _serve(settings: Settings, hold: int | None) -> None:
    listener, link = listen(settings.host, settings.port), listen(*host_and_port(settings.link))
    url = url_of(listener)
    link_token = os.environ.get(LINK_TOKEN_VARIABLE) or secrets.token_urlsafe(24)
    token = None if settings.open_access else access_token(settings.data)
    app = build_app(settings, token=token, link=link, link_token=link_token, hold=hold)
    children = _children(settings, url, link, link_token, app.state.workers.words)
    telemetry = app.state.telemetry
    config = uvicorn.Config(
        TelemetryFirst(app, telemetry, Authentication(telemetry.handle, token)),
        proxy_headers=False,
        loop="uvloop",
        http="backend.http_protocol:RequestWithin",
        ws="backend.live.push_protocol:PushProtocol",
        ws_per_message_deflate=False,
        ws_max_size=64 * 1024,
        access_log=False,
        log_level="error",  # it warns of what callers send that is no request: they are told, and fill no log
        server_header=False,
        date_header=False,
        timeout_graceful_shutdown=3,
        lifespan="on",
    )
    server = _Announcing(config, url, children)
    server.run(sockets=[listener])


class _Announcing(uvicorn.Server):
    """A server that says on standard output when it answers, and then starts its children."""

    def __init__(self, config: uvicorn.Config, url: str, children: list[Child]) -> None:
        super().__init__(config)
        self._url = url
        self._children = children

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to answer requests."""
        await super().startup(sockets)
        if self.should_exit:
            raise SystemExit(3)
        tune_for_serving()
        for child in self._children:
            child.start()
        print(f"ready {self._url}", flush=True)  # noqa: T201 - the contract's line

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Stop the children, then answering."""
        await asyncio.gather(*(child.stop() for child in self._children))
        await super().shutdown(sockets)


def _children(
    settings: Settings, url: str, link: socket.socket, link_token: str, words: Callable[[int], int]
) -> list[Child]:
    """The processes that run beside the web process."""
    children = []
    if settings.worker:
        host, port = link.getsockname()[:2]
        arguments = [
            "worker",
            "--supervised",
            "--database",
            settings.database_url,
            "--link",
            f"{host}:{port}",
        ]
        environment = {LINK_TOKEN_VARIABLE: link_token, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        children.append(Child(arguments, environment, words))
    if settings.demo:
        arguments = ["demo", "--supervised", "--url", url]
        if not settings.open_access:
            arguments += ["--data", str(settings.data)]
        children.append(Child(arguments, {}))
    return children
