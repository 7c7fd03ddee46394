"""What the worker stores beside the log, fenced by the epoch of its lease."""

from collections.abc import Sequence

import msgspec
import sqlalchemy as sa
from sqlalchemy.dialects import postgresql, sqlite

from backend.log.base import RecordedFrame, Snapshot, StaleEpoch
from backend.log.engine import writing
from backend.log.schema import frames as frames_table
from backend.log.schema import leases, snapshots


class SqlDerivedWriter:
    """Stores recorded frames and snapshots.

    Args:
        engine: of the log's database.
    """

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine
        insert = sqlite.insert if engine.dialect.name == "sqlite" else postgresql.insert
        self._put_frame = _replacing(insert(frames_table), frames_table)
        self._put_snapshot = _replacing(insert(snapshots), snapshots)

    def save(
        self, incident: str, epoch: int, frames: Sequence[RecordedFrame], snapshot: Snapshot | None
    ) -> None:
        """Store recorded frames and, if given, the snapshot in one transaction; repeats replace.

        Raises:
            StaleEpoch: another worker holds the incident now.
            LogUnwritable: the database cannot be written.
        """
        with writing(self._engine) as connection:
            self._check(connection, incident, epoch)
            if frames:
                rows = [msgspec.structs.asdict(frame) | {"incident": incident} for frame in frames]
                connection.execute(self._put_frame, rows)
            if snapshot is not None:
                row = msgspec.structs.asdict(snapshot) | {"incident": incident}
                connection.execute(self._put_snapshot, row)

    @staticmethod
    def _check(connection: sa.Connection, incident: str, epoch: int) -> None:
        # Sharing the lock of the lease's row keeps another worker from taking it before this commits.
        query = sa.select(leases.c.epoch).where(leases.c.incident == incident).with_for_update(read=True)
        current = connection.execute(query).scalar()
        if current != epoch:
            raise StaleEpoch(f"incident {incident}: lease epoch is {current}, this worker's is {epoch}")


def _replacing(
    insert: sqlite.Insert | postgresql.Insert, table: sa.Table
) -> sqlite.Insert | postgresql.Insert:
    keys = list(table.primary_key.columns)
    return insert.on_conflict_do_update(
        index_elements=keys,
        set_={column.name: insert.excluded[column.name] for column in table.columns if column not in keys},
    )
