"""Incidents in the database: create, read, change."""

import secrets
import time
from collections.abc import Iterable, Iterator
from typing import Any

import sqlalchemy as sa

from backend.errors import Conflict, NotFound
from backend.log.engine import reading, writing
from backend.log.incident import Clock, Incident, IncidentSettings, Level, Origin, State, Stretch
from backend.log.schema import batches, frames, incidents, stretches

HELD_BACK_S = 6 * 3600
"""What a gateway held back is no older; what is older has a wrong clock, and says nothing of when."""

_first_came = (
    sa.select(sa.cast(batches.c.received, sa.BigInteger))
    .where(batches.c.incident == incidents.c.id, batches.c.seq == 1)
    .correlate(incidents)
    .scalar_subquery()
)
_first = sa.select(sa.func.min(frames.c.second)).where(frames.c.incident == incidents.c.id)
_earliest = sa.case(
    (
        incidents.c.clock == "live",
        sa.func.coalesce(_first_came, sa.cast(incidents.c.created, sa.BigInteger)) - HELD_BACK_S,
    )
)
_first_trusted = _first.where(frames.c.second >= sa.func.coalesce(_earliest, 0))
_shown = sa.select(
    incidents,
    sa.func.coalesce(
        _first_trusted.correlate(incidents).scalar_subquery(), _first.correlate(incidents).scalar_subquery()
    ).label("first_t"),
    sa.select(sa.func.max(frames.c.second))
    .where(frames.c.incident == incidents.c.id)
    .scalar_subquery()
    .label("last_t"),
    _earliest.label("earliest_t"),
)
_stretches = sa.select(stretches).order_by(stretches.c.incident, stretches.c.number)
_BASE32 = "0123456789abcdefghjkmnpqrstvwxyz"
_RANDOM_BITS = 28


def new_incident_id(now: float) -> str:
    """An identifier that sorts by time and is not guessed: 32 bits of seconds, 28 random ones."""
    number = int(now) << _RANDOM_BITS | secrets.randbits(_RANDOM_BITS)
    return "i" + "".join(_BASE32[number >> shift & 31] for shift in range(55, -1, -5))


class IncidentStore:
    """Creates, reads and changes incidents; safe to use from any thread.

    Args:
        engine: of the log's database.
    """

    def __init__(self, engine: sa.Engine) -> None:
        self._engine = engine

    def create(
        self,
        name: str,
        clock: Clock,
        origin: Origin | None = None,
        levels: list[Level] | None = None,
        settings: IncidentSettings | None = None,
        created: float | None = None,
    ) -> Incident:
        """Store a new, active incident; `created` (Unix seconds) is now, unless it was opened elsewhere."""
        now = time.time()
        opened = Stretch(
            after_seq=0,
            since=now if created is None else created,
            origin=origin,
            levels=levels or [],
            settings=settings or IncidentSettings(),
        )
        incident = Incident(
            id=new_incident_id(now),
            name=name,
            clock=clock,
            state="active",
            origin=opened.origin,
            levels=opened.levels,
            settings=opened.settings,
            created=opened.since,
            closed=None,
            last_seq=0,
            first_t=None,
            last_t=None,
            earliest_t=None,
            stretches=[opened],
        )
        with writing(self._engine) as connection:
            values = incident.model_dump(exclude={"first_t", "last_t", "earliest_t", "stretches"})
            connection.execute(sa.insert(incidents).values(values))
            _begin(connection, incident.id, 0, opened)
            return _one(connection, _shown, incident.id)

    def get(self, incident: str) -> Incident:
        """One incident.

        Raises:
            NotFound: there is none of that id.
        """
        with reading(self._engine) as connection:
            return _one(connection, _shown, incident)

    def all(self, state: State | None = None) -> list[Incident]:
        """All incidents, or those in one state, oldest first."""
        query = _shown.order_by(incidents.c.created, incidents.c.id)
        if state is not None:
            query = query.where(incidents.c.state == state)
        with reading(self._engine) as connection:
            rows = connection.execute(query).all()
            return list(_incidents(rows, connection.execute(_stretches)))

    def change(self, incident: str, changes: dict[str, Any]) -> Incident:
        """Change an incident; another origin, levels or settings begin a new stretch of it.

        Args:
            incident: its id.
            changes: new values of `name`, `origin`, `levels`, `settings`, `state` (plain data); settings that
                are not named keep their value. `closed`, `since` (Unix seconds): when it was closed, or set,
                unless it is now.

        Raises:
            pydantic.ValidationError: the settings contradict those that stay.
            NotFound: there is none of that id.
            Conflict: it is closed and would be opened again.
        """
        with writing(self._engine) as connection:
            # The lock keeps a batch from being numbered while the incident closes.
            before = _one(connection, _shown.with_for_update(of=incidents), incident)
            if before.state == "closed" and changes.get("state") == "active":
                raise Conflict(
                    f"Incident {incident} is closed and stays so: its log is a finished record. "
                    "Create a new incident to go on."
                )
            if before.state == "active" and changes.get("state") == "closed":
                changes = {"closed": time.time()} | changes
            if "settings" in changes:
                merged = before.settings.model_dump() | changes["settings"]
                changes = changes | {"settings": IncidentSettings.model_validate(merged).model_dump()}
            # No stretch begins before the one that it ends, whatever has become of the clock.
            since = max(changes.get("since", time.time()), before.stretches[-1].since)
            values = {name: value for name, value in changes.items() if name != "since"}
            if values:
                connection.execute(sa.update(incidents).where(incidents.c.id == incident).values(values))
            after = _one(connection, _shown, incident)
            told = Stretch(
                after_seq=after.last_seq,
                since=since,
                origin=after.origin,
                levels=after.levels,
                settings=after.settings,
            )
            if after.set_to(after.stretches[-1]) == after:
                return after
            _begin(connection, incident, len(after.stretches), told)
            return after.model_copy(update={"stretches": [*after.stretches, told]})


def _one(connection: sa.Connection, query: sa.Select[Any], incident: str) -> Incident:
    # An id with NUL in it would be refused by Postgres itself, with an error that reads like a defect.
    row = None if "\x00" in incident else connection.execute(query.where(incidents.c.id == incident)).first()
    if row is None:
        raise NotFound(f"There is no incident {incident!r}: GET /api/v1/incidents lists them.")
    told = connection.execute(_stretches.where(stretches.c.incident == incident))
    return next(_incidents([row], told))


def _incidents(rows: Iterable[sa.Row[Any]], told: Iterable[sa.Row[Any]]) -> Iterator[Incident]:
    """Incidents from their rows, and those of all their stretches in order."""
    of: dict[str, list[dict[str, Any]]] = {}
    for one in told:
        values = one._asdict()
        del values["number"]
        of.setdefault(values.pop("incident"), []).append(values)
    for row in rows:
        yield Incident.model_validate(row._asdict() | {"stretches": of[row.id]})


def _begin(connection: sa.Connection, incident: str, number: int, stretch: Stretch) -> None:
    values = stretch.model_dump() | {"incident": incident, "number": number}
    connection.execute(sa.insert(stretches).values(values))
