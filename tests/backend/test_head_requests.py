"""Whoever asks for the head of a page gets that of GET, and no body."""

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from backend import problems
from backend.head_requests import HeadRequests


@pytest.fixture
def client() -> TestClient:
    app = FastAPI()
    problems.install(app)

    @app.get("/page")
    async def page() -> dict[str, str]:
        return {"some": "thing"}

    @app.post("/act")
    async def act() -> None:
        raise AssertionError("nobody asked for it")

    app.add_middleware(HeadRequests)
    return TestClient(app)


def test_the_head_of_a_page_is_that_of_get(client: TestClient) -> None:
    whole, head = client.get("/page"), client.head("/page")
    assert (head.status_code, head.content) == (200, b"")
    assert head.headers == whole.headers


@pytest.mark.parametrize(("path", "status"), [("/act", 405), ("/nowhere", 404)])
def test_what_get_refuses_head_refuses(client: TestClient, path: str, status: int) -> None:
    head = client.head(path)
    assert (head.status_code, head.content) == (status, b"")
    assert head.headers["content-type"] == "application/problem+json"
