"""The database's files vanish under a running server, or the database goes away and comes back."""

from pathlib import Path

from tests.running import Post, running


def test_nothing_is_acknowledged_once_the_databases_files_are_deleted(tmp_path: Path) -> None:
    with running(tmp_path / "data", "--no-worker") as server:
        post = Post(server.url)
        incident = post.open_incident()
        batch = {"gateway": "engine-7", "batch": "late", "readings": []}
        post.telemetry(incident, "first", [])
        for file in (tmp_path / "data").glob("firethread.db*"):
            file.unlink()
        refused = [
            post.http.post(f"/incidents/{incident}/telemetry", json=batch),
            post.http.post("/incidents", json={"name": "another", "clock": "live"}),
            post.http.get(f"{server.url}/readyz"),
        ]
        assert [answer.status_code for answer in refused] == [503] * 3
        assert len(post.log(incident)) == 1, "what was acknowledged can be saved while the server runs"
