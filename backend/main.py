"""The web process, put together: what is constructed, in which order, and which routes there are."""

import socket
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib.metadata import version

from fastapi import Depends, FastAPI

from backend import api_docs, openapi, problems
from backend.authentication import Authentication, session_router
from backend.body_limit import BodyLimit
from backend.compression import Compression
from backend.coordination.web_link import WebLink
from backend.head_requests import HeadRequests
from backend.health import health_router
from backend.incidents.routes import incidents_router
from backend.ingest.log_route import log_router
from backend.ingest.route import TelemetryRoute
from backend.live.hub import Hub
from backend.live.socket import live_router
from backend.log.engine import make_engine
from backend.log.group_commit import GroupCommit
from backend.log.incidents import IncidentStore
from backend.log.migrate import prepare
from backend.log.read import SqlLogReader
from backend.parameters import known_parameters
from backend.replay.socket import replay_router
from backend.screen_files import Screen
from backend.settings import Settings
from backend.tracking.evidence_routes import evidence_router
from backend.tracking.routes import tracking_router
from backend.tracking.smoothing import Smoothing


def build_app(
    settings: Settings, *, token: str | None, link: socket.socket, link_token: str, hold: int | None = None
) -> FastAPI:
    """The application, its database brought up to date.

    Args:
        settings: of this process.
        token: the access token; None lets everybody in.
        link: listening socket where workers connect.
        link_token: what they must say.
        hold: handle by which this process has the data folder to itself.

    Raises:
        SchemaTooNew: a newer version has written the database.
    """
    url = settings.database_url
    prepare(url)
    engine = make_engine(url)
    incidents, reader = IncidentStore(engine), SqlLogReader(engine)
    writer = GroupCommit(url, settings.queue_bytes, hold)
    workers = WebLink(link, link_token)
    hub = Hub(incidents, reader)
    workers.on_picture(hub.take)
    smoothing = Smoothing(url)

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncIterator[None]:
        await writer.start()
        await workers.start()
        hub.start()
        smoothing.start()
        try:
            yield
        finally:
            await hub.stop()
            await workers.stop()
            smoothing.close()
            await writer.close()
            engine.dispose()

    app = FastAPI(
        title="Firethread",
        version=version("firethread"),
        description=openapi.DESCRIPTION.strip(),
        lifespan=lifespan,
        docs_url=None,  # FastAPI's own loads from afar
        redoc_url=None,
    )
    problems.install(app)
    app.state.workers = workers
    app.state.telemetry = TelemetryRoute(
        writer,
        incidents,
        max_readings=settings.max_readings,
        max_body_bytes=settings.max_body_bytes,
        wake=workers.wake,
    )
    app.router.routes.insert(0, app.state.telemetry)
    for router in (
        incidents_router(incidents),
        log_router(reader, incidents),
        tracking_router(incidents, reader, hub, workers, smoothing),
        evidence_router(incidents, reader, smoothing),
        live_router(hub),
        replay_router(incidents, reader),
        session_router(token),
    ):
        app.include_router(router, dependencies=[Depends(known_parameters)])
    app.include_router(health_router(engine, workers, lambda: writer.refusal))
    openapi.install(app)
    api_docs.install(app)
    app.mount("/", Screen(), name="screen")
    app.add_middleware(Compression)
    app.add_middleware(HeadRequests)
    app.add_middleware(BodyLimit, telemetry=app.state.telemetry)
    app.add_middleware(Authentication, token=token)
    return app
