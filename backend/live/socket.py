"""`WS /api/v1/incidents/{incident}/live`: the picture as it changes."""

from typing import Annotated

from fastapi import APIRouter, Query, WebSocket

from backend.errors import NotFound, Unavailable
from backend.live.hub import Hub
from backend.live.push_protocol import EXTENSION, PushProtocol

NO_SUCH_INCIDENT = 4404
TRY_AGAIN_LATER = 1013


def live_router(hub: Hub) -> APIRouter:
    """The route, on pictures of `hub`."""
    router = APIRouter(tags=["picture"])

    @router.websocket("/api/v1/incidents/{incident}/live")
    async def live(socket: WebSocket, incident: str, after: Annotated[int, Query(ge=0)] = 0) -> None:
        """First a whole frame, then deltas and heartbeats.

        `after` names the newest log entry that the screen has seen; it gets a whole frame all the same,
        because what it has may have aged.
        """
        del after
        await socket.accept()
        connection = connection_of(socket)
        try:
            channel, screen = await hub.join(incident, connection)
        except NotFound as problem:
            await socket.close(NO_SUCH_INCIDENT, problem.title)
            return
        except Unavailable as problem:
            await socket.close(TRY_AGAIN_LATER, problem.title)
            return
        connection.on_writable = lambda: channel.catch_up(screen)
        try:
            while (await socket.receive())["type"] != "websocket.disconnect":
                pass  # a screen has nothing to say here
        finally:
            connection.on_writable = None
            hub.leave(channel, screen)

    return router


def connection_of(socket: WebSocket) -> PushProtocol:
    """The connection under a socket.

    Raises:
        RuntimeError: the server does not speak `PushProtocol`.
    """
    extension = socket.scope.get("extensions", {}).get(EXTENSION)
    if extension is None:
        raise RuntimeError(f"serve with uvicorn and ws={PushProtocol.__module__}:{PushProtocol.__name__}")
    connection: PushProtocol = extension["connection"]
    return connection
