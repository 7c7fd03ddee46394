"""Reading the log and what was recorded beside it."""

from collections.abc import Iterator
from typing import Any

import sqlalchemy as sa

from backend.log.append import decode_rejected
from backend.log.base import LoggedBatch, LoggedStretch, RecordedFrame, Snapshot
from backend.log.engine import reading
from backend.log.schema import batches, frames, snapshots, stretches

BLOCK_ROWS = 512
BLOCK_BYTES = 4 * 1024 * 1024
FETCH_ROWS = 32

_batches_after = (
    sa.select(
        batches.c.seq,
        batches.c.gateway,
        batches.c.batch,
        batches.c.received,
        batches.c.sent,
        batches.c.body,
        batches.c.rejected,
    )
    .where(batches.c.incident == sa.bindparam("incident"), batches.c.seq > sa.bindparam("after"))
    .order_by(batches.c.seq)
    .limit(sa.bindparam("rows"))
)

_stretches_after = (
    sa.select(
        stretches.c.number,
        stretches.c.after_seq,
        stretches.c.since,
        sa.type_coerce(stretches.c.settings, sa.Text).label("settings"),
        sa.type_coerce(stretches.c.origin, sa.Text).label("origin"),
    )
    .where(stretches.c.incident == sa.bindparam("incident"), stretches.c.number > sa.bindparam("after"))
    .order_by(stretches.c.number)
)


class SqlLogReader:
    """Reads the log; safe to use from any thread.

    Args:
        engine: of the log's database.
    """

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine

    def batches(self, incident: str, after: int = 0, limit: int | None = None) -> Iterator[LoggedBatch]:
        """Batches with `seq` > `after` in `seq` order.

        They are read in blocks of bounded size, each in a transaction that has ended before the first of
        them is handed out: a slow consumer holds nothing back.

        Raises:
            LogUnreadable: the database failed.
        """
        left = limit
        while left is None or left > 0:
            rows = BLOCK_ROWS if left is None else min(BLOCK_ROWS, left)
            block, exhausted = self._block(incident, after, rows)
            yield from block
            if exhausted:
                return
            after = block[-1].seq
            if left is not None:
                left -= len(block)

    def _block(self, incident: str, after: int, rows: int) -> tuple[list[LoggedBatch], bool]:
        block: list[LoggedBatch] = []
        size = 0
        with reading(self._engine) as connection:
            result = connection.execution_options(stream_results=True, max_row_buffer=FETCH_ROWS).execute(
                _batches_after, {"incident": incident, "after": after, "rows": rows}
            )
            while size < BLOCK_BYTES and (fetched := result.fetchmany(FETCH_ROWS)):
                for seq, gateway, batch, received, sent, body, rejected in fetched:
                    size += len(body)
                    block.append(
                        LoggedBatch(
                            seq=seq,
                            gateway=gateway,
                            batch=batch,
                            received=received,
                            sent=sent,
                            body=body,
                            rejected=decode_rejected(rejected) if rejected else (),
                        )
                    )
            result.close()
        return block, len(block) < rows and size < BLOCK_BYTES

    def stretches(self, incident: str, after: int = -1) -> list[LoggedStretch]:
        """What the incident was set to, in order: those with `number` > `after`."""
        with reading(self._engine) as connection:
            rows = connection.execute(_stretches_after, {"incident": incident, "after": after}).all()
        return [LoggedStretch(**row._asdict()) for row in rows]

    def frame_at(self, incident: str, t: float, received_by: float | None = None) -> RecordedFrame | None:
        """The newest recorded frame with second ≤ `t` (and received ≤ `received_by`)."""
        query = _frames(incident).where(frames.c.second <= t)
        if received_by is not None:
            query = query.where(frames.c.received <= received_by)
        with reading(self._engine) as connection:
            row = connection.execute(query.order_by(frames.c.second.desc()).limit(1)).first()
        return None if row is None else _frame(row)

    def frames(
        self, incident: str, start: float | None = None, end: float | None = None
    ) -> Iterator[RecordedFrame]:
        """Recorded frames with start ≤ second ≤ end, in order, read in blocks as `batches` are."""
        query = _frames(incident).order_by(frames.c.second).limit(BLOCK_ROWS)
        if end is not None:
            query = query.where(frames.c.second <= end)
        while True:
            part = query if start is None else query.where(frames.c.second >= start)
            with reading(self._engine) as connection:
                block = [_frame(row) for row in connection.execute(part)]
            yield from block
            if len(block) < BLOCK_ROWS:
                return
            start = block[-1].second + 1

    def frame_span(self, incident: str) -> tuple[int, int] | None:
        """First and last recorded second; None if there is none."""
        query = sa.select(sa.func.min(frames.c.second), sa.func.max(frames.c.second))
        with reading(self._engine) as connection:
            first, last = connection.execute(query.where(frames.c.incident == incident)).one()
        return None if first is None else (first, last)

    def snapshot(self, incident: str) -> Snapshot | None:
        """The newest snapshot of an incident."""
        query = sa.select(snapshots).where(snapshots.c.incident == incident)
        with reading(self._engine) as connection:
            row = connection.execute(query).first()
        return None if row is None else Snapshot(seq=row.seq, state=row.state, made_with=row.made_with)


def _frames(incident: str) -> sa.Select[Any]:
    columns = (frames.c.second, frames.c.seq, frames.c.received, frames.c.record)
    return sa.select(*columns).where(frames.c.incident == incident)


def _frame(row: sa.Row[Any]) -> RecordedFrame:
    return RecordedFrame(second=row.second, seq=row.seq, received=row.received, record=row.record)
