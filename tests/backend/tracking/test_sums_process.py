"""What is read of the log and of stored states for sums aside."""

import asyncio
from collections.abc import Callable
from typing import ParamSpec, TypeVar

import pytest
import sqlalchemy as sa

from backend.coordination.lease import Leases
from backend.errors import NotFound
from backend.log import schema
from backend.log.base import Snapshot
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import writing
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking.fold import IncidentFold
from backend.tracking.heads import Head, head_of
from backend.tracking.log_blocks import read_block
from backend.tracking.smoothing import Smoothing
from backend.tracking.sums_process import (
    advice_of_log,
    evidence_of_log,
    relative_from_state,
    smooth_log,
    smoothed_of,
)
from estimator import trackers
from estimator.measurements import Position
from estimator.measurements.imu import Imu
from estimator.trackers import kirchhoff
from estimator.trackers.base import Told, TrackerSettings
from estimator.trackers.heard import Heard
from tests.backend.tracking.conftest import Write, walk

HOUR_S = 3600.0

P = ParamSpec("P")
T = TypeVar("T")


class Asked:
    """Stands in for the smoother and keeps what it was given."""

    def __init__(self) -> None:
        self.epochs: list[float] = []
        self.until: list[float] = []
        self.told = 0

    def evidence(self, told: Told, node: str) -> None:
        self.told = len(told)
        if not isinstance(told, Heard):
            self.epochs = [reading.t for reading in told]
            self.until = [reading.until_t for reading in told]
        if node != "ff1":
            raise KeyError(node)

    advice = evidence


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> Asked:
    stand_in = Asked()

    def smoother(tracker: str, settings: TrackerSettings) -> Asked:
        assert (tracker, settings) == ("kirchhoff", TrackerSettings())
        return stand_in

    monkeypatch.setattr(trackers, "smoother", smoother)
    return stand_in


@pytest.fixture
def head(store: IncidentStore, write: Write) -> Head:
    """An incident whose third entry came late."""
    incident = store.create("late", "recorded")
    write(incident.id, [[fix(10.0)], [fix(12.0), fix(11.0)], [fix(9.0)], [fix(13.0)]])
    return head_of(store.get(incident.id))


def fix(t: float) -> Position:
    return Position(t=t, node="ff1", position_m=(0.0, 0.0, 0.0))


def test_smoothed_tracks_reach_the_web_process_to_the_last_bit(
    sqlite_url: str, store: IncidentStore, write: Write
) -> None:
    incident, batches = store.create("walk", "recorded"), walk(9)
    write(incident.id, batches)
    smoothed = smoothed_of(smooth_log(sqlite_url, head_of(store.get(incident.id))))
    readings = [reading for batch in batches for reading in batch]
    assert smoothed == trackers.smoother("kirchhoff", TrackerSettings()).smooth(readings)
    assert smoothed["ff1"]


def test_after_the_servers_clock_was_put_back_all_is_told_by_the_clock_that_is_right_now(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, right_t = store.create("put back", "live"), 1001.0
    ahead = [[fix(right_t + HOUR_S + second)] for second in range(20)]
    write(incident.id, [*ahead, *([fix(right_t + second)] for second in range(20, 40))])
    with writing(engine) as connection:
        early = schema.batches.c.seq <= len(ahead)
        connection.execute(
            sa.update(schema.batches).where(early).values(received=schema.batches.c.received + HOUR_S)
        )
    head = head_of(store.get(incident.id))
    track = smoothed_of(smooth_log(sqlite_url, head))["ff1"]
    assert (track[0].t, track[-1].t) == pytest.approx((right_t, right_t + 39.0), abs=1.0)
    evidence = evidence_of_log(sqlite_url, head, "ff1", right_t + 30.0)
    assert evidence is not None
    assert evidence.t == pytest.approx(right_t + 30.0, abs=1.0)
    held = [measurement.t for measurement in evidence.held]
    assert held
    assert right_t - 1.0 <= min(held) <= max(held) <= right_t + 30.0


def test_without_a_moment_the_whole_log_counts(sqlite_url: str, head: Head, asked: Asked) -> None:
    for ask in (
        lambda: evidence_of_log(sqlite_url, head, "ff1", None),
        lambda: advice_of_log(sqlite_url, head, "ff1"),
    ):
        asked.told = 0
        assert ask() is None
        assert asked.told == 5


def test_of_a_moment_epochs_up_to_it_count_whenever_they_came(
    sqlite_url: str, head: Head, asked: Asked
) -> None:
    evidence_of_log(sqlite_url, head, "ff1", 11.0)
    assert asked.epochs == [10.0, 11.0, 9.0]


def test_of_a_moment_in_the_middle_of_raw_samples_their_first_part_counts(
    sqlite_url: str, store: IncidentStore, write: Write, asked: Asked
) -> None:
    incident = store.create("boot", "recorded")
    rest = [(0.0, 0.0, 9.81)] * 5000
    boot = Imu(t=10.0, node="ff1", rate_hz=100.0, accel_mps2=rest, gyro_radps=[(0.0, 0.0, 0.0)] * 5000)
    write(incident.id, [[boot]])
    evidence_of_log(sqlite_url, head_of(store.get(incident.id)), "ff1", 40.0)
    assert asked.until == [40.0]


def test_entries_after_the_head_are_left_out(sqlite_url: str, head: Head, write: Write, asked: Asked) -> None:
    write(head.incident, [[fix(14.0)]])
    evidence_of_log(sqlite_url, head, "ff1", None)
    assert asked.told == 5
    evidence_of_log(sqlite_url, head, "ff1", 14.0)
    assert max(asked.epochs) == 13.0


def test_a_node_that_nothing_has_named_is_not_found(sqlite_url: str, head: Head, asked: Asked) -> None:
    with pytest.raises(NotFound, match=r"has named 'ff9' up to t = 11\.000"):
        evidence_of_log(sqlite_url, head, "ff9", 11.0)
    with pytest.raises(NotFound, match="has named 'ff9' yet"):
        advice_of_log(sqlite_url, head, "ff9")
    assert asked.told


def test_where_the_stored_state_is_refused_the_log_tells_the_relative_position(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    incident = store.create("of an older version", "recorded").id
    write(incident, walk(5))
    head = head_of(store.get(incident))
    fold = IncidentFold(head.tracker, head.settings)
    for batch, readings in read_block(SqlLogReader(engine), incident, 0):
        list(fold.fold(batch, readings))
    epoch = Leases(lambda: writing(engine), "north").acquire(incident)
    assert epoch is not None
    SqlDerivedWriter(engine).save(incident, epoch, [], Snapshot(seq=fold.seq, state=fold.state()))
    expected = relative_from_state(sqlite_url, head, "ff1", "ff2")
    assert expected is not None

    monkeypatch.setattr(kirchhoff, "VERSION", kirchhoff.VERSION + 1)
    smoothing = Smoothing(sqlite_url)
    monkeypatch.setattr(smoothing, "_aside", at_once)
    assert asyncio.run(smoothing.relative(head, "ff1", "ff2")) == expected
    with pytest.raises(NotFound, match="no node 'ff9'"):
        asyncio.run(smoothing.relative(head, "ff1", "ff9"))
    smoothing.close()


def test_where_no_state_is_stored_yet_the_log_tells_the_relative_position(
    sqlite_url: str, store: IncidentStore, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    incident = store.create("a worker was killed in its first half minute", "recorded").id
    write(incident, walk(5))
    smoothing = Smoothing(sqlite_url)
    monkeypatch.setattr(smoothing, "_aside", at_once)
    found = asyncio.run(smoothing.relative(head_of(store.get(incident)), "ff1", "ff2"))
    assert found is not None
    smoothing.close()


async def at_once(function: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
    """Stands in for the process aside."""
    return function(*args, **kwargs)
