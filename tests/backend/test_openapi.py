"""The OpenAPI document: all that somebody has who writes a client from it."""

import socket
from collections.abc import Iterator, Sequence
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import APIWebSocketRoute

from backend.main import build_app
from backend.settings import Settings


@pytest.fixture(scope="module")
def app(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FastAPI]:
    with socket.create_server(("127.0.0.1", 0)) as link:
        yield build_app(Settings(data=tmp_path_factory.mktemp("data")), token=None, link=link, link_token="")


@pytest.fixture(scope="module")
def document(app: FastAPI) -> dict[str, Any]:
    return app.openapi()


def sockets(routes: Sequence[object]) -> Iterator[APIWebSocketRoute]:
    """The sockets among routes, those of routers in them included."""
    for route in routes:
        if isinstance(route, APIWebSocketRoute):
            yield route
        elif (router := getattr(route, "original_router", None)) is not None:
            yield from sockets(router.routes)


def operations(document: dict[str, Any]) -> Iterator[tuple[str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield f"{method} {path}", operation


def test_every_socket_is_told_of_with_its_parameters(app: FastAPI, document: dict[str, Any]) -> None:
    told = document["info"]["description"]
    routes = list(sockets(app.routes))
    assert len(routes) == 2
    for route in routes:
        line = next(line for line in told.splitlines() if f"WS {route.path}?" in line)
        for field in route.dependant.query_params:
            assert f"{field.alias}=" in line, (route.path, field.alias)


def test_every_parameter_is_described(document: dict[str, Any]) -> None:
    bare = [
        (name, parameter["name"])
        for name, operation in operations(document)
        for parameter in operation.get("parameters", [])
        if not parameter.get("description")
    ]
    assert bare == []


def test_a_refusal_is_described_where_it_may_come_and_nowhere_else(document: dict[str, Any]) -> None:
    def with_status(status: str) -> set[str]:
        named = {name for name, operation in operations(document) if status in operation["responses"]}
        return {name.replace("/api/v1/incidents/{incident}", "…") for name in named}

    assert with_status("409") == {
        "patch …",
        "post …/telemetry",
        *(f"get …/{x}" for x in ("relative", "evidence", "advice")),
    }
    assert with_status("504") == {f"get …/{x}" for x in ("frame", "relative", "tracks", "evidence", "advice")}
    assert with_status("415") == {
        "patch …",
        "post …/telemetry",
        "post /api/v1/incidents",
        "post /api/v1/session",
    }


def test_every_refusal_has_one_form(document: dict[str, Any]) -> None:
    form = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}
    others = [
        (name, status)
        for name, operation in operations(document)
        for status, answer in operation["responses"].items()
        if status >= "400" and answer["content"] != form
    ]
    assert others == []
