"""Processes are killed at random moments under load: nothing acknowledged is lost, no track changes."""

import random
import threading
import time
from pathlib import Path

import httpx2
import msgspec
import pytest

from estimator.simulate import scenario
from tests.running import Post, Server, eventually, running

ROUNDS = 20
SECONDS_PER_BATCH = 0.5
PAUSE_S = 0.02


class StubbornGateway(threading.Thread):
    """Posts its batches one by one and sends each again until it is acknowledged."""

    def __init__(self, server: Server, incident: str, name: str, batches: list[bytes]) -> None:
        super().__init__(name=name, daemon=True)
        self.server, self.incident, self.batches = server, incident, batches
        self.acknowledged: dict[str, int] = {}
        self.finish = threading.Event()
        self.sent_again = 0
        self.strange: list[str] = []

    def run(self) -> None:
        with httpx2.Client(timeout=5.0) as http:
            for number, readings in enumerate(self.batches):
                if self.finish.is_set():
                    return
                self._until_acknowledged(http, f"{self.name}-{number}", readings)
                time.sleep(PAUSE_S)

    def _until_acknowledged(self, http: httpx2.Client, batch: str, readings: bytes) -> None:
        body = b'{"gateway":"%s","batch":"%s","readings":%s}' % (self.name.encode(), batch.encode(), readings)
        while True:
            try:
                response = http.post(
                    f"{self.server.url}/api/v1/incidents/{self.incident}/telemetry",
                    content=body,
                    headers={"content-type": "application/json"},
                )
            except httpx2.TransportError:
                self.sent_again += 1
                time.sleep(0.05)
                continue
            if response.status_code == 202:
                self.acknowledged[batch] = response.json()["seq"]
                return
            if response.status_code not in {429, 503}:
                self.strange.append(f"{response.status_code} {response.text}")
                return
            time.sleep(0.05)


def batches_of(crew: int) -> list[bytes]:
    """Every second node's part of an office fire, half a second a batch."""
    readings = sorted(scenario("office-fire", seed=7).readings, key=lambda reading: reading.t)
    mine = [r for r in readings if (hash_of(getattr(r, "node", None) or r.a) % 2) == crew]  # type: ignore[union-attr]
    cut: dict[int, list[object]] = {}
    for reading in mine:
        cut.setdefault(int(reading.t / SECONDS_PER_BATCH), []).append(reading)
    return [msgspec.json.encode(cut[key]) for key in sorted(cut)]


def hash_of(node: str) -> int:
    """A stable number of a name."""
    return sum(node.encode())


@pytest.mark.timeout(600)
def test_acknowledged_batches_survive_and_tracks_do_not_change(tmp_path: Path) -> None:
    moments = random.Random(20261121)
    server = Server(tmp_path / "data").start()
    try:
        incident = Post(server.url).open_incident("kill test")
        gateways = [
            StubbornGateway(server, incident, name, batches_of(part))
            for part, name in enumerate(("engine-7", "ladder-3"))
        ]
        for gateway in gateways:
            gateway.start()
        for kill in range(ROUNDS):
            time.sleep(moments.uniform(0.1, 1.5))
            what = ("worker", "web", "both")[kill % 3]
            if what in {"worker", "both"}:
                eventually(server.kill_worker)
            if what in {"web", "both"}:
                server.kill_web()
                server.start()
        for gateway in gateways:
            gateway.finish.set()
            gateway.join()
            assert gateway.strange == []
        assert sum(gateway.sent_again for gateway in gateways) > 0, "no post was ever interrupted: not a test"

        post = Post(server.url)
        lines = [msgspec.json.decode(line) for line in post.log(incident)]
        assert [line["seq"] for line in lines] == list(range(1, len(lines) + 1))
        for gateway in gateways:
            mine = [(line["batch"], line["seq"]) for line in lines if line["gateway"] == gateway.name]
            assert len(mine) == len(dict(mine)), "a batch stands in the log twice"
            assert [batch for batch, _ in mine] == [f"{gateway.name}-{n}" for n in range(len(mine))]
            assert dict(mine) == gateway.acknowledged

        post.frame(incident, min_seq=len(lines), timeout_s=60)
        assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
        newest_t = max(reading["t"] for line in lines for reading in line["readings"])
        disturbed = eventually_settled(post, incident, newest_t)
    finally:
        server.stop()

    with running(tmp_path / "undisturbed") as calm:
        post = Post(calm.url)
        again = post.open_incident("kill test")
        for line in lines:
            post.telemetry(again, line["batch"], line["readings"], gateway=line["gateway"])
        post.frame(again, min_seq=len(lines), timeout_s=60)
        assert post.http.patch(f"/incidents/{again}", json={"state": "closed"}).status_code == 200
        assert eventually_settled(post, again, newest_t) == disturbed


def eventually_settled(post: Post, incident: str, newest_t: float) -> bytes:
    """The tracks of a closed incident once the worker has written its last row, with its newest reading."""

    def same_twice() -> bytes | None:
        if post.http.get(f"/incidents/{incident}").json()["last_t"] < newest_t:
            return None
        before = post.tracks(incident)
        time.sleep(1.5)
        return before if before == post.tracks(incident) and len(before) > 1000 else None

    settled = eventually(same_twice, within_s=60)
    assert isinstance(settled, bytes)
    return settled
