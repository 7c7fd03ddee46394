"""Routes that tell why a fix is where it is, and what would make it surer: `evidence`, `advice`."""

import asyncio
from typing import Annotated, Any

import msgspec
from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from backend.errors import Conflict
from backend.live.past import record_of, row_at, told_at
from backend.log.base import LogReader
from backend.log.incident import Incident
from backend.log.incidents import IncidentStore
from backend.tracking.asked import while_asked
from backend.tracking.heads import head_of
from backend.tracking.routes import NodeName, answers_with, as_json, moment
from backend.tracking.smoothing import Smoothing
from estimator.evidence import Advice, Evidence
from estimator.measurements.base import LATEST_T


def evidence_router(incidents: IncidentStore, reader: LogReader, smoothing: Smoothing) -> APIRouter:
    """The routes.

    Args:
        incidents: their settings.
        reader: of the recorded rows.
        smoothing: weighs whole incidents.
    """
    router = APIRouter(prefix="/api/v1/incidents/{incident}", tags=["picture"])

    @router.get("/evidence", operation_id="get_evidence", responses=answers_with("Evidence", 409, 504))
    async def evidence(
        request: Request,
        incident: str,
        node: NodeName,
        t: Annotated[float | None, moment("of which moment, Unix seconds; the newest, without it")] = None,
    ) -> Response:
        """Which measurements hold a node's fix where it is, and which were rejected.

        It is what the whole log says now of everything up to `t` (without it: up to the newest epoch); where
        that takes longer than anybody waits, what it said when the weighing was begun, for who asks again. An
        entry that came later than `t` but tells of epochs before it counts. Settings and origin are those
        of then.
        """
        known = await asyncio.to_thread(incidents.get, incident)
        if t is not None:
            known = told_at(known, t, await asyncio.to_thread(row_at, reader, known, t))
        found = await while_asked(request, smoothing.evidence(head_of(known), node, t))
        if found is None:
            raise await _no_fix(known, node, t)
        return as_json(found)

    @router.get("/advice", operation_id="get_advice", responses=answers_with("Advice", 409, 504))
    async def advice(request: Request, incident: str, node: NodeName) -> Response:
        """What would shrink the uncertainty of a node's newest position most."""
        known = await asyncio.to_thread(incidents.get, incident)
        found = await while_asked(request, smoothing.advice(head_of(known), node))
        if found is None:
            raise await _no_fix(known, node, None)
        return as_json(found)

    async def _no_fix(known: Incident, node: str, t: float | None) -> Conflict:
        """Why nothing holds a node anywhere, and what to do about it."""
        row = await asyncio.to_thread(row_at, reader, known, LATEST_T if t is None else t)
        told = next((one for one in record_of(row).nodes if one.node == node), None)
        if told is not None and told.role == "base" and told.position_m is not None:
            return Conflict(
                f"{node!r} is a base: it is where it was said to be, and nothing measured holds it."
            )
        when = "yet" if t is None else "at that time"
        return Conflict(
            f"The position of {node!r} is not decided {when}: it takes readings to others whose are."
        )

    return router


def evidence_schemas() -> dict[str, Any]:
    """Schemas of the answers, for `components.schemas` of the OpenAPI document."""
    _, schemas = msgspec.json.schema_components(
        [Evidence, Advice], ref_template="#/components/schemas/{name}"
    )
    return dict(schemas)
