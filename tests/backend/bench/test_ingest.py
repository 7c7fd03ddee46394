from pathlib import Path

import httpx2
import pytest

from backend.bench.ingest import _row, limit, load, rival
from backend.bench.load import Task
from backend.bench.server import served


def test_the_load_counts_what_the_server_acknowledged() -> None:
    with served("--no-worker") as (host, port):
        url = f"http://{host}:{port}/api/v1/incidents"
        incident = httpx2.post(url, json={"name": "x", "clock": "live"}).json()["id"]
        task = Task(
            host, port, f"/api/v1/incidents/{incident}/telemetry", 10, 0, 8, warm_s=0.1, counted_s=0.3
        )
        rate = load(task)
        logged = httpx2.get(f"{url}/{incident}").json()["last_seq"]
        assert 0 < rate * task.counted_s <= logged
        with pytest.raises(RuntimeError, match="404"):
            load(Task(host, port, "/api/v1/incidents/nowhere/telemetry", 10, 0, 2, 0.1, 0.1))


def test_the_plain_application_takes_the_same_load(tmp_path: Path) -> None:
    with rival(str(tmp_path)) as port:
        path = "/api/v1/incidents/i1/telemetry"
        assert load(Task("127.0.0.1", port, path, 10, 0, 4, warm_s=0.3, counted_s=0.3)) > 0


def test_the_limit_is_a_rate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("backend.bench.ingest.LIMIT_S", 0.05)
    assert limit(10, tmp_path / "limit") > 0
    assert list(tmp_path.iterdir()) == []


def test_a_row_of_the_table_names_ratio_and_target(capsys: pytest.CaptureFixture[str]) -> None:
    _row(100, [1_000.0, 1_000.0, 1_000.0], [500.0, 600.0, 900.0], [50.0, 60.0, 70.0])
    assert " ".join(capsys.readouterr().out.split()) == "100 1000/s 600/s 60000 0.60 0.50 0.90 0.50 60/s 0.06"
