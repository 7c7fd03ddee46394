import asyncio
import gzip
import json
import time
from typing import Any

import pytest
from starlette.routing import Match, NoMatchFound

from backend.errors import PROBLEM_MEDIA_TYPE, TooBusy
from backend.ingest.tally import tally
from backend.log.base import Appended, LogUnwritable, NewBatch
from backend.log.read import SqlLogReader
from tests.backend.ingest.asgi import Answer, Body, Sent, scope
from tests.backend.ingest.gateway import Field

RANGE = {"kind": "range", "t": 100.0, "a": "ff1", "b": "b3", "range_m": 7.31}


def batch(*readings: object, name: str = "1", **others: object) -> dict[str, Any]:
    return {"gateway": "engine-7", "batch": name, "readings": list(readings), **others}


def refused(answer: Answer, status: int) -> str:
    """The detail of a problem in the contract's form."""
    assert answer.status == status
    assert answer.headers["content-type"] == PROBLEM_MEDIA_TYPE
    problem = answer.json()
    assert problem["status"] == status
    assert problem["type"]
    assert problem["title"]
    detail: str = problem["detail"]
    assert detail
    return detail


def stored(gateway: Field, incident: str) -> int:
    return len(list(SqlLogReader(gateway.engine).batches(incident)))


def test_a_batch_is_acknowledged_and_logged_as_it_came(gateway: Field) -> None:
    incident = gateway.incident()
    body = json.dumps(batch(RANGE, sent=99.5), indent=1).encode()
    answer = gateway.post(incident, body)
    assert answer.status == 202
    assert answer.headers["content-type"] == "application/json"
    assert answer.json() == {"batch": "1", "seq": 1, "accepted": 1, "duplicate": False, "rejected": []}
    (logged,) = SqlLogReader(gateway.engine).batches(incident)
    assert (logged.body, logged.gateway, logged.batch, logged.sent) == (body, "engine-7", "1", 99.5)
    assert abs(logged.received - time.time()) < 60


def test_a_bad_reading_is_set_aside_by_index(gateway: Field) -> None:
    incident = gateway.incident()
    answer = gateway.post(incident, batch(RANGE, {**RANGE, "b": "ff1"}, {"kind": "sonar"}))
    assert answer.status == 202
    told = answer.json()
    assert told["accepted"] == 1
    assert [(one["index"], one["code"]) for one in told["rejected"]] == [
        (1, "self_reading"),
        (2, "unknown_kind"),
    ]
    assert all(one["message"] for one in told["rejected"])


def test_a_batch_sent_again_is_answered_as_before_and_wakes_nobody(gateway: Field) -> None:
    incident = gateway.incident()
    first = gateway.post(incident, batch(RANGE, {"kind": "?"})).json()
    again = gateway.post(incident, batch(RANGE)).json()
    assert again == first | {"duplicate": True}
    assert gateway.woken == [(incident, 1)]
    assert stored(gateway, incident) == 1


def test_every_new_batch_wakes_the_estimator_once(gateway: Field) -> None:
    incident = gateway.incident()
    for name in "abc":
        gateway.post(incident, batch(RANGE, RANGE, name=name))
    assert gateway.woken == [(incident, 1), (incident, 2), (incident, 3)]


def test_gzip_is_logged_as_what_it_holds(gateway: Field) -> None:
    incident = gateway.incident()
    body = json.dumps(batch(RANGE)).encode()
    assert gateway.post(incident, gzip.compress(body), {"content-encoding": "gzip"}).status == 202
    (logged,) = SqlLogReader(gateway.engine).batches(incident)
    assert logged.body == body


def test_only_a_live_incident_minds_the_clock(gateway: Field) -> None:
    ahead = batch({**RANGE, "t": time.time() + 3_600})
    assert gateway.post(gateway.incident("live"), ahead).json()["rejected"][0]["code"] == "time_in_future"
    assert gateway.post(gateway.incident("recorded"), ahead).json()["rejected"] == []


def test_an_unknown_incident_is_not_found_whatever_is_posted(gateway: Field) -> None:
    for incident in ("nowhere", "%00", "\x00", "é", "i" * 5_000):
        refused(gateway.post(incident, b"no json"), 404)


def test_a_closed_incident_refuses_and_still_answers_repeats(gateway: Field) -> None:
    incident = gateway.incident()
    gateway.post(incident, batch(RANGE))
    gateway.store.change(incident, {"state": "closed"})
    assert "closed" in refused(gateway.post(incident, batch(RANGE, name="2")), 409)
    assert gateway.post(incident, batch(RANGE)).json()["duplicate"] is True
    assert stored(gateway, incident) == 1


@pytest.mark.parametrize(
    ("body", "headers", "status"),
    [
        (b"", {}, 400),
        (b"{", {}, 400),
        (b'{"gateway":"g"}', {}, 400),
        (b"\xff\xfe", {}, 400),
        (b"{}", {"content-encoding": "gzip"}, 400),
        (b"{}", {"content-type": "text/plain"}, 415),
        (b"{}", {"content-encoding": "br"}, 415),
        (b"x" * 100_001, {}, 413),
        (gzip.compress(bytes(1_000_000)), {"content-encoding": "gzip"}, 413),
        (json.dumps(batch(*[RANGE] * 101)).encode(), {}, 413),
    ],
)
def test_what_is_no_batch_is_refused_and_stores_nothing(
    gateway: Field, body: bytes, headers: dict[str, str], status: int
) -> None:
    incident = gateway.incident()
    refused(gateway.post(incident, body, headers), status)
    assert stored(gateway, incident) == 0
    assert gateway.woken == []


def test_where_a_body_stops_being_text_is_told_by_its_bytes(gateway: Field) -> None:
    body = b'{"gateway":"g","batch":"b","readings":[{"kind":"node","t":1,"node":"n\xff"}]}'
    assert f"at byte {body.index(255)}" in refused(gateway.post(gateway.incident(), body), 400)


def test_a_batch_that_lacks_a_field_is_told_which(gateway: Field) -> None:
    answer = gateway.post(gateway.incident(), b'{"gateway":"g","readings":[]}')
    refused(answer, 400)
    (fault,) = answer.json()["errors"]
    assert (fault["code"], fault["field"]) == ("missing_field", "batch")


@pytest.mark.parametrize("method", ["GET", "PUT", "DELETE", "PATCH", "HEAD", "OPTIONS"])
def test_other_methods_are_not_allowed(gateway: Field, method: str) -> None:
    answer = gateway.post(gateway.incident(), b"", method=method)
    refused(answer, 405)
    assert answer.headers["allow"] == "POST"


class Refusing:
    """A log that takes nothing."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    async def append(self, batch: NewBatch) -> Appended:
        del batch
        raise self.error


@pytest.mark.parametrize(
    ("error", "status", "retry_after"),
    [
        (TooBusy("full", retry_after_s=1), 429, "1"),
        (LogUnwritable("away", retry_after_s=5), 503, "5"),
        (RuntimeError("a defect"), 500, None),
    ],
)
def test_a_log_that_takes_nothing_acknowledges_nothing(
    gateway: Field, error: Exception, status: int, retry_after: str | None
) -> None:
    gateway.route._writer = Refusing(error)
    answer = gateway.post(gateway.incident(), batch(RANGE))
    refused(answer, status)
    assert answer.headers.get("retry-after") == retry_after
    assert gateway.woken == []


def test_a_client_that_hangs_up_is_not_answered(gateway: Field) -> None:
    sent = Sent()
    request = scope(f"/api/v1/incidents/{gateway.incident()}/telemetry", {"content-type": "application/json"})
    asyncio.run(gateway.route(request, Body([b"{", None]), sent))
    assert sent.messages == []


@pytest.mark.parametrize(
    "path",
    [
        "/api/v1/incidents/telemetry",
        "/api/v1/incidents//telemetry",
        "/api/v1/incidents/a/b/telemetry",
        "/telemetry",
    ],
)
def test_other_paths_are_left_to_others(gateway: Field, path: str) -> None:
    assert gateway.route.matches(scope(path, {}))[0] is Match.NONE
    assert (
        gateway.route.matches({"type": "websocket", "path": "/api/v1/incidents/a/telemetry"})[0] is Match.NONE
    )


def test_the_route_knows_its_address(gateway: Field) -> None:
    assert gateway.route.url_path_for("post_telemetry", incident="i1") == "/api/v1/incidents/i1/telemetry"
    with pytest.raises(NoMatchFound):
        gateway.route.url_path_for("another", incident="i1")


def test_what_is_ingested_is_counted(gateway: Field) -> None:
    def counts() -> dict[tuple[str, str], float]:
        return {
            (sample.name, ",".join(sample.labels.values())): sample.value
            for metric in tally.collect()
            for sample in metric.samples
        }

    incident, before = gateway.incident(), counts()
    gateway.post(incident, batch(RANGE, RANGE, {"kind": "?"}))
    gateway.post(incident, batch(RANGE))
    gateway.post(incident, b"")
    after = counts()

    def grown(name: str, label: str = "") -> float:
        key = (f"firethread_ingest_{name}_total", label)
        return after[key] - before.get(key, 0.0)

    assert grown("batches") == 2
    assert grown("duplicates") == 1
    assert grown("readings") == 2
    assert grown("rejected", "unknown_kind") == 1
    assert grown("refused", "400") == 1
