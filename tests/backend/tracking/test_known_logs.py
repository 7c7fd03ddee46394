"""Logs of running incidents are read and folded before anybody asks about them."""

from collections.abc import Iterator, Sequence

import pytest
import sqlalchemy as sa

from backend.log.base import LoggedBatch
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.tracking import known_logs, sums_process
from backend.tracking.heads import Head, head_of
from backend.tracking.known_logs import KnownLogs
from backend.tracking.sums_process import read_ahead
from estimator import trackers
from estimator.measurements import AnyReading, Range
from estimator.trackers.base import TrackerSettings
from tests.backend.tracking.conftest import Write, walk

SETTINGS = TrackerSettings(lag_s=5.0)


class Watched(SqlLogReader):
    """Takes note of the entries after which a log was read."""

    def __init__(self, engine: sa.Engine) -> None:
        super().__init__(engine)
        self.after: list[int] = []

    def batches(self, incident: str, after: int = 0, limit: int | None = None) -> Iterator[LoggedBatch]:
        self.after.append(after)
        return super().batches(incident, after=after, limit=limit)


@pytest.fixture
def reader(engine: sa.Engine) -> Watched:
    return Watched(engine)


@pytest.fixture
def incident(store: IncidentStore) -> str:
    opened = store.create("walk", "recorded")
    store.change(opened.id, {"settings": {"lag_s": SETTINGS.lag_s}})
    return opened.id


@pytest.fixture
def kept(monkeypatch: pytest.MonkeyPatch) -> KnownLogs:
    """What the process for sums has read, none of it of other tests."""
    known = KnownLogs()
    monkeypatch.setattr(sums_process, "_known", known)
    return known


def read_whole(known: KnownLogs, reader: SqlLogReader, head: Head) -> None:
    while known.read_ahead(reader, head, "here"):
        pass


def smoothed(head: Head, known: KnownLogs, reader: SqlLogReader) -> object:
    return trackers.smoother(head.tracker, head.settings).smooth(known.up_to(reader, head, "here").heard)


def alone(batches: Sequence[Sequence[AnyReading]]) -> object:
    readings = [reading for batch in batches for reading in batch]
    return trackers.smoother("kirchhoff", SETTINGS).smooth(readings)


def test_what_was_read_ahead_is_not_read_again_and_changes_no_bit(
    reader: Watched, store: IncidentStore, incident: str, write: Write
) -> None:
    batches, known = walk(20), KnownLogs()
    half = len(batches) // 2
    write(incident, batches[:half])
    read_whole(known, reader, head_of(store.get(incident)))
    write(incident, batches[half:])
    reader.after.clear()
    assert smoothed(head_of(store.get(incident)), known, reader) == alone(batches)
    assert min(reader.after) == half


def test_a_log_that_tells_of_folded_times_is_read_anew_when_it_is_asked_about(
    reader: Watched, store: IncidentStore, incident: str, write: Write
) -> None:
    batches, known = walk(20), KnownLogs()
    late = [Range(t=1002.05, a="ff1", b="base", range_m=1.6, technology="uwb")]
    write(incident, batches)
    read_whole(known, reader, head_of(store.get(incident)))
    write(incident, [late])
    head = head_of(store.get(incident))
    assert not known.read_ahead(reader, head, "here")
    reader.after.clear()
    assert not known.read_ahead(reader, head, "here")
    assert reader.after == []
    assert smoothed(head, known, reader) == alone([*batches, late])
    assert reader.after[0] == 0
    write(incident, [[Range(t=1021.0, a="ff1", b="base", range_m=20.0, technology="uwb")]])
    assert known.read_ahead(reader, head_of(store.get(incident)), "here")


def test_a_unit_without_a_clock_that_came_first_costs_nobody_the_others(
    reader: Watched, store: IncidentStore, incident: str, write: Write
) -> None:
    """It counts from when it was switched on, half a century before all others."""
    early = [[Range(t=float(t), a="ff9", b="base", range_m=1.0, technology="uwb")] for t in range(30)]
    batches, known = walk(10, start_t=1e9), KnownLogs()
    for part in (early, batches):
        write(incident, part)
        read_whole(known, reader, head_of(store.get(incident)))
    for _ in range(2):
        assert smoothed(head_of(store.get(incident)), known, reader) == alone([*early, *batches])


def test_an_entry_that_came_after_the_question_is_left_out(
    reader: Watched, store: IncidentStore, incident: str, write: Write
) -> None:
    batches, known = walk(10), KnownLogs()
    write(incident, batches[:-1])
    head = head_of(store.get(incident))
    write(incident, batches[-1:])
    read_whole(known, reader, head_of(store.get(incident)))
    assert smoothed(head, known, reader) == alone(batches[:-1])


@pytest.mark.parametrize("most", [{"KEPT": 1}, {"LARGEST": 300}])
def test_what_is_kept_has_bounds(
    reader: Watched,
    store: IncidentStore,
    write: Write,
    monkeypatch: pytest.MonkeyPatch,
    most: dict[str, int],
) -> None:
    """One that did not fit is not read again and again to be given up each time."""
    for name, bound in most.items():
        monkeypatch.setattr(known_logs, name, bound)
    known, heads = KnownLogs(), []
    for name in ("north", "south"):
        opened = store.create(name, "recorded")
        write(opened.id, walk(20))
        heads.append(head_of(store.get(opened.id)))
        read_whole(known, reader, heads[-1])
    reader.after.clear()
    assert not known.read_ahead(reader, heads[0], "here")
    assert reader.after == []


def test_the_largest_gives_way_to_the_others(
    reader: Watched, store: IncidentStore, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(known_logs, "LARGEST", 200)
    known, heads = KnownLogs(), []
    for name, seconds in (("small", 10), ("large", 60)):
        opened = store.create(name, "recorded")
        write(opened.id, walk(seconds))
        heads.append(head_of(store.get(opened.id)))
        read_whole(known, reader, heads[-1])
    reader.after.clear()
    assert known.read_ahead(reader, heads[0], "here") is False
    assert reader.after == [heads[0].last_seq]
    known.read_ahead(reader, heads[1], "here")
    assert len(reader.after) == 1


def test_running_incidents_are_read_ahead_and_others_are_not(
    sqlite_url: str, store: IncidentStore, write: Write, kept: KnownLogs, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Head] = []

    def note(_reader: SqlLogReader, head: Head, _of: str) -> bool:
        asked.append(head)
        return False

    monkeypatch.setattr(kept, "read_ahead", note)
    running, past = store.create("now", "live"), store.create("then", "recorded")
    for one in (running, past):
        write(one.id, walk(5))
    assert not read_ahead(sqlite_url)
    assert [head.incident for head in asked] == [running.id]


def test_an_incident_that_cannot_be_folded_keeps_no_other_from_being_read(
    sqlite_url: str,
    reader: Watched,
    store: IncidentStore,
    write: Write,
    kept: KnownLogs,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    broken, sound = (store.create(name, "live") for name in ("broken", "sound"))
    batches = walk(10)
    for one in (broken, sound):
        write(one.id, batches)
    fold_ahead = known_logs.KnownLog.fold_ahead

    def breaks(known: known_logs.KnownLog) -> None:
        if known.seq and not folded:
            folded.append(known)
            raise FloatingPointError
        fold_ahead(known)

    folded: list[known_logs.KnownLog] = []
    monkeypatch.setattr(known_logs.KnownLog, "fold_ahead", breaks)
    while read_ahead(sqlite_url):
        pass
    head = head_of(store.get(sound.id))
    assert kept.up_to(reader, head, sqlite_url).heard.ended()
    assert reader.after == []
    assert not kept.read_ahead(reader, head_of(store.get(broken.id)), sqlite_url)
    assert reader.after == []
