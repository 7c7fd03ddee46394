"""Sockets that a server refuses to open."""

import msgspec
import pytest
from websockets.exceptions import InvalidStatus

from backend.errors import PROBLEM_MEDIA_TYPE
from tests.running import Server
from tests.watching import watching


def assert_refused(server: Server, path: str, status: int, said: str) -> None:
    """The handshake is answered with a problem of this status, whose detail holds these words."""
    with pytest.raises(InvalidStatus) as refused, watching(server.url, path):
        pass
    response = refused.value.response
    assert (response.status_code, response.headers["content-type"]) == (status, PROBLEM_MEDIA_TYPE)
    problem = msgspec.json.decode(bytes(response.body or b""))
    assert problem["status"] == status
    assert said in problem["detail"]
