"""Whether this process lives, whether it can do its work, and its metrics."""

import prometheus_client
import sqlalchemy as sa
from fastapi import APIRouter
from pydantic import BaseModel
from starlette.responses import Response

from backend.coordination.web_link import WebLink
from backend.errors import Unavailable
from backend.problems import openapi_responses


class Health(BaseModel):
    """That this process answers."""

    status: str = "ok"


class Readiness(BaseModel):
    """What this process needs for its work.

    Attributes:
        log: the database answers.
        worker: an estimator worker is connected and ready to compute; it takes seconds to begin. Without one
            telemetry is still taken, and dots go stale.
    """

    log: bool
    worker: bool


def health_router(engine: sa.Engine, workers: WebLink) -> APIRouter:
    """The routes of health and metrics; they need no access token."""
    router = APIRouter(tags=["health"])

    @router.get("/healthz", summary="Is the process alive?")
    async def healthz() -> Health:
        return Health()

    @router.get("/readyz", summary="Can it do its work?", responses=openapi_responses(503))
    def readyz() -> Readiness:
        try:
            with engine.connect() as connection:
                connection.execute(sa.text("SELECT 1"))
        except sa.exc.DBAPIError as error:
            raise Unavailable(f"the database does not answer: {error.__cause__ or error}") from error
        return Readiness(log=True, worker=workers.connected)

    @router.get("/metrics", summary="Metrics for Prometheus", response_class=Response)
    async def metrics() -> Response:
        return Response(prometheus_client.generate_latest(), media_type=prometheus_client.CONTENT_TYPE_LATEST)

    return router
