"""Web process and worker as two commands on Postgres, as docker-compose.yml runs them."""

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
import sqlalchemy as sa

from tests.running import Post, Server, eventually, free_port, running

SHARED_WORD = "a-word-that-both-share"
FULL = [
    """CREATE FUNCTION full_disk() RETURNS trigger LANGUAGE plpgsql AS $$ BEGIN
    RAISE EXCEPTION 'could not extend file: No space left on device' USING ERRCODE = '53100'; END $$""",
    "CREATE TRIGGER full_disk BEFORE INSERT ON batches FOR EACH ROW EXECUTE FUNCTION full_disk()",
]
"""What Postgres answers where its disk is full, without filling it."""


@contextlib.contextmanager
def worker(database: str, link: str, says: Path | None = None) -> Iterator[subprocess.Popen[bytes]]:
    """A worker by itself; what it reports goes to a file, if one is given."""
    command = [sys.executable, "-m", "backend.cli", "worker", "--database", database, "--link", link]
    with (says or Path(os.devnull)).open("ab") as reports:
        process = subprocess.Popen(command, stderr=reports)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGCONT)
        process.terminate()
        process.wait(20)


@pytest.fixture
def apart(
    tmp_path: Path, postgres_url: str, monkeypatch: pytest.MonkeyPatch
) -> Iterator[tuple[Server, str, str]]:
    """A web process without a worker, the address of its link, and the database."""
    monkeypatch.setitem(os.environ, "FIRETHREAD_LINK_TOKEN", SHARED_WORD)
    link = f"127.0.0.1:{free_port()}"
    server = Server(tmp_path / "data", ["--no-worker", "--database", postgres_url, "--link", link])
    yield server.start(), link, postgres_url
    server.stop()


def walk(post: Post, incident: str, second: int) -> int:
    """A responder makes a step; the log entry in which it stands."""
    step = {"kind": "displacement", "t": 1000.0 + second, "node": "ff1", "delta_m": [1.0, 0.0, 0.0]}
    return int(str(post.telemetry(incident, f"step-{second}", [step])["seq"]))


def test_a_worker_that_comes_later_finds_the_log_and_one_that_is_replaced_is_not_missed(
    apart: tuple[Server, str, str],
) -> None:
    server, link, database = apart
    post = Post(server.url)
    incident = post.open_incident()
    base = {"kind": "node", "t": 1000.0, "node": "base", "role": "base", "position_m": [0, 0, 0]}
    post.telemetry(incident, "base", [base])
    for second in range(5):
        newest = walk(post, incident, second)
    assert post.http.get("/incidents").status_code == 200
    assert post.frame(incident)["seq"] == 0, "somebody estimated without a worker"

    with worker(database, link):
        assert post.frame(incident, min_seq=newest, timeout_s=30)["seq"] == newest
    # Nobody estimates now; telemetry is taken all the same.
    newest = walk(post, incident, 5)
    eventually(lambda: not readiness(server)["worker"])
    with worker(database, link):
        frame = post.frame(incident, min_seq=newest, timeout_s=30)
    nodes = frame["nodes"]
    assert isinstance(nodes, list)
    walker = next(node for node in nodes if node["node"] == "ff1")
    assert walker["position_m"][0] == pytest.approx(6.0, abs=1.0)


def test_while_the_only_worker_hangs_readiness_and_frames_tell_and_it_goes_on_when_it_wakes(
    apart: tuple[Server, str, str],
) -> None:
    server, link, database = apart
    post = Post(server.url)
    incident = post.open_incident()
    with worker(database, link) as hangs:
        post.frame(incident, min_seq=walk(post, incident, 0))
        hangs.send_signal(signal.SIGSTOP)
        newest = walk(post, incident, 1)
        eventually(lambda: not readiness(server)["worker"], within_s=15.0)
        notices = post.frame(incident)["notices"]
        assert isinstance(notices, list)
        assert "estimator_behind" in [notice["code"] for notice in notices]
        hangs.send_signal(signal.SIGCONT)
        post.frame(incident, min_seq=newest)
        eventually(lambda: readiness(server)["worker"])


def test_a_worker_that_hung_gives_way_to_the_one_that_has_taken_its_place_and_can_take_it_again(
    apart: tuple[Server, str, str], tmp_path: Path
) -> None:
    server, link, database = apart
    post = Post(server.url)
    incident = post.open_incident()
    says = tmp_path / "first.stderr"
    with worker(database, link, says) as first:
        post.frame(incident, min_seq=walk(post, incident, 0))
        with worker(database, link) as second:
            eventually(lambda: workers_of(server) == 2, within_s=60.0)
            first.send_signal(signal.SIGSTOP)
            post.frame(incident, min_seq=walk(post, incident, 1))
            assert epoch_of(database, incident) == 2
            first.send_signal(signal.SIGCONT)
            eventually(lambda: "another worker has taken the incident" in says.read_text())
            eventually(lambda: workers_of(server) == 2)
            post.frame(incident, min_seq=walk(post, incident, 2))
            assert epoch_of(database, incident) == 2
            second.kill()
            post.frame(incident, min_seq=walk(post, incident, 3))
        assert epoch_of(database, incident) == 3
    assert first.returncode == 0


def workers_of(server: Server) -> int:
    """How many workers the web process says are connected."""
    with Post(server.url).http as http:
        text = http.get(server.url + "/metrics").text
    return int(float(text.split("\nfirethread_link_workers ")[1].split()[0]))


def epoch_of(database: str, incident: str) -> int:
    """How often an incident has been taken."""
    engine = sa.create_engine(database)
    with engine.connect() as connection:
        query = sa.text("SELECT epoch FROM leases WHERE incident = :incident")
        epoch = connection.execute(query, {"incident": incident}).scalar_one()
    engine.dispose()
    return int(epoch)


def test_a_worker_without_the_shared_word_is_turned_away(
    apart: tuple[Server, str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    server, link, database = apart
    monkeypatch.setitem(os.environ, "FIRETHREAD_LINK_TOKEN", "another-word")
    with worker(database, link) as process:
        assert process.poll() is None
        with pytest.raises(AssertionError):
            eventually(lambda: readiness(server)["worker"], within_s=3.0)


def test_a_postgres_whose_disk_is_full_is_told_until_there_is_room_again(
    apart: tuple[Server, str, str],
) -> None:
    server, _, database = apart
    post = Post(server.url)
    incident = post.open_incident()
    walk(post, incident, 0)
    assert post.http.get(server.url + "/readyz").status_code == 200

    admin = sa.create_engine(database, isolation_level="AUTOCOMMIT")
    with admin.connect() as connection:
        for statement in FULL:
            connection.execute(sa.text(statement))
    step = {"gateway": "engine-7", "batch": "step-1", "readings": []}
    refused = post.http.post(f"/incidents/{incident}/telemetry", json=step)
    unready = post.http.get(server.url + "/readyz")
    assert (refused.status_code, unready.status_code) == (503, 503)
    assert "No space left on device" in unready.json()["detail"]
    assert "retry-after" in unready.headers

    with admin.connect() as connection:
        connection.execute(sa.text("DROP TRIGGER full_disk ON batches"))
    admin.dispose()
    assert post.http.post(f"/incidents/{incident}/telemetry", json=step).status_code == 202
    assert post.http.get(server.url + "/readyz").status_code == 200


def test_one_batch_that_several_web_processes_take_at_once_is_in_the_log_once(
    apart: tuple[Server, str, str], tmp_path: Path
) -> None:
    first, _, database = apart
    incident = Post(first.url).open_incident()
    with running(tmp_path / "second", "--no-worker", "--database", database) as second:

        def post_all(server: Server) -> list[dict[str, object]]:
            with contextlib.closing(Post(server.url).http) as http:
                sent = [{"gateway": "g", "batch": f"b{number}", "readings": []} for number in range(50)]
                return [http.post(f"/incidents/{incident}/telemetry", json=one).json() for one in sent]

        with ThreadPoolExecutor(4) as gateways:
            answers = list(gateways.map(post_all, [first, second, first, second]))
    for same in zip(*answers, strict=True):
        assert len({answer["seq"] for answer in same}) == 1
        assert sorted(bool(answer["duplicate"]) for answer in same) == [False, True, True, True]
    assert len(Post(first.url).log(incident)) == 50


def readiness(server: Server) -> dict[str, bool]:
    """What `/readyz` says."""
    with Post(server.url).http as http:
        return dict(http.get(server.url + "/readyz").json())
