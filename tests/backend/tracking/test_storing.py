"""Rows are kept while the database cannot be written, and lost never."""

import asyncio
from collections.abc import Callable
from sqlite3 import Connection

import pytest
import sqlalchemy as sa

from backend.coordination.lease import Leases
from backend.log.base import RecordedFrame, Snapshot, StaleEpoch
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine, writing
from backend.log.read import SqlLogReader
from backend.tracking.storing import MAX_WAITING_BYTES, SNAPSHOT_EVERY_BATCHES, Keeper


def row(second: int, record: bytes = b"record", seq: int = 1) -> RecordedFrame:
    return RecordedFrame(second=second, seq=seq, received=1.0, record=record)


@pytest.fixture
def keeper(engine: sa.Engine) -> Callable[..., Keeper]:
    def make(writer_engine: sa.Engine = engine, settled: int | None = None) -> Keeper:
        epoch = Leases(lambda: writing(engine), "north").acquire("i1")
        assert epoch is not None
        return Keeper(SqlDerivedWriter(writer_engine), "i1", epoch, settled, (0, 0))

    return make


def stored(engine: sa.Engine) -> dict[int, bytes]:
    return {row.second: row.record for row in SqlLogReader(engine).frames("i1")}


def test_rows_and_state_are_stored_together(engine: sa.Engine, keeper: Callable[..., Keeper]) -> None:
    keeping = keeper()
    keeping.take(row(1))
    keeping.take(row(2, b"first"))
    keeping.take(row(2, b"second"))
    assert asyncio.run(keeping.save(Snapshot(seq=9, state=b"state")))
    assert stored(engine) == {1: b"record", 2: b"second"}
    snapshot = SqlLogReader(engine).snapshot("i1")
    assert snapshot == Snapshot(seq=9, state=b"state")
    assert keeping.empty
    assert keeping.snapshot_at == (9, 0)


def test_a_full_disk_costs_no_row(sqlite_url: str, engine: sa.Engine, keeper: Callable[..., Keeper]) -> None:
    full = make_engine(sqlite_url)
    pages = {"most": 1}

    @sa.event.listens_for(full, "connect")
    def limit(connection: Connection, _record: object) -> None:
        connection.execute(f"PRAGMA max_page_count={pages['most']}")

    keeping = keeper(full)
    big = bytes(100_000)
    keeping.take(row(1, big))
    assert not asyncio.run(keeping.save(None))
    assert not keeping.empty
    assert keeping.rests_s() > 0.5
    keeping.take(row(2, big))
    pages["most"] = 1_000_000
    assert asyncio.run(keeping.save(Snapshot(seq=2, state=b"state")))
    assert stored(engine) == {1: big, 2: big}
    full.dispose()


def test_rows_that_come_while_others_are_stored_are_stored_next(
    engine: sa.Engine, keeper: Callable[..., Keeper]
) -> None:
    async def go() -> None:
        keeping = keeper()
        keeping.take(row(1))
        saving = asyncio.create_task(keeping.save(None))
        await asyncio.sleep(0)
        keeping.take(row(1, b"newer"))
        keeping.take(row(2))
        assert await saving
        assert not keeping.empty
        assert await keeping.save(None)

    asyncio.run(go())
    assert stored(engine) == {1: b"newer", 2: b"record"}


def test_a_lost_lease_ends_the_storing(engine: sa.Engine, keeper: Callable[..., Keeper]) -> None:
    old = keeper()
    keeper()
    old.take(row(1))
    with pytest.raises(StaleEpoch):
        asyncio.run(old.save(None))
    assert stored(engine) == {}


def test_seconds_that_were_shown_already_stay_as_they_were(keeper: Callable[..., Keeper]) -> None:
    keeping = keeper(settled=10)
    keeping.take(row(9))
    assert keeping.empty
    keeping.take(row(10))
    assert not keeping.empty


def test_seconds_after_the_clock_was_put_back_are_stored_though_later_ones_are(
    keeper: Callable[..., Keeper],
) -> None:
    keeping = keeper(settled=10)
    keeping.take(row(9), put_back=True)
    assert not keeping.empty


def test_folding_waits_where_too_much_waits_to_be_stored(keeper: Callable[..., Keeper]) -> None:
    keeping = keeper()
    assert not keeping.full
    keeping.take(row(1, bytes(MAX_WAITING_BYTES + 1)))
    assert keeping.full


def test_a_state_is_stored_when_there_is_time_or_much_was_folded(keeper: Callable[..., Keeper]) -> None:
    keeping = keeper()
    assert not keeping.wants_snapshot((0, 0), idle=True)
    assert keeping.wants_snapshot((1, 0), idle=True)
    assert not keeping.wants_snapshot((1, 0), idle=False)
    assert keeping.wants_snapshot((0, 1), idle=False)
    assert keeping.wants_snapshot((SNAPSHOT_EVERY_BATCHES, 0), idle=False)
