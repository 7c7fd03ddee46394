"""The demo plays its incident through a real HTTP server, however bad the link is."""

import asyncio
import signal
import subprocess
import sys
import time
from collections.abc import Callable

import pytest

from backend.demo import play, playing
from backend.demo.client import Client, Refused
from backend.errors import CommandRefused
from estimator.simulate import scenario
from tests.backend.demo.field_server import FieldServer

FAST = 2_000.0


def eventually(holds: Callable[[], bool], within_s: float = 30.0) -> None:
    deadline = time.monotonic() + within_s
    while not holds():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def played(server: FieldServer, name: str = "paper-a", seed: int = 1) -> None:
    asyncio.run(play(server.url, None, name, seed, speed=FAST, once=True))


def test_every_reading_of_the_scenario_arrives_once_and_in_order(field_server: FieldServer) -> None:
    played(field_server)
    arrived = [r for b in field_server.posted("i1", "engine-1") for r in b["readings"]]
    expected = scenario("paper-a", 1).readings
    assert len(arrived) == len(expected)
    start = arrived[0]["t"]
    for got, want in zip(arrived, expected, strict=True):
        assert got["t"] - start == pytest.approx(want.t, abs=0.002)
        assert (got["kind"], got.get("b")) == (want.__struct_config__.tag, getattr(want, "b", None))


def test_readings_are_dated_from_now_on_and_no_more_than_a_minute_ahead_of_sending(
    field_server: FieldServer,
) -> None:
    before = time.time()
    played(field_server)
    for batch in field_server.posted("i1", "engine-1"):
        for reading in batch["readings"]:
            assert before - 0.01 <= reading["t"] <= batch["sent"] + 0.01
            if "from_t" in reading:
                assert reading["t"] - reading["from_t"] == pytest.approx(1.0, abs=0.002)


def test_what_is_refused_or_lost_on_the_way_is_sent_again_with_the_same_key(
    field_server: FieldServer,
) -> None:
    field_server.faults.extend(["", "503", "", "lost", "", "429", "lost", "lost", ""])
    played(field_server)
    tries: dict[str, set[bytes]] = {}
    for _, batch, body in field_server.requests:
        tries.setdefault(batch, set()).add(body)
    assert len(field_server.requests) == len(tries) + 5
    assert all(len(bodies) == 1 for bodies in tries.values())
    posted = [b["batch"] for b in field_server.posted("i1", "engine-1")]
    assert posted == sorted(tries)
    assert sum(len(b["readings"]) for b in field_server.posted("i1", "engine-1")) == len(
        scenario("paper-a", 1).readings
    )


def test_retry_after_is_waited_for(field_server: FieldServer) -> None:
    field_server.faults.extend(["503"])
    began = time.monotonic()
    played(field_server)
    assert time.monotonic() - began >= 1.0


def test_it_waits_until_the_server_is_ready(field_server: FieldServer) -> None:
    field_server.not_ready = 2
    played(field_server)
    assert list(field_server.incidents) == ["i1"]


def test_the_incident_has_the_scenarios_storeys_and_is_closed_at_its_end(field_server: FieldServer) -> None:
    played(field_server, "office-fire")
    incident = field_server.incidents["i1"]
    assert incident["name"] == "Office fire (demo)"
    assert incident["clock"] == "recorded"
    assert [level["up_m"] for level in incident["levels"]] == [0.0, 3.4, 6.8]
    assert incident["state"] == "closed"
    gateways = {gateway for _, gateway, _ in field_server.batches}
    assert gateways == {"engine-7", "ladder-3", "uav-1", "command-post"}


def test_incidents_that_an_earlier_demo_left_open_are_closed_and_others_are_not(
    field_server: FieldServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(playing, "LEFT_AFTER_S", 0.1)
    name = scenario("paper-a", 1).incident
    left, real = {"name": f"{name} (demo)", "state": "active"}, {"name": name, "state": "active"}
    field_server.incidents = {"i1": left | {"id": "i1"}, "i2": real | {"id": "i2"}}
    played(field_server)
    assert [i["state"] for i in field_server.incidents.values()] == ["closed", "active", "closed"]


def test_an_incident_that_another_demo_plays_goes_on(
    field_server: FieldServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(playing, "LEFT_AFTER_S", 4.0)

    async def play_twice() -> None:
        first = asyncio.create_task(play(field_server.url, None, "paper-a", 1))
        await asyncio.to_thread(eventually, lambda: bool(field_server.batches))
        await play(field_server.url, None, "paper-a", 2, speed=FAST, once=True)
        assert [one["state"] for one in field_server.incidents.values()] == ["active", "closed"]
        first.cancel()
        await asyncio.gather(first, return_exceptions=True)

    asyncio.run(asyncio.wait_for(play_twice(), 60.0))


def test_when_the_incident_is_closed_by_others_the_next_one_begins(
    field_server: FieldServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(playing, "BETWEEN_S", 0.0)

    async def close_the_first() -> None:
        task = asyncio.create_task(play(field_server.url, None, "office-fire", 1))
        await asyncio.to_thread(eventually, lambda: bool(field_server.batches))
        field_server.incidents["i1"]["state"] = "closed"
        await asyncio.to_thread(eventually, lambda: "i2" in field_server.incidents)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    asyncio.run(asyncio.wait_for(close_the_first(), 20.0))
    assert field_server.incidents["i2"]["clock"] == "live"
    assert field_server.incidents["i2"]["state"] == "closed"


def test_stopped_while_its_incident_is_being_created_it_closes_that_one(field_server: FieldServer) -> None:
    field_server.creating_lasts_s = 0.3

    async def stop_it() -> None:
        task = asyncio.create_task(play(field_server.url, None, "office-fire", 1))
        await asyncio.to_thread(eventually, lambda: "i1" in field_server.incidents)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)

    asyncio.run(asyncio.wait_for(stop_it(), 20.0))
    assert field_server.incidents["i1"]["state"] == "closed"


def test_sigterm_ends_it_and_closes_its_incident(field_server: FieldServer) -> None:
    call = f"play_until_stopped({field_server.url!r}, 'secret', 'office-fire', 1)"
    process = subprocess.Popen([sys.executable, "-c", f"from backend.demo import play_until_stopped; {call}"])
    eventually(lambda: bool(field_server.batches))
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=10.0) == 0
    assert field_server.incidents["i1"]["state"] == "closed"
    assert field_server.tokens == {"Bearer secret"}


def test_a_refused_batch_ends_the_demo_with_the_servers_words(field_server: FieldServer) -> None:
    async def post_to_nowhere() -> None:
        client = Client(field_server.url, None)
        try:
            await client.ask("PUT", "/api/v1/incidents")
        finally:
            await client.close()

    with pytest.raises(Refused, match="501"):
        asyncio.run(post_to_nowhere())


@pytest.mark.parametrize("speed", [0.0, -1.0, float("nan")])
def test_a_speed_that_is_none_is_refused(speed: float) -> None:
    with pytest.raises(CommandRefused, match="speed"):
        asyncio.run(play("http://127.0.0.1:9", None, "paper-a", 1, speed=speed))
