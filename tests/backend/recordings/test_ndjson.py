"""A recorded log goes in and comes out again byte for byte, on both databases."""

import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from backend.errors import CommandRefused, Conflict, NotFound, NotUnderstood
from backend.log.base import LogUnwritable
from backend.log.engine import make_engine
from backend.log.incident import Level, Origin
from backend.log.incidents import IncidentStore
from backend.log.read import SqlLogReader
from backend.recordings import export_log, import_log, parse_level, parse_origin

EXPORTED = [
    (
        b'{"seq":1,"received":1763712345.25,"gateway":"engine-7","batch":"b1","sent":1763712345.1,'
        b'"readings":[ {"kind":"range", "t":1763712345.0,"a":"ff1","b":"b3","range_m":7.310} ]}\n'
    ),
    (
        b'{"seq":2,"received":1763712345.5,"gateway":"ladder-3","batch":"b1",'
        b'"rejected":[{"code":"out_of_bounds","message":"`t`: must be >= 0.0","index":1,"field":"t"}],'
        b'"readings":[{"t":1763712345.5,"kind":"status","node":"ff1","battery":0.5},'
        b'{"t":-1,"kind":"status","node":"ff1"}]}\n'
    ),
    b'{"seq":3,"received":1763712346.0,"gateway":"engine-7","batch":"b2","readings":[]}\n',
]


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "recording.ndjson"
    path.write_bytes(b"".join(EXPORTED))
    return path


def test_an_imported_log_is_exported_byte_for_byte(database_url: str, recording: Path) -> None:
    imported = import_log(database_url, "Drill", recording)
    assert list(export_log(database_url, imported.incident)) == EXPORTED
    assert (imported.batches, imported.duplicates, imported.accepted, imported.rejected) == (3, 0, 2, 1)


def test_what_is_exported_and_imported_again_is_the_same(database_url: str, tmp_path: Path) -> None:
    path = tmp_path / "bare.ndjson"
    path.write_bytes(
        b'{"gateway":"g","batch":"1","readings":[{"kind":"status","node":"ff1","t":7.5}]}\n\n'
        b'{"gateway":"g","batch":"2","sent":9.5,"readings":[{"kind":"nonsense"}],"note":"newer"}\n'
    )
    first = list(export_log(database_url, import_log(database_url, "A", path).incident))
    path.write_bytes(b"".join(first))
    assert list(export_log(database_url, import_log(database_url, "B", path).incident)) == first
    lines = [msgspec.json.decode(line) for line in first]
    assert [(line["seq"], line["received"]) for line in lines] == [(1, 7.5), (2, 9.5)]
    assert [fault["code"] for fault in lines[1]["rejected"]] == ["unknown_kind"]


def piped(data: Path, log: bytes) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "backend.cli", "import", "--data", str(data), "--incident", "Drill", "-"]
    return subprocess.run(command, input=log, capture_output=True, check=False)


def test_a_log_is_imported_from_a_pipe(tmp_path: Path) -> None:
    done = piped(tmp_path, b"".join(EXPORTED))
    assert done.returncode == 0, done.stderr
    assert list(export_log(f"sqlite:///{tmp_path / 'firethread.db'}", "Drill")) == EXPORTED


def test_a_pipe_with_a_line_that_is_no_batch_is_refused_by_that_line(tmp_path: Path) -> None:
    refused = piped(tmp_path, EXPORTED[0] + b"{\n")
    assert refused.returncode == 2
    assert b"standard input, line 2: " in refused.stderr
    assert not (tmp_path / "firethread.db").exists()


def test_each_import_makes_an_incident_of_its_own(database_url: str, recording: Path) -> None:
    first, second = (import_log(database_url, "Drill", recording) for _ in range(2))
    assert first.incident != second.incident
    engine = make_engine(database_url)
    assert [one.last_seq for one in IncidentStore(engine).all()] == [3, 3]
    engine.dispose()


def test_clock_levels_and_origin_are_those_asked_for(database_url: str, recording: Path) -> None:
    levels, origin = [Level(level=0, name="G", up_m=0.0)], Origin(lat=50.1, lon=14.4, hae=250.0)
    imported = import_log(database_url, "Drill", recording, "recorded", levels, origin)
    engine = make_engine(database_url)
    incident = IncidentStore(engine).get(imported.incident)
    assert (incident.clock, incident.levels, incident.origin) == ("recorded", levels, origin)
    assert (incident.name, incident.state) == ("Drill", "active")
    engine.dispose()


def test_received_is_kept(database_url: str, recording: Path) -> None:
    imported = import_log(database_url, "Drill", recording)
    engine = make_engine(database_url)
    logged = list(SqlLogReader(engine).batches(imported.incident))
    assert [batch.received for batch in logged] == [1763712345.25, 1763712345.5, 1763712346.0]
    engine.dispose()


def test_a_batch_that_comes_twice_counts_once(database_url: str, tmp_path: Path) -> None:
    path = tmp_path / "twice.ndjson"
    path.write_bytes(EXPORTED[0] + EXPORTED[0] + EXPORTED[2])
    imported = import_log(database_url, "Drill", path)
    assert (imported.batches, imported.duplicates) == (2, 1)


@pytest.mark.parametrize(
    "line",
    [b"{", b"[]", b'{"gateway":"g","batch":"b"}', b'{"gateway":"g","batch":"b","readings":{}}', b"\xff"],
)
def test_of_a_file_with_a_line_that_is_no_batch_nothing_is_stored(
    database_url: str, tmp_path: Path, line: bytes
) -> None:
    path = tmp_path / "broken.ndjson"
    path.write_bytes(EXPORTED[0] + line + b"\n")
    import_log(database_url, "Before", _one_line(tmp_path))
    with pytest.raises(NotUnderstood, match=r"broken\.ndjson, line 2: .* Nothing was imported"):
        import_log(database_url, "Drill", path)
    engine = make_engine(database_url)
    assert [one.name for one in IncidentStore(engine).all()] == ["Before"]
    engine.dispose()


def test_a_file_that_holds_nothing_makes_no_incident(database_url: str, tmp_path: Path) -> None:
    path = tmp_path / "empty.ndjson"
    path.write_bytes(b"\n")
    import_log(database_url, "Before", _one_line(tmp_path))
    with pytest.raises(NotUnderstood, match=r"empty\.ndjson holds no batch"):
        import_log(database_url, "Drill", path)
    engine = make_engine(database_url)
    assert [one.name for one in IncidentStore(engine).all()] == ["Before"]
    engine.dispose()


def _one_line(tmp_path: Path) -> Path:
    path = tmp_path / "one.ndjson"
    path.write_bytes(EXPORTED[0])
    return path


def test_a_long_log_is_written_in_parts_and_says_how_far_it_is(database_url: str, tmp_path: Path) -> None:
    path = tmp_path / "long.ndjson"
    body = b'"readings":[{"kind":"status","node":"ff1","t":5}]}\n'
    path.write_bytes(b"".join(b'{"gateway":"g","batch":"%d",' % n + body for n in range(600)))
    steps: list[tuple[int, int]] = []
    imported = import_log(
        database_url, "Long", path, progress=lambda done, total: steps.append((done, total))
    )
    assert steps == [(256, 600), (512, 600), (600, 600)]
    assert imported.accepted == 600
    assert sum(1 for _ in export_log(database_url, imported.incident)) == 600


@pytest.mark.parametrize("name", ["Long", "L" * 200])
def test_of_an_import_that_is_broken_off_the_name_says_so(
    database_url: str, tmp_path: Path, name: str
) -> None:
    path = tmp_path / "long.ndjson"
    path.write_bytes(b"".join(b'{"gateway":"g","batch":"%d","readings":[]}\n' % n for n in range(300)))

    def break_off(*_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        import_log(database_url, name, path, progress=break_off)
    whole = import_log(database_url, name, path)
    engine = make_engine(database_url)
    broken, found = IncidentStore(engine).all()
    engine.dispose()
    assert broken.name == f"{name[:178]} (import not finished)"
    assert (found.id, found.name, len(found.stretches)) == (whole.incident, name, 1)


def test_an_incident_that_is_closed_while_it_is_imported_ends_the_import(
    database_url: str, tmp_path: Path
) -> None:
    path = tmp_path / "long.ndjson"
    path.write_bytes(b"".join(b'{"gateway":"g","batch":"%d","readings":[]}\n' % n for n in range(300)))
    engine = make_engine(database_url)

    def close(done: int, total: int) -> None:
        assert done < total
        IncidentStore(engine).change(IncidentStore(engine).all()[0].id, {"state": "closed"})

    with pytest.raises(Conflict, match="closed"):
        import_log(database_url, "Long", path, progress=close)
    engine.dispose()


def test_an_export_finds_an_incident_by_id_or_by_its_name_alone(database_url: str, recording: Path) -> None:
    first = import_log(database_url, "Drill", recording).incident
    assert list(export_log(database_url, "Drill")) == EXPORTED
    second = import_log(database_url, "Drill", recording).incident
    with pytest.raises(NotFound, match=f"2 incidents are called 'Drill'.*{first}.*{second}"):
        list(export_log(database_url, "Drill"))
    with pytest.raises(NotFound, match=f"no incident 'Nowhere'.*{first}"):
        list(export_log(database_url, "Nowhere"))


def test_a_database_that_cannot_be_reached_is_said(recording: Path) -> None:
    with pytest.raises(LogUnwritable, match="unable to open"):
        import_log("sqlite:////nowhere/at/all/firethread.db", "Drill", recording)


def test_levels_and_origin_are_read_from_the_command_line() -> None:
    assert parse_level("1:First floor:3.4") == Level(level=1, name="First floor", up_m=3.4)
    assert parse_origin("50.1,14.4,250") == Origin(lat=50.1, lon=14.4, hae=250.0)


@pytest.mark.parametrize("text", ["", "1", "1:G", "x:G:0", "1:G:nan", "1::0", "1:G:0:0"])
def test_a_level_of_another_form_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(CommandRefused, match="LEVEL:NAME:UP_M"):
        parse_level(text)


@pytest.mark.parametrize("text", ["", "50,14", "91,0,0", "50;14;0", "a,b,c"])
def test_an_origin_of_another_form_is_refused(text: str) -> None:
    with pytest.raises(CommandRefused, match="LAT,LON,HAE"):
        parse_origin(text)
