"""What an incident is set to under way holds from then on, and what was made before stays."""

import random
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from backend.log.base import RecordedFrame, Snapshot
from backend.log.engine import make_engine
from backend.log.incident import Clock
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.recordings import export_log, import_log
from backend.tracking.course import Course
from backend.tracking.fold import IncidentFold
from backend.tracking.heads import head_of
from backend.tracking.log_blocks import read_block
from estimator import trackers
from estimator.measurements import Retire, Status
from estimator.trackers.base import Tracker, TrackerSettings
from tests.backend.tracking.conftest import Write, through, walk
from tests.backend.tracking.fragile import Fragile
from tests.backend.tracking.test_worker import Process, rows, settled, worker
from tests.running import Post, eventually

START_T = 1_000.0
BATCHES = walk(12)
CHANGES: list[tuple[int, dict[str, object], float]] = [
    (8, {"settings": {"tracker": "paper-a"}}, 1008.1),
    (9, {"settings": {"stale_after_s": 5.0}}, 1009.2),
    (15, {"settings": {"tracker": "kirchhoff", "lag_s": 5.0}}, 1019.5),
    (15, {"origin": {"lat": 50.0, "lon": 14.0, "hae": 200.0}}, 1022.75),
]


def changed_under_way(store: IncidentStore, write: Write, clock: Clock) -> str:
    """An incident whose settings are changed after some of its entries; entry n comes at 1000 + n."""
    incident = store.create("changed", clock, created=999.0).id
    written = 0
    for after_seq, change, since in CHANGES:
        write(incident, BATCHES[written:after_seq])
        written = after_seq
        store.change(incident, change | {"since": since})
    write(incident, BATCHES[written:])
    return incident


def folded(reader: SqlLogReader, incident: str, live: bool) -> tuple[list[RecordedFrame], Course]:
    course = Course.begin(reader, incident, live)
    return list(through(course)), course


def told_in(store: IncidentStore, incident: str, stretch: int) -> IncidentFold:
    """A fold of the whole log that is told what one stretch says."""
    known = store.get(incident)
    head = head_of(known.set_to(known.stretches[stretch]))
    return IncidentFold(head.tracker, head.settings, head.live)


def whole(reader: SqlLogReader, incident: str, fold: IncidentFold) -> Iterator[RecordedFrame]:
    while block := read_block(reader, incident, fold.seq):
        for batch, readings in block:
            yield from (row for row in fold.fold(batch, readings) if row is not None)


def test_each_row_is_what_the_settings_of_its_time_make_of_the_log(
    engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, reader = changed_under_way(store, write, "recorded"), SqlLogReader(engine)
    made, course = folded(reader, incident, live=False)
    assert course.at == (len(BATCHES), len(CHANGES))
    shown = {row.second: row.record for row in made}
    pure = [
        {row.second: row.record for row in whole(reader, incident, told_in(store, incident, n))}
        for n in range(len(CHANGES) + 1)
    ]
    assert shown.keys() == pure[0].keys()
    made_by: dict[int, set[int]] = {}
    for row in made:
        stretch = sum(after_seq <= row.seq for after_seq, _, _ in CHANGES)
        made_by.setdefault(stretch, set()).add(row.second)
        assert row.record == pure[stretch][row.second]
    assert {0, 2, 4} <= made_by.keys()
    assert shown != pure[0]
    assert shown != pure[4]


@pytest.mark.parametrize("clock", ["live", "recorded"])
def test_a_course_goes_on_from_a_state_after_any_entry_as_if_it_had_never_stopped(
    clock: Clock, engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, reader = changed_under_way(store, write, clock), SqlLogReader(engine)
    live = clock == "live"
    expected, end = folded(reader, incident, live)
    course = Course.begin(reader, incident, live)
    made: list[RecordedFrame] = []
    stops = 0
    for row, is_whole in course.steps(course.read()):
        if row is not None:
            made.append(row)
        if is_whole:
            state = Snapshot(
                seq=course.fold.seq, state=course.fold.state(), made_with=course.made_with.encoded()
            )
            again = Course.begin(reader, incident, live, state)
            rest = list(through(again))
            assert made + rest == expected
            assert again.fold.last_row() == end.fold.last_row()
            stops += 1
    assert stops == len(BATCHES) + len(CHANGES)


def test_entries_that_come_before_a_change_is_heard_of_are_folded_by_it(
    engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, reader = store.create("raced", "recorded").id, SqlLogReader(engine)
    write(incident, BATCHES[:8])
    course = Course.begin(reader, incident, live=False)
    first = list(through(course))
    store.change(incident, {"settings": {"tracker": "paper-a"}})
    write(incident, BATCHES[8:])
    assert first + list(through(course)) == folded(reader, incident, live=False)[0]


def test_what_stood_until_it_was_set_otherwise_is_recorded_as_it_was(
    engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, reader = store.create("stood", "live", created=999.0).id, SqlLogReader(engine)
    write(incident, BATCHES[:9])
    before = Course.begin(reader, incident, live=True)
    list(through(before))
    standing = before.fold.last_row()
    assert standing is not None
    store.change(incident, {"settings": {"tracker": "paper-a"}, "since": 1030.0})
    (stood,) = through(before)
    assert stood == standing
    now = before.fold.last_row()
    assert now is not None
    assert (now.second, now.seq, now.received) == (stood.second + 1, stood.seq, 1030.0)
    assert now.record != stood.record
    assert before.fold.since_t == 1029.0


def test_where_a_tracker_breaks_the_next_that_is_told_goes_on(
    engine: sa.Engine, store: IncidentStore, write: Write, monkeypatch: pytest.MonkeyPatch
) -> None:
    create = trackers.create

    def fragile_or_whole(name: str, settings: TrackerSettings) -> Tracker:
        return Fragile(settings) if name == "kirchhoff" else create(name, settings)

    monkeypatch.setattr(trackers, "create", fragile_or_whole)
    incident, reader = store.create("broken", "recorded").id, SqlLogReader(engine)
    told = [[Status(t=1.0 + second, node="ff1", battery=0.5)] for second in range(9)]
    write(incident, [*told[:3], [Retire(t=4.0, node="ff2")], *told[4:6]])
    course = Course.begin(reader, incident, live=False)
    with pytest.raises(ZeroDivisionError):
        list(through(course))
    store.change(incident, {"settings": {"lag_s": 5.0}})
    with pytest.raises(ZeroDivisionError):
        list(through(Course.begin(reader, incident, live=False)))
    store.change(incident, {"settings": {"tracker": "paper-a"}})
    write(incident, told[6:])
    made, course = folded(reader, incident, live=False)
    assert course.at == (9, 2)
    assert [row.second for row in made] == [1, 2, 6, 7, 8]


def test_a_kill_at_any_moment_and_an_import_elsewhere_make_the_same_rows(
    sqlite_url: str, engine: sa.Engine, store: IncidentStore, write: Write, tmp_path: Path
) -> None:
    batches = walk(40)
    killed = store.create("killed", "live", created=999.0).id
    chance = random.Random(68)
    changes: dict[int, dict[str, object]] = {
        20: {"settings": {"tracker": "paper-a"}},
        33: {"levels": [{"level": 0, "name": "G", "up_m": 0.0}]},
        34: {"settings": {"lag_s": 5.0, "tracker": "kirchhoff"}},
        60: {"settings": {"stale_after_s": 2.0, "tracker": "paper-a"}},
    }
    kills, process, kill_at = 0, Process(sqlite_url), time.monotonic() + 2.0
    for number, batch in enumerate(batches, start=1):
        write(killed, [batch])
        if number in changes:
            store.change(killed, changes[number] | {"since": 1000.5 + number})
        time.sleep(0.08)
        if time.monotonic() > kill_at:
            process.kill()
            kills, process = kills + 1, Process(sqlite_url)
            kill_at = time.monotonic() + chance.uniform(0.8, 1.8)
    process.kill()
    store.change(killed, {"state": "closed", "closed": 1200.0})
    with worker(sqlite_url):
        eventually(lambda: settled(engine, killed, len(batches)))
    assert kills >= 3

    file = tmp_path / "changed.ndjson"
    file.write_bytes(b"".join(export_log(sqlite_url, killed)))
    elsewhere = f"sqlite:///{tmp_path / 'elsewhere.db'}"
    imported = import_log(elsewhere, None, file).incident
    there = make_engine(elsewhere)
    with worker(elsewhere):
        eventually(lambda: settled(there, imported, len(batches)))
    assert len(rows(engine, killed)) >= 40
    assert rows(there, imported) == rows(engine, killed)
    there.dispose()


def test_what_tells_the_tracker_nothing_folds_nothing_anew(
    engine: sa.Engine, store: IncidentStore, write: Write
) -> None:
    incident, reader = store.create("storeys", "live", created=999.0).id, SqlLogReader(engine)
    write(incident, BATCHES)
    _, course = folded(reader, incident, live=True)
    fold, picture = course.fold, course.fold.last_row()
    store.change(incident, {"levels": [{"level": 0, "name": "G", "up_m": 0.0}], "since": 1100.0})
    assert list(through(course)) == []
    assert course.at == (len(BATCHES), 1)
    assert course.fold is fold
    assert fold.last_row() == picture


def test_what_was_shown_before_something_was_set_is_shown_as_it_was(post: Post) -> None:
    incident = post.open_incident("storeys known later")
    start = {"kind": "position", "node": "ff1", "position_m": [0, 0, 0], "sigma_m": [1, 1, 1]}
    step = {"kind": "displacement", "node": "ff1", "delta_m": [0.5, 0.0, 0.0]}
    post.telemetry(incident, "b0", [start | {"t": START_T}])
    for second in range(1, 11):
        post.telemetry(incident, f"b{second}", [step | {"t": START_T + second}])
    post.frame(incident, min_seq=11)
    before = post.frame(incident, t=START_T + 5.0)
    storeys = [{"level": 0, "name": "G", "up_m": 0.0}]
    change = {"levels": storeys, "settings": {"tracker": "paper-a", "stale_after_s": 0.5}}
    changed = post.http.patch(f"/incidents/{incident}", json=change).json()
    assert [one["after_seq"] for one in changed["stretches"]] == [0, 11]
    assert [one["levels"] for one in changed["stretches"]] == [[], storeys]
    for second in range(11, 21):
        post.telemetry(incident, f"b{second}", [step | {"t": START_T + second}])
    frame: dict[str, Any] = post.frame(incident, min_seq=21)
    assert frame["nodes"][0]["level"] == 0
    assert post.frame(incident, t=START_T + 5.0) == before
    later: dict[str, Any] = post.frame(incident, t=START_T + 15.75)
    node = later["nodes"][0]
    assert (node["level"], node["status"]) == (0, "stale")
