"""How large a body may be where no telemetry comes."""

import asyncio
from collections.abc import Sequence

import pytest
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from backend.authentication import SESSION_PATH
from backend.body_limit import MAX_BYTES, SESSION_BYTES, BodyLimit
from tests.backend.ingest.asgi import Answer, Body, Sent, scope

INCIDENTS = "/api/v1/incidents"
TELEMETRY = "/api/v1/incidents/i1/telemetry"
TELEMETRY_ROUTE = Route(TELEMETRY, lambda _: None, methods=["POST"])


async def echo(_: Scope, receive: Receive, send: Send) -> None:
    """An application that answers with the length of the body, and takes it part by part."""
    size, more = 0, True
    while more:
        message = await receive()
        size += len(message["body"])
        more = message.get("more_body", False)
    await send({"type": "http.response.start", "status": 200, "headers": []})
    await send({"type": "http.response.body", "body": b"%d" % size})


def ask(path: str, parts: Sequence[bytes | None], **headers: str) -> tuple[Answer | None, Body]:
    body, sent = Body(parts), Sent()
    told = {name.replace("_", "-"): value for name, value in headers.items()}
    asyncio.run(BodyLimit(echo, TELEMETRY_ROUTE)(scope(path, told), body, sent))
    return (sent.answer if sent.messages else None), body


@pytest.mark.parametrize(("path", "limit"), [(SESSION_PATH, SESSION_BYTES), (INCIDENTS, MAX_BYTES)])
def test_a_body_without_end_is_refused_at_the_limit(path: str, limit: int) -> None:
    answer, body = ask(path, [b"x" * (limit // 4)] * 100, transfer_encoding="chunked")
    assert answer is not None
    assert answer.status == 413
    assert answer.headers["content-type"] == "application/problem+json"
    assert str(limit) in answer.json()["detail"]
    assert body.given == 5


def test_a_body_that_is_announced_as_too_large_is_not_read() -> None:
    answer, body = ask(SESSION_PATH, [b"x"], content_length=str(SESSION_BYTES + 1))
    assert answer is not None
    assert (answer.status, body.given) == (413, 0)


@pytest.mark.parametrize(("path", "limit"), [(SESSION_PATH, SESSION_BYTES), (INCIDENTS, MAX_BYTES)])
def test_a_body_at_the_limit_goes_through_whole(path: str, limit: int) -> None:
    answer, _ = ask(path, [b"x" * (limit // 2), b"x" * (limit // 2)], content_length=str(limit))
    assert answer is not None
    assert (answer.status, answer.body) == (200, b"%d" % limit)


def test_telemetry_has_limits_of_its_own() -> None:
    answer, _ = ask(TELEMETRY, [b"x" * MAX_BYTES] * 3, content_length=str(3 * MAX_BYTES))
    assert answer is not None
    assert answer.body == b"%d" % (3 * MAX_BYTES)


def test_who_hangs_up_before_the_body_is_whole_gets_no_answer() -> None:
    answer, _ = ask(INCIDENTS, [b"x", None], transfer_encoding="chunked")
    assert answer is None
