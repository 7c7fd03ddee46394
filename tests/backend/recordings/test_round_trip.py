"""Whoever gets an export sees the same pictures: the same storeys, the same ages, at each moment."""

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec
import pytest

from backend.coordination.lease import Leases
from backend.errors import CommandRefused, NotUnderstood
from backend.live.frame import Frame
from backend.live.past import SHOWN_WITHIN_S, frame_of, row_at
from backend.log.append import append_group
from backend.log.base import NewBatch
from backend.log.decode import judge
from backend.log.derived import SqlDerivedWriter
from backend.log.engine import make_engine, writing
from backend.log.incident import Incident, IncidentSettings, Level, Origin
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from backend.recordings import export_log, import_log, parse_settings
from backend.tracking.course import Course
from tests.backend.tracking.conftest import through, walk

SECONDS = 30
OPENED = 990.0
CLOSED = 1000.0 + SECONDS + 90.0
STOREYS = [Level(level=0, name="Ground", up_m=0.0), Level(level=1, name="First", up_m=3.2)]
PLACE = Origin(lat=50.1, lon=14.4, hae=250.0)
SETTINGS = IncidentSettings(tracker="paper-a", lag_s=2.0, stale_after_s=3.0, lost_after_s=5.0)

CHANGES: dict[int, dict[str, Any]] = {
    12: {"settings": {"tracker": "kirchhoff", "lag_s": 20.0}},
    25: {"levels": [STOREYS[1].model_dump()], "settings": {"stale_after_s": 1.0}},
    40: {"origin": None, "settings": {"tracker": "paper-a"}},
}
"""What is set after some of the entries."""


def live_incident(
    url: str, name: str = "Cellar fire", changes: Mapping[int, dict[str, Any]] | None = None
) -> Incident:
    """A closed incident on the server's clock; batches come by fits and starts, one reading of each aside."""
    prepare(url)
    engine = make_engine(url)
    store = IncidentStore(engine)
    incident = store.create(name, "live", PLACE, STOREYS, SETTINGS, OPENED).id
    for number, readings in enumerate(walk(SECONDS), start=1):
        came = 1000.0 + 0.5 * number + (4.0 if number % 8 == 0 else 0.1)
        ahead = {"kind": "status", "node": "ff1", "t": came + 600.0, "air_bar": 10.0}
        body = msgspec.json.encode({"gateway": "e7", "batch": f"b{number}", "readings": [*readings, ahead]})
        judged = judge(body, 1000, came)
        assert [fault.code for fault in judged.rejected] == ["time_in_future"]
        batch = NewBatch(
            incident=incident,
            gateway="e7",
            batch=f"b{number}",
            received=came,
            sent=None,
            body=body,
            accepted=len(judged.accepted),
            rejected=judged.rejected,
        )
        append_group(engine, [batch])
        if changes is not None and number in changes:
            store.change(incident, changes[number] | {"since": came + 0.25})
    closed = store.change(incident, {"state": "closed", "closed": CLOSED})
    engine.dispose()
    return closed


def shown(url: str, incident: str) -> list[Frame]:
    """Folds an incident as a worker does; what a replay shows at each half second."""
    engine = make_engine(url)
    known, reader = IncidentStore(engine).get(incident), SqlLogReader(engine)
    course = Course.begin(reader, incident, live=known.clock == "live")
    rows = list(through(course))
    last = course.fold.last_row()
    assert last is not None
    epoch = Leases(lambda: writing(engine), "test").acquire(incident)
    assert epoch is not None
    SqlDerivedWriter(engine).save(incident, epoch, [*rows, last], None)
    moments = [1000.0 + half / 2 for half in range(2 * SECONDS + 20)]
    frames = [frame_of(row_at(reader, known, t), known, t) for t in moments]
    engine.dispose()
    return [msgspec.structs.replace(frame, incident="") for frame in frames]


def kept(url: str, incident: str) -> dict[str, Any]:
    """What is stored of an incident, save its id and what is worked out from its log."""
    engine = make_engine(url)
    values = IncidentStore(engine).get(incident).model_dump(exclude={"id", "first_t", "last_t"})
    engine.dispose()
    return values


def test_an_imported_incident_is_replayed_as_the_original_was(tmp_path: Path) -> None:
    here, there = (f"sqlite:///{tmp_path / name}.db" for name in ("here", "there"))
    original = live_incident(here).id
    file = tmp_path / "fire.ndjson"
    file.write_bytes(b"".join(export_log(here, original)))

    imported = import_log(there, None, file).incident
    assert kept(there, imported) == kept(here, original)
    frames = shown(there, imported)
    assert frames == shown(here, original)
    # Were everybody always live and nowhere, other settings would show the same.
    assert {node.status for frame in frames for node in frame.nodes} >= {"live", "stale", "lost"}
    assert {node.level for node in frames[-1].nodes} >= {0}
    assert list(export_log(there, imported)) == file.read_bytes().splitlines(keepends=True)


def test_what_was_set_under_way_comes_along_and_shows_the_same_at_each_moment(tmp_path: Path) -> None:
    here, there = (f"sqlite:///{tmp_path / name}.db" for name in ("here", "there"))
    original = live_incident(here, changes=CHANGES).id
    file = tmp_path / "fire.ndjson"
    file.write_bytes(b"".join(export_log(here, original)))

    imported = import_log(there, None, file).incident
    assert kept(there, imported) == kept(here, original)
    assert [one["after_seq"] for one in kept(there, imported)["stretches"]] == [0, *CHANGES]
    frames = shown(there, imported)
    assert frames == shown(here, original)
    assert list(export_log(there, imported)) == file.read_bytes().splitlines(keepends=True)

    opened = live_incident(here, "Never changed").id
    unchanged = shown(here, opened)
    known_by = 1000.0 + 12 / 2 + 0.35 - SHOWN_WITHIN_S
    early = [(was, would) for was, would in zip(frames, unchanged, strict=True) if was.t < known_by]
    assert len(early) > 10
    assert all(was == would for was, would in early)
    assert frames[-1] != unchanged[-1]
    assert {node.level for node in frames[0].nodes} == {0}
    assert {node.level for node in frames[-1].nodes if node.position_m} == {1}


def test_a_change_stays_between_the_lines_where_one_of_them_is_a_repeat(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'log.db'}"
    first, *others = export_log(url, live_incident(url, changes={12: CHANGES[12]}).id)
    file = tmp_path / "fire.ndjson"
    file.write_bytes(b"".join([first, *others[:4], others[3], *others[4:]]))
    done = import_log(url, "Repeated", file)
    assert (done.batches, done.duplicates) == (1 + len(others), 1)
    assert [one["after_seq"] for one in kept(url, done.incident)["stretches"]] == [0, 12]


def test_lines_of_an_export_are_those_of_the_log_and_the_first_says_of_what(database_url: str) -> None:
    incident = live_incident(database_url).id
    first, second, *_ = (msgspec.json.decode(line) for line in export_log(database_url, incident))
    said = first.pop("incident")
    assert first.keys() == second.keys() == {"seq", "received", "gateway", "batch", "rejected", "readings"}
    assert (said["name"], said["clock"], said["closed"]) == ("Cellar fire", "live", CLOSED)
    assert said["settings"]["tracker"] == "paper-a"


def test_what_is_asked_for_goes_before_what_the_file_says(tmp_path: Path) -> None:
    url = f"sqlite:///{tmp_path / 'log.db'}"
    file = tmp_path / "fire.ndjson"
    file.write_bytes(b"".join(export_log(url, live_incident(url, changes={25: CHANGES[25]}).id)))
    wanted = parse_settings(["tracker=kirchhoff"])
    done = import_log(url, "Drill", file, clock="recorded", levels=STOREYS[:1], settings=wanted)
    imported = kept(url, done.incident)
    assert (imported["name"], imported["clock"], len(imported["levels"])) == ("Drill", "recorded", 1)
    changed = {"tracker": "kirchhoff", "stale_after_s": 1.0}
    assert imported["settings"] == SETTINGS.model_copy(update=changed).model_dump()
    assert [len(stretch["levels"]) for stretch in imported["stretches"]] == [1, 1]
    assert {stretch["settings"]["tracker"] for stretch in imported["stretches"]} == {"kirchhoff"}


def line(batch: str, **more: object) -> bytes:
    return msgspec.json.encode({**more, "gateway": "g", "batch": batch, "readings": []}) + b"\n"


def set_after(seq: int) -> dict[str, object]:
    return {"after_seq": seq, "since": 1.0, "origin": None, "levels": [], "settings": {}}


@pytest.mark.parametrize(
    ("lines", "why"),
    [
        ([line("1", incident={"name": "A", "clock": "sundial"}), line("2")], "line 1: .*clock"),
        ([line("1", incident={"name": "A", "settings": {"lag_s": -1}})], "line 1: .*settings.lag_s"),
        ([line("1", incident={"name": "A", "phase": "moon"})], "line 1: .*phase"),
        ([line("1", incident={"name": "A"}), line("2", incident={"name": "B"})], "line 2: another incident"),
        ([line("1", incident={"name": "A", "changes": [{"after_seq": 1}]})], "line 1: .*changes.0.since"),
        ([line("1", incident={"name": "A", "changes": [set_after(2), set_after(1)]})], "line 1: .*order"),
        ([line("1")], "--incident"),
    ],
    ids=["no clock", "out of bounds", "newer", "two incidents", "no moment", "no order", "no name"],
)
def test_of_an_incident_that_is_not_understood_nothing_is_stored(
    tmp_path: Path, lines: list[bytes], why: str
) -> None:
    file = tmp_path / "fire.ndjson"
    file.write_bytes(b"".join(lines))
    with pytest.raises(NotUnderstood, match=why):
        import_log(f"sqlite:///{tmp_path / 'log.db'}", None, file)
    assert not (tmp_path / "log.db").exists()


def firethread(*words: str, log: bytes = b"") -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "backend.cli", *words]
    return subprocess.run(command, input=log, capture_output=True, check=False)


def test_an_export_is_piped_into_an_import_without_a_word_more(tmp_path: Path) -> None:
    here, there = tmp_path / "here", tmp_path / "there"
    here.mkdir()
    url = f"sqlite:///{here / 'firethread.db'}"
    original = live_incident(url).id
    exported = firethread("export", "--data", str(here), "Cellar fire")
    done = firethread("import", "--data", str(there), "--setting", "lag_s=90", "-", log=exported.stdout)
    assert done.returncode == 0, done.stderr
    imported = done.stdout.split()[1].decode().rstrip(":")
    before, after = kept(url, original), kept(f"sqlite:///{there / 'firethread.db'}", imported)
    assert after.pop("stretches")[0]["settings"] == after["settings"]
    del before["stretches"]
    assert after == before | {"settings": before["settings"] | {"lag_s": 90.0}}


@pytest.mark.parametrize("text", ["", "lag_s", "lag=5", "=5"])
def test_a_setting_of_another_form_is_refused_with_those_that_there_are(text: str) -> None:
    with pytest.raises(CommandRefused, match=r"NAME=VALUE.*lost_after_s"):
        parse_settings([text])
