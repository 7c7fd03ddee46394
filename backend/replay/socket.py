"""`WS /api/v1/incidents/{incident}/replay`: the past, in the messages of the live socket."""

import asyncio
import contextlib
import time
from typing import Annotated

import msgspec
from fastapi import APIRouter, Query, WebSocket, WebSocketDisconnect

from backend.errors import NotFound, Unavailable
from backend.live.frame import ErrorMessage
from backend.live.socket import NO_SUCH_INCIDENT, TRY_AGAIN_LATER
from backend.log.base import LogReader
from backend.log.incidents import IncidentStore
from backend.problems import deny, reversed_span
from backend.replay.clock import ReplayClock
from backend.replay.control import FASTEST, SLOWEST, understand
from backend.replay.player import Player
from estimator.measurements.base import LATEST_T

STEP_S = 0.1
BEAT_S = 1.0
MOST_WAITING = 64
"""Messages of a viewer that wait to be done; more are left in its socket."""

Moment = Annotated[float | None, Query(ge=0.0, le=LATEST_T, allow_inf_nan=False)]


def replay_router(incidents: IncidentStore, reader: LogReader) -> APIRouter:
    """The route.

    Args:
        incidents: settings and levels.
        reader: of the recorded rows.
    """
    router = APIRouter(tags=["picture"])

    @router.websocket("/api/v1/incidents/{incident}/replay")
    async def replay(
        socket: WebSocket,
        incident: str,
        start: Annotated[float | None, Query(alias="from", ge=0.0, le=LATEST_T, allow_inf_nan=False)] = None,
        to: Moment = None,
        speed: Annotated[float, Query(ge=SLOWEST, le=FASTEST, allow_inf_nan=False)] = 1.0,
    ) -> None:
        """First a whole frame, then deltas and heartbeats, in incident time."""
        if start is not None and to is not None and to < start:
            await deny(socket, reversed_span())
            return
        await socket.accept()
        try:
            known = await asyncio.to_thread(incidents.get, incident)
        except NotFound as problem:
            await socket.close(NO_SUCH_INCIDENT, problem.title)
            return
        except Unavailable as problem:
            await socket.close(TRY_AGAIN_LATER, problem.title)
            return
        clock = ReplayClock(
            (known.first_t or 0.0) if start is None else start,
            (known.last_t or 0.0) if to is None else to,
            speed,
            time.monotonic(),
        )
        await play(socket, Player(reader, known, clock))

    return router


async def play(socket: WebSocket, player: Player) -> None:
    """Show and listen until the viewer leaves.

    What the viewer asks waits until the message under way is made: made of two moments, it would be a
    whole frame of the one that was left, and the one that was sought would come as a change of it.

    Args:
        socket: accepted.
        player: of the replay.
    """
    said: asyncio.Queue[str | bytes] = asyncio.Queue(MOST_WAITING)
    listening = asyncio.create_task(_listen(socket, said))
    try:
        with contextlib.suppress(WebSocketDisconnect):
            await _show(socket, player, said, listening)
    finally:
        listening.cancel()
        with contextlib.suppress(asyncio.CancelledError, WebSocketDisconnect):
            await listening


async def _show(
    socket: WebSocket, player: Player, said: asyncio.Queue[str | bytes], listening: asyncio.Task[None]
) -> None:
    beat_at = 0.0
    while not listening.done():
        wall_s = time.monotonic()
        while not said.empty():
            try:
                player.obey(understand(said.get_nowait()), wall_s)
            except ValueError as error:
                await socket.send_text(msgspec.json.encode(ErrorMessage(detail=str(error))).decode())
        try:
            message = await asyncio.to_thread(player.message, wall_s)
        except Unavailable as problem:
            await socket.close(TRY_AGAIN_LATER, problem.title)
            return
        if message is not None:
            await socket.send_text(msgspec.json.encode(message).decode())
        if wall_s >= beat_at:
            beat_at = wall_s + BEAT_S
            await socket.send_text(msgspec.json.encode(player.beat(wall_s)).decode())
        # A viewer that takes its messages slowly is not behind: the next one is of the moment it is made.
        await asyncio.wait([listening], timeout=STEP_S)


async def _listen(socket: WebSocket, said: asyncio.Queue[str | bytes]) -> None:
    while True:
        received = await socket.receive()
        if received["type"] == "websocket.disconnect":
            return
        await said.put(received.get("text") or received.get("bytes") or b"")
