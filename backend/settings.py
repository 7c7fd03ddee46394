"""What a deployment may set, each with its default and its reason."""

from pathlib import Path
from urllib.parse import quote

import msgspec

from backend.errors import CommandRefused, in_reach

LINK_TOKEN_VARIABLE = "FIRETHREAD_LINK_TOKEN"  # noqa: S105 - the variable's name, not a secret
DATABASE_VARIABLE = "FIRETHREAD_DATABASE"
MAX_PORT = 65_535


def host_and_port(address: str) -> tuple[str, int]:
    """Host and port of `HOST:PORT`; an IPv6 host may stand in brackets.

    Raises:
        CommandRefused: it is no such address.
    """
    host, _, port = address.rpartition(":")
    if not host or not (port.isascii() and port.isdigit()) or int(port) > MAX_PORT:
        raise CommandRefused(f"--link takes HOST:PORT, such as 127.0.0.1:7070, not {address!r}")
    return host.removeprefix("[").removesuffix("]"), int(port)


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """Settings of one `firethread` process.

    Attributes:
        data: folder of the SQLite database, the access token and nothing else.
        database: SQLAlchemy URL; None means SQLite under `data`.
        host: address that the web process listens on.
        port: its port; 0 picks a free one.
        open_access: requests need no access token (only on a loopback address).
        worker: supervise an estimator worker beside the web process.
        link: `host:port` where web and worker meet; port 0 picks a free one.
        demo: play the demo incident through the public API.
        max_readings: readings in a batch; the contract's limit.
        max_body_bytes: bytes of a batch, after decompression; the contract's limit.
        queue_bytes: bodies waiting for the log before 429 is answered: a second of a fast disk.
        shown_hz: how often a frame may be pushed, per incident; the contract's limit.
    """

    data: Path
    database: str | None = None
    host: str = "127.0.0.1"
    port: int = 8000
    open_access: bool = False
    worker: bool = True
    link: str = "127.0.0.1:0"
    demo: bool = False
    max_readings: int = 10_000
    max_body_bytes: int = 8 * 1024 * 1024
    queue_bytes: int = 64 * 1024 * 1024
    shown_hz: float = 10.0

    def make_folder(self) -> None:
        """Make the folder where there is none yet.

        Raises:
            CommandRefused: the operating system does not let us.
        """
        with in_reach(f"--data {self.data}"):
            self.data.mkdir(parents=True, exist_ok=True)

    @property
    def database_url(self) -> str:
        """The SQLAlchemy URL of the log."""
        if self.database is None:
            return f"sqlite:///{quote(str(self.data.resolve() / 'firethread.db'))}"
        # Engineers write the scheme of libpq; the driver is ours to choose.
        for scheme in ("postgresql://", "postgres://"):
            if self.database.startswith(scheme):
                return "postgresql+psycopg://" + self.database.removeprefix(scheme)
        return self.database
