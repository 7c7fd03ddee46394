"""A log that is folded anew while somebody follows it."""

import asyncio
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

import pytest
import sqlalchemy as sa

from backend.log.base import LoggedBatch, RecordedFrame
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking import course as course_module
from backend.tracking.course import Course
from backend.tracking.fold import IncidentFold
from estimator.measurements import AnyReading
from tests.backend.tracking.conftest import Write, through, walk
from tests.backend.tracking.test_follower import Watch, follow


def test_who_is_told_to_stop_while_the_log_is_folded_anew_leaves_what_was_to_be_done(
    engine: sa.Engine,
    store: IncidentStore,
    write: Write,
    compute: ThreadPoolExecutor,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    incident, batches = store.create("stopped", "live", created=999.0).id, walk(60)
    write(incident, batches[:-1])
    store.change(incident, {"settings": {"lag_s": 5.0}, "since": 1200.0})
    write(incident, batches[-1:])
    reader = SqlLogReader(engine)

    async def stopped_on_the_way() -> None:
        watch, anew = Watch(engine, store, incident, compute), asyncio.Event()
        loop = asyncio.get_running_loop()
        folds: list[IncidentFold] = []

        class Counted(IncidentFold):
            def fold(
                self, batch: LoggedBatch, readings: Sequence[AnyReading]
            ) -> Iterator[RecordedFrame | None]:
                if self not in folds:
                    folds.append(self)
                if len(folds) == 2 and batch.seq == 2:
                    loop.call_soon_threadsafe(anew.set)
                    time.sleep(0.2)
                yield from super().fold(batch, readings)

        with monkeypatch.context() as patched:
            patched.setattr(course_module, "IncidentFold", Counted)
            following = asyncio.create_task(watch.follower.run())
            await anew.wait()
            watch.follower.stop()
            async with asyncio.timeout(2.0):
                await following
        assert folds[1].seq < len(batches) - 1

    asyncio.run(stopped_on_the_way())
    assert reader.snapshot(incident) is None
    follow(engine, store, incident, compute, len(batches))
    course = Course.begin(reader, incident, live=True)
    made = list(through(course))
    last = course.fold.last_row()
    assert last is not None
    assert list(reader.frames(incident)) == [*made, last]
