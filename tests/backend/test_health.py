"""Whether a process is ready is told in time, and as it is."""

import shutil
import socket
import time
from pathlib import Path

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from backend import health, problems
from backend.coordination.web_link import WebLink
from backend.health import health_router
from backend.log.engine import make_engine


def test_a_database_that_does_not_answer_makes_the_process_not_ready_in_time(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(health, "ANSWER_WITHIN_S", 0.2)
    with socket.create_server(("127.0.0.1", 0)) as hangs, socket.create_server(("127.0.0.1", 0)) as link:
        engine = make_engine(f"postgresql+psycopg://127.0.0.1:{hangs.getsockname()[1]}/never")
        app = FastAPI()
        problems.install(app)
        app.include_router(health_router(engine, WebLink(link, ""), lambda: None))
        with TestClient(app) as http:
            began = time.monotonic()
            answers = [http.get("/readyz") for _ in range(3)]
            took_s = time.monotonic() - began
            hangs.close()
    assert [answer.status_code for answer in answers] == [503] * 3
    assert "not answered" in answers[0].json()["detail"]
    assert took_s < 2.0


def test_a_disk_without_room_for_telemetry_makes_the_process_not_ready_until_there_is_room_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    free = health.LEAST_FREE_BYTES - 1
    asked: list[Path] = []

    def usage(path: Path) -> shutil._ntuple_diskusage:
        asked.append(path)
        return shutil._ntuple_diskusage(10 * free, 9 * free, free)

    monkeypatch.setattr(shutil, "disk_usage", usage)
    with socket.create_server(("127.0.0.1", 0)) as link:
        app = FastAPI()
        problems.install(app)
        app.include_router(
            health_router(
                make_engine(f"sqlite:///{tmp_path / 'firethread.db'}"), WebLink(link, ""), lambda: None
            )
        )
        with TestClient(app) as http:
            full = http.get("/readyz")
            free += 1
            roomy = http.get("/readyz")
    assert (full.status_code, roomy.status_code) == (503, 200)
    assert "Make room" in full.json()["detail"]
    assert "retry-after" in full.headers
    assert roomy.json()["log"] is True
    assert set(asked) == {tmp_path}
