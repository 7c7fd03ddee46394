"""Whether this process lives, whether it can do its work, and its metrics."""

import asyncio
import shutil
from collections.abc import Callable
from pathlib import Path

import prometheus_client
import sqlalchemy as sa
from fastapi import APIRouter
from pydantic import BaseModel
from starlette.responses import Response

from backend.coordination.web_link import WebLink
from backend.errors import Unavailable
from backend.log.base import LogUnwritable
from backend.log.engine import RETRY_UNWRITABLE_S, reading, refuse_if_gone
from backend.problems import openapi_responses

ANSWER_WITHIN_S = 3.0
"""Whoever asks whether this process is ready gives up sooner or later; a database may not answer at all."""

LEAST_FREE_BYTES = 32 * 1024 * 1024
"""The WAL between two checkpoints and a largest group: with less room the next batches may be refused."""


class Health(BaseModel):
    """That this process answers."""

    status: str = "ok"


class Readiness(BaseModel):
    """What this process needs for its work.

    Attributes:
        log: the database answers, its writer is at work and was not refused what it wrote last, and its disk
            has room, where it is a file here.
        worker: an estimator worker is connected and ready to compute; it takes seconds to begin. Without one
            telemetry is still taken, and dots go stale.
    """

    log: bool
    worker: bool


def health_router(
    engine: sa.Engine, workers: WebLink, refusal: Callable[[], LogUnwritable | None]
) -> APIRouter:
    """The routes of health and metrics; they need no access token.

    Args:
        engine: of the log's database.
        workers: the link to them.
        refusal: why the log cannot be written, where that is known.
    """
    router = APIRouter(tags=["health"])

    @router.get("/healthz", summary="Is the process alive?")
    async def healthz() -> Health:
        return Health()

    asking: asyncio.Task[None] | None = None

    @router.get("/readyz", summary="Can it do its work?", responses=openapi_responses(503))
    async def readyz() -> Readiness:
        nonlocal asking
        if asking is None or asking.done():  # each question that hangs would hold a thread
            asking = asyncio.create_task(asyncio.to_thread(_ask, engine))
        done, _ = await asyncio.wait({asking}, timeout=ANSWER_WITHIN_S)
        if not done:
            raise Unavailable(f"The database has not answered within {ANSWER_WITHIN_S:g} s.")
        asking.result()
        if (problem := refusal()) is not None:  # a database elsewhere does not tell how full its disk is
            raise LogUnwritable(problem.detail, retry_after_s=problem.retry_after_s)
        return Readiness(log=True, worker=workers.connected)

    @router.get("/metrics", summary="Metrics for Prometheus", response_class=Response)
    async def metrics() -> Response:
        return Response(prometheus_client.generate_latest(), media_type=prometheus_client.CONTENT_TYPE_LATEST)

    return router


def _ask(engine: sa.Engine) -> None:
    """Ask the database for something, and its disk for room.

    Raises:
        LogUnreadable: it failed.
        LogUnwritable: there is no room for more telemetry, or the database's file is gone.
    """
    with reading(engine) as connection:
        connection.execute(sa.text("SELECT 1"))
        refuse_if_gone(connection)
    if engine.dialect.name != "sqlite" or not engine.url.database:
        return
    free = shutil.disk_usage(Path(engine.url.database).parent).free
    if free < LEAST_FREE_BYTES:
        raise LogUnwritable(
            f"The disk of the log has {free // 1024} kB left, less than {LEAST_FREE_BYTES // 1024} kB: "
            "telemetry is refused, or will be soon. Make room.",
            retry_after_s=RETRY_UNWRITABLE_S,
        )
