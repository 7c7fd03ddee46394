"""Where a picture begins."""

import asyncio
import time
from collections.abc import Iterator

import pytest
import sqlalchemy as sa

from backend.coordination.base import Picture
from backend.coordination.lease import Leases
from backend.errors import NotFound
from backend.live import hub as hub_module
from backend.live.channel import Channel, Waiting
from backend.live.hub import Hub
from backend.live.record import PictureRecord, RecordNode, encode
from backend.log.base import LoggedBatch, RecordedFrame, Snapshot
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.log.schema import batches, incidents


@pytest.fixture
def store(engine: sa.Engine) -> IncidentStore:
    return IncidentStore(engine)


def record(t: float) -> bytes:
    return encode(PictureRecord(t=t, nodes=(RecordNode(node="ff1", role="responder", t=t),)))


def save(
    engine: sa.Engine, incident: str, rows: list[RecordedFrame], snapshot: Snapshot | None = None
) -> None:
    epoch = Leases(lambda: writing(engine), "north").acquire(incident)
    assert epoch is not None
    SqlDerivedWriter(engine).save(incident, epoch, rows, snapshot)


def grow(engine: sa.Engine, incident: str, seq: int) -> None:
    """Have the incident's log end at an entry."""
    with writing(engine) as connection:
        connection.execute(sa.update(incidents).where(incidents.c.id == incident).values(last_seq=seq))


def came(engine: sa.Engine, incident: str, received: dict[int, float]) -> None:
    """Have entries come into the incident's log at those moments (Unix s)."""
    with writing(engine) as connection:
        for seq, t in received.items():
            row = {"gateway": "g", "batch": str(seq), "received": t, "body": b"{}", "accepted": 0}
            connection.execute(sa.insert(batches).values(incident=incident, seq=seq, **row))
    grow(engine, incident, max(received))


def channel(engine: sa.Engine, incident: str, *pictures: Picture) -> Channel:
    """The channel of an incident in a web process that has just started and heard some pictures."""
    hub = Hub(IncidentStore(engine), SqlLogReader(engine))
    for picture in pictures:
        hub.take(picture)
    return asyncio.run(hub.channel(incident))


def test_a_web_process_that_starts_again_shows_the_newest_recorded_picture(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("before", "recorded").id
    rows = [RecordedFrame(second=s, seq=s, received=1.0, record=record(float(s))) for s in (10, 11)]
    save(engine, incident, rows)
    grow(engine, incident, 11)
    begun = channel(engine, incident)
    assert (begun.seq, begun.frame(0.0).t, [n.node for n in begun.frame(0.0).nodes]) == (11, 11.0, ["ff1"])


def test_the_workers_picture_wins_over_an_older_recorded_one_and_not_over_a_newer(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("both", "recorded").id
    save(engine, incident, [RecordedFrame(second=10, seq=10, received=1.0, record=record(10.0))])
    grow(engine, incident, 12)
    assert channel(engine, incident, Picture(incident, 12, record(12.0))).frame(0.0).t == 12.0
    assert channel(engine, incident, Picture(incident, 3, record(3.0))).frame(0.0).t == 10.0


def test_a_picture_that_the_worker_could_not_tell_of_is_found_in_the_rows(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("link down", "recorded").id

    async def go() -> list[int]:
        hub = Hub(store, SqlLogReader(engine))
        seqs = [(await hub.channel(incident)).seq]
        grow(engine, incident, 5)
        save(engine, incident, [RecordedFrame(second=10, seq=5, received=1.0, record=record(10.0))])
        return [*seqs, (await hub.channel(incident)).seq]

    assert asyncio.run(go()) == [0, 5]


def test_entries_without_readings_are_known_from_the_stored_state(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("silent", "recorded").id
    grow(engine, incident, 4)
    save(engine, incident, [], Snapshot(seq=4, state=b""))
    assert channel(engine, incident).seq == 4


class SlowReader(SqlLogReader):
    """Of a busy machine."""

    def batches(self, incident: str, after: int = 0, limit: int | None = None) -> Iterator[LoggedBatch]:
        time.sleep(0.1)
        return super().batches(incident, after, limit)


def test_who_waits_for_a_picture_gets_it_though_others_were_let_go_of_while_the_database_was_read(
    engine: sa.Engine, store: IncidentStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(hub_module, "BEAT_S", 0.005)
    incident = store.create("busy", "recorded").id
    came(engine, incident, {1: 1.0})

    async def go() -> bool:
        hub = Hub(store, SlowReader(engine))

        async def wait() -> bool:
            return await (await hub.channel(incident)).folded(1, 5.0)

        hub.start()
        try:
            waiting = asyncio.create_task(wait())
            await asyncio.sleep(0.5)
            hub.take(Picture(incident, 1, record(1.0)))
            return await waiting
        finally:
            await hub.stop()

    assert asyncio.run(go())


def test_what_waits_in_the_log_is_known_by_the_oldest_entry_that_is_not_in_the_picture(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("no worker", "recorded").id
    came(engine, incident, {1: 10.0, 2: 20.0, 3: 30.0})
    assert channel(engine, incident).waiting == Waiting(oldest=1, since_t=10.0, newest=3)
    assert channel(engine, incident, Picture(incident, 1, record(1.0))).waiting == Waiting(2, 20.0, 3)
    assert channel(engine, incident, Picture(incident, 3, record(3.0))).waiting is None


def test_nothing_waits_for_a_closed_incident(engine: sa.Engine, store: IncidentStore) -> None:
    incident = store.create("over", "recorded").id
    came(engine, incident, {1: 10.0})
    store.change(incident, {"state": "closed"})
    assert channel(engine, incident).waiting is None


def test_a_recorded_picture_of_another_version_is_passed_over(
    engine: sa.Engine, store: IncidentStore
) -> None:
    incident = store.create("old", "recorded").id
    save(engine, incident, [RecordedFrame(second=10, seq=10, received=1.0, record=b"\xfaold")])
    assert channel(engine, incident).frame(0.0).nodes == ()


def test_an_incident_whose_estimator_has_failed_is_named_until_it_goes_on(engine: sa.Engine) -> None:
    hub = Hub(IncidentStore(engine), SqlLogReader(engine))
    hub.take(Picture("i1", 1, record(1.0), failed=True))
    assert hub.failing == {"i1"}
    hub.take(Picture("i1", 2, record(2.0)))
    assert hub.failing == set()


def test_a_picture_of_another_version_is_not_taken(engine: sa.Engine, store: IncidentStore) -> None:
    incident = store.create("two versions", "recorded").id
    assert channel(engine, incident, Picture(incident, 9, b"\xfaother")).seq == 0


def test_there_is_no_picture_of_an_unknown_incident(engine: sa.Engine) -> None:
    with pytest.raises(NotFound):
        channel(engine, "nobody")
