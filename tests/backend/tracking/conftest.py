"""A walk of two responders for tests of the worker."""

import math
import random
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import msgspec
import pytest
import sqlalchemy as sa

from backend.log.append import append_group
from backend.log.base import Appended, LoggedBatch, NewBatch, RecordedFrame
from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.tracking.course import Course
from backend.tracking.fold import IncidentFold
from estimator import trackers
from estimator.measurements import Alarm, AnyReading, Displacement, Drop, Node, Range, Rssi, Status
from estimator.trackers.base import Tracker, TrackerSettings
from tests.backend.tracking.fragile import Fragile

Write = Callable[[str, Sequence[Sequence[AnyReading]]], None]


def walk(seconds: int, start_t: float = 1000.0, seed: int = 1) -> list[list[AnyReading]]:
    """Batches of a walk, some of them late: two responders who drop breadcrumbs and range to them."""
    chance = random.Random(seed)
    batches: list[list[AnyReading]] = [
        [
            Node(t=start_t, node="base", role="base", position_m=(0.0, 0.0, 0.0)),
            Node(t=start_t, node="ff1", role="responder", position_m=(1.0, 0.0, 0.0), sigma_m=0.2, crew="E7"),
            Node(t=start_t, node="ff2", role="responder", position_m=(0.0, 1.0, 0.0), sigma_m=0.2, crew="E7"),
        ]
    ]
    for step in range(2 * seconds):
        t = start_t + 0.5 * (step + 1) + 0.1
        angle = 0.05 * step
        batch: list[AnyReading] = []
        for name in ("ff1", "ff2"):
            delta = (0.5 * math.cos(angle) + chance.gauss(0, 0.02), 0.5 * math.sin(angle), 0.0)
            batch.append(Displacement(t=t, node=name, delta_m=delta))
            batch.append(
                Range(t=t + 0.05, a=name, b="base", range_m=0.5 * step + chance.random(), technology="uwb")
            )
        if step % 10 == 4:
            batch.append(Drop(t=t, node=f"bc{step}", by="ff1"))
        if step > 6:
            batch.append(Rssi(t=t, a="ff2", b="bc4", dbm=-60.0 + chance.gauss(0, 4)))
        if step % 7 == 0:
            batch.append(Status(t=t, node="ff2", air_bar=300.0 - step, battery=0.5))
        if step == 8:
            batch.append(Alarm(t=t, node="ff2", alarm="mayday", state="raised", text="stuck"))
        batches.append(batch)
    # An unreliable link: some batches come after their successors.
    for i in range(5, len(batches) - 1, 9):
        batches[i], batches[i + 1] = batches[i + 1], batches[i]
    return batches


def a_gateway_behind(seconds: int, behind_s: int = 40) -> list[list[AnyReading]]:
    """ff1 posts each second; ff2's gateway does so as often, always as far behind."""
    batches: list[list[AnyReading]] = [
        [Node(t=1000.0, node="base", role="base")],
        [Node(t=1000.0, node=name, role="responder", position_m=(0.0, 0.0, 0.0)) for name in ("ff1", "ff2")],
    ]
    for second in range(1, seconds + 1):
        for name, t in (("ff1", 1000.0 + second), ("ff2", 1000.0 + second - behind_s)):
            if t > 1000.0:
                step = Displacement(t=t, from_t=t - 1.0, node=name, delta_m=(1.0, 0.0, 0.0))
                heard = Range(t=t, a=name, b="base", range_m=t - 1000.0, technology="uwb")
                batches.append([step, heard])
    return batches


def entry(seq: int) -> LoggedBatch:
    return LoggedBatch(
        seq=seq, gateway="e7", batch=f"b{seq}", received=1000.0 + seq, sent=None, body=b"", rejected=()
    )


def fold_all(fold: IncidentFold, batches: list[list[AnyReading]], first: int = 1) -> list[RecordedFrame]:
    return [
        row
        for seq, readings in enumerate(batches, start=first)
        for row in fold.fold(entry(seq), readings)
        if row is not None
    ]


def through(course: Course) -> Iterator[RecordedFrame]:
    """The rows that a course makes, to its end."""
    while True:
        before = course.at
        for row, _ in course.steps(course.read()):
            if row is not None:
                yield row
        if course.at == before:
            return


@pytest.fixture
def sqlite_url(tmp_path: Path) -> str:
    url = f"sqlite:///{tmp_path / 'firethread.db'}"
    prepare(url)
    return url


@pytest.fixture
def engine(sqlite_url: str) -> Iterator[sa.Engine]:
    engine = make_engine(sqlite_url, checkpoints=True)
    yield engine
    engine.dispose()


@pytest.fixture
def store(engine: sa.Engine) -> IncidentStore:
    return IncidentStore(engine)


@pytest.fixture
def write(engine: sa.Engine) -> Write:
    """Appends batches to an incident's log."""
    numbers: dict[str, int] = {}

    def append(incident: str, batches: Sequence[Sequence[AnyReading]]) -> None:
        for readings in batches:
            number = numbers[incident] = numbers.get(incident, 0) + 1
            body = msgspec.json.encode({"gateway": "e7", "batch": f"b{number}", "readings": readings})
            (outcome,) = append_group(
                engine,
                [
                    NewBatch(
                        incident=incident,
                        gateway="e7",
                        batch=f"b{number}",
                        received=1000.0 + number,
                        sent=None,
                        body=body,
                        accepted=len(readings),
                    )
                ],
            )
            assert isinstance(outcome, Appended), outcome

    return append


@pytest.fixture
def fragile(monkeypatch: pytest.MonkeyPatch) -> None:
    def create(_name: str, settings: TrackerSettings) -> Tracker:
        return Fragile(settings)

    def restore(_name: str, state: bytes) -> Tracker:
        return Fragile.restore(state)

    monkeypatch.setattr(trackers, "create", create)
    monkeypatch.setattr(trackers, "restore", restore)


@pytest.fixture
def compute() -> Iterator[ThreadPoolExecutor]:
    with ThreadPoolExecutor(1) as pool:
        yield pool
