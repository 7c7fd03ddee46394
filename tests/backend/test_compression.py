"""A weak link carries no more than it must, and what is posted is not held up by it."""

import pytest
from fastapi import FastAPI, Request
from starlette.responses import Response
from starlette.testclient import TestClient

from backend.compression import Compression

LOG = "/api/v1/incidents/i1/log"
LONG = b"a line of a log\n" * 10_000


@pytest.fixture
def client() -> TestClient:
    app = FastAPI()

    @app.get(LOG)
    async def log() -> Response:
        return Response(LONG)

    @app.get("/api/v1/incidents/i1")
    async def short() -> Response:
        return Response(LONG[:100])

    @app.post("/api/v1/incidents/i1/telemetry")
    async def telemetry(request: Request) -> Response:
        return Response(await request.body())

    app.add_middleware(Compression)
    return TestClient(app)


def test_what_is_long_comes_compressed_to_who_takes_that_and_is_the_same(client: TestClient) -> None:
    answer = client.get(LOG, headers={"accept-encoding": "gzip"})
    assert answer.headers["content-encoding"] == "gzip"
    assert int(answer.headers["content-length"]) < len(LONG) / 10
    assert answer.content == LONG
    plain = client.get(LOG, headers={"accept-encoding": "identity"})
    assert "content-encoding" not in plain.headers
    assert plain.content == LONG


def test_what_is_short_or_posted_is_answered_as_it_is(client: TestClient) -> None:
    for answer in (
        client.get("/api/v1/incidents/i1"),
        client.post("/api/v1/incidents/i1/telemetry", content=LONG),
    ):
        assert "content-encoding" not in answer.headers
