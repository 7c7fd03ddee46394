"""What a follower shows while it cannot keep up, and in place of what was folded in a hurry."""

import asyncio
import time
from concurrent.futures import ThreadPoolExecutor
from threading import Semaphore

import pytest
import sqlalchemy as sa

from backend.live.record import decode
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking import follower
from backend.tracking.fold import IncidentFold
from backend.tracking.log_blocks import read_block
from estimator.estimate import NodeEstimate
from estimator.measurements import Status
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import Write, a_gateway_behind
from tests.backend.tracking.fragile import Fragile
from tests.backend.tracking.test_follower import Watch, status


def endless(t: float) -> Status:
    """Of what this tells the fragile tracker has always more to settle."""
    return Status(t=t, node="endless", battery=0.5)


def test_once_nothing_comes_any_more_what_was_folded_in_a_hurry_is_shown_without_one(
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    compute: ThreadPoolExecutor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(follower, "IDLE_S", 0.2)
    incident = store.create("behind", "recorded").id
    batches = a_gateway_behind(60)
    write(incident, batches)
    fold = IncidentFold("kirchhoff", TrackerSettings())
    while fold.seq < len(batches):
        for batch, readings in read_block(SqlLogReader(engine), incident, fold.seq):
            list(fold.fold(batch, readings))
    hurried = fold.picture()
    assert fold.settle()
    assert fold.picture() != hurried

    async def go() -> Watch:
        watch = Watch(engine, store, incident, compute)
        async with watch.following(), asyncio.timeout(30.0):
            while not watch.pictures or decode(watch.pictures[-1].record) != fold.picture():
                watch.published.clear()
                await watch.published.wait()
        return watch

    watch = asyncio.run(go())
    assert watch.pictures[-1].seq == len(batches)


@pytest.mark.usefixtures("fragile")
@pytest.mark.parametrize("more_comes", [True, False], ids=["more comes", "told to stop"])
def test_what_was_folded_in_a_hurry_keeps_nobody_waiting_while_it_is_folded_without_one(
    more_comes: bool,
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    compute: ThreadPoolExecutor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(follower, "IDLE_S", 0.0)
    incident = store.create("endless", "recorded").id
    write(incident, [[endless(1.0)]])

    async def go() -> None:
        watch = Watch(engine, store, incident, compute)
        async with watch.following():
            await watch.shown(1)
            await asyncio.sleep(0.1)
            if more_comes:
                write(incident, [[status(2.0)]])
                watch.follower.hear(2)
                await watch.shown(2)

    asyncio.run(go())


@pytest.mark.usefixtures("fragile")
def test_who_cannot_keep_up_shows_what_is_recorded_of_each_second_and_makes_no_other_picture(
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    compute: ThreadPoolExecutor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seconds, made, told = 12, list[float](), Fragile.estimates

    def slowly(tracker: Fragile) -> list[NodeEstimate]:
        made.append(tracker.newest_t)
        time.sleep(0.15)
        return told(tracker)

    monkeypatch.setattr(Fragile, "estimates", slowly)
    incident = store.create("slow", "recorded").id
    write(incident, [[status(float(second))] for second in range(1, seconds + 1)])

    async def go() -> Watch:
        watch = Watch(engine, store, incident, compute)
        async with watch.following():
            await watch.shown(seconds)
        return watch

    watch = asyncio.run(go())
    assert [picture.seq for picture in watch.pictures] == list(range(1, seconds + 1))
    assert made == [float(second) for second in range(1, seconds + 1)]
    rows = list(SqlLogReader(engine).frames(incident))
    assert [picture.record for picture in watch.pictures] == [row.record for row in rows]
    assert [picture.since_t for picture in watch.pictures] == [row.second for row in rows]


@pytest.mark.usefixtures("fragile")
def test_what_was_folded_in_a_hurry_is_folded_without_one_between_what_comes(
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    compute: ThreadPoolExecutor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settled, steps, settle = list[float](), Semaphore(0), Fragile.settle

    def noted(tracker: Fragile) -> bool:
        settled.append(time.monotonic())
        steps.release()
        time.sleep(0.01)
        return settle(tracker)

    monkeypatch.setattr(Fragile, "settle", noted)
    monkeypatch.setattr(follower, "IDLE_S", 60.0)
    incident = store.create("endless", "recorded").id
    write(incident, [[endless(1.0)]])

    async def go() -> float:
        watch = Watch(engine, store, incident, compute)
        async with watch.following():
            await watch.shown(1)
            await asyncio.to_thread(steps.acquire)
            write(incident, [[endless(2.0)]])
            heard_at = time.monotonic()
            watch.follower.hear(2)
            await watch.shown(2)
            until_then = len(settled)
            for _ in range(until_then):
                await asyncio.to_thread(steps.acquire)
        assert len(settled) > until_then
        return heard_at

    async def in_time() -> float:
        async with asyncio.timeout(30.0):
            return await go()

    heard_at = asyncio.run(in_time())
    assert not any(heard_at + 0.1 < at < heard_at + follower.AHEAD_AFTER_S for at in settled)
