"""The statements of the append, for many rows at once.

Stepping row by row would hand the interpreter's lock over at every row; and compiling a statement of many
rows in SQLAlchemy takes longer than running it. So they are built here from the schema, once for each number
of rows, and run in one call each.
"""

from collections.abc import Iterable
from functools import lru_cache

import sqlalchemy as sa

from backend.log.schema import batches

KEY = ("incident", "gateway", "batch")
COLUMNS = tuple(column.name for column in batches.columns)


def _marks(dialect: str, columns: Iterable[str]) -> str:
    if dialect == "sqlite":
        return ", ".join("?" for _ in columns)
    # Binary form for the body: as text it would be twice as long.
    return ", ".join("%b" if isinstance(batches.c[name].type, sa.LargeBinary) else "%s" for name in columns)


def _rows(dialect: str, columns: Iterable[str], count: int) -> str:
    return ", ".join([f"({_marks(dialect, columns)})"] * count)


@lru_cache(maxsize=1024)
def insert_batches(dialect: str, count: int) -> str:
    """INSERT of `count` batches, values in the order of `COLUMNS`; those in the log already are left out."""
    return " ".join(
        [
            *("INSERT INTO batches", f"({', '.join(COLUMNS)})", "VALUES", _rows(dialect, COLUMNS, count)),
            *("ON CONFLICT", f"({', '.join(KEY)})", "DO NOTHING"),
        ]
    )


@lru_cache(maxsize=1024)
def lock_incidents(dialect: str, count: int) -> str:
    """SELECT id, state and last_seq of `count` incidents, and keep others from changing them.

    One order for all writers, so that two groups never wait for each other in a circle. SQLite has taken its
    write lock at the start of the transaction.
    """
    marks = _marks(dialect, ["incident"] * count)
    lock = "" if dialect == "sqlite" else "FOR UPDATE"
    return " ".join(["SELECT id, state, last_seq FROM incidents WHERE id IN (", marks, ") ORDER BY id", lock])


@lru_cache(maxsize=2)
def advance_incident(dialect: str) -> str:
    """UPDATE of an incident's newest entry: `last_seq`, id."""
    mark = "?" if dialect == "sqlite" else "%s"
    return " ".join(["UPDATE incidents SET last_seq =", mark, "WHERE id =", mark])


@lru_cache(maxsize=1024)
def select_known(dialect: str, count: int) -> str:
    """SELECT those of `count` keys that are in the log: incident, gateway, batch, seq, accepted, rejected."""
    return " ".join(
        [
            "WITH asked (incident, gateway, batch) AS (VALUES",
            _rows(dialect, KEY, count),
            ") SELECT b.incident, b.gateway, b.batch, b.seq, b.accepted, b.rejected",
            # CROSS JOIN tells SQLite to walk the few keys, not the log.
            "FROM asked CROSS JOIN batches AS b",
            "WHERE b.incident = asked.incident AND b.gateway = asked.gateway AND b.batch = asked.batch",
        ]
    )
