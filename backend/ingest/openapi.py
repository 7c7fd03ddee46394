"""The telemetry route in the OpenAPI document, from the types that decode it."""

from typing import Any

import msgspec

from backend.ingest.route import PREFIX, SUFFIX, Receipt
from backend.log.batch import Batch

PATH = f"{PREFIX}{{incident}}{SUFFIX}"
_REFUSALS = {
    "400": "The body is no JSON, or no batch; nothing is stored",
    "401": "An access token is needed",
    "404": "There is no such incident",
    "409": "The incident is closed",
    "413": "Too many readings or bytes",
    "415": "Content type or encoding is not taken",
    "429": "The log cannot keep up: send it again after `Retry-After` seconds",
    "503": "The log cannot be written: send it again",
}


def openapi_operation() -> dict[str, Any]:
    """The path item's `post` operation; its schemas come from `openapi_schemas`."""
    problem = {"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}}
    return {
        "operationId": "post_telemetry",
        "tags": ["telemetry"],
        "summary": "Post a batch of readings",
        "description": (
            "Answered when the batch is durable on disk. `(gateway, batch)` is the idempotency key, for "
            "ever: a batch sent again gets its first answer with `duplicate: true`, even if the incident "
            "has been closed since, and changes nothing. A reading that breaks the schema, or is more "
            "than 60 s ahead of `sent` (or, where the incident's clock is live, of the server's clock), "
            "does not refuse its batch: it is listed in `rejected`, kept in the log as it came, and not "
            "given to the estimator. An alarm from a clock ahead is taken, and counts as of when it came. "
            "A batch may have no readings. Where an object names a field twice, "
            "the last one counts. The body may be gzip (`Content-Encoding: gzip`), in one member or several."
        ),
        "parameters": [{"name": "incident", "in": "path", "required": True, "schema": {"type": "string"}}],
        "requestBody": {
            "required": True,
            "content": {"application/json": {"schema": {"$ref": "#/components/schemas/Batch"}}},
        },
        "responses": {
            "202": {
                "description": "The batch is in the log",
                "content": {"application/json": {"schema": {"$ref": "#/components/schemas/BatchAnswer"}}},
            },
            **{status: {"description": text, "content": problem} for status, text in _REFUSALS.items()},
        },
    }


def openapi_schemas() -> dict[str, Any]:
    """The schemas that `openapi_operation` refers to, all but `Problem`."""
    _, schemas = msgspec.json.schema_components([Batch, Receipt], ref_template="#/components/schemas/{name}")
    schemas["BatchAnswer"] = schemas.pop("Receipt") | {"title": "BatchAnswer"}
    return schemas
