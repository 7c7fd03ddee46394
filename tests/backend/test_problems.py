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
