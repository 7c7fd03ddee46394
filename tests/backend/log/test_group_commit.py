import asyncio
import contextlib
import os
import signal
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa
from prometheus_client import REGISTRY

from backend.errors import Conflict, NotFound, TooBusy
from backend.log.base import Appended, LogUnwritable, NewBatch
from backend.log.engine import make_engine
from backend.log.group_commit import GroupCommit
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from tests.backend.log.batches import MakeBatch

QUEUE_BYTES = 64 * 1024 * 1024


@asynccontextmanager
async def writing(url: str, queue_bytes: int = QUEUE_BYTES) -> AsyncIterator[GroupCommit]:
    writer = GroupCommit(url, queue_bytes)
    await writer.start()
    try:
        yield writer
    finally:
        await writer.close()


def groups() -> float:
    return REGISTRY.get_sample_value("firethread_log_group_batches_count") or 0.0


def writer_pids() -> list[int]:
    """The writer processes that are children of this one."""
    children = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read_text().split()
    found = []
    for pid in children:
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):  # it has ended meanwhile
            if b"backend.log.writer_process" in Path(f"/proc/{pid}/cmdline").read_bytes():
                found.append(int(pid))
    return found


async def until_taken(post: Callable[[], Awaitable[Appended]]) -> Appended:
    """Send again until it is acknowledged, as a gateway does."""
    async with asyncio.timeout(20):
        while True:
            try:
                return await post()
            except LogUnwritable:
                await asyncio.sleep(0.05)


def test_batches_that_wait_together_are_written_together(url: str, batch: MakeBatch) -> None:
    async def post() -> list[Appended]:
        async with writing(url) as writer:
            await writer.append(batch("first"))
            before = groups()
            done = await asyncio.gather(*(writer.append(batch(str(i))) for i in range(200)))
            assert groups() - before <= 20
            return done

    assert sorted(one.seq for one in asyncio.run(post())) == list(range(2, 202))


def test_a_batch_posted_many_times_at_once_is_in_the_log_once(
    url: str, engine: sa.Engine, batch: MakeBatch
) -> None:
    async def post() -> list[Appended]:
        async with writing(url) as writer:
            return await asyncio.gather(*(writer.append(batch("x")) for _ in range(50)))

    done = asyncio.run(post())
    assert {one.seq for one in done} == {1}
    assert sum(not one.duplicate for one in done) == 1
    assert len(list(SqlLogReader(engine).batches(batch.incident))) == 1


def test_each_batch_gets_its_own_answer(url: str, store: IncidentStore, batch: MakeBatch) -> None:
    closed = store.create("closed", "live").id
    store.change(closed, {"state": "closed"})

    async def post() -> list[Appended | BaseException]:
        async with writing(url) as writer:
            several = [batch("1"), batch("1", incident="nowhere"), batch("1", incident=closed), batch("2")]
            return await asyncio.gather(*(writer.append(one) for one in several), return_exceptions=True)

    first, unknown, refused, last = asyncio.run(post())
    assert isinstance(first, Appended)
    assert isinstance(unknown, NotFound)
    assert isinstance(refused, Conflict)
    assert isinstance(last, Appended)


def test_too_much_waiting_is_refused_and_room_comes_back(url: str, batch: MakeBatch) -> None:
    async def post() -> None:
        async with writing(url, queue_bytes=5_000) as writer:
            large = [batch(str(i), body=b"x" * 2_000) for i in range(4)]
            done = await asyncio.gather(*(writer.append(one) for one in large), return_exceptions=True)
            refused = [one for one in done if isinstance(one, TooBusy)]
            assert len(refused) == 3
            assert all(one.retry_after_s for one in refused)
            assert (await writer.append(large[3])).seq == 2

    asyncio.run(post())


def test_a_batch_larger_than_the_queue_is_taken_when_nothing_waits(url: str, batch: MakeBatch) -> None:
    async def post() -> Appended:
        async with writing(url, queue_bytes=10) as writer:
            return await writer.append(batch("x", body=b"x" * 500_000))

    assert asyncio.run(post()).seq == 1


def test_a_request_that_is_cancelled_leaves_the_others_their_answers(url: str, batch: MakeBatch) -> None:
    async def post() -> list[Appended]:
        async with writing(url) as writer:
            tasks = [asyncio.create_task(writer.append(batch(str(i)))) for i in range(10)]
            await asyncio.sleep(0)
            tasks[3].cancel()
            return await asyncio.gather(*tasks[:3], *tasks[4:])

    assert len(asyncio.run(post())) == 9


def test_closing_writes_what_waits_and_then_takes_nothing(
    url: str, engine: sa.Engine, batch: MakeBatch
) -> None:
    async def post() -> list[Appended]:
        writer = GroupCommit(url, QUEUE_BYTES)
        await writer.start()
        tasks = [asyncio.create_task(writer.append(batch(str(i)))) for i in range(30)]
        await asyncio.sleep(0)
        await writer.close()
        with pytest.raises(LogUnwritable):
            await writer.append(batch("late"))
        return await asyncio.gather(*tasks)

    done = asyncio.run(post())
    assert [one.seq for one in SqlLogReader(engine).batches(batch.incident)] == [one.seq for one in done]
    assert writer_pids() == []


def test_a_killed_writer_is_replaced_and_loses_nothing_acknowledged(
    url: str, engine: sa.Engine, batch: MakeBatch
) -> None:
    async def post() -> set[int]:
        async with writing(url) as writer:
            acknowledged = set()

            async def send(one: NewBatch) -> None:
                acknowledged.add((await until_taken(lambda: writer.append(one))).seq)

            for round_ in range(3):
                tasks = [asyncio.create_task(send(batch(f"{round_}-{i}"))) for i in range(60)]
                await asyncio.sleep(0.002 * round_)
                for pid in writer_pids():
                    os.kill(pid, signal.SIGKILL)
                await asyncio.gather(*tasks)
            return acknowledged

    acknowledged = asyncio.run(post())
    logged = [one.seq for one in SqlLogReader(engine).batches(batch.incident)]
    assert logged == list(range(1, 181))
    assert acknowledged == set(logged)


def test_a_writer_that_hangs_does_not_keep_the_server_from_stopping(
    url: str, batch: MakeBatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.log.group_commit.STOP_S", 0.3)

    async def post() -> None:
        writer = GroupCommit(url, QUEUE_BYTES)
        await writer.start()
        await writer.append(batch("x"))
        for pid in writer_pids():
            os.kill(pid, signal.SIGSTOP)
        waiting = asyncio.create_task(writer.append(batch("y")))
        await asyncio.sleep(0.05)
        await writer.close()
        with pytest.raises(LogUnwritable):
            await waiting

    asyncio.run(post())
    assert writer_pids() == []


def test_what_a_hanging_writer_holds_is_refused_in_time_and_sent_again_it_gets_its_first_answer(
    url: str, engine: sa.Engine, batch: MakeBatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.log.group_commit.LOOK_EVERY_S", 0.05)

    async def post() -> list[Appended]:
        async with writing(url) as writer:
            await writer.append(batch("before"))
            monkeypatch.setattr("backend.log.group_commit.HANGS_AFTER_S", 0.2)
            (pid,) = writer_pids()
            os.kill(pid, signal.SIGSTOP)
            async with asyncio.timeout(5):
                waited = [writer.append(batch(name)) for name in "ab"]
                refused = await asyncio.gather(*waited, return_exceptions=True)
            told = writer.refusal
            assert told is not None
            for problem in (*refused, told):
                assert isinstance(problem, LogUnwritable)
                assert problem.retry_after_s
                assert "under the same name" in problem.detail
            with pytest.raises(LogUnwritable):  # at once: nothing more is piled up
                await asyncio.wait_for(writer.append(batch("c")), 0.04)
            os.kill(pid, signal.SIGCONT)
            again = [await until_taken(lambda name=name: writer.append(batch(name))) for name in "abc"]  # type: ignore[misc]
            assert writer.refusal is None
            assert writer_pids() == [pid]
            return again

    again = asyncio.run(post())
    assert [(one.seq, one.duplicate) for one in again] == [(2, True), (3, True), (4, False)]
    assert [one.batch for one in SqlLogReader(engine).batches(batch.incident)] == ["before", "a", "b", "c"]


def test_a_writer_that_hangs_for_long_is_killed_and_replaced(
    url: str, engine: sa.Engine, batch: MakeBatch, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("backend.log.group_commit.LOOK_EVERY_S", 0.05)
    monkeypatch.setattr("backend.log.group_commit.HANGS_AFTER_S", 0.1)
    # The one that takes its place needs a second to begin.
    monkeypatch.setattr("backend.log.group_commit.KILLED_AFTER_S", 5.0)

    async def post() -> list[int]:
        async with writing(url) as writer:
            await until_taken(lambda: writer.append(batch("before")))
            (hangs,) = writer_pids()
            os.kill(hangs, signal.SIGSTOP)
            seqs = [(await until_taken(lambda name=name: writer.append(batch(name)))).seq for name in "ab"]  # type: ignore[misc]
            assert writer_pids() != [hangs]
            return seqs

    assert asyncio.run(post()) == [2, 3]
    assert [one.batch for one in SqlLogReader(engine).batches(batch.incident)] == ["before", "a", "b"]


def test_a_database_that_went_away_and_came_back_needs_no_restart(postgres_url: str) -> None:
    prepare(postgres_url)
    engine = make_engine(postgres_url)
    batch = MakeBatch(IncidentStore(engine).create("fire", "live").id)
    end_all = sa.text(
        "SELECT pg_terminate_backend(pid) FROM pg_stat_activity "
        "WHERE datname = current_database() AND pid <> pg_backend_pid()"
    )

    async def post() -> list[int]:
        seqs = []
        async with writing(postgres_url) as writer:
            for i in range(5):
                seqs.append((await until_taken(lambda i=i: writer.append(batch(str(i))))).seq)  # type: ignore[misc]
                with engine.connect() as connection:
                    connection.execute(end_all)
        return seqs

    assert asyncio.run(post()) == [1, 2, 3, 4, 5]
    engine.dispose()
