"""How requests are refused that no route has understood."""

import httpx2
import pytest

from tests.running import Server

FORM = {"content-type": "application/x-www-form-urlencoded"}
JSON = {"content-type": "application/json"}


@pytest.mark.parametrize(
    ("body", "headers", "status", "said"),
    [
        (b'{"name": "Drill", "clock": "live"}', FORM, 415, "application/json"),
        (b'{"name": "Drill", "clock": "live"}', {}, 415, "application/json"),
        (b'{"name": "Drill"', JSON, 400, "no JSON"),
        (b'{"name": "\xff", "clock": "live"}', JSON, 400, "UTF-8"),
        (b"[]", JSON, 422, "dictionary"),
        (b'{"name": " ", "clock": "live"}', JSON, 422, "body.name: nothing of this name can be seen"),
        (b"", JSON, 422, "required"),
    ],
)
def test_a_body_is_refused_for_what_is_wrong_with_it(
    server: Server, body: bytes, headers: dict[str, str], status: int, said: str
) -> None:
    answer = httpx2.post(f"{server.url}/api/v1/incidents", content=body, headers=headers)
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")
    assert said in answer.json()["detail"]


@pytest.mark.parametrize("method", ["GET", "POST", "PATCH", "DELETE"])
@pytest.mark.parametrize("path", ["incidents/", "incidents/x/telemetry/", "nowhere"])
def test_where_the_api_has_no_page_none_is_found_by_any_method(
    server: Server, method: str, path: str
) -> None:
    answer = httpx2.request(method, f"{server.url}/api/v1/{path}")
    assert (answer.status_code, answer.json()["title"]) == (404, "There is nothing under that name")
    assert "/docs" in answer.json()["detail"]
    assert "allow" not in answer.headers


@pytest.mark.parametrize(
    ("path", "allowed"), [("api/v1/incidents", "GET, POST"), ("assets/screen.js", "GET, HEAD")]
)
def test_a_page_says_which_methods_it_takes(server: Server, path: str, allowed: str) -> None:
    answer = httpx2.delete(f"{server.url}/{path}")
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)
    assert f"it takes {allowed}" in answer.json()["detail"]


@pytest.mark.parametrize("method", ["GET", "POST"])
@pytest.mark.parametrize("socket", ["live", "replay"])
def test_who_asks_for_a_socket_as_for_a_page_hears_how_to_open_it(
    server: Server, method: str, socket: str
) -> None:
    answer = httpx2.request(method, f"{server.url}/api/v1/incidents/x/{socket}")
    assert (answer.status_code, answer.headers["upgrade"]) == (426, "websocket")
    assert answer.headers["content-type"] == "application/problem+json"
    assert "a proxy on the way" in answer.json()["detail"]
