"""An incident that the estimator cannot fold stands still and says so; the others go on."""

import asyncio
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager

import pytest
import sqlalchemy as sa

from backend.coordination.base import Answer, Picture, Query
from backend.coordination.lease import Leases
from backend.live.record import decode
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking.follower import Follower
from backend.tracking.heads import head_of, heads
from estimator.measurements import AnyReading, Retire, Status
from tests.backend.tracking.conftest import Write, walk


class Watch:
    """A follower of one incident, and what it publishes."""

    def __init__(
        self, engine: sa.Engine, store: IncidentStore, incident: str, compute: ThreadPoolExecutor
    ) -> None:
        self.pictures: list[Picture] = []
        self.published = asyncio.Event()
        self.follower = Follower(
            head_of(store.get(incident)),
            SqlLogReader(engine),
            SqlDerivedWriter(engine),
            Leases(lambda: writing(engine), "north"),
            compute,
            self.publish,
            shown_hz=10.0,
        )

    def publish(self, message: Picture | Answer) -> None:
        assert isinstance(message, Picture)
        self.pictures.append(message)
        self.published.set()

    @asynccontextmanager
    async def following(self) -> AsyncIterator[None]:
        """Follow meanwhile, and end in order."""
        following = asyncio.create_task(self.follower.run())
        yield
        self.follower.stop()
        async with asyncio.timeout(30.0):
            await following

    async def shown(self, seq: int) -> None:
        """Wait until an entry is in a picture."""
        async with asyncio.timeout(30.0):
            while not self.pictures or self.pictures[-1].seq < seq:
                self.published.clear()
                await self.published.wait()


def follow(
    engine: sa.Engine, store: IncidentStore, incident: str, compute: ThreadPoolExecutor, seq: int
) -> None:
    """Follow an incident until an entry is shown, and end in order."""

    async def go() -> None:
        watch = Watch(engine, store, incident, compute)
        async with watch.following():
            await watch.shown(seq)

    asyncio.run(go())


def status(t: float) -> Status:
    return Status(t=t, node="ff1", battery=0.5)


@pytest.mark.usefixtures("fragile")
@pytest.mark.parametrize("poison", [Retire(t=3.5, node="ff1"), Status(t=3.5, node="late-to-break")])
def test_a_picture_that_cannot_be_folded_on_stands_still_and_says_so(
    poison: AnyReading, engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    incident = store.create("poisoned", "recorded").id
    write(incident, [[status(1.0)], [status(2.5)]])

    async def go() -> Watch:
        watch = Watch(engine, store, incident, compute)
        following = asyncio.create_task(watch.follower.run())
        await watch.shown(2)
        write(incident, [[status(3.0), poison]])
        watch.follower.hear(3)
        await following
        return watch

    watch = asyncio.run(go())
    assert watch.follower.failed
    last = watch.pictures[-1]
    assert (last.seq, last.failed) == (2, True)
    assert not watch.pictures[-2].failed
    record = decode(last.record)
    assert [notice.code for notice in record.notices] == ["estimator_failed"]
    assert "entry 3" in record.notices[0].text
    assert [(node.node, node.t) for node in record.nodes] == [("ff1", 2.5)]
    assert [row.second for row in SqlLogReader(engine).frames(incident)][:1] == [1]


@pytest.mark.usefixtures("fragile")
def test_questions_are_answered_between_two_pieces_of_work(
    engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    incident = store.create("asked", "recorded").id
    write(incident, [[status(1.0)]])

    async def go() -> list[Answer]:
        watch = Watch(engine, store, incident, compute)
        early = await watch.follower.ask(Query(1, incident, "ff1", "ff2"))
        following = asyncio.create_task(watch.follower.run())
        await watch.shown(1)
        pairs = [("ff1", "ff2"), ("lost", "ff2"), ("ff1", "nobody")]
        answers = [await watch.follower.ask(Query(2 + i, incident, a, b)) for i, (a, b) in enumerate(pairs)]
        watch.follower.stop()
        await following
        return [early, *answers]

    early, found, undecided, unknown = asyncio.run(go())
    assert (early.found, early.followed) == (False, False)
    assert (found.found, found.delta_m, found.number) == (True, (1.0, 2.0, 3.0), 2)
    assert (undecided.found, undecided.unknown, undecided.followed) == (False, False, True)
    assert (unknown.found, unknown.unknown) == (False, True)


@pytest.mark.usefixtures("fragile")
def test_pictures_are_published_ten_times_a_second_at_most_and_the_newest_always(
    engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    incident = store.create("busy", "recorded").id
    write(incident, [[status(1.0)]])

    async def go() -> tuple[list[Picture], float]:
        watch = Watch(engine, store, incident, compute)
        following = asyncio.create_task(watch.follower.run())
        began = asyncio.get_running_loop().time()
        for seq in range(2, 82):
            write(incident, [[status(float(seq))]])
            watch.follower.hear(seq)
            await asyncio.sleep(0.01)
        await watch.shown(81)
        took_s = asyncio.get_running_loop().time() - began
        watch.follower.stop()
        await following
        return watch.pictures, took_s

    pictures, took_s = asyncio.run(go())
    assert len(pictures) <= 10.0 * took_s + 2
    assert pictures[-1].seq == 81
    assert [picture.seq for picture in pictures] == sorted(picture.seq for picture in pictures)


def test_the_last_picture_of_a_closed_incident_is_published(
    engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    incident = store.create("closed in a hurry", "recorded").id
    write(incident, [[status(1.0)]])

    async def go() -> list[Picture]:
        watch = Watch(engine, store, incident, compute)
        following = asyncio.create_task(watch.follower.run())
        await watch.shown(1)
        write(incident, [[status(2.0)]])
        store.change(incident, {"state": "closed"})
        watch.follower.hear_of(head_of(store.get(incident)))
        await following
        return watch.pictures

    assert [picture.seq for picture in asyncio.run(go())] == [1, 2]


def test_incidents_that_are_folded_to_their_end_are_left_alone(
    engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    quiet, busy = store.create("quiet", "recorded").id, store.create("busy", "recorded").id
    store.create("empty", "recorded")
    write(quiet, [[status(1.0)]])
    write(busy, [[status(1.0)]])

    async def fold(incident: str) -> None:
        watch = Watch(engine, store, incident, compute)
        following = asyncio.create_task(watch.follower.run())
        await watch.shown(1)
        watch.follower.stop()
        await following

    assert {head.incident for head in heads(engine, [])} == {quiet, busy}
    asyncio.run(fold(quiet))
    assert {head.incident for head in heads(engine, [])} == {busy}
    assert {head.incident for head in heads(engine, [quiet])} == {quiet, busy}
    write(quiet, [[status(2.0)]])
    assert {head.incident for head in heads(engine, [])} == {quiet, busy}


def test_another_tracker_leaves_what_was_shown_and_goes_on_from_there(
    engine: sa.Engine, store: IncidentStore, write: Write, compute: ThreadPoolExecutor
) -> None:
    incident = store.create("switched", "recorded").id
    batches = walk(10)
    write(incident, batches)
    reader = SqlLogReader(engine)

    follow(engine, store, incident, compute, len(batches))
    before = list(reader.frames(incident))
    head = head_of(store.change(incident, {"settings": {"tracker": "paper-a"}}))
    follow(engine, store, incident, compute, len(batches))
    snapshot = reader.snapshot(incident)
    assert snapshot is not None
    assert snapshot.made_with == head.made_with.encoded()
    after = list(reader.frames(incident))
    assert after[: len(before) - 1] == before[:-1]
    assert after[-1] != before[-1]
