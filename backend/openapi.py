"""The OpenAPI document: FastAPI's own, and what it cannot know."""

from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from backend.authentication import PROTECTED_PREFIX, SESSION_PATH, SOCKET_TOKEN, TOKEN_FILE
from backend.ingest import openapi as telemetry
from backend.live.frame import message_schemas
from backend.problems import openapi_responses
from backend.replay.control import FASTEST, SLOWEST
from backend.tracking.evidence_routes import evidence_schemas

DESCRIPTION = f"""
Where every firefighter is inside a burning building, how sure that is, and the way out.

**Conventions.** JSON in UTF-8. Lengths are in m, angles in rad, power in dBm, pressure in Pa. `t` is an
epoch in Unix seconds: the one that a reading refers to, not when it was sent. Positions are east, north, up
(m) from the incident's origin; a covariance is the upper triangle `[ee, en, eu, nn, nu, uu]` (m²).
Identifiers have 1 to 64 of `A-Za-z0-9_.:-`. NaN, infinities, unknown fields and unknown parameters are
refused. A refusal is `application/problem+json` (RFC 9457), and nothing of a refused request is stored.

**Sockets.** What comes over them is in the schema `LiveMessage`. One that cannot show anything is closed
with 4404 (no such incident) or 1013 (try again later). A program that cannot set the `Authorization` header
gives the access token as `?{SOCKET_TOKEN}=`.

- `WS /api/v1/incidents/{{incident}}/live?after=SEQ`: first a whole `frame`, then a `delta` at up to 10 Hz
  and a `heartbeat` at least every 2 s. Who is slow gets the newest state, never a backlog.
- `WS /api/v1/incidents/{{incident}}/replay?from=T&to=T&speed=X`: the same messages, time from the log, at
  {SLOWEST:g} to {FASTEST:g} incident seconds per second. The client may send `{{"seek": T}}`,
  `{{"speed": X}}` and `{{"pause": true}}` or `false`.
"""
"""Markdown: what the document cannot say in schemas. OpenAPI has no word for sockets."""

PROBLEM_SCHEMA: dict[str, Any] = {
    "type": "object",
    "title": "Problem",
    "description": "RFC 9457.",
    "required": ["type", "title", "status", "detail"],
    "properties": {
        "type": {"type": "string"},
        "title": {"type": "string"},
        "status": {"type": "integer"},
        "detail": {"type": "string"},
        "errors": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["code", "message"],
                "properties": {
                    "index": {"type": "integer"},
                    "field": {"type": "string"},
                    "code": {"type": "string"},
                    "message": {"type": "string"},
                },
            },
        },
    },
}


ACCESS_SCHEMES: dict[str, Any] = {
    "accessToken": {
        "type": "http",
        "scheme": "bearer",
        "description": (
            f"The access token of the deployment, from the file `{TOKEN_FILE}` of its data folder. "
            f"A screen that has signed in (`POST {SESSION_PATH}`) carries a cookie instead."
        ),
    }
}
ACCESS: list[dict[str, list[str]]] = [{"accessToken": []}, {}]
"""The token, or nothing: a server started with `--open` asks nobody."""


def install(app: FastAPI) -> None:
    """Have `/openapi.json` answer with the whole document."""

    def whole() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = complete(
                get_openapi(
                    title=app.title, version=app.version, description=app.description, routes=app.routes
                )
            )
        return app.openapi_schema

    app.openapi = whole  # type: ignore[method-assign]  # FastAPI's documented way to extend the document


OF_EVERY_ROUTE = (400, 401, 422, 503)
OF_ONE_INCIDENT = (404,)
OF_A_BODY = (413, 415)
OF_A_CHANGE = (409,)


def complete(document: dict[str, Any]) -> dict[str, Any]:
    """Add what FastAPI cannot know: the raw telemetry route, socket messages, and the form of refusals."""
    schemas = document["components"]["schemas"]
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    schemas["Problem"] = PROBLEM_SCHEMA
    schemas.update(telemetry.openapi_schemas())
    schemas.update(message_schemas())
    schemas.update(evidence_schemas())
    for path, method, operation in _operations(document):
        if path.startswith(PROTECTED_PREFIX):
            _describe_refusals(path, method, operation)
    document["paths"][telemetry.PATH] = {"post": telemetry.openapi_operation()}
    document["components"]["securitySchemes"] = ACCESS_SCHEMES
    for path, _, operation in _operations(document):
        if path.startswith(PROTECTED_PREFIX) and path != SESSION_PATH:
            operation["security"] = ACCESS
        for parameter in operation.get("parameters", []):
            if parameter["name"] == "incident":
                parameter["description"] = "its id, as `GET /api/v1/incidents` lists it"
    return document


def _operations(document: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Path, method and operation of every route."""
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            yield path, method, operation


def _describe_refusals(path: str, method: str, operation: dict[str, Any]) -> None:
    """Add what any route of its sort may refuse with to what a route names itself."""
    statuses = {*OF_EVERY_ROUTE, *(OF_ONE_INCIDENT if "{incident}" in path else ())}
    if "requestBody" in operation:
        statuses.update(OF_A_BODY, OF_A_CHANGE if method == "patch" else ())
    described = {str(status): refusal for status, refusal in openapi_responses(*sorted(statuses)).items()}
    operation["responses"] |= described  # FastAPI's own 422 has another form
