import pytest
import sqlalchemy as sa

from backend.log.append import append_group
from backend.log.base import RecordedFrame, Snapshot, StaleEpoch
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incident import Clock
from backend.log.incidents import IncidentStore
from backend.log.read import BLOCK_ROWS, SqlLogReader
from backend.log.schema import leases
from tests.backend.log.batches import MakeBatch


@pytest.fixture
def held(engine: sa.Engine, incident: str) -> str:
    """The incident, its lease held with epoch 3."""
    with writing(engine) as connection:
        connection.execute(
            sa.insert(leases).values(incident=incident, holder="worker", epoch=3, expires=1e10)
        )
    return incident


def frame(second: int, record: bytes = b"r", received: float = 0.0) -> RecordedFrame:
    return RecordedFrame(second=second, seq=1, received=received or second + 0.5, record=record)


def test_frames_and_snapshot_are_stored_and_replaced(engine: sa.Engine, held: str) -> None:
    writer, reader = SqlDerivedWriter(engine), SqlLogReader(engine)
    writer.save(held, 3, [frame(1), frame(2)], Snapshot(seq=4, state=b"\x00old"))
    writer.save(held, 3, [frame(2, b"new"), frame(3)], Snapshot(seq=9, state=b"\xffnew"))
    assert list(reader.frames(held)) == [frame(1), frame(2, b"new"), frame(3)]
    assert reader.snapshot(held) == Snapshot(seq=9, state=b"\xffnew")
    assert reader.frame_span(held) == (1, 3)


@pytest.mark.parametrize("epoch", [2, 4])
def test_a_worker_without_the_lease_writes_nothing(engine: sa.Engine, held: str, epoch: int) -> None:
    with pytest.raises(StaleEpoch):
        SqlDerivedWriter(engine).save(held, epoch, [frame(1)], Snapshot(seq=1, state=b"s"))
    assert SqlLogReader(engine).frame_span(held) is None
    assert SqlLogReader(engine).snapshot(held) is None


def test_nothing_is_written_where_nobody_holds_the_incident(engine: sa.Engine, incident: str) -> None:
    with pytest.raises(StaleEpoch):
        SqlDerivedWriter(engine).save(incident, 0, [frame(1)], None)


def test_the_newest_frame_known_by_then_is_found(engine: sa.Engine, held: str) -> None:
    SqlDerivedWriter(engine).save(held, 3, [frame(1), frame(2, received=50.0), frame(3)], None)
    reader = SqlLogReader(engine)
    assert reader.frame_at(held, 2.9) == frame(2, received=50.0)
    assert reader.frame_at(held, 2.9, received_by=3.9) == frame(1)
    assert reader.frame_at(held, 0.5) is None
    assert reader.frame_at(held, 1e9) == frame(3)


def test_frames_are_read_over_any_span(engine: sa.Engine, held: str) -> None:
    every = [frame(second) for second in range(1, 2 * BLOCK_ROWS + 2)]
    SqlDerivedWriter(engine).save(held, 3, every, None)
    reader = SqlLogReader(engine)
    assert list(reader.frames(held)) == every
    assert [one.second for one in reader.frames(held, 10.5, 13.5)] == [11, 12, 13]
    assert [one.second for one in reader.frames(held, start=2 * BLOCK_ROWS)] == [
        2 * BLOCK_ROWS,
        2 * BLOCK_ROWS + 1,
    ]


@pytest.mark.parametrize(
    ("clock", "seconds", "first_t"),
    [
        (
            "live",
            [0, 5_000, 100_000, 100_001],
            100_000.0,
        ),  # units without a clock came first
        ("live", [0, 85_000, 100_000], 85_000.0),  # a gateway had held back what it tells
        ("live", [0, 1], 0.0),  # nobody has a clock: an exercise that counts from 0
        ("recorded", [0, 100_000], 0.0),  # its time is that of its readings
    ],
)
def test_a_wrong_clock_does_not_begin_a_live_incident(
    engine: sa.Engine, store: IncidentStore, clock: Clock, seconds: list[int], first_t: float
) -> None:
    incident = store.create("a unit without a clock", clock).id
    append_group(engine, [MakeBatch(incident)("1", received=100_000.5)])
    with writing(engine) as connection:
        connection.execute(
            sa.insert(leases).values(incident=incident, holder="worker", epoch=3, expires=1e10)
        )
    SqlDerivedWriter(engine).save(incident, 3, [frame(second) for second in seconds], None)
    assert store.get(incident).first_t == first_t
    assert store.get(incident).earliest_t == (100_000 - 6 * 3600 if clock == "live" else None)
    assert store.get(incident).last_t == seconds[-1]


def test_an_incident_shows_the_span_of_its_frames(engine: sa.Engine, store: IncidentStore, held: str) -> None:
    SqlDerivedWriter(engine).save(held, 3, [frame(7), frame(8)], None)
    shown = store.get(held)
    assert (shown.first_t, shown.last_t) == (7.0, 8.0)
