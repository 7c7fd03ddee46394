"""Processes hang without ending: they are found out by their silence, and nothing acknowledged is lost."""

import os
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from tests.running import READY_WITHIN_S, Post, Server, eventually, running, stopped


@pytest.fixture(scope="module")
def disturbed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server whose processes these tests alone disturb: each leaves it well."""
    with running(tmp_path_factory.mktemp("hanging") / "data") as server:
        yield server


@pytest.fixture
def at_work(disturbed: Server) -> Server:
    """The same with a worker that computes."""
    return disturbed.until_it_computes()


def step(second: int) -> dict[str, object]:
    """A batch in which a responder makes a step."""
    reading = {"kind": "displacement", "t": 1000.0 + second, "node": "ff1", "delta_m": [1.0, 0.0, 0.0]}
    return {"gateway": "engine-7", "batch": f"step-{second}", "readings": [reading]}


def test_while_the_logs_writer_hangs_gateways_are_refused_and_the_server_says_that_it_is_not_ready(
    at_work: Server,
) -> None:
    post = Post(at_work.url)
    incident = post.open_incident()

    def telemetry(second: int) -> httpx2.Response:
        return post.http.post(f"/incidents/{incident}/telemetry", json=step(second))

    assert telemetry(0).status_code == 202
    (writer,) = at_work.writer_pids()
    with stopped(writer):
        began = time.monotonic()
        held = telemetry(1)
        took_s = time.monotonic() - began
        ready = post.http.get(at_work.url + "/readyz")
        at_once = telemetry(2)
    assert 8.0 < took_s < 20.0
    for answer in (held, ready, at_once):
        assert answer.status_code == 503
        assert "does not answer" in answer.json()["detail"]
        assert "retry-after" in answer.headers

    eventually(lambda: telemetry(1).status_code == 202)
    assert [telemetry(second).json()["seq"] for second in (0, 1, 2)] == [1, 2, 3]
    assert post.http.get(at_work.url + "/readyz").status_code == 200
    assert len(post.log(incident)) == 3
    assert post.frame(incident, min_seq=3)["seq"] == 3


def test_while_the_logs_writer_is_started_again_the_server_says_that_it_is_not_ready(at_work: Server) -> None:
    (writer,) = at_work.writer_pids()
    with Post(at_work.url).http as http:

        def readiness() -> httpx2.Response:
            return http.get(at_work.url + "/readyz")

        assert readiness().json()["log"] is True
        os.kill(writer, signal.SIGKILL)
        eventually(lambda: at_work.writer_pids() not in ([writer], []))
        # The next one is there as a process, and is not at work yet.
        starting = readiness()
        assert starting.status_code == 503
        assert "starts again by itself" in starting.json()["detail"]
        assert "retry-after" in starting.headers
        eventually(lambda: readiness().status_code == 200)
        assert readiness().json()["log"] is True


def test_a_worker_that_hangs_is_replaced_and_what_came_meanwhile_is_shown(at_work: Server) -> None:
    post = Post(at_work.url)
    incident = post.open_incident()
    assert post.http.post(f"/incidents/{incident}/telemetry", json=step(0)).status_code == 202
    post.frame(incident, min_seq=1)
    (hangs,) = at_work.worker_pids()
    with stopped(hangs):
        assert post.http.post(f"/incidents/{incident}/telemetry", json=step(1)).status_code == 202
        eventually(lambda: at_work.worker_pids() not in ([hangs], []), within_s=40.0)
        assert not Path(f"/proc/{hangs}").exists()
        eventually(at_work.until_it_computes, within_s=READY_WITHIN_S)
        assert post.frame(incident, min_seq=2)["seq"] == 2
