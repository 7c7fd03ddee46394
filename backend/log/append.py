"""Appending a group of batches in one transaction."""

from collections.abc import Sequence

import msgspec
import sqlalchemy as sa

from backend.errors import Conflict, FieldError, NotFound, Problem
from backend.log.base import Appended, NewBatch
from backend.log.engine import writing
from backend.log.statements import (
    COLUMNS,
    advance_incident,
    insert_batches,
    lock_incidents,
    select_known,
)

Key = tuple[str, str, str]
Outcome = Appended | Problem

_decode_rejected = msgspec.json.Decoder(tuple[FieldError, ...]).decode


class _AskFirst(Exception):  # noqa: N818 - names what to do
    """A batch of the group may be in the log already."""


def encode_rejected(rejected: tuple[FieldError, ...]) -> str | None:
    """The readings set aside, as they are stored; None where there are none."""
    return msgspec.json.encode(rejected).decode() if rejected else None


def decode_rejected(stored: str | None) -> tuple[FieldError, ...]:
    """The inverse of `encode_rejected`."""
    return _decode_rejected(stored) if stored else ()


def append_group(engine: sa.Engine, group: Sequence[NewBatch]) -> list[Outcome]:
    """Append batches in one transaction, durable when it returns.

    `seq` is given out under the lock of the incident's row, so that it counts up without gaps in the order of
    commits. A batch that is in the log already, or earlier in the group, gets its first answer again, even if
    the incident has been closed since.

    Args:
        engine: of the log's database.
        group: batches of any incidents.

    Returns:
        What became of each: `Appended`, or the problem (NotFound, Conflict) that refused it.

    Raises:
        LogUnwritable: the database failed; nothing of the group is stored or acknowledged.
    """
    try:
        with writing(engine) as connection:
            return _append(connection, group, ask=False)
    except _AskFirst:
        # Repeats are rare: asking for them beforehand would cost every group what now only these cost.
        with writing(engine) as connection:
            return _append(connection, group, ask=True)


def _append(connection: sa.Connection, group: Sequence[NewBatch], *, ask: bool) -> list[Outcome]:
    """Append those batches that are not in the log yet.

    Args:
        connection: in a transaction that writes.
        group: batches of any incidents.
        ask: which of them are in the log; else none is taken to be.

    Raises:
        _AskFirst: one may be, and it was not asked.
    """
    dialect = connection.dialect.name
    ids = sorted({batch.incident for batch in group})
    heads = {
        incident: (state, last_seq)
        for incident, state, last_seq in connection.exec_driver_sql(
            lock_incidents(dialect, len(ids)), tuple(ids)
        )
    }
    # Under the lock: another process may write the same batches to the same database.
    known = _known(connection, group) if ask else {}
    newest: dict[str, int] = {}
    outcomes: list[Outcome] = []
    values: list[object] = []
    for batch in group:
        incident = batch.incident
        key = (incident, batch.gateway, batch.batch)
        if key in known:
            outcomes.append(known[key])
            continue
        if incident not in heads:
            outcomes.append(_unknown(incident))
            continue
        state, last_seq = heads[incident]
        if state != "active":
            if not ask:  # a repeat is answered even where the incident has been closed since
                raise _AskFirst
            outcomes.append(_closed(incident))
            continue
        seq = newest[incident] = newest.get(incident, last_seq) + 1
        rejected = encode_rejected(batch.rejected)
        values += (
            incident,
            seq,
            batch.gateway,
            batch.batch,
            batch.received,
            batch.sent,
            batch.body,
            batch.accepted,
            rejected,
        )
        outcomes.append(Appended(seq, batch.accepted, duplicate=False, rejected=batch.rejected))
        known[key] = Appended(seq, batch.accepted, duplicate=True, rejected=batch.rejected)
    count = len(values) // len(COLUMNS)
    if count:
        inserted = connection.exec_driver_sql(insert_batches(dialect, count), tuple(values))
        if inserted.rowcount != count:
            raise _AskFirst
        for incident, seq in newest.items():
            connection.exec_driver_sql(advance_incident(dialect), (seq, incident))
    return outcomes


def _known(connection: sa.Connection, group: Sequence[NewBatch]) -> dict[Key, Appended]:
    keys = [name for batch in group for name in (batch.incident, batch.gateway, batch.batch)]
    rows = connection.exec_driver_sql(select_known(connection.dialect.name, len(group)), tuple(keys))
    return {
        (incident, gateway, batch): Appended(
            seq, accepted, duplicate=True, rejected=decode_rejected(rejected)
        )
        for incident, gateway, batch, seq, accepted, rejected in rows
    }


def _unknown(incident: str) -> NotFound:
    return NotFound(f"There is no incident {incident!r}: GET /api/v1/incidents lists them.")


def _closed(incident: str) -> Conflict:
    return Conflict(f"Incident {incident} is closed: it takes no more telemetry. Post to an active incident.")
