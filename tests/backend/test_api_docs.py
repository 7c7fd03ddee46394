"""The page that describes the API, on a fire ground without internet."""

import re
from collections.abc import Iterator

import httpx2
import pytest

from tests.running import running


@pytest.fixture(scope="module")
def http(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.Client]:
    with (
        running(tmp_path_factory.mktemp("docs") / "data", "--no-worker") as server,
        httpx2.Client(base_url=server.url) as client,
    ):
        yield client


def test_the_page_and_all_that_it_loads_come_from_this_server(http: httpx2.Client) -> None:
    page = http.get("/docs")
    assert page.status_code == 200
    assert "//" not in re.sub(r"<!--.*?-->", "", page.text), "an address of another host"
    assert "default-src 'self'" in page.headers["content-security-policy"]
    loaded = re.findall(r'(?:src|href)="([^"]+)"', page.text)
    assert {path.rsplit(".", 1)[1] for path in loaded} == {"css", "js", "png"}
    for path in [*loaded, *re.findall(r"url: '([^']+)'", page.text)]:
        answer = http.get(path)
        assert (answer.status_code, len(answer.content) > 1_000) == (200, True), path


def test_the_document_says_where_the_token_goes(http: httpx2.Client) -> None:
    document = http.get("/openapi.json").json()
    scheme = document["components"]["securitySchemes"]["accessToken"]
    assert (scheme["type"], scheme["scheme"]) == ("http", "bearer")
    guarded = {
        path
        for path, operations in document["paths"].items()
        for operation in operations.values()
        if {"accessToken": []} in operation.get("security", [])
    }
    api = {path for path in document["paths"] if path.startswith("/api/")}
    assert guarded == api - {"/api/v1/session"}
    assert "/api/v1/incidents/{incident}/telemetry" in guarded


@pytest.mark.parametrize("path", ["/healthz", "/openapi.json", "/api/v1/incidents"])
def test_every_page_that_can_be_read_tells_its_head(http: httpx2.Client, path: str) -> None:
    head = http.head(path)
    assert (head.status_code, head.content) == (200, b"")
    assert int(head.headers["content-length"]) == len(http.get(path).content)
