"""The live socket of a real server."""

import contextlib
import socket
import time
from collections.abc import Iterator

import msgspec
import pytest
from websockets.exceptions import ConnectionClosed

from tests.backend.refusing import assert_refused
from tests.running import READY_WITHIN_S, Post, Server, eventually, running
from tests.watching import watching

IDLE_SOCKETS = 1_100
ROUNDS = 40


def fix(t: float, east_m: float = 1.0, node: str = "ff1") -> dict[str, object]:
    return {"kind": "position", "t": t, "node": node, "position_m": [east_m, 2.0, 0.0], "sigma_m": [1, 1, 1]}


def test_what_a_gateway_posts_is_seen_on_the_screen(server: Server, post: Post) -> None:
    incident = post.open_incident()
    with watching(server.url, f"/incidents/{incident}/live") as screen:
        first = screen.hear()
        assert (first["type"], first["incident"], first["seq"], first["nodes"]) == ("frame", incident, 0, [])
        post.telemetry(incident, "b1", [fix(10.0), fix(10.0, 5.0, "ff2")])
        screen.until(lambda m: m["type"] == "delta" and m["seq"] == 1)
        assert set(screen.nodes) == {"ff1", "ff2"}
        post.telemetry(incident, "b2", [fix(11.0, 3.0)])
        delta = screen.until(lambda m: m["type"] == "delta" and m["seq"] == 2)
        assert [node["node"] for node in delta["nodes"]] == ["ff1"]
        assert screen.nodes == {node["node"]: node for node in post.frame(incident)["nodes"]}  # type: ignore[attr-defined]  # JSON


def test_a_screen_that_comes_later_begins_with_the_whole_frame(server: Server, post: Post) -> None:
    incident = post.open_incident()
    post.telemetry(incident, "b1", [fix(10.0)])
    post.frame(incident, min_seq=1)
    with watching(server.url, f"/incidents/{incident}/live?after=1") as screen:
        assert [node["node"] for node in screen.hear()["nodes"]] == ["ff1"]


def test_every_screen_hears_something_every_two_seconds(server: Server, post: Post) -> None:
    incident = post.open_incident()
    with watching(server.url, f"/incidents/{incident}/live") as screen:
        screen.hear()
        for _ in range(3):
            screen.until(lambda m: m["type"] == "heartbeat", within_s=2.0)


def test_an_unknown_incident_is_told_as_such(server: Server) -> None:
    with watching(server.url, "/incidents/nobody/live") as screen, pytest.raises(ConnectionClosed) as closed:
        screen.hear()
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 4404


@pytest.mark.parametrize(
    ("path", "status", "said"),
    [
        ("/incidents/nobody/live?after=-1", 422, "query.after"),
        ("/incidents/nobody/live?after=abc", 422, "query.after"),
        ("/incidents/nobody/life", 404, "/api/v1/incidents/nobody/life"),
    ],
)
def test_a_socket_that_is_refused_is_told_why(server: Server, path: str, status: int, said: str) -> None:
    assert_refused(server, path, status, said)


@pytest.mark.parametrize(
    "header", ["Content-Length: 5", "Transfer-Encoding: chunked", "Cookie: " + 9_000 * "x"]
)
def test_what_is_no_handshake_is_refused_and_holds_no_connection(server: Server, header: str) -> None:
    handshake = _handshake(server, "/incidents/nobody/live").replace(
        b"Upgrade:", f"{header}\r\nUpgrade:".encode()
    )
    with socket.create_connection(("127.0.0.1", server.port), timeout=10) as connection:
        connection.sendall(handshake)
        answer = b"".join(iter(lambda: connection.recv(4096), b""))
    head, _, body = answer.partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 400 ")
    assert b"content-type: application/problem+json" in head
    assert msgspec.json.decode(body)["status"] == 400


def test_a_closed_incident_shows_its_last_frame_and_beats_on(server: Server, post: Post) -> None:
    incident = post.open_incident()
    post.telemetry(incident, "b1", [fix(10.0)])
    post.frame(incident, min_seq=1)
    post.http.patch(f"/incidents/{incident}", json={"state": "closed"})
    with watching(server.url, f"/incidents/{incident}/live") as screen:
        assert [node["node"] for node in screen.hear()["nodes"]] == ["ff1"]
        screen.until(lambda m: m["type"] == "heartbeat")


def test_a_screen_that_does_not_read_stops_nobody_and_then_sees_the_newest(
    server: Server, post: Post
) -> None:
    incident = post.open_incident()
    nodes = [f"bc{i}" for i in range(80)]
    path = f"/incidents/{incident}/live"
    with watching(server.url, path) as quick, _deaf(server, path) as deaf:
        quick.hear()
        for second in range(1, ROUNDS + 1):
            t0 = time.monotonic()
            post.telemetry(
                incident, f"b{second}", [fix(100.0 + second, float(second), node) for node in nodes]
            )
            quick.until(lambda m, seq=second: m["type"] != "heartbeat" and m["seq"] == seq, within_s=5.0)  # type: ignore[misc]  # mypy cannot infer a lambda with defaults
            assert time.monotonic() - t0 < 5.0
        backlog = _read_all(deaf)
    whole = sum(len(str(message)) for message in quick.messages)
    assert backlog.count(b'"type":"delta"') < ROUNDS, "every delta was kept for a screen that did not read"
    assert len(backlog) < whole
    assert backlog.rindex(b'"seq":%d' % ROUNDS) > 0


@contextlib.contextmanager
def _deaf(server: Server, path: str) -> Iterator[socket.socket]:
    """A connection that has shaken hands and then reads nothing."""
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16 * 1024)
        connection.connect(("127.0.0.1", server.port))
        connection.sendall(_handshake(server, path))
        yield connection


def _handshake(server: Server, path: str) -> bytes:
    return (
        f"GET /api/v1{path} HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
        "Sec-WebSocket-Version: 13\r\n\r\n"
    ).encode()


def _read_all(connection: socket.socket) -> bytes:
    """Everything that comes until the newest entry has been seen and only heartbeats follow."""
    connection.settimeout(5.0)
    heard = b""
    while b'"seq":%d,"t"' % ROUNDS not in heard or not heard.rstrip().endswith(b'"seq":%d}' % ROUNDS):
        heard += connection.recv(1 << 20)
    return heard


def test_idle_sockets_do_not_end_the_server(server: Server, post: Post) -> None:
    incident = post.open_incident()
    path = f"/incidents/{incident}/live"
    with contextlib.ExitStack() as stack:
        for _ in range(IDLE_SOCKETS):
            connection = stack.enter_context(socket.create_connection(("127.0.0.1", server.port)))
            connection.sendall(_handshake(server, path))
        with watching(server.url, path) as screen:
            screen.hear()
            post.telemetry(incident, "b1", [fix(10.0)])
            screen.until(lambda m: m["type"] == "delta" and m["seq"] == 1)
        assert connection.recv(12) == b"HTTP/1.1 101"
    with watching(server.url, path) as screen:
        assert [node["node"] for node in screen.hear()["nodes"]] == ["ff1"]
        assert post.http.get("/incidents").status_code == 200


def test_dots_age_while_the_worker_is_dead(server: Server, post: Post) -> None:
    incident = post.open_incident(clock="live", settings={"stale_after_s": 4.0, "lost_after_s": 7.0})
    with watching(server.url, f"/incidents/{incident}/live") as screen:
        post.telemetry(incident, "b1", [fix(time.time())])
        screen.until(lambda m: m["type"] == "delta" and m["nodes"])
        eventually(server.kill_worker)
        screen.until(lambda _: screen.nodes["ff1"]["status"] == "lost")
    statuses = [n["status"] for m in screen.messages if m["type"] != "heartbeat" for n in m["nodes"]]
    assert list(dict.fromkeys(statuses)) == ["live", "stale", "lost"]


def test_the_picture_goes_on_after_the_worker_has_come_back(server: Server, post: Post) -> None:
    incident = post.open_incident()
    post.telemetry(incident, "b1", [fix(10.0)])
    post.frame(incident, min_seq=1)
    with watching(server.url, f"/incidents/{incident}/live") as screen:
        screen.hear()
        eventually(server.kill_worker)
        post.telemetry(incident, "b2", [fix(11.0, 7.0)])
        screen.until(lambda m: m["type"] == "delta" and m["seq"] == 2, within_s=READY_WITHIN_S)


def test_a_server_that_stops_says_so(tmp_path_factory: pytest.TempPathFactory) -> None:
    with running(tmp_path_factory.mktemp("stop") / "data") as server:
        post = Post(server.url)
        incident = post.open_incident()
        post.http.close()
        with watching(server.url, f"/incidents/{incident}/live") as screen:
            screen.hear()
            began = time.monotonic()
            server.stop()
            assert time.monotonic() - began < 10.0
            with pytest.raises(ConnectionClosed) as closed:
                screen.until(lambda _: False)
    assert closed.value.rcvd is not None
    assert closed.value.rcvd.code == 1001
