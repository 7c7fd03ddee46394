"""The replay socket of a real server."""

import itertools
import time

import msgspec
import pytest
from websockets.exceptions import ConnectionClosed

from tests.backend.refusing import assert_refused
from tests.running import Post, Server, eventually
from tests.watching import watching

START_T, SECONDS = 1_000.0, 30


@pytest.fixture(scope="module")
def path(post: Post) -> str:
    """The replay of an incident in which a responder has walked for half a minute."""
    incident = post.open_incident("a walk")
    for second in range(SECONDS + 1):
        fix = {"kind": "position", "t": START_T + second, "node": "ff1", "position_m": [second, 0, 0]}
        post.telemetry(incident, f"b{second}", [fix | {"sigma_m": [1, 1, 1]}])
    assert post.http.patch(f"/incidents/{incident}", json={"state": "closed"}).status_code == 200
    eventually(lambda: post.tracks(incident).count(b"[10") >= SECONDS)
    return f"/incidents/{incident}/replay"


def test_a_replay_shows_what_the_frames_of_its_seconds_are(server: Server, post: Post, path: str) -> None:
    incident = path.split("/")[2]
    with watching(server.url, f"{path}?from={START_T + 5}&to={START_T + 25}&speed=16") as screen:
        first = screen.hear()
        assert (first["type"], first["t"]) == ("frame", pytest.approx(START_T + 5, abs=1.0))
        last = screen.until(lambda m: m["type"] == "heartbeat" and m["ended"])
    assert last["t"] == START_T + 25
    shown = [m for m in screen.messages if m["type"] != "heartbeat"]
    assert [m["t"] for m in shown] == sorted(m["t"] for m in shown)
    for message in shown:
        frame = post.frame(incident, t=message["t"])
        known = {node["node"]: node for node in frame["nodes"]}  # type: ignore[attr-defined]  # JSON
        assert message["seq"] == frame["seq"]
        assert all(known[node["node"]] == node for node in message["nodes"])


def test_a_call_that_its_unit_cleared_is_replayed_until_a_person_has_acknowledged_it(
    server: Server, post: Post
) -> None:
    incident = post.open_incident("a mayday")
    for t, state in ((10.0, "raised"), (12.0, "cleared"), (15.0, "acknowledged"), (17.0, "acknowledged")):
        said = {"kind": "alarm", "t": t, "node": "ff1", "alarm": "mayday", "state": state}
        post.telemetry(incident, f"b{t}", [said])
    eventually(lambda: [post.frame(incident, t=t)["seq"] for t in (10.0, 12.0, 16.0)] == [1, 2, 3])
    with watching(server.url, f"/incidents/{incident}/replay?from=10&to=17&speed=8") as screen:
        screen.until(lambda m: m["type"] == "heartbeat" and m["ended"])
    shown = [[a["state"] for a in m["alarms"]] for m in screen.messages if m["type"] in {"frame", "delta"}]
    assert [states for states, _ in itertools.groupby(shown)] == [["raised"], ["cleared"], []]


def test_a_viewer_pauses_seeks_and_changes_speed(server: Server, path: str) -> None:
    with watching(server.url, path) as screen:
        screen.hear()
        screen.say({"pause": True})
        beat = screen.until(lambda m: m["type"] == "heartbeat" and m["paused"])
        again = screen.until(lambda m: m["type"] == "heartbeat")
        assert again["t"] == beat["t"]
        screen.say({"seek": START_T + 20})
        frame = screen.until(lambda m: m["type"] == "frame")
        assert frame["t"] == START_T + 20
        assert frame["nodes"][0]["position_m"][0] == pytest.approx(20.0, abs=3.0)
        screen.say({"speed": 32, "pause": False})
        screen.until(lambda m: m["type"] == "heartbeat" and m["ended"] and m["speed"] == 32)
        screen.say({"seek": START_T + 3})
        screen.until(lambda m: m["type"] == "frame" and m["t"] < START_T + 10)


def test_the_replay_stays_open_after_its_end(server: Server, path: str) -> None:
    with watching(server.url, f"{path}?from={START_T + SECONDS}") as screen:
        for _ in range(3):
            screen.until(lambda m: m["type"] == "heartbeat" and m["ended"], within_s=3.0)


def test_what_is_not_understood_is_answered_and_changes_nothing(server: Server, path: str) -> None:
    with watching(server.url, path) as screen:
        screen.hear()
        for nonsense in ("go", {"seek": "noon"}, {"speed": -1}, {}):
            screen.say(nonsense)
            error = screen.until(lambda m: m["type"] == "error")
            assert "send" in error["detail"]
        screen.until(lambda m: m["type"] == "heartbeat" and m["speed"] == 1.0)


def test_an_unknown_incident_is_told_as_such(server: Server) -> None:
    with (
        watching(server.url, "/incidents/nobody/replay") as screen,
        pytest.raises(ConnectionClosed) as closed,
    ):
        screen.hear()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4404


@pytest.mark.parametrize("query", ["speed=0", "speed=1000", "from=NaN", "to=-1", "from=noon"])
def test_a_wrong_parameter_opens_no_socket_and_is_named(server: Server, path: str, query: str) -> None:
    assert_refused(server, f"{path}?{query}", 422, f"query.{query.split('=', maxsplit=1)[0]}")


def test_a_span_that_ends_before_it_begins_opens_no_socket(server: Server, path: str) -> None:
    assert_refused(server, f"{path}?from={START_T + 9}&to={START_T}", 422, "`to` is before `from`")


def test_a_replay_begins_where_the_incident_does_and_not_with_a_unit_that_has_no_clock(
    server: Server, post: Post
) -> None:
    incident = post.open_incident("no clock", clock="live")
    now = float(int(time.time()))
    fix = {"kind": "position", "node": "ff1", "position_m": [1, 2, 0], "sigma_m": [1, 1, 1]}
    for t in (0.0, now - 2.0, now - 1.0):
        post.telemetry(incident, f"b{t}", [fix | {"t": t}])
    eventually(lambda: post.http.get(f"/incidents/{incident}").json()["first_t"] == now - 2.0)
    with watching(server.url, f"/incidents/{incident}/replay") as screen:
        assert screen.hear()["t"] == now - 2.0
    for view in ("live", "smoothed"):
        track = msgspec.json.decode(post.tracks(incident, view=view))["tracks"][0]
        assert track["points"][0][0] == now - 2.0
    assert msgspec.json.decode(post.tracks(incident, **{"from": 0, "to": 9}))["tracks"][0]["points"]


def test_an_incident_without_readings_can_be_replayed(server: Server, post: Post) -> None:
    incident = post.open_incident("silent")
    with watching(server.url, f"/incidents/{incident}/replay") as screen:
        assert screen.hear()["nodes"] == []
        screen.until(lambda m: m["type"] == "heartbeat" and m["ended"])
