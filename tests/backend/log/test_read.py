import sqlalchemy as sa

from backend.errors import FieldError
from backend.log.append import append_group
from backend.log.base import LoggedBatch
from backend.log.incidents import IncidentStore
from backend.log.read import BLOCK_BYTES, BLOCK_ROWS, SqlLogReader
from tests.backend.log.batches import MakeBatch


def test_what_was_appended_is_read_back_whole(engine: sa.Engine, batch: MakeBatch) -> None:
    fault = FieldError(code="unknown_kind", message="Ünknown", index=0, field="kind")
    body = bytes(range(256))
    append_group(engine, [batch("x", body=body, rejected=(fault,), received=1763712345.123456, sent=0.1)])
    (logged,) = SqlLogReader(engine).batches(batch.incident)
    assert logged == LoggedBatch(
        seq=1,
        gateway="g",
        batch="x",
        received=1763712345.123456,
        sent=0.1,
        body=body,
        rejected=(fault,),
    )


def test_after_and_limit_choose_what_is_read(engine: sa.Engine, batch: MakeBatch) -> None:
    append_group(engine, [batch(str(i)) for i in range(1, 11)])
    reader = SqlLogReader(engine)
    assert [one.seq for one in reader.batches(batch.incident, after=3, limit=4)] == [4, 5, 6, 7]
    assert [one.seq for one in reader.batches(batch.incident, after=8, limit=100)] == [9, 10]
    assert list(reader.batches(batch.incident, after=10)) == []
    assert list(reader.batches(batch.incident, limit=0)) == []
    assert list(reader.batches("nowhere")) == []


def test_a_log_of_many_blocks_is_read_without_a_gap(engine: sa.Engine, batch: MakeBatch) -> None:
    count = 2 * BLOCK_ROWS + 3
    for start in range(0, count, 200):
        append_group(engine, [batch(str(i)) for i in range(start, min(start + 200, count))])
    reader = SqlLogReader(engine)
    assert [one.seq for one in reader.batches(batch.incident)] == list(range(1, count + 1))
    exactly = list(reader.batches(batch.incident, limit=2 * BLOCK_ROWS))
    assert len(exactly) == 2 * BLOCK_ROWS


def test_large_bodies_end_a_block_early(engine: sa.Engine, batch: MakeBatch) -> None:
    large = b"x" * (BLOCK_BYTES // 20)
    append_group(engine, [batch(str(i), body=large) for i in range(70)])
    reader = SqlLogReader(engine)
    block, exhausted = reader._block(batch.incident, 0, BLOCK_ROWS)
    assert not exhausted
    assert len(block) < 70
    assert [one.seq for one in reader.batches(batch.incident)] == list(range(1, 71))


def test_a_slow_consumer_holds_nothing_back(
    engine: sa.Engine, store: IncidentStore, batch: MakeBatch
) -> None:
    append_group(engine, [batch(str(i)) for i in range(5)])
    batches = SqlLogReader(engine).batches(batch.incident)
    assert next(batches).seq == 1
    append_group(engine, [batch("later")])
    store.change(batch.incident, {"name": "renamed"})
    assert [one.seq for one in batches] == [2, 3, 4, 5]
