"""The OpenAPI document: FastAPI's own, and what it cannot know."""

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from backend.authentication import PROTECTED_PREFIX, SESSION_PATH, TOKEN_FILE
from backend.errors import PROBLEM_MEDIA_TYPE
from backend.ingest import openapi as telemetry
from backend.live.frame import message_schemas
from backend.tracking.evidence_routes import evidence_schemas

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


REFUSALS = {
    400: "The request could not be understood",
    401: "An access token is needed",
    404: "There is nothing under that name",
    409: "The request contradicts what is there",
    413: "The request is too large",
    422: "A field or parameter is not valid",
    503: "A part that is needed is not available",
    504: "What was waited for did not come in time",
}
OF_EVERY_ROUTE = (400, 401, 422, 503)
OF_ONE_INCIDENT = (404, 409, 504)
OF_A_BODY = (413,)


def complete(document: dict[str, Any]) -> dict[str, Any]:
    """Add what FastAPI cannot know: the raw telemetry route, socket messages, and the form of refusals."""
    schemas = document["components"]["schemas"]
    for unused in ("HTTPValidationError", "ValidationError"):
        schemas.pop(unused, None)
    schemas["Problem"] = PROBLEM_SCHEMA
    schemas.update(telemetry.openapi_schemas())
    schemas.update(message_schemas())
    schemas.update(evidence_schemas())
    for path, operations in document["paths"].items():
        if path.startswith("/api/"):
            statuses = OF_EVERY_ROUTE + (OF_ONE_INCIDENT if "{incident}" in path else ())
            for operation in operations.values():
                for status in statuses + (OF_A_BODY if "requestBody" in operation else ()):
                    operation["responses"][str(status)] = {
                        "description": REFUSALS[status],
                        "content": {PROBLEM_MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}},
                    }
    document["paths"][telemetry.PATH] = {"post": telemetry.openapi_operation()}
    document["components"]["securitySchemes"] = ACCESS_SCHEMES
    for path, operations in document["paths"].items():
        if path.startswith(PROTECTED_PREFIX) and path != SESSION_PATH:
            for operation in operations.values():
                operation["security"] = ACCESS
    return document
