"""What a follower shows in place of what was folded in a hurry, once nothing comes any more."""

import asyncio
from concurrent.futures import ThreadPoolExecutor

import pytest
import sqlalchemy as sa

from backend.live.record import decode
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking import follower
from backend.tracking.fold import IncidentFold
from backend.tracking.log_blocks import read_block
from estimator.measurements import Status
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import Write, a_gateway_behind
from tests.backend.tracking.test_follower import Watch, status


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
        following = asyncio.create_task(watch.follower.run())
        async with asyncio.timeout(30.0):
            while not watch.pictures or decode(watch.pictures[-1].record) != fold.picture():
                watch.published.clear()
                await watch.published.wait()
        watch.follower.stop()
        await following
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
    write(incident, [[Status(t=1.0, node="endless", battery=0.5)]])

    async def go() -> None:
        watch = Watch(engine, store, incident, compute)
        following = asyncio.create_task(watch.follower.run())
        await watch.shown(1)
        await asyncio.sleep(0.1)
        if more_comes:
            write(incident, [[status(2.0)]])
            watch.follower.hear(2)
            await watch.shown(2)
        watch.follower.stop()
        async with asyncio.timeout(30.0):
            await following

    asyncio.run(go())
