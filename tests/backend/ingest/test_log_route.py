import json
from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from backend import problems
from backend.ingest.log_route import NDJSON, log_router
from backend.log.lines import log_line, parse_line
from backend.log.read import SqlLogReader
from tests.backend.ingest.gateway import Field


@pytest.fixture
def client(gateway: Field) -> TestClient:
    app = FastAPI()
    problems.install(app)
    app.include_router(log_router(SqlLogReader(gateway.engine), gateway.store))
    return TestClient(app)


def fill(gateway: Field, incident: str, count: int) -> list[bytes]:
    readings = b'[ {"kind":"altitude",\r\n"t":1,"node":"n","up_m":1},{"kind":"?"} ]'
    bodies = [b'{"gateway":"g","batch":"%d","readings":%s}' % (i, readings) for i in range(1, count + 1)]
    for body in bodies:
        assert gateway.post(incident, body).status == 202
    return bodies


def test_the_log_is_a_line_a_batch_with_readings_as_they_came(client: TestClient, gateway: Field) -> None:
    incident = gateway.incident()
    fill(gateway, incident, 3)
    answer = client.get(f"/api/v1/incidents/{incident}/log")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == NDJSON
    lines = answer.content.splitlines(keepends=True)
    assert lines == [log_line(one) for one in SqlLogReader(gateway.engine).batches(incident)]
    assert [json.loads(line)["seq"] for line in lines] == [1, 2, 3]
    assert b'[ {"kind":"altitude",  "t":1,"node":"n","up_m":1},{"kind":"?"} ]' in lines[0]
    assert json.loads(lines[0])["rejected"][0]["code"] == "unknown_kind"


def test_after_and_limit_choose_lines(client: TestClient, gateway: Field) -> None:
    incident = gateway.incident()
    fill(gateway, incident, 5)
    answer = client.get(f"/api/v1/incidents/{incident}/log", params={"after": 1, "limit": 2})
    assert [json.loads(line)["seq"] for line in answer.content.splitlines()] == [2, 3]


def test_of_the_entries_chosen_those_with_a_kind_of_reading_come_whole_also_if_it_was_set_aside(
    client: TestClient, gateway: Field
) -> None:
    incident = gateway.incident()
    bodies = [
        b'[{"kind":"altitude","t":1,"node":"alarm","up_m":1}]',
        b'[{"kind":"altitude","t":2,"node":"n","up_m":1},{"kind":"retire","t":2,"node":"n"}]',
        b'["alarm",{"kind":"alarm"}]',
        rb'[{"kind":"\u0061larm","t":4,"node":"n","alarm":"pass","state":"raised"},"cut \ud83d"]',
        b'[{"kind":"retire","t":5,"node":"n"}]',
    ]
    for number, readings in enumerate(bodies):
        body = b'{"gateway":"g","batch":"%d","readings":%s}' % (number, readings)
        assert gateway.post(incident, body).status == 202
    whole = client.get(f"/api/v1/incidents/{incident}/log").content.splitlines()

    def chosen(**query: object) -> list[bytes]:
        answer = client.get(f"/api/v1/incidents/{incident}/log", params=query)  # type: ignore[arg-type]
        assert answer.status_code == 200
        return answer.content.splitlines()

    assert chosen(kind="alarm") == whole[2:4]
    assert chosen(kind=["alarm", "retire"]) == whole[1:5]
    assert chosen(kind="retire", after=1, limit=3) == whole[1:2]
    assert chosen(kind="nothing") == []


def test_an_empty_log_is_empty(client: TestClient, gateway: Field) -> None:
    answer = client.get(f"/api/v1/incidents/{gateway.incident()}/log")
    assert (answer.status_code, answer.content) == (200, b"")


@pytest.mark.parametrize(
    ("incident", "query", "status"),
    [
        ("nowhere", "", 404),
        (None, "after=-1", 422),
        (None, "limit=0", 422),
        (None, "after=x", 422),
        (None, f"after={2**64}", 422),
        (None, "kind=", 422),
    ],
)
def test_what_is_not_there_or_no_number_is_refused(
    client: TestClient, gateway: Field, incident: str | None, query: str, status: int
) -> None:
    answer = client.get(f"/api/v1/incidents/{incident or gateway.incident()}/log?{query}")
    assert answer.status_code == status
    assert answer.headers["content-type"].startswith("application/problem+json")


def test_lines_fed_to_an_empty_incident_make_the_same_log(client: TestClient, gateway: Field) -> None:
    first, second = gateway.incident(), gateway.incident()
    fill(gateway, first, 4)
    content = client.get(f"/api/v1/incidents/{first}/log").content
    for line in content.splitlines():
        assert gateway.post(second, parse_line(line).body()).status == 202
    again = client.get(f"/api/v1/incidents/{second}/log").content

    def without_time(lines: bytes) -> list[dict[str, object]]:
        return [{k: v for k, v in json.loads(line).items() if k != "received"} for line in lines.splitlines()]

    assert without_time(again) == without_time(content)


def test_a_database_that_is_away_is_a_503_and_no_cut_body(
    client: TestClient, gateway: Field, tmp_path: Path
) -> None:
    incident = gateway.incident()
    (tmp_path / "firethread.db").rename(tmp_path / "away")
    gateway.engine.dispose()
    (tmp_path / "firethread.db").mkdir()
    answer = client.get(f"/api/v1/incidents/{incident}/log")
    assert answer.status_code == 503
    (tmp_path / "firethread.db").rmdir()


def test_a_text_that_was_cut_within_a_character_goes_out_and_in_as_it_came(
    client: TestClient, gateway: Field
) -> None:
    readings = rb'[{"kind":"altitude","t":1,"node":"n","up_m":1},"cut \ud83d","whole \ud83d\ude00"]'
    first, second = gateway.incident(), gateway.incident()
    assert gateway.post(first, b'{"gateway":"g","batch":"b","readings":%s}' % readings).status == 202
    (line,) = client.get(f"/api/v1/incidents/{first}/log").content.splitlines()
    assert readings in line
    assert gateway.post(second, parse_line(line).body()).status == 202
    (again,) = client.get(f"/api/v1/incidents/{second}/log").content.splitlines()
    assert readings in again
    assert [fault["index"] for fault in json.loads(again)["rejected"]] == [1, 2]
