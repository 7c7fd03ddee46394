"""Which incidents have log entries that are not in a snapshot yet: what the worker has to follow."""

from collections.abc import Collection
from functools import lru_cache
from typing import Any

import msgspec
import sqlalchemy as sa

from backend.log.engine import reading
from backend.log.incident import Incident, IncidentSettings, Origin
from backend.log.schema import incidents, snapshots, stretches
from estimator.trackers.base import TrackerSettings

MADE_WITH_KEPT = 4096
"""Decoded settings that are kept: all incidents are looked at several times a second."""


class MadeWith(msgspec.Struct, frozen=True):
    """What the numbers of a fold depend on beside the log.

    Attributes:
        tracker: name of the tracker.
        settings: what it is told.
        stretch: number of the incident's stretch in which it was told so.
    """

    tracker: str
    settings: TrackerSettings
    stretch: int = 0

    def tells_as(self, other: "MadeWith") -> bool:
        """The tracker is the same and told the same, if not in the same stretch."""
        return (self.tracker, self.settings) == (other.tracker, other.settings)

    def encoded(self) -> str:
        """As it is stored beside a snapshot."""
        return msgspec.json.encode(self).decode()

    @staticmethod
    def stored(encoded: str) -> "MadeWith":
        """The inverse of `encoded`."""
        return _stored(encoded)


class Head(msgspec.Struct, frozen=True, kw_only=True):
    """What the worker needs to know of an incident.

    Attributes:
        incident: its id.
        closed: it takes no more telemetry.
        last_seq: newest entry of its log.
        tracker: name of its tracker.
        settings: what its tracker is told.
        live: it goes by the server's clock.
        stretch: number of its newest stretch: as often has it been set otherwise since it was opened.
    """

    incident: str
    closed: bool
    last_seq: int
    tracker: str
    settings: TrackerSettings
    live: bool
    stretch: int = 0

    @property
    def made_with(self) -> MadeWith:
        """What a fold of it is made with."""
        return MadeWith(self.tracker, self.settings, self.stretch)


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
        sa.select(sa.func.max(stretches.c.number))
        .where(stretches.c.incident == incidents.c.id)
        .scalar_subquery()
        .label("stretch"),
    )
    .select_from(incidents.outerjoin(snapshots, snapshots.c.incident == incidents.c.id))
    .order_by(incidents.c.created)
)


def heads(engine: sa.Engine, followed: Collection[str]) -> list[Head]:
    """The incidents that are not folded to their end, and those that are followed already.

    One whose snapshot was made in an earlier stretch is not folded to its end, whatever was set.

    Args:
        engine: of the log's database.
        followed: ids of the latter.

    Raises:
        LogUnreadable: the database failed.
    """
    with reading(engine) as connection:
        rows = connection.execute(_heads).all()
    return [_head(row) for row in rows if row.id in followed or not _folded(row)]


def running(engine: sa.Engine) -> list[Head]:
    """The live incidents that take telemetry, in order of creation.

    Args:
        engine: of the log's database.

    Raises:
        LogUnreadable: the database failed.
    """
    taking = _heads.where(incidents.c.clock == "live", incidents.c.state != "closed")
    with reading(engine) as connection:
        return [_head(row) for row in connection.execute(taking)]


def _folded(row: Any) -> bool:
    if row.last_seq > row.snapshot_seq:
        return False
    return row.made_with is None or _stored(row.made_with) == _head(row).made_with


def _head(row: Any) -> Head:
    told = told_by(row.settings, row.origin)
    return Head(
        incident=row.id,
        closed=row.state == "closed",
        last_seq=row.last_seq,
        tracker=told.tracker,
        settings=told.settings,
        live=row.clock == "live",
        stretch=row.stretch,
    )


@lru_cache(MADE_WITH_KEPT)
def _stored(made_with: str) -> MadeWith:
    return msgspec.json.decode(made_with, type=MadeWith)


@lru_cache(MADE_WITH_KEPT)
def told_by(settings: str, origin: str | None, stretch: int = 0) -> MadeWith:
    """What an incident's tracker is told, by settings and an origin as they are stored."""
    known = IncidentSettings.model_validate_json(settings)
    place = None if origin is None else Origin.model_validate_json(origin)
    return MadeWith(known.tracker, _tracker_settings(known, place), stretch)


def head_of(incident: Incident) -> Head:
    """The head of an incident that is at hand."""
    return Head(
        incident=incident.id,
        closed=incident.state == "closed",
        last_seq=incident.last_seq,
        tracker=incident.settings.tracker,
        settings=_tracker_settings(incident.settings, incident.origin),
        live=incident.clock == "live",
        stretch=len(incident.stretches) - 1,
    )


def _tracker_settings(settings: IncidentSettings, origin: Origin | None) -> TrackerSettings:
    return TrackerSettings(
        lag_s=settings.lag_s,
        origin_wgs84=None if origin is None else (origin.lat, origin.lon, origin.hae),
    )
