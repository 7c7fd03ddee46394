"""Routes that show where everybody is and was: `frame`, `relative`, `tracks`."""

import asyncio
import math
import time
from typing import Annotated, Any, Literal

import msgspec
from fastapi import APIRouter, Query
from starlette.requests import Request
from starlette.responses import Response

from backend.coordination.base import WebSide
from backend.errors import Conflict, FieldError, Invalid, NotFound, TooSlow, Unavailable
from backend.live.frame import RelativePosition, Track, Tracks
from backend.live.hub import Hub
from backend.live.past import frame_of, row_at
from backend.log.base import LogReader
from backend.log.incidents import IncidentStore
from backend.problems import openapi_responses, reversed_span
from backend.tracking.asked import while_asked
from backend.tracking.heads import head_of
from backend.tracking.smoothing import Smoothing
from backend.tracking.tracks import live_tracks, rounded
from estimator.estimate import Relative, TrackPoint
from estimator.measurements.base import LATEST_T
from estimator.measurements.node import Role

ASK_WITHIN_S = 5.0


def moment(description: str, alias: str | None = None) -> Any:
    """A parameter that is a moment in Unix seconds."""
    return Query(alias=alias, ge=0.0, le=LATEST_T, allow_inf_nan=False, description=description)


NodeName = Annotated[str, Query(min_length=1, max_length=64, description="name of the node")]


def tracking_router(
    incidents: IncidentStore, reader: LogReader, hub: Hub, workers: WebSide, smoothing: Smoothing
) -> APIRouter:
    """The routes.

    Args:
        incidents: settings and levels.
        reader: of the log and the recorded rows.
        hub: the newest pictures.
        workers: answers questions that need the joint covariance.
        smoothing: smooths whole incidents.
    """
    router = APIRouter(prefix="/api/v1/incidents/{incident}", tags=["picture"])

    @router.get("/frame", operation_id="get_frame", responses=answers_with("Frame", 504))
    async def frame(
        incident: str,
        t: Annotated[
            float | None, moment("when it was known and shown, Unix seconds; now, without it")
        ] = None,
        min_seq: Annotated[int, Query(ge=0, le=2**62, description="log entry that is waited for")] = 0,
        timeout_s: Annotated[
            float, Query(ge=0.0, le=60.0, allow_inf_nan=False, description="how long it is waited for (s)")
        ] = 10.0,
    ) -> Response:
        """The picture now, or as it was known and shown at `t`.

        `min_seq` waits until the estimator has folded that log entry, at most `timeout_s`.
        """
        channel = await hub.channel(incident)
        if not await channel.folded(min_seq, timeout_s):
            raise TooSlow(
                f"Log entry {min_seq} was not folded within {timeout_s:g} s; the newest one is {channel.seq}."
            )
        if t is None or t >= channel.now(time.time()):
            return as_json(channel.frame(time.time()))
        if (standing := channel.past_frame(t)) is not None:
            return as_json(standing)
        await hub.stored(channel, t)
        row = await asyncio.to_thread(row_at, reader, channel.incident, t)
        return as_json(frame_of(row, channel.incident, t))

    @router.get(
        "/relative",
        operation_id="get_relative",
        responses=answers_with("RelativePosition", 409, 504),
    )
    async def relative(incident: str, a: NodeName, b: NodeName) -> Response:
        """Where node `b` is relative to node `a`, from their joint covariance."""
        known = await asyncio.to_thread(incidents.get, incident)
        if a == b:
            message = "`a` and `b` are the same node: name two"
            raise Invalid(message, [FieldError(code="same_node", field="query.b", message=message)])
        try:
            answer = await workers.ask(incident, a, b, ASK_WITHIN_S)
        except Unavailable:
            answer = None
        if answer is None or not answer.followed:
            found = await smoothing.relative(head_of(known), a, b)
            if found is None:
                raise Conflict("The position of one of them is not decided yet.")
            return as_json(relative_position(found))
        if answer.delta_m is None or answer.covariance_m2 is None:
            raise NotFound(answer.detail) if answer.unknown else Conflict(answer.detail)
        return as_json(
            relative_position(Relative(delta_m=answer.delta_m, covariance_m2=answer.covariance_m2))
        )

    @router.get("/tracks", operation_id="get_tracks", responses=answers_with("Tracks", 504))
    async def tracks(
        request: Request,
        incident: str,
        node: Annotated[
            str | None, Query(min_length=1, max_length=64, description="only this one; all, without it")
        ] = None,
        role: Annotated[
            list[Role] | None,
            Query(description="only nodes that have one of these roles now; all, without it"),
        ] = None,
        start: Annotated[
            float | None,
            moment("first second, Unix seconds; `first_t` without it", alias="from"),
        ] = None,
        to: Annotated[float | None, moment("last second, Unix seconds")] = None,
        step: Annotated[int, Query(ge=1, le=3600, description="seconds from point to point")] = 1,
        view: Annotated[
            Literal["live", "smoothed"],
            Query(description="as it stood at each second, or the best estimate with everything known now"),
        ] = "live",
        decimals: Annotated[
            int | None, Query(ge=0, le=9, description="of metres and m²; all that there are, without it")
        ] = None,
    ) -> Response:
        """Where the nodes were: as it was known then (`live`), or with everything known now (`smoothed`)."""
        if start is not None and to is not None and to < start:
            raise reversed_span()
        channel = await hub.channel(incident)
        if view == "live":
            await hub.stored(channel, LATEST_T if to is None else to)
        known = await asyncio.to_thread(incidents.get, incident)
        folded = channel.seq >= known.last_seq  # what is not may name any node
        if node is not None and folded and all(one.node != node for one in channel.record.nodes):
            raise NotFound(f"No reading of this incident has named {node!r}.")
        wanted = None if node is None else {node}
        if role is not None:
            of_role = {one.node for one in channel.record.nodes if one.role in role}
            wanted = of_role if wanted is None else wanted & of_role
        start = known.first_t if start is None else start
        if view == "live":
            newest = None
            if channel.record.t is not None and channel.record.t.is_integer():
                newest = int(channel.record.t), channel.record
            shown = await asyncio.to_thread(live_tracks, reader, incident, wanted, start, to, step, newest)
            return await asyncio.to_thread(_tracks_as_json, shown, decimals)
        smoothed = await while_asked(request, smoothing.smoothed(head_of(channel.incident)))
        chosen = {name: track for name, track in smoothed.items() if wanted is None or name in wanted}
        return await asyncio.to_thread(lambda: _tracks_as_json(_tracks(chosen, start, to, step), decimals))

    return router


def answers_with(schema: str, *refusals: int) -> dict[int | str, dict[str, object]]:
    """The answer and the refusals of a route, for the OpenAPI document.

    Args:
        schema: name of the answer's schema.
        refusals: statuses of those that not every route of an incident has.
    """
    content = {"application/json": {"schema": {"$ref": f"#/components/schemas/{schema}"}}}
    return {200: {"content": content, "description": "OK"}, **openapi_responses(*refusals)}


def as_json(answer: msgspec.Struct) -> Response:
    """An answer as JSON."""
    return Response(msgspec.json.encode(answer), media_type="application/json")


def relative_position(relative: Relative) -> RelativePosition:
    """A relative position with its distance, whose variance is that along the line between the two."""
    east, north, up = relative.delta_m
    ee, en, eu, nn, nu, uu = relative.covariance_m2
    distance_m = math.sqrt(east * east + north * north + up * up)
    if distance_m > 0.0:
        e, n, u = east / distance_m, north / distance_m, up / distance_m
        variance = e * e * ee + n * n * nn + u * u * uu + 2.0 * (e * n * en + e * u * eu + n * u * nu)
    else:
        variance = ee + nn + uu
    return RelativePosition(
        delta_m=relative.delta_m,
        covariance_m2=relative.covariance_m2,
        distance_m=distance_m,
        distance_sigma_m=math.sqrt(max(variance, 0.0)),
    )


def _tracks_as_json(tracks: Tracks, decimals: int | None) -> Response:
    return as_json(tracks if decimals is None else rounded(tracks, decimals))


def _tracks(
    smoothed: dict[str, list[TrackPoint]], start: float | None, to: float | None, step: int
) -> Tracks:
    return Tracks(
        tracks=[
            Track(
                node=node,
                points=[
                    (point.t, *point.position_m, *point.covariance_m2)
                    for point in points
                    if (start is None or point.t >= start)
                    and (to is None or point.t <= to)
                    and point.t % step == 0
                ],
            )
            for node, points in smoothed.items()
        ]
    )
