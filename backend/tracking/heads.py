"""Which incidents have log entries that are not in a snapshot yet: what the worker has to follow."""

from collections.abc import Collection
from functools import lru_cache
from typing import Any

import msgspec
import sqlalchemy as sa

from backend.log.engine import reading
from backend.log.incident import Incident, IncidentSettings, Origin
from backend.log.schema import incidents, snapshots
from estimator.trackers.base import TrackerSettings

MADE_WITH_KEPT = 4096
"""Decoded settings that are kept: all incidents are looked at several times a second."""


class MadeWith(msgspec.Struct, frozen=True):
    """What the numbers of a fold depend on beside the log.

    Attributes:
        tracker: name of the tracker.
        settings: what it is told.
    """

    tracker: str
    settings: TrackerSettings

    def encoded(self) -> str:
        """As it is stored beside a snapshot."""
        return msgspec.json.encode(self).decode()


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

    @property
    def made_with(self) -> MadeWith:
        """What a fold of it is made with."""
        return MadeWith(self.tracker, self.settings)


_heads = (
    sa.select(
        incidents.c.id,
        incidents.c.state,
        incidents.c.last_seq,
        incidents.c.clock,
        sa.type_coerce(incidents.c.origin, sa.Text).label("origin"),
        sa.type_coerce(incidents.c.settings, sa.Text).label("settings"),
        sa.func.coalesce(snapshots.c.seq, 0).label("snapshot_seq"),
        snapshots.c.made_with,
    )
    .select_from(incidents.outerjoin(snapshots, snapshots.c.incident == incidents.c.id))
    .order_by(incidents.c.created)
)


def heads(engine: sa.Engine, followed: Collection[str]) -> list[Head]:
    """The incidents that are not folded to their end, and those that are followed already.

    One whose snapshot was made with another tracker, or was told otherwise, is not folded at all yet.

    Args:
        engine: of the log's database.
        followed: ids of the latter.

    Raises:
        LogUnreadable: the database failed.
    """
    with reading(engine) as connection:
        rows = connection.execute(_heads).all()
    return [_head(row) for row in rows if row.id in followed or not _folded(row)]


def _folded(row: Any) -> bool:
    if row.last_seq > row.snapshot_seq:
        return False
    return row.made_with is None or _stored(row.made_with) == _told(row.settings, row.origin)


def _head(row: Any) -> Head:
    told = _told(row.settings, row.origin)
    return Head(
        incident=row.id,
        closed=row.state == "closed",
        last_seq=row.last_seq,
        tracker=told.tracker,
        settings=told.settings,
        live=row.clock == "live",
    )


@lru_cache(MADE_WITH_KEPT)
def _stored(made_with: str) -> MadeWith:
    return msgspec.json.decode(made_with, type=MadeWith)


@lru_cache(MADE_WITH_KEPT)
def _told(settings: str, origin: str | None) -> MadeWith:
    """What an incident says, from its settings and its origin as they are stored."""
    known = IncidentSettings.model_validate_json(settings)
    place = None if origin is None else Origin.model_validate_json(origin)
    return MadeWith(known.tracker, _tracker_settings(known, place))


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
