"""The server that the demo plays to."""

from collections.abc import Iterator

import pytest

from tests.backend.demo.field_server import FieldServer


@pytest.fixture
def field_server() -> Iterator[FieldServer]:
    server = FieldServer()
    yield server
    server.stop()
