"""`POST /api/v1/incidents/{incident}/telemetry`: a raw ASGI route, for speed.

A FastAPI route with declared models takes several times as long for the same readings: see
`firethread bench ingest`.
"""

import asyncio
import time
from collections.abc import Callable

import msgspec
import structlog
from starlette.datastructures import URLPath
from starlette.routing import BaseRoute, Match, NoMatchFound
from starlette.types import Receive, Scope, Send

from backend.errors import FieldError, NotAllowed, Problem
from backend.ingest.body import ClientGone, read_body
from backend.ingest.tally import tally
from backend.log.base import LogWriter, NewBatch
from backend.log.decode import judge
from backend.log.incident import Clock
from backend.log.incidents import IncidentStore
from backend.problems import answer

PREFIX = "/api/v1/incidents/"
SUFFIX = "/telemetry"
KNOWN_INCIDENTS = 10_000
"""Clocks of incidents that are kept in memory; a clock never changes."""


log = structlog.get_logger(__name__)


class Receipt(msgspec.Struct, frozen=True):
    """The answer to a batch.

    Attributes:
        batch: its name.
        seq: its place in the incident's log.
        accepted: how many of its readings go to the estimator.
        duplicate: it was in the log already.
        rejected: the readings that were set aside, by index.
    """

    batch: str
    seq: int
    accepted: int
    duplicate: bool
    rejected: tuple[FieldError, ...]


_encode = msgspec.json.Encoder().encode


class TelemetryRoute(BaseRoute):
    """Takes telemetry into the log.

    Args:
        writer: appends to the log.
        incidents: tells which clock an incident goes by.
        max_readings: readings in a batch.
        max_body_bytes: bytes of a batch, after decompression.
        wake: called with incident and `seq` of every batch that is new in the log.
    """

    name = "post_telemetry"

    def __init__(
        self,
        writer: LogWriter,
        incidents: IncidentStore,
        *,
        max_readings: int,
        max_body_bytes: int,
        wake: Callable[[str, int], None],
    ) -> None:
        self._writer = writer
        self._incidents = incidents
        self._max_readings = max_readings
        self._max_body_bytes = max_body_bytes
        self._wake = wake
        self._clocks: dict[str, Clock] = {}

    def matches(self, scope: Scope) -> tuple[Match, Scope]:
        """Whether a request is for this route, whatever its method."""
        if scope["type"] == "http":
            path: str = scope["path"]
            if path.endswith(SUFFIX) and path.startswith(PREFIX):
                incident = path[len(PREFIX) : -len(SUFFIX)]
                if incident and "/" not in incident:
                    return Match.FULL, {"path_params": {"incident": incident}}
        return Match.NONE, {}

    def url_path_for(self, name: str, /, **path_params: object) -> URLPath:
        """The path of an incident's telemetry."""
        if name != self.name or set(path_params) != {"incident"}:
            raise NoMatchFound(name, dict(path_params))
        return URLPath(f"{PREFIX}{path_params['incident']}{SUFFIX}", protocol="http")

    async def handle(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        try:
            body = await self._take(scope, receive)
        except ClientGone:
            return
        except Problem as problem:
            await _refuse(problem, scope, receive, send)
            return
        except Exception:
            log.exception("taking telemetry failed", path=scope["path"])
            defect = Problem(
                "This is a defect of the server, not of the batch, and the batch may not be stored."
            )
            await _refuse(defect, scope, receive, send)
            return
        await send(
            {
                "type": "http.response.start",
                "status": 202,
                "headers": [
                    (b"content-type", b"application/json"),
                    (b"content-length", b"%d" % len(body)),
                ],
            }
        )
        await send({"type": "http.response.body", "body": body})

    async def _take(self, scope: Scope, receive: Receive) -> bytes:
        """Take a batch into the log, and return the receipt."""
        if scope["method"] != "POST":
            raise NotAllowed(f"Telemetry takes POST, not {scope['method']}.")
        incident: str = scope["path_params"]["incident"]
        clock = self._clocks.get(incident) or await self._clock(incident)
        body = await read_body(scope, receive, self._max_body_bytes)
        batch = _batch(incident, clock, body, self._max_readings)
        appended = await self._writer.append(batch)
        if not appended.duplicate:
            self._wake(incident, appended.seq)
        tally.acknowledged(appended)
        return _encode(
            Receipt(batch.batch, appended.seq, appended.accepted, appended.duplicate, appended.rejected)
        )

    async def _clock(self, incident: str) -> Clock:
        clock = (await asyncio.to_thread(self._incidents.get, incident)).clock
        if len(self._clocks) >= KNOWN_INCIDENTS:
            self._clocks.clear()
        self._clocks[incident] = clock
        return clock


def _batch(incident: str, clock: Clock, body: bytes, max_readings: int) -> NewBatch:
    """Judge a body. The readings themselves end here: kept until it is durable, they fill the cache."""
    received = time.time()
    judged = judge(body, max_readings, received if clock == "live" else None)
    return NewBatch(
        incident=incident,
        gateway=judged.gateway,
        batch=judged.batch,
        received=received,
        sent=judged.sent,
        body=body,
        accepted=len(judged.accepted),
        rejected=judged.rejected,
    )


async def _refuse(problem: Problem, scope: Scope, receive: Receive, send: Send) -> None:
    tally.refused(problem.status)
    response = answer(problem)
    if isinstance(problem, NotAllowed):
        response.headers["allow"] = "POST"
    await response(scope, receive, send)
