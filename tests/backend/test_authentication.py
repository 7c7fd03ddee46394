"""Who is let in."""

import base64
import socket
from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from backend.authentication import access_token
from tests.running import Server

KEY = base64.b64encode(bytes(16))


class GuardedServer(Server):
    """A server that asks for the access token."""

    access = ()


@pytest.fixture(scope="module")
def guarded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    server = GuardedServer(tmp_path_factory.mktemp("guarded") / "data", ["--no-worker"])
    yield server.start()
    server.stop()


def ask(server: Server, path: str, **options: str) -> httpx2.Response:
    return httpx2.get(server.url + path, headers=options)


def test_nobody_is_let_in_without_the_token(guarded: Server) -> None:
    refused = ask(guarded, "/api/v1/incidents")
    assert refused.status_code == 401
    assert refused.headers["content-type"] == "application/problem+json"
    assert refused.headers["www-authenticate"].startswith("Bearer")
    assert "access-token" in refused.json()["detail"]


def test_the_token_of_the_data_folder_lets_a_gateway_in(guarded: Server) -> None:
    token = access_token(guarded.data)
    assert ask(guarded, "/api/v1/incidents", authorization=f"Bearer {token}").status_code == 200
    assert ask(guarded, "/api/v1/incidents", authorization=f"Bearer {token}x").status_code == 401


def test_only_the_owner_can_read_the_token(guarded: Server) -> None:
    assert (guarded.data / "access-token").stat().st_mode & 0o077 == 0


def test_a_screen_signs_in_once_and_is_known_by_its_cookie(guarded: Server) -> None:
    with httpx2.Client(base_url=guarded.url) as screen:
        assert screen.post("/api/v1/session", json={"token": "guess"}).status_code == 401
        signed = screen.post("/api/v1/session", json={"token": access_token(guarded.data)})
        assert signed.status_code == 204
        assert "httponly" in signed.headers["set-cookie"].lower()
        assert screen.get("/api/v1/incidents").status_code == 200


def test_sockets_are_guarded_too(guarded: Server) -> None:
    address = guarded.url.replace("http", "ws") + "/api/v1/incidents/none/live"
    for guess in ("", "?token=guess", "?token=guess&after=abc"):
        with pytest.raises(InvalidStatus) as refused, connect(address + guess):
            pass
        response = refused.value.response
        assert (response.status_code, response.headers["content-type"]) == (401, "application/problem+json")
        assert response.headers["www-authenticate"].startswith("Bearer")
        assert b"access-token" in bytes(response.body)


@pytest.mark.parametrize(
    ("header", "status"),
    [
        (b"upgrade: websocket\r\nsec-websocket-version: 13\r\nsec-websocket-key: " + KEY, b"401"),
        (b"upgrade: websocket\r\nsec-websocket-version: 3", b"400"),
        (b"upgrade: h2c", b"401"),
        (b"no HTTP", b"400"),
    ],
)
def test_nobody_without_the_token_fills_the_log(guarded: Server, header: bytes, status: bytes) -> None:
    before = guarded.log.read_text()
    with socket.create_connection(("127.0.0.1", guarded.port), timeout=10) as knocking:
        knocking.sendall(b"GET /api/v1/incidents/none/live HTTP/1.1\r\nhost: x\r\nconnection: upgrade\r\n")
        knocking.sendall(header + b"\r\n\r\n")
        assert knocking.recv(1024).split()[1] == status
    assert ask(guarded, "/healthz").status_code == 200  # what was to be logged before is
    assert guarded.log.read_text() == before


def test_a_program_may_name_the_token_in_a_socket_s_address(guarded: Server) -> None:
    token = access_token(guarded.data)
    with connect(f"{guarded.url.replace('http', 'ws')}/api/v1/incidents/none/live?token={token}") as opened:
        with pytest.raises(ConnectionClosed) as closed:
            opened.recv(timeout=5)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 4404


def test_health_pages_and_the_screen_ask_for_no_token(guarded: Server) -> None:
    for path in ("/healthz", "/readyz", "/metrics", "/openapi.json", "/docs"):
        assert ask(guarded, path).status_code == 200, path


def test_open_access_is_refused_where_others_can_reach_it(tmp_path: Path) -> None:
    server = Server(tmp_path / "data", ["--host", "0.0.0.0"])  # noqa: S104 - that it is refused is the test
    with pytest.raises(AssertionError, match=r"refused on 0\.0\.0\.0"):
        server.start()
