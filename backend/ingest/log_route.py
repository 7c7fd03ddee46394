"""`GET /api/v1/incidents/{incident}/log`: the log as NDJSON."""

from collections.abc import Iterator
from itertools import chain
from typing import Annotated

from fastapi import APIRouter, Path, Query
from fastapi.responses import StreamingResponse
from pydantic import StringConstraints

from backend.log.base import LogReader
from backend.log.incidents import IncidentStore
from backend.log.kinds import holds_one_of
from backend.log.lines import log_line

NDJSON = "application/x-ndjson"
MAX_SEQ = 2**63 - 1
CHUNK_BYTES = 256 * 1024
"""Each chunk changes threads once, so that a chunk a line would be slow."""

MOST_KINDS = 32

Kind = Annotated[str, StringConstraints(min_length=1, max_length=64)]


def log_router(reader: LogReader, incidents: IncidentStore) -> APIRouter:
    """The route, reading from `reader`."""
    router = APIRouter(tags=["telemetry"])

    @router.get(
        "/api/v1/incidents/{incident}/log",
        operation_id="get_log",
        summary="The log as it came, a line a batch",
        response_class=StreamingResponse,
        responses={
            200: {
                "description": "Lines `{seq, received, gateway, batch, sent?, rejected?, readings}` by `seq`",
                "content": {NDJSON: {"schema": {"type": "string"}}},
            }
        },
    )
    def get_log(
        incident: Annotated[str, Path()],
        after: Annotated[int, Query(ge=0, le=MAX_SEQ, description="only entries with a larger `seq`")] = 0,
        limit: Annotated[int | None, Query(ge=1, le=MAX_SEQ, description="at most so many entries")] = None,
        kind: Annotated[
            list[Kind] | None,
            Query(
                max_length=MOST_KINDS,
                description="of these entries only those that hold a reading of such a kind, whole",
            ),
        ] = None,
    ) -> StreamingResponse:
        incidents.get(incident)
        batches = reader.batches(incident, after, limit)
        lines = map(log_line, filter(holds_one_of(kind), batches) if kind else batches)
        # The first block is read before the status goes out: a database that is away is a 503, not a cut.
        first = next(lines, b"")
        return StreamingResponse(_chunks(chain((first,), lines)), media_type=NDJSON)

    return router


def _chunks(lines: Iterator[bytes]) -> Iterator[bytes]:
    chunk: list[bytes] = []
    size = 0
    for line in lines:
        chunk.append(line)
        size += len(line)
        if size >= CHUNK_BYTES:
            yield b"".join(chunk)
            chunk, size = [], 0
    yield b"".join(chunk)
