"""Which incidents have log entries that are not in a snapshot yet: what the worker has to follow."""

from collections.abc import Collection
from typing import Any

import msgspec
import sqlalchemy as sa

from backend.log.engine import reading
from backend.log.incident import Incident, IncidentSettings, Origin
from backend.log.schema import incidents, snapshots
from estimator.trackers.base import TrackerSettings


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """What the worker needs to know of an incident.

    Attributes:
        incident: its id.
        closed: it takes no more telemetry.
        last_seq: newest entry of its log.
        tracker: name of its tracker.
        settings: what its tracker is told.
        live: it goes by the server's clock.
    """

    incident: str
    closed: bool
    last_seq: int
    tracker: str
    settings: TrackerSettings
    live: bool


_snapshot_seq = sa.func.coalesce(snapshots.c.seq, 0)
_heads = sa.select(
    incidents.c.id,
    incidents.c.state,
    incidents.c.last_seq,
    incidents.c.origin,
    incidents.c.settings,
    incidents.c.clock,
).select_from(incidents.outerjoin(snapshots, snapshots.c.incident == incidents.c.id))


def heads(engine: sa.Engine, followed: Collection[str]) -> list[Head]:
    """The incidents that are not folded to their end, and those that are followed already.

    Args:
        engine: of the log's database.
        followed: ids of the latter.

    Raises:
        LogUnreadable: the database failed.
    """
    query = _heads.where(sa.or_(incidents.c.last_seq > _snapshot_seq, incidents.c.id.in_(sorted(followed))))
    with reading(engine) as connection:
        return [_head(row) for row in connection.execute(query.order_by(incidents.c.created))]


def _head(row: Any) -> Head:
    settings = IncidentSettings.model_validate(row.settings)
    origin = None if row.origin is None else Origin.model_validate(row.origin)
    return Head(
        incident=row.id,
        closed=row.state == "closed",
        last_seq=row.last_seq,
        tracker=settings.tracker,
        settings=_tracker_settings(settings, origin),
        live=row.clock == "live",
    )


def head_of(incident: Incident) -> Head:
    """The head of an incident that is at hand."""
    return Head(
        incident=incident.id,
        closed=incident.state == "closed",
        last_seq=incident.last_seq,
        tracker=incident.settings.tracker,
        settings=_tracker_settings(incident.settings, incident.origin),
        live=incident.clock == "live",
    )


def _tracker_settings(settings: IncidentSettings, origin: Origin | None) -> TrackerSettings:
    return TrackerSettings(
        lag_s=settings.lag_s,
        origin_wgs84=None if origin is None else (origin.lat, origin.lon, origin.hae),
    )
