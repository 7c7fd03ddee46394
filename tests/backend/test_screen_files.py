"""How the screen is served, and what is answered where it has not been built."""

from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from backend import problems, screen_files
from backend.screen_files import Screen


@pytest.fixture
def not_built(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TestClient:
    monkeypatch.setattr(screen_files, "FOLDER", tmp_path / "screen")
    app = FastAPI()
    problems.install(app)
    app.get("/api/v1/incidents")(list)
    app.mount("/", Screen())
    return TestClient(app)


def test_the_first_page_says_how_to_build_it(not_built: TestClient) -> None:
    answer = not_built.get("/")
    assert answer.status_code == 503
    assert "make screen" in answer.text


@pytest.mark.parametrize(
    ("method", "path", "status"),
    [("GET", "/nothing", 404), ("GET", "/api/v1/nothing", 404), ("HEAD", "/api/v1/incidents", 405)],
)
def test_all_else_is_refused_as_it_is_with_a_screen(
    not_built: TestClient, method: str, path: str, status: int
) -> None:
    answer = not_built.request(method, path)
    assert answer.status_code == status
    assert answer.headers["content-type"] == "application/problem+json"


def test_over_a_slow_link_the_screen_comes_compressed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script = "const storey = 'first floor';\n" * 5000
    (tmp_path / "assets").mkdir()
    (tmp_path / "assets" / "index-1a2b.js").write_text(script)
    monkeypatch.setattr(screen_files, "FOLDER", tmp_path)
    app = FastAPI()
    app.mount("/", Screen())
    answer = TestClient(app).get("/assets/index-1a2b.js", headers={"Accept-Encoding": "gzip"})
    assert answer.headers["content-encoding"] == "gzip"
    assert answer.headers["cache-control"] == "max-age=31536000, immutable"
    assert answer.text == script
    plain = TestClient(app).get("/assets/index-1a2b.js", headers={"Accept-Encoding": "identity"})
    assert "content-encoding" not in plain.headers
