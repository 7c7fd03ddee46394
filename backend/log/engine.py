"""Connections to the two databases: everything in which they differ but the statements of the append."""

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from sqlite3 import SQLITE_BUSY
from sqlite3 import Connection as SqliteConnection
from sqlite3 import OperationalError as SqliteError

import sqlalchemy as sa

from backend.errors import CommandRefused
from backend.log.base import LogUnreadable, LogUnwritable

BUSY_TIMEOUT_S = 10
RETRY_UNWRITABLE_S = 5
PAGE_BYTES = 8_192
"""Bodies are 1 to 100 kB: at SQLite's own 4 kB large ones took a fifth longer, at 16 kB small ones did."""

CHECKPOINT_PAGES = 2_000
"""16 MiB of WAL between checkpoints: at a full stream of telemetry one or two a second."""

POSTGRES_CONNECT: Mapping[str, object] = {
    "connect_timeout": 5,
    # An acknowledged batch must survive a crash whatever the server's own default; a lock that is never
    # given back and a network that swallows packets must end in a 503, not in silence.
    "options": "-c synchronous_commit=on -c lock_timeout=10s -c statement_timeout=60s",
    "keepalives_idle": 5,
    "tcp_user_timeout": 10_000,
}


def understood(url: str) -> sa.URL:
    """The parts of a database's URL.

    Args:
        url: SQLAlchemy URL.

    Raises:
        CommandRefused: it is none, or of neither SQLite nor Postgres; what it was is not repeated: it may
            hold a password.
    """
    try:
        parts = sa.engine.make_url(url)
        kind, driver = parts.get_backend_name(), parts.get_driver_name()
    except (sa.exc.ArgumentError, ValueError):
        raise CommandRefused(
            "--database takes a URL such as postgresql://USER:PASSWORD@HOST/NAME, and what was given is none"
        ) from None
    if (kind, driver) not in {("postgresql", "psycopg"), ("sqlite", "pysqlite")}:
        shown = parts.drivername
        raise CommandRefused(
            f"the log is kept in SQLite or Postgres (psycopg), not in {shown!r}: check --database"
        )
    return parts


def make_engine(url: str, *, checkpoints: bool = False) -> sa.Engine:
    """An engine for the log's database.

    Args:
        url: SQLAlchemy URL, SQLite or Postgres (psycopg 3).
        checkpoints: SQLite only: its connections move the WAL into the database. Only the process that
            appends does; SQLite below 3.51.3 may lose pages where two connections checkpoint.

    Raises:
        CommandRefused: it is no URL, or of neither SQLite nor Postgres.
    """
    parts = understood(url)
    if parts.get_backend_name() == "postgresql":
        return sa.create_engine(parts, connect_args=dict(POSTGRES_CONNECT), pool_pre_ping=True)
    engine = sa.create_engine(
        parts, connect_args={"timeout": BUSY_TIMEOUT_S, "check_same_thread": False, "cached_statements": 512}
    )

    @sa.event.listens_for(engine, "connect")
    def on_connect(connection: SqliteConnection, record: sa.pool.ConnectionPoolEntry) -> None:
        connection.isolation_level = None  # transactions are begun by us, not by the driver
        # Takes effect where the database is still empty, and not once it has a WAL.
        connection.execute(f"PRAGMA page_size={PAGE_BYTES}")
        _write_ahead(connection)
        for pragma in (
            "synchronous=FULL",
            "mmap_size=0",
            "journal_size_limit=67108864",
            f"wal_autocheckpoint={CHECKPOINT_PAGES if checkpoints else 0}",
        ):
            connection.execute(f"PRAGMA {pragma}")
        record.info[_FILE] = _file(parts.database)

    @sa.event.listens_for(engine, "begin")
    def on_begin(connection: sa.Connection) -> None:
        # A deferred transaction that turns into a writing one is refused where another wrote meanwhile.
        writes = connection.get_execution_options().get("writes", False)
        if writes:
            refuse_if_gone(connection)
        connection.exec_driver_sql("BEGIN IMMEDIATE" if writes else "BEGIN")

    return engine


AWAY = (sa.exc.OperationalError, sa.exc.InterfaceError, sa.exc.InternalError, sa.exc.TimeoutError)
"""What SQLAlchemy raises where the database fails, and not what was asked of it; see `_failed`."""


def _write_ahead(connection: SqliteConnection) -> None:
    """Have the database keep a WAL; SQLite itself does not wait where several open a new one at once."""
    until = time.monotonic() + BUSY_TIMEOUT_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode=WAL")
        except SqliteError as error:
            if error.sqlite_errorcode != SQLITE_BUSY or time.monotonic() > until:
                raise
            time.sleep(0.02)
        else:
            return


_FILE = "file"
"""Where a connection's pool keeps which file it has open."""


def _file(path: str | None) -> int | None:
    """The number by which the file system knows what lies at a path; None: nothing does."""
    try:
        return Path(path or "").stat().st_ino
    except OSError:
        return None


def refuse_if_gone(connection: sa.Connection) -> None:
    """Refuse where SQLite's file is not at its path any more: what is written to it is in no folder.

    SQLite itself does not look, and would write on to what was deleted, until its last connection closes.

    Raises:
        LogUnwritable: it has been deleted, moved or replaced.
    """
    if connection.dialect.name != "sqlite":
        return
    opened = connection.connection.info.get(_FILE)
    if opened is not None and opened != _file(connection.engine.url.database):
        raise LogUnwritable(
            "The database's file has been deleted, moved or replaced while the server ran: nothing is "
            "acknowledged. What it held can be read until the server stops: save each incident's `log` "
            "first. Then put the file back, or restart the server.",
            retry_after_s=RETRY_UNWRITABLE_S,
        )


@contextmanager
def writing(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A transaction that writes: SQLite's write lock is taken at its start.

    Raises:
        LogUnwritable: the database failed, or its file is gone; the transaction is rolled back.
    """
    try:
        with engine.execution_options(writes=True).begin() as connection:
            yield connection
    except sa.exc.SQLAlchemyError as error:
        if not _failed(error):
            raise
        # After an input or output error a connection may be of no more use: the next one is new.
        engine.dispose()
        raise LogUnwritable(
            f"The database cannot be written now ({cause_of(error)}). "
            "Nothing is acknowledged: send it later.",
            retry_after_s=RETRY_UNWRITABLE_S,
        ) from error


@contextmanager
def reading(engine: sa.Engine) -> Iterator[sa.Connection]:
    """A transaction that reads one consistent state.

    Raises:
        LogUnreadable: the database failed.
    """
    try:
        with engine.connect() as connection:
            yield connection
    except sa.exc.SQLAlchemyError as error:
        if not _failed(error):
            raise
        engine.dispose()
        raise LogUnreadable(f"The database cannot be read now ({cause_of(error)}): try again.") from error


def _failed(error: sa.exc.SQLAlchemyError) -> bool:
    """Whether the database failed; of a damaged file SQLite raises what is of no kind but the base of all."""
    return isinstance(error, AWAY) or type(error) is sa.exc.DatabaseError


def cause_of(error: BaseException) -> str:
    """The first line of what a driver says of a failure."""
    lines = str(error.__cause__ or error).splitlines()
    return lines[0] if lines else type(error).__name__
