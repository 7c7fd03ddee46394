"""A gateway, and a telemetry route on a real log."""

import asyncio
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import sqlalchemy as sa

from backend.ingest.route import TelemetryRoute
from backend.log.append import append_group
from backend.log.base import Appended, NewBatch
from backend.log.incident import Clock
from backend.log.incidents import IncidentStore
from tests.backend.ingest.asgi import Answer, Body, Sent, scope


class OneByOne:
    """Appends at once, each batch in a transaction of its own."""

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine

    async def append(self, batch: NewBatch) -> Appended:
        (outcome,) = append_group(self._engine, [batch])
        if isinstance(outcome, Appended):
            return outcome
        raise outcome


@dataclass
class Field:
    """What a gateway sees, and what the log then holds."""

    engine: sa.Engine
    store: IncidentStore
    woken: list[tuple[str, int]] = field(default_factory=list)
    max_readings: int = 100
    max_body_bytes: int = 100_000

    def __post_init__(self) -> None:
        self.route = TelemetryRoute(
            OneByOne(self.engine),
            self.store,
            max_readings=self.max_readings,
            max_body_bytes=self.max_body_bytes,
            wake=lambda incident, seq: self.woken.append((incident, seq)),
        )

    def incident(self, clock: Clock = "recorded") -> str:
        return self.store.create("fire", clock).id

    def post(
        self,
        incident: str,
        body: bytes | Mapping[str, Any],
        headers: Mapping[str, str] | None = None,
        method: str = "POST",
    ) -> Answer:
        sent = body if isinstance(body, bytes) else json.dumps(body).encode()
        request = scope(
            f"/api/v1/incidents/{incident}/telemetry",
            {"content-type": "application/json", **(headers or {})},
            method,
        )
        answered = Sent()
        asyncio.run(self.route(request, Body([sent]), answered))
        return answered.answer
