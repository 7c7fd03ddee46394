"""The worker as a process of its own, on a real database."""

import asyncio
import math
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import pytest
import sqlalchemy as sa

from backend.live.record import decode
from backend.log.base import RecordedFrame
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.log.schema import leases
from backend.tracking import worker as worker_module
from backend.tracking.heads import Head, head_of
from backend.tracking.worker import Worker
from estimator import trackers
from estimator.measurements import AnyReading, Retire, Status
from estimator.trackers.base import Tracker, TrackerSettings
from tests.backend.tracking.conftest import Write, walk
from tests.backend.tracking.fragile import Fragile
from tests.running import eventually


class Process:
    """A worker process that can be killed."""

    def __init__(self, url: str, holder: str = "north", log: Path | None = None) -> None:
        command = [sys.executable, "-m", "backend.cli", "worker", "--database", url, "--holder", holder]
        self.errors = (log or Path(os.devnull)).open("a")
        self.process = subprocess.Popen(command, stdout=self.errors, stderr=self.errors)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()
        self.errors.close()

    def stop(self) -> int:
        self.process.terminate()
        code = self.process.wait(20)
        self.errors.close()
        return code


@contextmanager
def worker(url: str, holder: str = "north") -> Iterator[Process]:
    process = Process(url, holder)
    try:
        yield process
    finally:
        if process.process.poll() is None:
            process.stop()


def settled(engine: sa.Engine, incident: str, seq: int) -> bool:
    """Everything up to an entry is folded and stored."""
    snapshot = SqlLogReader(engine).snapshot(incident)
    return snapshot is not None and snapshot.seq >= seq


def rows(engine: sa.Engine, incident: str) -> list[RecordedFrame]:
    return list(SqlLogReader(engine).frames(incident))


def test_rows_are_the_same_however_often_the_worker_is_killed(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    batches = walk(40)
    disturbed = store.create("killed", "recorded").id
    chance = random.Random(3)

    def post() -> None:
        for batch in batches:
            write(disturbed, [batch])
            time.sleep(0.04)

    writing = threading.Thread(target=post)
    writing.start()
    kills = 0
    while writing.is_alive():
        process = Process(sqlite_url)
        time.sleep(chance.uniform(0.6, 1.6))
        process.kill()
        kills += 1
    writing.join()
    calm = store.create("calm", "recorded").id
    write(calm, batches)
    for incident in (disturbed, calm):
        store.change(incident, {"state": "closed"})
    with worker(sqlite_url):
        eventually(lambda: settled(engine, disturbed, len(batches)) and settled(engine, calm, len(batches)))
    assert kills >= 3
    assert len(rows(engine, calm)) >= 40
    assert rows(engine, disturbed) == rows(engine, calm)


def test_a_worker_that_is_told_to_stop_leaves_everything_stored_and_free(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident = store.create("stopped", "recorded").id
    write(incident, walk(10))
    with worker(sqlite_url) as process:
        eventually(lambda: rows(engine, incident))
        assert process.stop() == 0
    assert settled(engine, incident, 21)
    with engine.connect() as connection:
        assert connection.execute(sa.select(leases.c.expires)).scalars().all() == [0.0]


def test_a_closed_incident_is_folded_to_its_end(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident = store.create("closed before", "recorded").id
    write(incident, walk(10))
    store.change(incident, {"state": "closed"})
    with worker(sqlite_url):
        eventually(lambda: settled(engine, incident, 21))
    last = rows(engine, incident)[-1]
    assert (last.second, last.seq) == (1011, 21)
    newest_t = max(reading.t for batch in walk(10) for reading in batch)
    assert decode(last.record).t == newest_t


def test_a_backlog_does_not_hold_back_who_is_live(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    backlog = store.create("import", "recorded").id
    live = store.create("live", "recorded").id
    write(backlog, walk(600))
    write(live, walk(5))
    with worker(sqlite_url):
        eventually(lambda: settled(engine, live, 11))
        assert not settled(engine, backlog, 1201), "the backlog is too short for this test"


def test_a_step_that_takes_long_holds_no_other_incident_back(
    sqlite_url: str,
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun, enough = threading.Event(), threading.Event()

    class Crowded(Fragile):
        def fold(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
            if any(isinstance(reading, Status) and reading.node == "crowd" for reading in readings):
                begun.set()
                enough.wait(30.0)
            super().fold(readings, known_t)

    monkeypatch.setattr(trackers, "create", lambda _, settings: Crowded(settings))
    monkeypatch.setattr(worker_module, "warm_up", lambda: None)
    crowded = store.create("crowded", "recorded").id
    write(crowded, [[Status(t=1.0, node="crowd", battery=0.5)]])

    def watch() -> None:
        try:
            assert begun.wait(20.0)
            other = store.create("other", "recorded").id
            write(other, [[Status(t=1.0, node="ff1", battery=0.5)]])
            eventually(lambda: settled(engine, other, 1))
            assert not settled(engine, crowded, 1)
        finally:
            enough.set()
            signal.raise_signal(signal.SIGTERM)

    async def go() -> None:
        watching = asyncio.create_task(asyncio.to_thread(watch))
        await Worker(sqlite_url, None, "", "north", shown_hz=10.0).run()
        await watching

    asyncio.run(go())


def test_new_settings_are_used_for_everything_and_what_was_shown_stays(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident = store.create("origin later", "recorded").id
    batches = walk(20)
    write(incident, batches[:21])
    with worker(sqlite_url):
        eventually(lambda: settled(engine, incident, 21))
        before = rows(engine, incident)
        store.change(incident, {"settings": {"lag_s": 0.0}})
        write(incident, batches[21:])
        eventually(lambda: settled(engine, incident, 41))
    after = rows(engine, incident)
    assert after[: len(before) - 1] == before[:-1]
    assert after[-1].second > before[-1].second


def test_another_tracker_folds_what_the_first_broke_at(
    sqlite_url: str,
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    create = trackers.create
    broke = threading.Event()

    class Breaking(Fragile):
        def fold(self, readings: Sequence[AnyReading], known_t: float = math.inf) -> None:
            broke.set()
            super().fold(readings, known_t)

    def fragile_or_whole(name: str, settings: TrackerSettings) -> Tracker:
        return Breaking(settings) if name == "kirchhoff" else create(name, settings)

    monkeypatch.setattr(trackers, "create", fragile_or_whole)
    monkeypatch.setattr(worker_module, "warm_up", lambda: None)
    incident = store.create("broken", "recorded").id
    write(incident, [[Status(t=1.0, node="ff1", battery=0.5), Retire(t=2.0, node="ff1")]])

    def switch() -> None:
        broke.wait(20.0)
        head = head_of(store.change(incident, {"settings": {"tracker": "paper-a"}}))
        try:
            eventually(lambda: made_with(engine, incident) == head.made_with.encoded())
        finally:
            signal.raise_signal(signal.SIGTERM)

    async def go() -> None:
        switching = asyncio.create_task(asyncio.to_thread(switch))
        await Worker(sqlite_url, None, "", "north", shown_hz=10.0).run()
        await switching

    asyncio.run(go())


def test_a_worker_that_waits_for_a_database_for_ever_does_not_say_that_it_goes_on(
    sqlite_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    said, twice, let_go = [0], asyncio.Event(), threading.Event()
    answers = iter([True, True, False])

    def asked(*_: object) -> list[Head]:
        if not next(answers, False):
            let_go.wait(20.0)
        return []

    def look() -> None:
        said[0] += 1
        if said[0] == 2:
            twice.set()

    async def go() -> int:
        worker = Worker(sqlite_url, None, "", "north", 10.0, look)
        running = asyncio.create_task(worker.run())
        await twice.wait()
        await asyncio.sleep(4 * worker_module.POLL_S)
        while_it_hung = said[0]
        let_go.set()
        signal.raise_signal(signal.SIGTERM)
        await running
        return while_it_hung

    monkeypatch.setattr(worker_module, "heads", asked)
    monkeypatch.setattr(worker_module, "warm_up", lambda: None)
    assert asyncio.run(go()) == 2


def made_with(engine: sa.Engine, incident: str) -> str | None:
    snapshot = SqlLogReader(engine).snapshot(incident)
    return None if snapshot is None else snapshot.made_with


def test_another_worker_takes_over_when_the_first_falls_silent(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident = store.create("two workers", "recorded").id
    batches = walk(20)
    write(incident, batches[:11])
    first = Process(sqlite_url, "north")
    try:
        eventually(lambda: settled(engine, incident, 11))
        os.kill(first.process.pid, signal.SIGSTOP)
        with worker(sqlite_url, "south"):
            write(incident, batches[11:])
            eventually(lambda: settled(engine, incident, 41), within_s=30.0)
            taken = rows(engine, incident)
            os.kill(first.process.pid, signal.SIGCONT)
            time.sleep(2.0)
            assert rows(engine, incident) == taken
            assert first.process.poll() is None
    finally:
        os.kill(first.process.pid, signal.SIGCONT)
        first.stop()
