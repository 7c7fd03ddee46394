from collections.abc import Iterator
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from backend import problems
from backend.incidents.routes import incidents_router
from backend.log.engine import make_engine
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare

INCIDENTS = "/api/v1/incidents"
NEW: dict[str, Any] = {"name": "Storgatan 4", "clock": "live"}
FULL: dict[str, Any] = {
    "name": "Exercise – night",
    "clock": "recorded",
    "origin": {"lat": 59.3, "lon": 18.1, "hae": 31},
    "levels": [{"level": 1, "name": "1", "up_m": 3.2}, {"level": 0, "name": "G", "up_m": 0}],
    "settings": {"stale_after_s": 5, "tracker": "kirchhoff"},
}


@pytest.fixture
def client(database_url: str) -> Iterator[TestClient]:
    prepare(database_url)
    engine = make_engine(database_url)
    app = FastAPI()
    problems.install(app)
    app.include_router(incidents_router(IncidentStore(engine)))
    yield TestClient(app)
    engine.dispose()


@pytest.fixture
def created(client: TestClient) -> dict[str, Any]:
    answer: dict[str, Any] = client.post(INCIDENTS, json=NEW).json()
    return answer


def test_an_incident_is_created_and_found_at_its_address(client: TestClient) -> None:
    answer = client.post(INCIDENTS, json=FULL)
    assert answer.status_code == 201
    incident = answer.json()
    assert answer.headers["location"] == f"{INCIDENTS}/{incident['id']}"
    assert incident["state"] == "active"
    assert [level["level"] for level in incident["levels"]] == [0, 1]
    assert incident["settings"]["stale_after_s"] == 5
    assert incident["settings"]["lost_after_s"] == 60
    assert client.get(answer.headers["location"]).json() == incident


def test_incidents_are_listed_by_state(client: TestClient, created: dict[str, Any]) -> None:
    second = client.post(INCIDENTS, json=FULL).json()
    client.patch(f"{INCIDENTS}/{created['id']}", json={"state": "closed"})
    assert [one["id"] for one in client.get(INCIDENTS).json()] == [created["id"], second["id"]]
    assert [one["id"] for one in client.get(INCIDENTS, params={"state": "active"}).json()] == [second["id"]]
    assert [one["id"] for one in client.get(INCIDENTS, params={"state": "closed"}).json()] == [created["id"]]
    assert client.get(INCIDENTS, params={"state": "burning"}).status_code == 422


@pytest.mark.parametrize(
    "change",
    [
        {"name": ""},
        {"name": "x" * 201},
        {"name": "a\x00b"},
        {"name": "a\nb"},
        {"name": " "},
        {"name": "\u00a0\u2003"},
        {"name": "\u200b\u2060\ufeff"},
        {"name": "\u3164 \u2800"},
        {"name": None},
        {"name": 7},
        {"clock": "sundial"},
        {"origin": {"lat": 91, "lon": 0, "hae": 0}},
        {"origin": {"lat": 0, "lon": 181, "hae": 0}},
        {"origin": {"lat": 0, "lon": 0}},
        {"origin": {"lat": "59", "lon": 0, "hae": 0}},
        {"levels": [{"level": 0, "name": "G", "up_m": 0}] * 2},
        {"levels": [{"level": i, "name": "x", "up_m": i} for i in range(101)]},
        {"levels": [{"level": 0.5, "name": "G", "up_m": 0}]},
        {"levels": [{"level": 0, "name": "", "up_m": 0}]},
        {"levels": [{"level": 0, "name": "\u200b", "up_m": 0}]},
        {"levels": [{"level": 2, "name": "2", "up_m": 3}, {"level": 1, "name": "1", "up_m": 6}]},
        {"levels": [{"level": 0, "name": "G", "up_m": 1e9}]},
        {"settings": {"stale_after_s": 0}},
        {"settings": {"stale_after_s": 100, "lost_after_s": 50}},
        {"settings": {"lag_s": -1}},
        {"settings": {"lag_s": True}},
        {"settings": {"tracker": "crystal ball"}},
        {"settings": {"colour": "red"}},
        {"note": "unknown field"},
    ],
)
def test_a_field_outside_its_bounds_is_refused_by_name(client: TestClient, change: dict[str, Any]) -> None:
    answer = client.post(INCIDENTS, json={**NEW, **change})
    assert answer.status_code == 422
    assert answer.headers["content-type"] == "application/problem+json"
    assert next(iter(change)) in answer.json()["errors"][0]["field"]
    assert client.get(INCIDENTS).json() == []


@pytest.mark.parametrize(
    "body", [b"", b"{", b'{"name":"x","clock":"live","origin":{"lat":NaN,"lon":0,"hae":0}}', b"[]", b"\xff"]
)
def test_what_is_no_incident_is_refused(client: TestClient, body: bytes) -> None:
    answer = client.post(INCIDENTS, content=body, headers={"content-type": "application/json"})
    assert answer.status_code in {400, 422}
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_change_touches_only_what_is_sent(client: TestClient) -> None:
    before = client.post(INCIDENTS, json=FULL).json()
    address = f"{INCIDENTS}/{before['id']}"
    after = client.patch(address, json={"name": "new", "settings": {"lag_s": 30}}).json()
    settings, stretches = before["settings"] | {"lag_s": 30}, after["stretches"]
    assert after == before | {"name": "new", "settings": settings, "stretches": stretches}
    assert client.patch(address, json={}).json() == after
    assert client.patch(address, json={"settings": {"lag_s": 30}}).json() == after
    assert client.patch(address, json={"origin": None}).json()["origin"] is None


@pytest.mark.parametrize(
    "change",
    [
        {"clock": "recorded"},
        {"name": None},
        {"state": "open"},
        {"levels": None},
        {"settings": {"lost_after_s": 1}},
        {"id": "x"},
    ],
)
def test_a_change_that_makes_no_sense_changes_nothing(
    client: TestClient, created: dict[str, Any], change: dict[str, Any]
) -> None:
    address = f"{INCIDENTS}/{created['id']}"
    answer = client.patch(address, json={"name": "new", **change})
    assert answer.status_code == 422
    assert answer.json()["errors"]
    assert client.get(address).json() == created


def test_settings_that_contradict_those_that_stay_are_refused_by_name(
    client: TestClient, created: dict[str, Any]
) -> None:
    change = {"settings": {"lost_after_s": 1}}
    problem = client.patch(f"{INCIDENTS}/{created['id']}", json=change).json()
    assert problem["errors"][0]["field"] == "body.settings"
    assert problem["detail"].startswith("body.settings: a node cannot be lost before it is stale")


def test_a_closed_incident_stays_closed(client: TestClient, created: dict[str, Any]) -> None:
    address = f"{INCIDENTS}/{created['id']}"
    closed = client.patch(address, json={"state": "closed"}).json()
    assert closed["state"] == "closed"
    assert closed["closed"] >= created["created"]
    assert client.patch(address, json={"state": "closed"}).json() == closed
    answer = client.patch(address, json={"state": "active"})
    assert answer.status_code == 409
    assert "new incident" in answer.json()["detail"]


def test_which_levels_contradict_each_other_is_said(client: TestClient) -> None:
    levels = [{"level": 2, "name": "2", "up_m": 3.0}, {"level": 1, "name": "1", "up_m": 6.5}]
    (error,) = client.post(INCIDENTS, json=NEW | {"levels": levels}).json()["errors"]
    assert "level 2 is at 3 m, below level 1 at 6.5 m" in error["message"]


@pytest.mark.parametrize("incident", ["nowhere", "%00", "i%00", "%F0%9F%94%A5"])
def test_an_unknown_incident_is_not_found(client: TestClient, incident: str) -> None:
    for answer in (client.get(f"{INCIDENTS}/{incident}"), client.patch(f"{INCIDENTS}/{incident}", json={})):
        assert answer.status_code == 404
        assert answer.headers["content-type"] == "application/problem+json"
