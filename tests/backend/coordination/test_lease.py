"""One worker follows an incident, and only its writes count."""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor

import pytest
import sqlalchemy as sa

from backend.coordination.instance import Instance
from backend.coordination.lease import Leases
from backend.log.base import RecordedFrame, Snapshot, StaleEpoch
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine, writing
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from backend.log.schema import leases as table

ROW = RecordedFrame(second=1, seq=1, received=1.0, record=b"row")


@pytest.fixture
def engine(database_url: str) -> Iterator[sa.Engine]:
    prepare(database_url)
    engine = make_engine(database_url)
    yield engine
    engine.dispose()


@pytest.fixture
def leases(engine: sa.Engine) -> Callable[..., Leases]:
    return lambda holder, lease_s=30.0: Leases(lambda: writing(engine), holder, lease_s)


def test_only_one_worker_gets_an_incident(leases: Callable[..., Leases]) -> None:
    assert leases("north").acquire("i1") == 1
    assert leases("south").acquire("i1") is None
    assert leases("south").acquire("i2") == 1


def test_a_worker_that_starts_again_under_its_name_takes_its_incident_at_once(
    leases: Callable[..., Leases],
) -> None:
    assert [leases("north").acquire("i1") for _ in range(3)] == [1, 2, 3]


def test_of_two_under_one_name_the_one_that_lives_keeps_its_incident(engine: sa.Engine) -> None:
    here = Instance.this()
    parent = Leases(lambda: writing(engine), "north", 30.0, Instance(here.host, os.getppid(), "p"))
    own = Leases(lambda: writing(engine), "north", 30.0)
    assert parent.acquire("i1") == 1
    assert own.acquire("i1") is None
    parent.release("i1", 1)
    assert own.acquire("i1") == 2
    assert parent.acquire("i1") is None


def test_what_ended_under_the_name_gives_way_at_once(engine: sa.Engine) -> None:
    here = Instance.this()
    ended = subprocess.Popen([sys.executable, "-c", ""])
    ended.wait()
    # A container that starts again gives its processes the numbers that they had.
    for epoch, before in enumerate((Instance(here.host, ended.pid, "x"), Instance(here.host, here.pid, "x"))):
        assert Leases(lambda: writing(engine), "north", 30.0, before).acquire("i1") == 2 * epoch + 1
        assert Leases(lambda: writing(engine), "north", 30.0).acquire("i1") == 2 * epoch + 2
        Leases(lambda: writing(engine), "north", 30.0).release("i1", 2 * epoch + 2)


def test_of_another_machine_only_silence_tells(engine: sa.Engine) -> None:
    elsewhere = Leases(lambda: writing(engine), "north", 30.0, Instance("elsewhere", 1, "x"))
    assert elsewhere.acquire("i1") == 1
    assert Leases(lambda: writing(engine), "north").acquire("i1") is None


def test_a_lease_that_an_older_version_took_is_its_names(engine: sa.Engine) -> None:
    with writing(engine) as connection:
        connection.execute(
            sa.insert(table).values(incident="i1", holder="north", epoch=4, expires=time.time() + 30.0)
        )
    assert Leases(lambda: writing(engine), "south").acquire("i1") is None
    assert Leases(lambda: writing(engine), "north").acquire("i1") == 5


def test_a_silent_workers_incident_is_taken_by_another(leases: Callable[..., Leases]) -> None:
    assert leases("north", 0.05).acquire("i1") == 1
    time.sleep(0.1)
    assert leases("south").acquire("i1") == 2


def test_a_lease_that_is_renewed_is_kept(leases: Callable[..., Leases]) -> None:
    north = leases("north", 0.5)
    assert north.acquire("i1") == 1
    for _ in range(4):
        time.sleep(0.2)
        assert north.renew([("i1", 1)]) == set()
        assert leases("south").acquire("i1") is None


def test_who_has_lost_its_lease_is_told_when_it_renews(leases: Callable[..., Leases]) -> None:
    north = leases("north", 0.01)
    north.acquire("i1")
    north.acquire("i2")
    time.sleep(0.05)
    leases("south").acquire("i1")
    assert north.renew([("i1", 1), ("i2", 1)]) == {"i1"}


def test_a_lease_given_back_is_free_and_its_epochs_count_on(leases: Callable[..., Leases]) -> None:
    north = leases("north")
    north.acquire("i1")
    north.release("i1", 1)
    assert leases("south").acquire("i1") == 2


def test_giving_back_what_another_has_taken_changes_nothing(leases: Callable[..., Leases]) -> None:
    leases("north", 0.01).acquire("i1")
    time.sleep(0.05)
    leases("south").acquire("i1")
    leases("north").release("i1", 1)
    assert leases("north").acquire("i1") is None


def test_a_write_under_an_old_epoch_is_refused_and_changes_nothing(
    engine: sa.Engine, leases: Callable[..., Leases]
) -> None:
    writer, reader = SqlDerivedWriter(engine), SqlLogReader(engine)
    old = leases("north", 0.01).acquire("i1")
    assert old == 1
    writer.save("i1", old, [ROW], Snapshot(seq=1, state=b"old"))
    time.sleep(0.05)
    new = leases("south").acquire("i1")
    with pytest.raises(StaleEpoch):
        writer.save(
            "i1",
            old,
            [RecordedFrame(second=2, seq=2, received=2.0, record=b"x")],
            Snapshot(seq=2, state=b"x"),
        )
    assert [row.second for row in reader.frames("i1")] == [1]
    snapshot = reader.snapshot("i1")
    assert snapshot is not None
    assert snapshot.state == b"old"
    assert new == 2
    writer.save("i1", new, [], Snapshot(seq=2, state=b"new"))


def test_of_many_that_try_at_once_one_gets_it(leases: Callable[..., Leases]) -> None:
    workers = [leases(f"worker-{number}") for number in range(8)]
    with ThreadPoolExecutor(8) as pool:
        for incident in ("i1", "i2", "i3"):
            epochs = list(pool.map(lambda worker, name=incident: worker.acquire(name), workers))
            assert sorted(epoch for epoch in epochs if epoch is not None) == [1]
